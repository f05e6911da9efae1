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
from mpm.rigid.band import back_substitute, factorise
from mpm.rigid.enthalpy import Enthalpy, rate
from mpm.rigid.sdirk import TABLEAUS
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
    for i in range(n):
        band[i, 0] += problem.mass[i] / slope[i]


@kernel
def norm(problem, r):
    return np.sqrt(np.sum(problem.mass * r * r))


@kernel
def stage(problem, band, base, dt, allowed, h, f):
    """Newton for h = base + dt F(h), from the guess h; (iterations or -1, heat taken a second). f: the rate at the last h."""
    n = len(h)
    theta, work, slope, r, step, trial = np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    taken = rate(problem, h, f, theta, work)
    r[:] = h - base - dt * f
    size = norm(problem, r)
    for count in range(ITERATIONS):
        if size <= CLOSE * allowed:
            return count, taken
        jacobian(problem, band, h, dt, slope)
        if factorise(band) >= 0:
            return -1, taken
        step[:] = problem.mass * r
        back_substitute(band, step)
        part = 1.0
        for _ in range(HALVINGS):
            trial[:] = h - part * step / slope
            taken = rate(problem, trial, f, theta, work)
            r[:] = trial - base - dt * f
            new = norm(problem, r)
            if new < size:
                break
            part *= 0.5
        if not new < size:
            return -1, taken
        h[:], size = trial, new
    return -1, taken


@kernel
def step(problem, band, a, dt, h, allowed, f, q):
    """Rates f (m, N) and heats q (m,) of all stages; Newton iterations, or -1."""
    guess, base = h.copy(), np.empty_like(h)
    total = 0
    for i in range(len(a)):
        base[:] = h
        for j in range(i):
            base += dt * a[i, j] * f[j]
        count, q[i] = stage(problem, band, base, dt * a[i, i], allowed, guess, f[i])
        if count < 0:
            return -1
        total += count
    return total


class NewtonSteps(Enthalpy):
    """Implicit steps of one body on enthalpy."""

    replan, radius = False, 0.0

    def __init__(self, system, tolerance: float, order: int = 2):
        super().__init__(system, tolerance)
        self.tableau = TABLEAUS[order]
        self.power = self.tableau.power
        self.band = np.empty((len(self.state), int(self.problem.diff[-1]) + 1))
        self.floor = FLOOR / self.diffusion if self.diffusion > 0 else 0.0
        self.iterations = 0

    def first_size(self, end: float) -> float:
        return min(end, self.floor) if self.floor > 0 else end

    def attempt(self, dt: float) -> float:
        f, q = np.empty((len(self.tableau.a), len(self.state))), np.empty(len(self.tableau.a))
        count = step(self.problem, self.band, self.tableau.a, dt, self.state, self.allowed, f, q)
        if count < 0:
            return np.inf
        self.iterations += count
        self.rates, self.taken, self.dt = f, q, dt
        error = (dt * self.tableau.error) @ f
        return float(np.sqrt(np.sum(self.weight * error * error))) / self.allowed

    def accept(self):
        weights = self.dt * self.tableau.a[-1]
        self.before_q = self.q
        self.state = self.state + weights @ self.rates
        self.q += float(weights @ self.taken)

    def dense(self, s):
        """Basis (S, m), columns (m, N), exchanged heat (S,)."""
        basis = self.dt * self.tableau.weights(s)
        return basis, self.rates, self.before_q + basis @ self.taken
