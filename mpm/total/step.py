"""The mechanical step of a body in the total frame: velocity Verlet on the nodes, and how long it may be.

p <- ((1 - dt d/2) p + dt/2 a) twice a step, in the middle at once, a = (f + s(t) load)/m + g,  d: rate of the drag, the second half implicit: no limit from it
v from p (mpm.total.inertia);  u <- u + dt v
f = -sum V0 P grad_X w from F(u); walls hold nodes, and what lies behind them mirrors what is inside
load, where it is by present area, from F(u) at points of the surface (mpm.total.forces.press)

Largest stable step, at rest: frequencies are below those of single particles on their own masses (Fried 1972, for elements),
    omega^2 <= max_p T_p (D lam + 2 mu)/R0,   T_p = largest of sum_i (d_k w_ip)^2/w_ip over directions k,   dt < 2/omega.
Beside a wall that sticks, where splines are other ones, T is that of all points of a span together (clamped_spread).
Quadratic splines have T_p h^2 = 4.5 at Gauss points of whole spans and at most 6 at cut ones, so 2/omega is 0.94 to 0.82 h sqrt(R0/(D lam + 2 mu));
compressed or stressed material is stiffer, in the reference shape by one over the squared stretch. SHARE of it is taken.
Inertia by neighbours (mpm.total.inertia) raises the highest frequency by a sixth, which is within what these bounds leave.
Errors       order 2 in time and in the cell; the energy of a free mode omega swings by (omega dt)^2/4, without drift
Fails when   waves shorter than two cells matter: nothing damps them
"""

import numpy as np

from mpm.basis import stencil
from mpm.boundary import STICK, directions, extents
from mpm.integrate.strain import CODE, STEP, STRAIN, WORKED
from mpm.integrate.traction import share, within
from mpm.jit import kernel
from mpm.state import PAD, Axisymmetric, Cubic
from mpm.total.forces import act_on, average_volume, press
from mpm.total.inertia import follow
from mpm.total.reference import fold, hold, mirror
from mpm.total.strain import answer_all
from mpm.transfer import CHUNK, give, lay_down, new_chunk, take

SHARE = 0.9  # of the largest stable step


@kernel
def advance_total(space, body, reference, gravity, dt, steps, report):
    """`steps` steps of dt of one body; gravity (1 or steps + 1, D), at the kicks [m/s2].

    report (REPORT,): integrate/strain.py, its STRAIN such that 1 - STRAIN is how much stiffer than at rest it is.
    """
    chunk, rows, begun = new_chunk(gravity.shape[1], reference.f, True, False), len(gravity), report[STRAIN]
    x = 0.5 * dt * reference.drag * within(reference.ramp, reference.t[0], 0.0)
    squeeze = force_all(space, body, reference, chunk, 0.0 * dt, report)
    for step in range(steps):
        if report[CODE] == 0.0:
            opening = step == 0
            kick(reference, gravity[step % rows], 0.0, 1.0 - x if opening else (1.0 - x) / (1.0 + x), 0.5 * dt if opening else dt / (1.0 + x))
            follow(reference)
            report[WORKED] += dt * power(reference, dt)
            drift(reference, dt)
            press(reference.skin, space, reference, chunk, dt, report)
            squeeze = max(squeeze, force_all(space, body, reference, chunk, dt, report))
            report[STEP] = step
    kick(reference, gravity[steps % rows], 1.0, 1.0 / (1.0 + x), 0.5 * dt / (1.0 + x))
    follow(reference)
    report[STRAIN] = min(begun, 1.0 - (1.0 - min(report[STRAIN], 0.0)) * squeeze)


@kernel
def kick(reference, gravity, past, keep, push):
    """p <- keep p + push a; loads that jump now by `past` as before it."""
    f, p, m, load, D = reference.f, reference.p, reference.m, reference.load, gravity.shape[0]
    now = push * share(reference.ramp, reference.t[0], past)
    for n in reference.active:
        inverse = 1.0 / m[n]
        for c in range(D):
            p[n, c] = keep * p[n, c] + push * (f[n, c] * inverse + gravity[c])
        if load.shape[0] > 0:
            for c in range(D):
                p[n, c] += now * load[n, c] * inverse
    near, less = reference.near, reference.less
    for k in range(len(near)):
        for c in range(D):
            p[near[k], c] -= push * less[k, c] * gravity[c]
    hold(p, reference)


@kernel
def power(reference, dt):
    """What tractions and drag work on the nodes in the middle of the coming step [W]."""
    v, p, m, load, D = reference.v, reference.p, reference.m, reference.load, reference.X.shape[1]
    middle = reference.t[0] + 0.5 * dt
    total, now, drag = 0.0, share(reference.ramp, middle, 0.0), reference.drag * within(reference.ramp, middle, 0.0)
    if load.shape[0] > 0 or drag > 0.0:
        for n in reference.active:
            for c in range(D):
                total -= drag * m[n] * p[n, c] * v[n, c]
                if load.shape[0] > 0:
                    total += now * load[n, c] * v[n, c]
    return total


@kernel
def drift(reference, dt):
    """u <- u + dt v, ghosts too; time goes on."""
    u, v = reference.u, reference.v
    for n in reference.active:
        for c in range(reference.X.shape[1]):
            u[n, c] += dt * v[n, c]
    mirror(u, reference)
    reference.t[0] += dt


@kernel
def force_all(space, body, reference, chunk, dt, report):
    """Forces of the present displacement on to the nodes, flow and heating of a step dt behind it; returns the squeeze."""
    X, f, squeeze = reference.X, reference.f, 1.0
    for n in reference.touched:
        for c in range(f.shape[1]):
            f[n, c] = 0.0
    average_volume(body.locking, space, body, reference, chunk)
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        lay_down(space, X, first, count, chunk)
        take(space, X, first, chunk, count, reference.u)
        chunk.a[:] = 0.0
        squeeze = max(squeeze, answer_all(space, body, reference, chunk, first, count, dt, report))
        if report[CODE] != 0.0:
            return squeeze
        act_on(body.source, body, chunk, first, count, dt, report)
        give(space, X, first, chunk, count, f)
    fold(f, reference)
    return squeeze


@kernel
def spread_of(space, X):
    """Largest sum (d_k w)^2/w of any point and direction, and of the hoop where there is one [1/m2]: T of the head."""
    most, D, inverse = 0.0, X.shape[1], 1.0 / space.h
    for i in range(X.shape[0]):
        for a in range(D):
            _, w, g, _, _ = stencil(space.basis, X[i, a] * inverse)
            total = 0.0
            for k in range(len(w)):
                if w[k] > 0.0:
                    total += g[k] * g[k] / w[k]
            most = max(most, total * inverse * inverse)
    return most


@kernel
def hoop_of(space, X):
    """Largest sum w~^2/(w R^2) of any point, w~ the weights with the axis' mirror folded on to them [1/m2]."""
    most, inverse = 0.0, 1.0 / space.h
    for i in range(X.shape[0]):
        first, w, _, _, _ = stencil(space.basis, X[i, 0] * inverse)
        total = 0.0
        for k in range(len(w)):
            node, odd, even = first + k, w[k], w[k]
            if node <= PAD:
                continue
            for j in range(len(w)):
                if first + j == 2 * PAD - node:
                    odd -= w[j]
                    even += w[j]
            if even > 0.0:
                total += odd * odd / even
        most = max(most, total / (X[i, 0] * X[i, 0]))
    return most


@kernel
def stencils(space, x, first, w, g):
    """First node (N, D), weights and their slopes (N, D, K) of points x (N, D)."""
    for i in range(x.shape[0]):
        for a in range(x.shape[1]):
            first[i, a], one, slope, _, _ = stencil(space.basis, x[i, a] / space.h)
            for k in range(len(one)):
                w[i, a, k], g[i, a, k] = one[k], slope[k] / space.h


def sampled(space, x: np.ndarray):
    """(first, w, g) of points."""
    N, D = x.shape
    K = 4 if isinstance(space.basis, Cubic) else 3
    found = np.zeros((N, D), np.int64), np.zeros((N, D, K)), np.zeros((N, D, K))
    stencils(space, np.ascontiguousarray(x), *found)
    return found


def leaning(space) -> float:
    """What a ghost behind a wall that sticks takes of the node on the wall, beside -1 of its image: the spline is then zero on the wall."""
    _, w, _ = sampled(space, np.zeros((1, directions(space))))
    return float(-w[0, 0, 1] / w[0, 0, 0])


def clamped_spread(space, X: np.ndarray, V: np.ndarray, walls: np.ndarray) -> float:
    """T beside walls that stick, where splines are other ones: of all points of a span together, on the mass that they give the nodes [1/m2]; 0 without."""
    if not (walls == STICK).any():
        return 0.0
    (N, D), ends = X.shape, np.array(extents(space)) - 1 - PAD
    first, w, g = sampled(space, X)
    K, lean, held = w.shape[2], leaning(space), w.copy()
    beside = np.zeros(N, bool)
    for a in range(D):
        for side in range(2):
            ghost = PAD - 1 - first[:, a] if side == 0 else ends[a] + 1 - first[:, a]
            some = np.flatnonzero((ghost == 0 if side == 0 else ghost == K - 1) & (walls[a, side] == STICK))
            at, on, image = (0, 1, 2) if side == 0 else (K - 1, K - 2, K - 3)
            for field, along, across in ((w, lean, -1.0), (g, lean, -1.0), (held, 0.0, 1.0)):
                field[some, a, on] += along * field[some, a, at]
                field[some, a, image] += across * field[some, a, at]
                field[some, a, at] = 0.0
            beside[some] = True
    most = 0.0
    _, span = np.unique(first[beside], axis=0, return_inverse=True)
    for number in range(span.max(initial=-1) + 1):
        p = np.flatnonzero(beside)[span.ravel() == number]
        mass = V[p] @ product(held[p])
        used = mass > 0
        for k in range(D):
            B = product(np.where(np.arange(D)[None, :, None] == k, g[p], w[p]))[:, used] / np.sqrt(mass[used])
            most = max(most, float(np.linalg.norm(np.sqrt(V[p])[:, None] * B, 2) ** 2))
    return most


def product(lines: np.ndarray) -> np.ndarray:
    """Values (P, K^D) of products of those by direction (P, D, K)."""
    whole = lines[:, 0]
    for a in range(1, lines.shape[1]):
        whole = (whole[:, :, None] * lines[:, a, None, :]).reshape(len(lines), -1)
    return whole


def courant_of(space, X: np.ndarray, V: np.ndarray, walls: np.ndarray, lam: float, mu: float) -> float:
    """The largest stable step at rest, SHARE of it, in h sqrt(R0/(D lam + 2 mu)); walls (3, 2): kinds of those that the body lies on."""
    D, T = directions(space), max(spread_of(space, X), clamped_spread(space, X, V, walls))
    stiff = D * lam + 2 * mu
    if isinstance(space, Axisymmetric):
        T, stiff = max(T, hoop_of(space, X)), 3 * lam + 2 * mu
    return float(SHARE * 2 / np.sqrt(T) / space.h * np.sqrt((D * lam + 2 * mu) / stiff))
