"""Tractions by present area in an implicit step: forces that follow the surface as it moves within the step, and how they change (docs/physics.md 17).

    f_k = G s_k + |G N| t_k + det F a w_k e_r,   s_k = w_k f_s + D_s grad_X w_k,   t_k alike,   F = F^n + sum u grad_X w,   G = J F^-T,   J = lambda det F
s by pressures, t by Cauchy tractions, a the hoop's share of a pressure; lambda the stretch out of the plane. With q_k = F^-T grad_X w_k and z_k = G s_k
    df_kc/du_me = z_kc (q_me + w_m/r e_re) - z_ke q_mc + |G N| t_kc (q_me - (n.q_m) n_e + w_m/r e_re) + det F a w_k q_me e_rc
A pressure all around, or on a part that only mirrors end, has a potential, p times the volume, and this is symmetric. Else what is skew is no part of the
matrix: it is taken in as the matrix is solved (mpm.implicit.matrix.untwisted).
Updated frame   particles, by F and J that they carry, as in integrate/traction.py         Total frame   points of the reference surface (mpm.total.forces)
Fails when   what the skew part moves in a step is far beyond the body's size: solving takes too many turns, and the step is cut.
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.implicit.lasting import laid
from mpm.implicit.matrix import add
from mpm.implicit.nodes import numbers
from mpm.implicit.trial import sign
from mpm.integrate.deformation import cofactor
from mpm.integrate.traction import Present, share
from mpm.jit import kernel
from mpm.sources import acting
from mpm.state import Axisymmetric, Load
from mpm.total.reference import Skin, gradients_at


class Following(NamedTuple):
    """Q points with M nodes each, and what acts on them, at the share of the end of the step."""

    node: np.ndarray  # (Q, M) number of the node
    flip: np.ndarray  # (Q, M) see mpm.implicit.nodes
    w: np.ndarray  # (Q, M) weights
    g: np.ndarray  # (Q, M, D) gradients in the reference shape [1/m]
    F: np.ndarray  # (Q, D, D) at the start of the step
    out: np.ndarray  # (Q,) stretch out of the plane at the start of the step
    across: np.ndarray  # (Q,) by how much a radial displacement adds to it [1/m]
    press: np.ndarray  # (Q, D) force of pressures on the reference surface [N]
    press_moment: np.ndarray  # (Q, D, D) its moment [N m]
    pull: np.ndarray  # (Q, D) of Cauchy tractions [N]
    pull_moment: np.ndarray  # (Q, D, D)
    normal: np.ndarray  # (Q, D) N, of those
    hoop: np.ndarray  # (Q,) a [N]
    z: np.ndarray  # (Q, M, D) at the last u that was asked for, as are
    t: np.ndarray  # (Q, M, D) |G N| t_k
    q: np.ndarray  # (Q, M, D)
    n: np.ndarray  # (Q, D) the present normal
    wide: np.ndarray  # (Q, M) w/r
    spread: np.ndarray  # (Q,) det F a


def new_following(*given) -> Following:
    """With room for what it finds."""
    g = given[3]
    return Following(*given, *np.zeros((3, *g.shape)), np.zeros((len(g), g.shape[2])), np.zeros(g.shape[:2]), np.zeros(len(g)))


def following(space, body, nodes, dt: float) -> Following | None:
    """What follows the surface of a body in the updated frame in a step of dt; None without."""
    parts = []
    for load in acting(body.source):
        if isinstance(load, Load) and isinstance(load.area, Present):
            a = load.area
            some = [np.abs(each).reshape(len(a.hoop), -1).max(axis=1) for each in (a.press, a.press_moment, a.pull, a.pull_moment, a.hoop)]
            rows = np.flatnonzero(np.max(some, axis=0) > 0)
            now, F = share(load.ramp, load.t[0] + dt, 1.0), load.F[rows]
            g = np.ascontiguousarray(np.einsum("qkd,qda->qka", nodes.g[rows], F))
            out = body.particles.J[rows] / np.linalg.det(F)
            acts = [now * each[rows] for each in (a.press, a.press_moment, a.pull, a.pull_moment)]
            across = out / body.particles.x[rows, 0] if isinstance(space, Axisymmetric) else 0.0 * out
            parts.append((nodes.node[rows], nodes.flip[rows], nodes.w[rows], g, F, out, across, *acts, a.normal[rows], now * a.hoop[rows]))
    return new_following(*(np.concatenate(each) for each in zip(*parts, strict=True))) if parts else None


def laid_skin(space, reference, lasting) -> tuple | None:
    """Nodes, flips, weights and gradients of the points of a surface in the total frame; None where nothing follows it."""
    if not isinstance(reference.skin, Skin):
        return None
    flat, flip, w, g = laid(space, reference, reference.skin.x.astype(float))
    node = numbers(space, lasting.places)[flat]  # a point on the edge of a span may touch a node that no particle does: by nothing
    return np.maximum(node, 0), flip, np.where(node < 0, 0.0, w), np.where(node[:, :, None] < 0, 0.0, g)


def following_skin(space, reference, skin: tuple | None, dt: float) -> Following | None:
    """What follows the surface of a body in the total frame in a step of dt."""
    if skin is None:
        return None
    points, D, now = reference.skin, directions(space), share(reference.ramp, reference.t[0] + dt, 1.0)
    H, stretch = gradients_at(space, reference, points.x)
    Q = len(points.x)
    across = 1.0 / points.x[:, 0] if isinstance(space, Axisymmetric) else np.zeros(Q)
    press, no_moment = -now * points.pressure[:, None] * points.area, np.zeros((Q, D, D))
    return new_following(*skin, np.eye(D) + H, 1.0 + stretch, across, press, no_moment, now * points.pull, no_moment, points.area, np.zeros(Q))


@kernel
def follow(one, u, force):
    """Add the forces at displacements u to force (A, D), and keep what their slopes are made of; false where a point is turned inside out."""
    (Q, M), D = one.w.shape, u.shape[1]
    F, G, n = np.empty((1, D, D)), np.empty((D, D)), np.empty(D)
    for s in range(Q):
        out = one.out[s]
        for c in range(D):
            for d in range(D):
                F[0, c, d] = one.F[s, c, d]
        for k in range(M):
            for c in range(D):
                moved = sign(one, s, k, c) * u[one.node[s, k], c]
                for d in range(D):
                    F[0, c, d] += moved * one.g[s, k, d]
                if c == 0:
                    out += one.across[s] * one.w[s, k] * moved
        volume, square = 0.0, 0.0
        for k in range(D):
            volume += F[0, 0, k] * cofactor(F, 0, 0, k, D)
        if not (volume > 0.0 and out > 0.0):
            return False
        for c in range(D):
            n[c] = 0.0
            for k in range(D):
                G[c, k] = out * cofactor(F, 0, c, k, D)
                n[c] += G[c, k] * one.normal[s, k]
            square += n[c] * n[c]
        size = math.sqrt(square)
        for c in range(D):
            one.n[s, c] = n[c] / size if size > 0.0 else 0.0
        one.spread[s] = volume * one.hoop[s]
        for k in range(M):
            one.wide[s, k] = one.across[s] * one.w[s, k] / out
            for c in range(D):
                z, q, t = 0.0, 0.0, one.pull[s, c] * one.w[s, k]
                for b in range(D):
                    pressed = one.press[s, b] * one.w[s, k]
                    for a in range(D):
                        pressed += one.press_moment[s, b, a] * one.g[s, k, a]
                    z, q, t = z + G[c, b] * pressed, q + G[c, b] * one.g[s, k, b], t + one.pull_moment[s, c, b] * one.g[s, k, b]
                one.z[s, k, c], one.q[s, k, c], one.t[s, k, c] = z, q / (out * volume), size * t
                force[one.node[s, k], c] += sign(one, s, k, c) * (z + size * t + (one.spread[s] * one.w[s, k] if c == 0 else 0.0))
    return True


@kernel
def stiffen(one, nodes, matrix):
    """Add the symmetric part of minus the slopes to the matrix."""
    (Q, M, D) = one.z.shape
    for s in range(Q):
        for k in range(M):
            for m in range(M):
                for c in range(D):
                    for e in range(D):
                        both = slope(one, s, k, c, m, e) + slope(one, s, m, e, k, c)
                        add(matrix, nodes, one.node[s, k], c, one.node[s, m], e, -0.5 * both * sign(one, s, k, c) * sign(one, s, m, e))


@kernel(inline=True)
def slope(one, s, k, c, m, e):
    """By how much force c of node k grows with displacement e of node m at point s, but for mirrors; from z, t, q, n, wide and spread."""
    along = 0.0
    for d in range(one.n.shape[1]):
        along += one.n[s, d] * one.q[s, m, d]
    grown = one.q[s, m, e] + (one.wide[s, m] if e == 0 else 0.0)
    hoop = one.spread[s] * one.w[s, k] * one.q[s, m, e] if c == 0 else 0.0
    return one.z[s, k, c] * grown - one.z[s, k, e] * one.q[s, m, c] + one.t[s, k, c] * (grown - along * one.n[s, e]) + hoop


@kernel
def twist(one, x, out):
    """Add to out (A, D) the product of x (A, D) with the skew part of minus the slopes."""
    (Q, M), D = one.w.shape, x.shape[1]
    y = np.empty((M, D))
    for s in range(Q):
        for k in range(M):
            for c in range(D):
                y[k, c] = sign(one, s, k, c) * x[one.node[s, k], c]
        for k in range(M):
            for c in range(D):
                total = 0.0
                for m in range(M):
                    for e in range(D):
                        total += (slope(one, s, k, c, m, e) - slope(one, s, m, e, k, c)) * y[m, e]
                out[one.node[s, k], c] -= 0.5 * sign(one, s, k, c) * total
