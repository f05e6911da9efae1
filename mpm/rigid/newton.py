"""Implicit steps on enthalpy: stages of an L-stable SDIRK method, each by Newton.

    m (h_i - g) = gamma dt F(h_i),   g = h_n + dt sum_j<i a_ij F_j / m        F: mpm.rigid.enthalpy.rate
    (m/theta' + gamma dt (D K D + B)) dtheta = -residual,   dh = dtheta/theta',   D = sqrt(kappa)     theta' = d theta/d h

One band Cholesky an iteration; symmetric, because D K D stands for K kappa (the same for constant kappa; otherwise convergence is linear,
at the relative change of kappa over a cell). An iteration that does not lower the residual is halved. What counts as F_j is the rate at the
last iterate, and the step ends with h + dt sum b_j F_j: the heat ledger closes to round-off whatever Newton left, and no step can jump over latent heat.
Good values  large beta h/kappa (beta = inf), fine cells with smooth alpha(theta). Elsewhere mpm.rigid.chebyshev is faster: figures in mpm/rigid/__init__.py.
"""

import numpy as np

from mpm.jit import kernel
from mpm.rigid.band import back_substitute, factorise, make_band
from mpm.rigid.enthalpy import Enthalpy, rate
from mpm.rigid.ordered import combined, dot
from mpm.rigid.sdirk import TABLEAUS
from mpm.rigid.surroundings import radiate_slope
from mpm.rigid.tables import look_up

ITERATIONS, HALVINGS, CLOSE = 25, 8, 1e-2  # residual in enthalpy over the step's tolerance
FLOOR = 0.03  # of h^2/diffusivity, as in mpm.rigid.linear


@kernel
def jacobian(problem, band, h, dt, slope):
    """band = m/theta' + dt (D on_potential D + on_theta), slope = theta'."""
    n = len(h)
    theta, potential, conductance, root = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    look_up(problem.table, h, theta, potential, slope, conductance)
    for i in range(n):
        root[i] = np.sqrt(max(conductance[i], 0.0) / slope[i])
    band[:] = 0.0
    for o in range(len(problem.on_theta)):
        k = problem.diff[o]
        for i in range(n - k):
            band[i, k] = dt * problem.on_theta[o, i]
        if len(problem.on_potential) > 0:
            for i in range(n - k):
                band[i, k] += dt * problem.on_potential[o, i] * root[i] * root[i + k]
    radiate_slope(problem.radiant, theta, dt, band)
    for i in range(n):
        band[i, 0] += problem.mass[i] / slope[i]


class NewtonSteps(Enthalpy):
    """Implicit steps of one body on enthalpy."""

    CARRIES = ("state", "q", "now", "iterations")
    replan, radius, close = False, 0.0, CLOSE

    def __init__(self, system, tolerance: float, order: int = 2):
        super().__init__(system, tolerance)
        self.tableau = TABLEAUS[order]
        self.power = self.tableau.power
        self.reach = int(self.problem.diff[-1])
        self.band = make_band(len(self.state), self.reach)
        self.floor = FLOOR / self.diffusion if self.diffusion > 0 else 0.0
        self.iterations = 0

    def first_size(self, end: float) -> float:
        return min(end, self.floor) if self.floor > 0 else end

    def stage(self, base, dt: float, around, h, f):
        """Newton for h = base + dt F(h) from the guess h: (h, heat taken in a second) with f = F(h), or None where it does not converge."""
        problem, work = self.problem, np.empty((3, len(h)))
        theta, scratch, slope = work
        taken = rate(problem, around, h, f, theta, scratch)
        residual = h - base - dt * f
        size = self.norm(residual)
        for _ in range(ITERATIONS):
            if size <= self.close * self.allowed:
                return h, taken
            jacobian(problem, self.band, h, dt, slope)
            if factorise(self.band, len(h), self.reach) >= 0:
                return None
            self.iterations += 1
            step = problem.mass * residual
            back_substitute(self.band, self.reach, step)
            step /= slope
            for halving in range(HALVINGS):
                trial = h - step / 2**halving
                taken = rate(problem, around, trial, f, theta, scratch)
                residual = trial - base - dt * f
                new = self.norm(residual)
                if new < size:
                    break
            else:
                return None
            h, size = trial, new
        return None

    def norm(self, residual) -> float:
        return float(np.sqrt(dot(self.weight, residual * residual)))

    def attempt(self, dt: float) -> float:
        a = self.tableau.a
        f, q, guess = np.empty((len(a), len(self.state))), [0.0] * len(a), self.state
        for i, row in enumerate(a):
            found = self.stage(self.state + combined(dt * row[:i], f[:i]), dt * row[i], self.around(self.now + dt * row.sum()), guess, f[i])
            if found is None:
                return np.inf
            guess, q[i] = found
        self.rates, self.taken, self.dt, self.reached = f, np.array(q), dt, guess
        return self.norm(combined(dt * self.tableau.error, f)) / self.allowed

    def accept(self):
        weights = self.dt * self.tableau.a[-1]
        self.before_q = self.q
        self.state = self.state + combined(weights, self.rates)
        self.q = self.q + combined(weights, self.taken)
        self.now += self.dt

    def dense(self, s):
        """Basis (S, m), columns (m, N), exchanged heat (S,)."""
        basis = self.dt * self.tableau.weights(s)
        return basis, self.rates, self.before_q + combined(basis, self.taken)
