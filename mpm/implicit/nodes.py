"""What stands on the nodes for one implicit step: weights at the start's positions, unknowns, masses, velocities, and where the ghost penalty acts.

Mirror walls fold as in mpm.boundary.walls: a node outside is its image inside, with the sign of each component; held components are no unknowns.
Ghost penalty   GAMMA mu r h^(D-2) |u_{i-1} - 3 u_i + 3 u_{i+1} - u_{i+2}|^2/2 on every line of four nodes of which one is less than FILLED full: a node that
                a body hardly reaches is tied to its neighbours. It acts on the step's displacements, so it is a viscosity GAMMA mu dt on third
                differences at the surface, and a cubic field is not seen (E. Burman, C. R. Acad. Sci. Paris 348 (2010) 1217).
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.basis import stencil
from mpm.boundary import CONTACT, STICK, directions, extents
from mpm.implicit.matrix import add
from mpm.implicit.nozzle import told_nodes
from mpm.implicit.spans import new_spans
from mpm.integrate.nozzle import Nozzle
from mpm.jit import kernel
from mpm.state import PAD, Axisymmetric
from mpm.transfer import uses_basis_gradient

GAMMA, FILLED = 0.05, 0.6
ON_AXIS = 13.0 / 32.0  # cells: mean distance from the axis of what the node on it weighs


class Nodes(NamedTuple):
    """A nodes that particles see, M a particle. Node `node` of a particle carries u with the sign of `flip`, bit c of which turns component c."""

    node: np.ndarray  # (N, M) number of the node
    flip: np.ndarray  # (N, M)
    w: np.ndarray  # (N, M) weights
    g: np.ndarray  # (N, M, D) gradients [1/m]
    m: np.ndarray  # (A,) [kg]
    v: np.ndarray  # (A, D) [m/s]
    push: np.ndarray  # (A, D) forces that do not depend on u [N]
    eq: np.ndarray  # (A, D) number of the unknown; -1: held
    lines: np.ndarray  # (L, 4) nodes in a row under the ghost penalty
    stiff: np.ndarray  # (L,) [N/m]
    spans: object  # NoSpans, or Spans over which volume changes are averaged
    places: np.ndarray  # (A, 3) on the grid
    band: int  # unknowns below the diagonal that a row reaches
    unknowns: int


@kernel
def lay(space, gradient, particles, walls, gravity, flat, flip, w, g, sums):
    """Weights of all particles; `sums` (n, 2 + 2 D): mass, volume, momentum and weight of the particles on the images inside the walls."""
    h, D, shape, x = space.h, directions(space), extents(space), particles.x
    basis = uses_basis_gradient(gradient)
    for p in range(x.shape[0]):
        one, two = stencil(space.basis, x[p, 0] / h), stencil(space.basis, x[p, min(1, D - 1)] / h)
        three, k = stencil(space.basis, x[p, D - 1] / h), 0
        for i in range(len(one[1])):
            for j in range(len(two[1]) if D > 1 else 1):
                for q in range(len(three[1]) if D > 2 else 1):
                    wi, gi = one[1][i], (one[2][i] if basis else one[4][i]) / h
                    wj, gj = (two[1][j], (two[2][j] if basis else two[4][j]) / h) if D > 1 else (1.0, 0.0)
                    wl, gl = (three[1][q], (three[2][q] if basis else three[4][q]) / h) if D > 2 else (1.0, 0.0)
                    weight = wi * wj * wl
                    w[p, k], g[p, k, 0] = weight, gi * wj * wl
                    if D > 1:
                        g[p, k, 1] = wi * gj * wl
                    if D > 2:
                        g[p, k, 2] = wi * wj * gl
                    turn, at = 0, 0
                    for c in range(D):
                        n = one[0] + i if c == 0 else two[0] + j if c == 1 else three[0] + q
                        for side in range(2):
                            wall = PAD if side == 0 else shape[c] - 1 - PAD
                            if walls[c, side] < CONTACT and (n < wall if side == 0 else n > wall):
                                n = 2 * wall - n
                                turn ^= 2**D - 1 if walls[c, side] == STICK else 1 << c
                        at = at * shape[c] + n
                    flat[p, k], flip[p, k] = at, turn
                    mass = weight * particles.m[p]
                    sums[at, 0] += mass
                    sums[at, 1] += weight * particles.V0[p] * particles.J[p]
                    for c in range(D):
                        sign = -1.0 if turn >> c & 1 else 1.0
                        v = particles.v[p, c]
                        for d in range(D):
                            v += particles.C[p, c, d] * h * (one[3][i] if d == 0 else two[3][j] if d == 1 else three[3][q])
                        sums[at, 2 + c] += sign * mass * v
                        sums[at, 2 + D + c] += sign * mass * gravity[c]
                    k += 1


@kernel
def breadth(eq, node):
    """How far apart the unknowns of one particle are, at most."""
    most = 0
    for p in range(node.shape[0]):
        low, high = eq.size, -1
        for k in range(node.shape[1]):
            for c in range(eq.shape[1]):
                e = eq[node[p, k], c]
                if e >= 0:
                    low, high = min(low, e), max(high, e)
        most = max(most, high - low)
    return most


def new_nodes(space, gradient, body, walls, gravity, mu: float) -> Nodes:
    """The nodes of a step from the particles' positions; mu [Pa] scales the ghost penalty."""
    particles = body.particles
    D, shape, N = directions(space), extents(space), len(particles.m)
    M = len(stencil(space.basis, 0.0)[1]) ** D
    flat, flip, w, g = np.empty((N, M), np.int64), np.empty((N, M), np.int8), np.empty((N, M)), np.empty((N, M, D))
    n = shape[0] * shape[1] * shape[2]
    sums = np.zeros((n, 2 + 2 * D))
    lay(space, gradient, particles, walls, gravity, flat, flip, w, g, sums)
    active, places = in_order(space, np.flatnonzero(sums[:, 0] > 0))
    held = np.zeros((len(active), D), bool)
    for axis, side in np.argwhere(walls[:D] < CONTACT):
        held[on_wall(space, places, axis, side)] |= True if walls[axis, side] == STICK else np.arange(D) == axis
    m = sums[active, 0]
    v = np.where(held, 0.0, sums[active, 2 : 2 + D] / m[:, None])
    if isinstance(body.source, Nozzle):
        told = told_nodes(body.source, particles, flat, w, sums[:, 0])[active]
        held[told], v[told] = True, body.source.speed[0] * body.source.way
    carried = m, v, sums[active, 2 + D :].copy()
    ghosts = ghosts_of(space, walls, places, sums[active, 1], mu)
    return arrange(space, places, held, (flat, flip, w, g), carried, ghosts, new_spans(body.locking, space, particles, M))


def in_order(space, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(numbers (A,), places (A, 3)) of nodes on the grid, the shorter direction fastest: a narrow band."""
    places = np.stack(np.unravel_index(active, extents(space)), axis=1)
    if directions(space) == 2 and np.ptp(places[:, 0]) < np.ptp(places[:, 1]):
        order = np.lexsort(places.T)
        active, places = active[order], places[order]
    return active, places


def on_wall(space, places: np.ndarray, axis: int, side: int) -> np.ndarray:
    """Which nodes stand on a wall (A,)."""
    return places[:, axis] == (PAD if side == 0 else extents(space)[axis] - 1 - PAD)


def arrange(space, places, held, laid: tuple, carried: tuple, ghosts: tuple, spans) -> Nodes:
    """Nodes from what was laid on the grid (numbers, flips, weights, gradients), what they carry (mass, velocity, force) and the ghost penalty's lines."""
    (flat, flip, w, g), (lines, stiff), D = laid, ghosts, directions(space)
    node, eq = numbers(space, places)[flat], np.where(held, -1, np.cumsum(~held).reshape(held.shape) - 1).astype(np.int64)
    far = eq[lines].reshape(len(lines), 4 * D)
    spread = far.max(axis=1) - np.where(far < 0, eq.size, far).min(axis=1) if len(lines) else np.zeros(1, np.int64)
    band = int(max(breadth(eq, node), spread.max(), 0)) if D < 3 else 0
    return Nodes(node, flip, w, g, *carried, eq, lines, stiff, spans, places, band, int((~held).sum()))


def numbers(space, places: np.ndarray) -> np.ndarray:
    """Of every node of the grid, its number among those at `places`; -1 where it is none of them."""
    number = np.full(math.prod(extents(space)), -1)
    number[np.ravel_multi_index(tuple(places.T), extents(space))] = np.arange(len(places))
    return number


def ghosts_of(space, walls, places, volume: np.ndarray, mu: float) -> tuple[np.ndarray, np.ndarray]:
    """(lines (L, 4), stiffness (L,) [N/m]) of the ghost penalty; volume (A,): what the nodes hold of the body."""
    D, shape, count = directions(space), extents(space), len(places)
    double, thin, number = np.ones(count), np.ones((count, D)), numbers(space, places)
    for axis, side in np.argwhere(walls[:D] < CONTACT):
        on = on_wall(space, places, axis, side)
        double[on] *= 2.0
        if not (axis == 0 and isinstance(space, Axisymmetric)):  # where `radius` knows how thin it is; a line on a mirror stands for half a cell elsewhere
            thin[np.ix_(on, np.arange(D) != axis)] *= 0.5
    radius = np.maximum(places[:, 0] - PAD, ON_AXIS) * space.h if isinstance(space, Axisymmetric) else np.ones(count)
    fill, active = double * volume / (radius * space.h**D), np.ravel_multi_index(tuple(places.T), shape)
    lines, stiff = [np.zeros((0, 4), np.int64)], [np.zeros(0)]
    for axis in range(D):
        stride = math.prod(shape[axis + 1 :])
        row = np.stack([number[np.minimum(active + k * stride, len(number) - 1)] for k in range(4)], axis=1)
        row = row[(places[:, axis] + 3 < shape[axis]) & (row >= 0).all(axis=1)]
        row = row[fill[row].min(axis=1) < FILLED]
        lines.append(row)
        stiff.append(GAMMA * mu * radius[row].mean(axis=1) * thin[row, axis].min(axis=1) * space.h ** (D - 2))
    return np.concatenate(lines), np.concatenate(stiff)


@kernel
def third_differences(nodes, u, r, matrix, want):
    """The ghost penalty's part of the potential; of residual r (A, D) and matrix where wanted."""
    total, D, c4 = 0.0, u.shape[1], (1.0, -3.0, 3.0, -1.0)
    for s in range(nodes.lines.shape[0]):
        for c in range(D):
            jump = 0.0
            for a in range(4):
                jump += c4[a] * u[nodes.lines[s, a], c]
            total += 0.5 * nodes.stiff[s] * jump * jump
            if want:
                for a in range(4):
                    r[nodes.lines[s, a], c] += nodes.stiff[s] * c4[a] * jump
                    for b in range(4):
                        add(matrix, nodes, nodes.lines[s, a], c, nodes.lines[s, b], c, nodes.stiff[s] * c4[a] * c4[b])
    return total
