"""Solvers of S x = b, S = M + gamma dt A: a band Cholesky factor, or conjugate gradients on the stencil where a factor is too large (3-D).

Conjugate gradients, preconditioned by an incomplete Cholesky factor on the stencil's own places (zero fill). They end when the residual, weighted with 1/D,
is below `tolerance` of that of b; then the body's mean is set so that 1.S x = 1.b to round-off: the heat ledger does not see the tolerance.
Iterations to 1e-7, sphere of 8 cells a radius, gamma dt = 0.01: Bi 10: 81 by the diagonal, 39 by a symmetric Gauss-Seidel sweep, 5 by this one;
beta = inf (a penalty of 1e5 kappa/h): 1411, 908, 176: there the factor needs a shift of its diagonal, doubled from SHIFT until all pivots are positive.
Good values  tolerance 1e-4 of the step's.   Fails when: MOST_ITERATIONS iterations do not do (the step is rejected, and a shorter one tried).
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel, role
from mpm.rigid.band import back_substitute, factorise, fill, make_band
from mpm.rigid.nodes import apply

MOST_ITERATIONS, SHIFT = 1000, 1e-3


class Factor(NamedTuple):
    """Band Cholesky."""

    band: np.ndarray  # mpm.rigid.band.make_band
    reach: int  # numbers below the diagonal


class Gradients(NamedTuple):
    """The stencil of S itself, and what conjugate gradients need."""

    diff: np.ndarray
    stencil: np.ndarray  # (n, N), one on the diagonal of idle nodes
    factor: np.ndarray  # (N, n) incomplete: row j is column j of L
    slot: np.ndarray  # (n, n) place of the difference of two differences, -1 outside the stencil
    sums: np.ndarray  # (N,) S 1, zero on idle nodes
    tolerance: float
    count: np.ndarray  # (2,) solutions and iterations so far; the first is -1 after one that did not converge


def make_factor(diff, size: int) -> Factor:
    return Factor(make_band(size, int(diff[-1])), int(diff[-1]))


def make_gradients(diff, size: int, tolerance: float) -> Gradients:
    apart = diff[None] - diff[:, None]
    place = np.minimum(np.searchsorted(diff, apart), len(diff) - 1)
    slot = np.where(diff[place] == apart, place, -1)
    return Gradients(diff, np.empty((len(diff), size)), np.empty((size, len(diff))), slot, np.empty(size), tolerance, np.zeros(2, np.int64))


@role
def prepare(solver, diff, a, first, b, second, idle, sums):
    """S = first a + second b from stencils (n, N), whose row sums are `sums`; false where it has no positive pivots."""
    raise TypeError(f"no solver {type(solver).__name__}")


@role
def invert(solver, x, guess):
    """x <- S^-1 x, from `guess` where the solver takes one."""
    raise TypeError(f"no solver {type(solver).__name__}")


@prepare.register(Factor)
def prepare_factor(solver, diff, a, first, b, second, idle, sums):
    fill(solver.band, diff, a, first, b, second, idle)
    return factorise(solver.band, a.shape[1], solver.reach) < 0


@invert.register(Factor)
def invert_factor(solver, x, guess):
    back_substitute(solver.band, solver.reach, x)


@prepare.register(Gradients)
def prepare_gradients(solver, diff, a, first, b, second, idle, sums):
    for o in range(a.shape[0]):
        for i in range(a.shape[1]):
            solver.stencil[o, i] = first * a[o, i] + second * b[o, i]
    for i in range(a.shape[1]):
        solver.sums[i] = 0.0 if idle[i] else sums[i]
        if idle[i]:
            solver.stencil[0, i] = 1.0
    shift = 0.0
    while shift < 2.0:
        if incomplete(solver, shift):
            return True
        shift = max(2.0 * shift, SHIFT)
    return False


@kernel
def incomplete(solver, shift):
    """The factor of S with its diagonal raised by `shift`; false where a pivot is not positive."""
    L, diff = solver.factor, solver.diff
    n, m = L.shape
    for i in range(n):
        for o in range(m):
            L[i, o] = solver.stencil[o, i]
        L[i, 0] *= 1.0 + shift
    for j in range(n):
        if not L[j, 0] > 0.0:
            return False
        L[j, 0] = np.sqrt(L[j, 0])
        for o in range(1, m):
            L[j, o] /= L[j, 0]
        for o in range(1, m):
            f = L[j, o]
            if f != 0.0 and j + diff[o] < n:
                for k in range(o, m):
                    if solver.slot[o, k] >= 0:
                        L[j + diff[o], solver.slot[o, k]] -= f * L[j, k]
    return True


@kernel
def ready(solver, diff, a, first, b, second, idle, sums):
    """`prepare`, compiled."""
    return prepare(solver, diff, a, first, b, second, idle, sums)


@kernel
def inverted(solver, x):
    """`invert` from nothing, compiled."""
    invert(solver, x, np.zeros(len(x)))


@kernel
def smooth(solver, z):
    """z <- (L L^T)^-1 z."""
    L, diff = solver.factor, solver.diff
    n, m = L.shape
    for j in range(n):
        y = z[j] / L[j, 0]
        z[j] = y
        if y != 0.0:
            for o in range(1, m if j + diff[-1] < n else np.searchsorted(diff, n - j)):
                z[j + diff[o]] -= L[j, o] * y
    for j in range(n - 1, -1, -1):
        y = z[j]
        for o in range(1, m if j + diff[-1] < n else np.searchsorted(diff, n - j)):
            y -= L[j, o] * z[j + diff[o]]
        z[j] = y / L[j, 0]


@invert.register(Gradients)
def invert_gradients(solver, x, guess):
    n, S = len(x), solver.stencil
    b, r, p, z, q = x.copy(), np.empty(n), np.zeros(n), np.empty(n), np.empty(n)
    goal = 0.0
    for i in range(n):
        x[i] = guess[i]
    for i in range(n):
        goal += b[i] * b[i] / S[0, i]
    goal *= solver.tolerance * solver.tolerance
    apply(S, solver.diff, x, q)
    for i in range(n):
        r[i] = b[i] - q[i]
    before, done = 1.0, False
    for _ in range(MOST_ITERATIONS):
        size = 0.0
        for i in range(n):
            size += r[i] * r[i] / S[0, i]
        if size <= goal:
            done = True
            break
        z[:] = r
        smooth(solver, z)
        rho = 0.0
        for i in range(n):
            rho += r[i] * z[i]
        for i in range(n):
            p[i] = z[i] + rho / before * p[i]
        before = rho
        apply(S, solver.diff, p, q)
        curve = 0.0
        for i in range(n):
            curve += p[i] * q[i]
        step = rho / curve
        for i in range(n):
            x[i] += step * p[i]
            r[i] -= step * q[i]
        solver.count[1] += 1
    solver.count[0] = solver.count[0] + 1 if done and solver.count[0] >= 0 else -1
    apply(S, solver.diff, x, q)
    left, whole = 0.0, 0.0
    for i in range(n):
        left += b[i] - q[i]
        whole += solver.sums[i]
    for i in range(n):
        if solver.sums[i] != 0.0:
            x[i] += left / whole
