"""Stabilised explicit steps: the Runge-Kutta-Chebyshev method of order 2 (Sommeijer, Shampine & Verwer 1997, RKC).

s stages reach dt = 0.653 (s + 1)^2/lambda, against 2/lambda of Euler: cost per time falls as 1/s. lambda bounds the spectral radius of the
rate: the largest d theta/d h times that of M^-1 (kappa K + B), by power iteration. Error estimate 0.8 (h_n - h_n+1) + 0.4 dt (F_n + F_n+1),
root mean square over the body's mass, against the range of enthalpy in the data. The heat taken in is one more unknown of the same
recurrence, so the ledger closes to round-off. Dense output: cubic Hermite.
Fails when   beta h/kappa is large (lambda grows with it): implicit then.
"""

import numpy as np

from mpm.jit import kernel
from mpm.rigid.enthalpy import Enthalpy, rate
from mpm.rigid.nodes import apply
from mpm.rigid.ordered import combined, dot
from mpm.rigid.surroundings import Around, between

DAMPING = 2.0 / 13.0
FIRST = 0.05  # of h^2/diffusivity
TURNS, MARGIN = 30, 1.1  # of the power iteration, and over it
STAGES = 1000  # most a step
ROUNDOFF_STAGE = 1e-16  # of the heat that moves, times s^2


def spectral_radius(problem, conductivity: float) -> float:
    """Of M^-1 (conductivity on_potential + on_theta), from below, by TURNS power iterations."""
    n = len(problem.mass)
    x, y, z = (1 + 0.37 * np.sin(1 + 7.1 * np.arange(n))) * np.where(np.arange(n) % 2, -1.0, 1.0), np.empty(n), np.zeros(n)
    x[problem.weight == 0] = 0.0
    largest = 0.0
    for _ in range(TURNS):
        size = np.sqrt(dot(problem.weight, x * x))
        if size == 0.0:
            break
        x /= size
        apply(problem.on_theta, problem.diff, x, y)
        if len(problem.on_potential):
            apply(problem.on_potential, problem.diff, x, z)
        x = (y + conductivity * z) / problem.mass
        largest = max(largest, float(np.sqrt(dot(problem.weight, x * x))))
    return largest


@kernel(inline=True)
def settle(problem, gained, taken, s):
    """Spread over the body what the round-off of s stages has put between sum m `gained` and the heat taken; more would be an error, and the ledger shows."""
    total, size = 0.0, 0.0
    for i in range(len(gained)):
        total += problem.weight[i] * gained[i]
        size += problem.weight[i] * abs(gained[i])
    gap = taken - total
    if abs(gap) <= ROUNDOFF_STAGE * s * s * size:
        gap /= np.sum(problem.weight)
        for i in range(len(gained)):
            if problem.weight[i] > 0.0:
                gained[i] += gap


@kernel
def chebyshev(problem, ends, changes, h, f0, q0, dt, s, new, f1):
    """One step of s >= 2 stages: `new` enthalpies, rate f1 there, (heat taken in the step, its rate at the end, squared error norm).

    h, f0 (N,) and q0 [W] are the state, its rate and the heat taken a second at the start; ends: Around at both, equal unless it `changes`.
    """
    first, final = ends
    n = len(h)
    w0 = 1.0 + DAMPING / s**2
    t1 = w0 * w0 - 1.0
    root = np.sqrt(t1)
    arg = s * np.log(w0 + root)
    w1 = np.sinh(arg) * t1 / (np.cosh(arg) * s * root - w0 * np.sinh(arg))
    b1 = 1.0 / (2.0 * w0) ** 2
    b2 = b1
    before, last, after = np.zeros(n), np.empty(n), np.empty(n)  # increments over h: the recurrence multiplies round-off by s^2, of these and not of h
    theta, work, here = np.empty(n), np.empty(n), np.empty(n)
    mu = w1 * b1 * dt
    for i in range(n):
        last[i] = mu * f0[i]
    q_before, q_last = 0.0, mu * q0
    t_before, t_last = 0.0, mu / dt  # of the step: time goes by the same recurrence
    supply, sky = np.empty(n if changes else 0), np.empty(len(first.sky))
    z1, z2, dz1, dz2, d2z1, d2z2 = w0, 1.0, 1.0, 0.0, 0.0, 0.0
    for _ in range(2, s + 1):
        z = 2.0 * w0 * z1 - z2
        dz = 2.0 * w0 * dz1 - dz2 + 2.0 * z1
        d2z = 2.0 * w0 * d2z1 - d2z2 + 4.0 * dz1
        b = d2z / dz**2
        a1 = 1.0 - z1 * b1
        mu, nu = 2.0 * w0 * b / b1, -b / b2
        step = mu * w1 / w0 * dt
        for i in range(n):
            here[i] = h[i] + last[i]
        if changes:
            received = between(first, final, t_last, supply, sky)
            taken = rate(problem, Around(supply, received, sky), here, f1, theta, work)
        else:
            taken = rate(problem, first, here, f1, theta, work)
        lag = a1 * step
        for i in range(n):
            after[i] = mu * last[i] + nu * before[i] + step * f1[i] - lag * f0[i]
        q_after = mu * q_last + nu * q_before + step * taken - lag * q0
        before, last, after = last, after, before
        q_before, q_last = q_last, q_after
        t_after = mu * t_last + nu * t_before + (step - lag) / dt
        t_before, t_last = t_last, t_after
        b2, b1 = b1, b
        z2, z1, dz2, dz1, d2z2, d2z1 = z1, z, dz1, dz, d2z1, d2z
    settle(problem, last, q_last, s)
    for i in range(n):
        new[i] = h[i] + last[i]
    q1 = rate(problem, final, new, f1, theta, work)
    error = 0.0
    for i in range(n):
        e = 0.8 * (h[i] - new[i]) + 0.4 * dt * (f0[i] + f1[i])
        error += problem.mass[i] * e * e
    return q_last, q1, error


class ChebyshevSteps(Enthalpy):
    """Explicit steps of one body, as many stages as the step needs."""

    CARRIES = ("state", "q", "now", "rate", "taken", "evaluations")
    replan, power, floor = False, 3, 0.0

    def __init__(self, system, tolerance: float):
        super().__init__(system, tolerance)
        stiff = self.problem if len(system.hot) == 0 else self.problem._replace(on_theta=self.problem.on_theta + system.hot)
        self.radius = MARGIN * self.problem.table.steepest * spectral_radius(stiff, self.problem.table.conductivity)
        self.evaluations = 0
        self.restart()

    def restart(self) -> None:
        """The rate of the state that it begins with."""
        self.rate, scratch = np.empty_like(self.state), np.empty((2, len(self.state)))
        self.taken = rate(self.problem, self.around(self.now), self.state, self.rate, scratch[0], scratch[1])
        self.evaluations += 1

    def first_size(self, end: float) -> float:
        return min(end, FIRST / self.diffusion) if self.diffusion > 0 else end

    def attempt(self, dt: float) -> float:
        s = max(2, 1 + int(np.sqrt(1.54 * dt * self.radius + 1.0)))
        if s > STAGES:
            return np.inf
        new, f1 = np.empty_like(self.state), np.empty_like(self.state)
        first, changes = self.around(self.now), self.system.programmes.changes
        q, q1, error = chebyshev(self.problem, (first, self.around(self.now + dt)), changes, self.state, self.rate, self.taken, dt, s, new, f1)
        self.evaluations += s
        self.trial = dt, new, f1, q, q1
        return float(np.sqrt(error)) / self.allowed

    def accept(self):
        dt, new, f1, q, q1 = self.trial
        self.columns = np.stack([new - self.state, dt * self.rate, dt * f1])
        self.steps = self.q, np.array([q, dt * self.taken, dt * q1])
        self.state, self.rate, self.taken, self.q = new, f1, q1, self.q + q
        self.now += dt

    def dense(self, s):
        """Hermite basis (S, 3), columns (3, N), exchanged heat (S,)."""
        s = np.asarray(s, dtype=float)
        basis = np.stack([s * s * (3 - 2 * s), s * (1 - s) ** 2, s * s * (s - 1)], axis=-1)
        start, columns = self.steps
        return basis, self.columns, start + combined(basis, columns)
