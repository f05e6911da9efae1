"""The state of a body in the total frame, and what its particles show of it.

The particles of the body (mpm.state.Particles) hold what records want: x, v, C (gradient of velocity in the present shape), B, J. Only B, J and what heat and
flow remember are used by steps; x, v and C are written by `show`.
"""

from typing import Any, NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.lanes import aligned
from mpm.state import Axisymmetric
from mpm.transfer import CHUNK, Bspline, columns, gather, lay_down, new_chunk, scatter


class Still(NamedTuple):
    """Tractions by reference area alone, or none: nodal forces stay as they are."""


class Skin(NamedTuple):
    """Points of the reference surface on which tractions by present area act (mpm.total.forces.press)."""

    x: np.ndarray  # (S, D) [m]
    area: np.ndarray  # (S, D) reference area times outward normal
    pressure: np.ndarray  # (S,) against the present normal [Pa]
    pull: np.ndarray  # (S, D) Cauchy traction [Pa]
    still: np.ndarray  # (n, columns(D)) nodal forces of tractions by reference area at full load [N], on ghosts too


class Reference(NamedTuple):
    """Nodal state of one body, and weights by the points X of its reference shape.

    Mirrors: node `ghost` outside a wall that the body is bonded to carries `sign` times what its `image` inside does, by direction, and `lean` times what the
    node `wall` between them does: 0 where the wall slips; where it sticks what makes the spline zero on the wall, and leaves its slopes free.
    """

    X: np.ndarray  # (N, D) reference positions of the particles [m]
    plastic: np.ndarray  # (N, K) inverse plastic metric F_p^-1 F_p^-T less the identity; (0, K) where nothing flows [-]
    u: np.ndarray  # (n, columns(D)) displacement [m]; further columns unused
    v: np.ndarray  # (n, columns(D)) velocity [m/s]
    p: np.ndarray  # (n, columns(D)) momentum, over m [m/s]: mpm.total.inertia; (0, columns(D)) in implicit mechanics, where v is that
    f: np.ndarray  # (n, columns(D)) scratch of one step: force of the stress [N]
    m: np.ndarray  # (n,) mass [kg], those of ghosts on their images
    load: np.ndarray  # (n, D), or (n, columns(D)) by present area: force of the tractions at full load [N]; (0, D) without
    touched: np.ndarray  # nodes that a particle sees
    active: np.ndarray  # those of them that are no ghosts
    ghost: np.ndarray  # (G,)
    image: np.ndarray  # (G,)
    sign: np.ndarray  # (G, D)
    wall: np.ndarray  # (G,)
    lean: np.ndarray  # (G,)
    near: np.ndarray  # (W,) nodes that gravity pulls less than their mass, as ghosts are folded on to them,
    less: np.ndarray  # (W, D) by this part of it
    held: np.ndarray  # (H, 2) (node, direction) that a wall holds
    walls: np.ndarray  # (3, 2) kinds of the walls that the body lies on; CONTACT where it lies on none
    t: np.ndarray  # (1,) time [s]
    ramp: Any  # mpm.state.Ramp or Within, of load and drag
    drag: float  # rate of the drag [1/s]
    courant: float  # largest stable step in h sqrt(R0/(D lam + 2 mu)), at rest
    spread: np.ndarray  # (n, 1 + 2 D), (0, 1 + 2 D) in implicit mechanics: how p makes v (mpm.total.inertia)
    beside: np.ndarray  # (2 D,) from the number of a node to those of its neighbours
    warmth: Any  # mpm.total.heat.Warmth or NoWarmth
    skin: Any = Still()  # or Skin


@kernel
def mirror(nodes, reference):
    """Continue nodal values to the ghosts, the last first: a ghost may be the image of another."""
    ghost, image, sign, wall, lean = reference.ghost, reference.image, reference.sign, reference.wall, reference.lean
    for k in range(len(ghost) - 1, -1, -1):
        for c in range(sign.shape[1]):
            nodes[ghost[k], c] = sign[k, c] * nodes[image[k], c] + lean[k] * nodes[wall[k], c]


@kernel
def fold(nodes, reference):
    """Add what ghosts carry to their images."""
    ghost, image, sign, wall, lean = reference.ghost, reference.image, reference.sign, reference.wall, reference.lean
    for k in range(len(ghost)):
        for c in range(sign.shape[1]):
            nodes[image[k], c] += sign[k, c] * nodes[ghost[k], c]
            nodes[wall[k], c] += lean[k] * nodes[ghost[k], c]


@kernel
def hold(nodes, reference):
    """Nothing moves where a wall holds it."""
    for k in range(reference.held.shape[0]):
        nodes[reference.held[k, 0], reference.held[k, 1]] = 0.0


@kernel
def project(space, reference, particles):
    """Nodal velocities from those of the particles and their slopes: m_i v_i = sum m w (v + C (x_i - X)); an affine motion comes out as it is."""
    X, D, v = reference.X, reference.X.shape[1], reference.v
    chunk, gradient = new_chunk(D, reference.f, True, False), Bspline()
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        lay_down(space, X, first, count, chunk)
        for p in range(count):
            m = particles.m[first + p]
            chunk.m[p] = m
            for c in range(D):
                chunk.a[c, p] = m * particles.v[first + p, c]
                for d in range(D):
                    chunk.A[c, d, p] = m * particles.C[first + p, c, d]
        for p in range(count, CHUNK):
            chunk.m[p] = 0.0
            chunk.a[:, p] = 0.0
            chunk.A[:, :, p] = 0.0
        scatter(space, gradient, X, first, chunk, count, v, chunk.reach)
    fold(v, reference)
    for n in reference.active:
        for c in range(D):
            v[n, c] /= reference.m[n]
        for c in range(D, v.shape[1]):
            v[n, c] = 0.0
    hold(v, reference)


@kernel
def show(space, particles, reference):
    """x, v and C of the particles: position, velocity and its gradient in the present shape."""
    X, D = reference.X, reference.X.shape[1]
    chunk, gradient, F = new_chunk(D, reference.f, True, False), Bspline(), np.zeros((CHUNK, D, D))
    mirror(reference.u, reference)
    mirror(reference.v, reference)
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        lay_down(space, X, first, count, chunk)
        gather(space, gradient, X, first, chunk, count, reference.u)
        for p in range(count):
            for c in range(D):
                particles.x[first + p, c] = X[first + p, c] + chunk.v[c, p]
                for d in range(D):
                    F[p, c, d] = chunk.L[c, d, p]
                F[p, c, c] += 1.0
        gather(space, gradient, X, first, chunk, count, reference.v)
        for p in range(count):
            inverse = np.linalg.inv(F[p])
            for c in range(D):
                particles.v[first + p, c] = chunk.v[c, p]
                for d in range(D):
                    rate = 0.0
                    for k in range(D):
                        rate += chunk.L[c, k, p] * inverse[k, d]
                    particles.C[first + p, c, d] = rate


def gradients_at(space, reference, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(F - 1 (P, D, D), F_33 - 1 (P,)) at points x (P, D) of the reference shape; the second is u_r/R in axisymmetry, else 0."""
    x = np.ascontiguousarray(x, dtype=reference.X.dtype)
    P, D = x.shape
    H, u = np.zeros((P, D, D)), np.zeros((P, D))
    mirror(reference.u, reference)
    sample(space, reference.u, x, u, H)
    return H, u[:, 0] / x[:, 0] if isinstance(space, Axisymmetric) else np.zeros(P)


def displacement_at(space, reference, x: np.ndarray) -> np.ndarray:
    """u (P, D) at points x (P, D) of the reference shape."""
    x = np.ascontiguousarray(x, dtype=reference.X.dtype)
    u = np.zeros(x.shape)
    mirror(reference.u, reference)
    sample(space, reference.u, x, u, np.zeros((*x.shape, x.shape[1])))
    return u


@kernel
def sample(space, nodes, x, value, gradient):
    """A nodal vector field (n, columns(D)) at points x (P, D): value (P, D), gradient (P, D, D)."""
    D = x.shape[1]
    chunk, own = new_chunk(D, nodes, True, False), Bspline()
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        lay_down(space, x, first, count, chunk)
        gather(space, own, x, first, chunk, count, nodes)
        for p in range(count):
            for c in range(D):
                value[first + p, c] = chunk.v[c, p]
                for d in range(D):
                    gradient[first + p, c, d] = chunk.L[c, d, p]


def kinetic(reference) -> float:
    """1/2 sum m_i p_i.v_i [J]."""
    D, n, p = reference.X.shape[1], reference.active, reference.p if len(reference.p) else reference.v
    return float(0.5 * np.sum(reference.m[n, None].astype(float) * p[n, :D].astype(float) * reference.v[n, :D].astype(float)))


def new_nodes(n: int, D: int, dtype) -> tuple[np.ndarray, ...]:
    """Displacement, velocity, momentum and force of n nodes."""
    return tuple(aligned((n, columns(D)), dtype) for _ in range(4))
