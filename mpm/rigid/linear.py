"""Constant kappa and alpha: consistent mass, L-stable implicit steps; one factorisation a step size, or conjugate gradients (mpm.rigid.gradients).

    M u' = s - A u,   M = rho alpha int N N,   A = kappa K + sum beta B,   s = sum beta (outside - zero) int N        u = theta - zero
    (M + gamma dt A) k_i = s - A (u + dt sum_j<i a_ij k_j)

Cholesky does not mind nodes that hardly touch the body: it is blind to diagonal scaling.
Error estimate: dt (W M)^FILTERS sum e_i k_i, W = (M + gamma dt A)^-1 (damped like the method itself, Hairer & Wanner IV.8), root mean square over the body.
Heat: 1.M k_i = 1.(s - A Y_i) with 1.K = 0, so the exchange sum is sum b_i (sum beta area outside - ...) to the round-off of the solve. Behind a stiff
surface (beta h/kappa = 1e5 stands for infinity) that is 3e-12 of the heat: what is below ROUNDOFF is spread evenly over the body (ledger 1e-15).
Good values  tolerance 1e-4 of the largest temperature difference; order 4.
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.rigid.geometry import evaluated
from mpm.rigid.gradients import Gradients, invert, inverted, make_factor, make_gradients, ready
from mpm.rigid.nodes import apply
from mpm.rigid.ordered import combined, dot
from mpm.rigid.sdirk import TABLEAUS

FILTERS, ROUNDOFF = 2, 1e-10
CANCELLED = 1e-4  # times ROUNDOFF, of the terms that nearly cancel behind a stiff surface whose temperature changes
FLOOR = 0.03  # of h^2 rho alpha/kappa
CLOSE = 1e-4  # residual of conjugate gradients over the tolerance of a step


class Problem(NamedTuple):
    """M, A (stencils), s, and what the surface takes: received - facing . u."""

    diff: np.ndarray
    mass: np.ndarray
    matrix: np.ndarray
    facing: np.ndarray
    weight: np.ndarray  # M 1


@kernel
def stages(problem, solver, tableau, filters, slack, dt, u, around, k, flux):
    """Stage slopes k (m, N), guessed from those of the last step, and the exchange rate of each stage, by a solver of M + gamma dt A.

    What the sum of a slope misses of it is spread over the body, up to `slack` of the heat that moves (below 0: never).
    Returns the square of the mass norm of the error, filtered so many times."""
    (a, error), (supply, received) = tableau, around
    n, m = len(u), len(a)
    y, work = np.empty(n), np.empty(n)
    for i in range(m):
        for p in range(n):  # numpy's own way to fill an array compiles the words of its errors
            y[p] = u[p]
        for j in range(i):
            f = dt * a[i, j]
            for p in range(n):
                y[p] += f * k[j, p]
        apply(problem.matrix, problem.diff, y, work)
        for p in range(n):
            work[p] = supply[i, p] - work[p]
        invert(solver, work, k[i - 1] if i > 0 else k[m - 1])
        taken, total, size, scale = received[i], 0.0, 0.0, abs(received[i])
        for p in range(n):
            k[i, p] = work[p]
        for p in range(n):  # sums apart from stores: see mpm.rigid.ordered
            passed = problem.facing[p] * (y[p] + dt * a[i, i] * work[p])
            taken -= passed
            scale += abs(passed)
            total += problem.weight[p] * work[p]
            size += problem.weight[p] * abs(work[p])
        flux[i] = taken
        if abs(taken - total) <= slack * (size + CANCELLED * scale):  # more would be an error, and the ledger has to show it
            gap, whole = taken - total, np.sum(problem.weight)
            for p in range(n):
                if problem.weight[p] > 0.0:
                    k[i, p] += gap / whole
    work[:] = 0.0
    for i in range(m):
        f = dt * error[i]
        for p in range(n):
            work[p] += f * k[i, p]
    square = 0.0
    for turn in range(filters + 1):
        for p in range(n):
            y[p] = work[p]
        apply(problem.mass, problem.diff, y, work)
        if turn < filters:
            invert(solver, work, u * 0.0)
    for p in range(n):
        square += y[p] * work[p]
    return square


class LinearSteps:
    """Implicit steps of one body; the driver's protocol is in mpm.rigid.time_loop."""

    CARRIES = ("state", "q", "now", "slopes")
    radius, closes = 0.0, ROUNDOFF

    def __init__(self, system, tolerance: float, order: int = 4, iterate: bool = False, checked: bool = True):
        """system: mpm.rigid.system.System with constant laws; iterate: by conjugate gradients, not by a factorisation; checked: the error is looked at."""
        self.filters = FILTERS if checked else 0
        self.system, self.tableau = system, TABLEAUS[order]
        shaped, capacity = system.geometry, system.density * system.alpha.constant
        matrix = system.kappa.constant * shaped.stiffness + system.exchange
        self.weight = capacity * shaped.volume
        self.problem = Problem(shaped.nodes.diff, capacity * shaped.mass, matrix, system.facing, self.weight)
        self.allowed = tolerance * system.span * np.sqrt(self.weight.sum())
        self.idle = ~shaped.active
        self.solver = make_gradients(shaped.nodes.diff, shaped.nodes.size, CLOSE * tolerance) if iterate else make_factor(shaped.nodes.diff, shaped.nodes.size)
        self.replan = not iterate  # a new size costs a factorisation
        self.size, self.slopes = None, np.zeros((len(self.tableau.a), shaped.nodes.size))
        self.now, self.longest, self.steady = 0.0, system.programmes.longest, None
        self.state = np.where(self.idle, 0.0, system.start - system.zero) if system.field is None else self.project(system.field)
        self.first, self.q, self.power = self.state, 0.0, self.tableau.power
        conductivity = system.kappa.constant
        self.floor = FLOOR * shaped.nodes.h**2 * capacity / conductivity if conductivity > 0 else 0.0

    def first_size(self, end: float) -> float:
        return min(end, max(self.floor, end / 4096)) if self.floor > 0 else end

    def project(self, field):
        """The start by least squares over the body: M u = rho alpha int N (field - zero)."""
        shaped, load = self.system.geometry, np.zeros(len(self.weight))
        index, spline = evaluated(shaped.nodes, shaped.x)
        each = (self.system.density * self.system.alpha.constant * shaped.w * (field(shaped.x) - self.system.zero))[:, None] * spline
        np.add.at(load, index, each)
        if not self.prepared(0.0):
            raise ValueError("the mass matrix of a rigid body is singular: the body is too thin for the cell")
        load[self.idle] = 0.0
        inverted(self.solver, load)
        return load

    def prepared(self, dt: float) -> bool:
        """Whether the solver is ready for M + dt A."""
        problem = self.problem
        return ready(self.solver, problem.diff, problem.mass, 1.0, problem.matrix, dt, self.idle, problem.weight + dt * problem.facing)

    def surroundings(self, dt: float):
        """Supply (m, N) and its sum (m,) at the stages of a step."""
        if self.steady is None or self.system.programmes.changes:
            around = [self.system.programmes.around(self.now + part * dt) for part in self.tableau.a.sum(axis=1)]
            self.steady = np.array([one.supply for one in around]), np.array([one.received for one in around])
        return self.steady

    def attempt(self, dt: float) -> float:
        """Error of a step of size dt over the tolerance."""
        tableau = self.tableau
        if dt != self.size:
            self.size = dt if self.prepared(tableau.gamma * dt) else None
            if self.size is None:
                return np.inf
        k, flux = self.slopes.copy(), np.empty(len(tableau.a))
        way = tableau.a, tableau.error
        square = stages(self.problem, self.solver, way, self.filters, self.closes, dt, self.state, self.surroundings(dt), k, flux)
        if isinstance(self.solver, Gradients) and self.solver.count[0] < 0:
            self.solver.count[0] = 0
            return np.inf
        self.stages, self.fluxes, self.dt = k, flux, dt
        return float(np.sqrt(max(square, 0.0))) / self.allowed

    def accept(self):
        weights = self.tableau.a[-1]
        self.slopes = self.stages
        self.q_before = self.q
        self.state = self.state + combined(self.dt * weights, self.stages)
        self.q = self.q + self.dt * combined(weights, self.fluxes)
        self.now += self.dt

    def dense(self, s):
        """Basis (S, m) and columns (m, N), exchanged heat (S,): state = before + basis @ columns."""
        basis = self.dt * self.tableau.weights(s)
        return basis, self.stages, self.q_before + combined(basis, self.fluxes)

    def temperature(self, state):
        return state

    def heat(self, state):
        """Heat content above `zero` [J]."""
        return dot(state, self.weight)
