"""What a rigid body's shape and grid fix, whatever kappa, beta, alpha: quadrature, mass, stiffness and surface matrices.

    M_ij = int N_i N_j,   K_ij = int grad N_i . grad N_j,   B_ij = int_side N_i N_j      (axisymmetric: with the weight r, everything per radian)

so that kappa K + beta B and rho alpha M of every point of a sweep come from one assembly. `geometry` keeps the last few.
"""

import functools
from typing import NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.rigid.nodes import Nodes, apply, assemble, evaluate, make_nodes
from mpm.rigid.touching import covered, surface_beside

ORDER = 4  # products of two quadratic splines, exact


class Geometry(NamedTuple):
    """Stencils of unit coefficients and the points they came from."""

    nodes: Nodes
    dimension: int
    mass: np.ndarray  # (n, N)
    stiffness: np.ndarray  # (n, N)
    exchange: tuple[np.ndarray, ...]  # (n, N) a surface
    volume: np.ndarray  # (N,) int N_i
    area: tuple[np.ndarray, ...]  # (N,) int_side N_i, a surface
    active: np.ndarray  # (N,) nodes whose spline reaches the body
    x: np.ndarray  # (Q, d) volume points
    w: np.ndarray  # (Q,) with the weight r where axisymmetric
    faces: tuple[tuple[np.ndarray, np.ndarray], ...]  # points and weights of each surface
    sight: tuple[np.ndarray, np.ndarray]  # splines at the points where extremes are looked for: cells' quadrature points nearest the middle, and the surface
    depth: tuple[np.ndarray, ...] = ()  # (N,) of the nodes below each surface, where they exchange one by one (mpm.rigid.hats)


def evaluated(nodes: Nodes, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and values of the splines at points x (P, d)."""
    return evaluate(nodes, x.shape[1], np.ascontiguousarray(x, dtype=np.float64))


def row_sums(stencil: np.ndarray, diff: np.ndarray) -> np.ndarray:
    """A 1 for a symmetric stencil."""
    total = np.empty(stencil.shape[1])
    apply(stencil, diff, np.ones(stencil.shape[1]), total)
    return total


@functools.lru_cache(maxsize=8)
def geometry(shape, axisymmetric: bool, h: float, origin: tuple[float, ...], sides: tuple[str, ...], others: tuple = ()) -> Geometry:
    """Matrices of `shape` on the grid of cell `h` whose node 0 lies at `origin`, one exchange matrix for each of `sides`.

    shape   hashable, with bounds(), cut(edges, order) and faces(surface, side, plane) -> (S,) bool: mpm.scene.shapes
    others  shapes that touch it: where they lie on it nothing is exchanged with the surroundings
    """
    lower, upper = (np.array(b, dtype=float) for b in shape.bounds())
    d = len(lower)
    if axisymmetric:
        lower[0] = max(lower[0], 0.0)
    nodes, edges = make_nodes(lower, upper, h, np.asarray(origin, dtype=float))
    edges = on_axis(edges, axisymmetric)
    counts = np.array([len(e) - 1 for e in edges], dtype=np.int64)
    volume, surface = shape.cut(edges, ORDER)
    beside = surface
    if others:
        beside = surface_beside(shape, others, edges, ORDER, h)
        beside = beside.at(~covered(beside.x, beside.normal, others, h))
    x, cell = beside.x, beside.cell
    w = volume.w * volume.x[:, 0] if axisymmetric else volume.w
    sw = beside.w * x[:, 0] if axisymmetric else beside.w
    mass, stiffness = np.zeros((2, len(nodes.diff), nodes.size))
    assemble(nodes, d, volume.x, w, volume.cell, counts, True, mass, stiffness)
    exchange, faces = [], []
    for side in sides:
        part = shape.faces(beside, side, not axisymmetric)
        stencil = np.zeros_like(mass)
        assemble(nodes, d, x[part], sw[part], cell[part], counts, False, stencil, stencil)
        exchange.append(stencil)
        faces.append((x[part], sw[part]))
    sight = evaluated(nodes, np.concatenate([volume.x[middles(volume)], surface.x]))
    sums = tuple(row_sums(b, nodes.diff) for b in exchange)
    return Geometry(nodes, d, mass, stiffness, tuple(exchange), row_sums(mass, nodes.diff), sums, mass[0] > 0, volume.x, w, tuple(faces), sight)


def on_axis(edges, axisymmetric: bool):
    """The lines, from the axis on where there is one: it cuts the first cell."""
    return [np.concatenate([[0.0], edges[0][1:]]), *edges[1:]] if axisymmetric and edges[0][0] < 0 else edges


def middles(volume) -> np.ndarray:
    """One quadrature point a cell: the one nearest to the mean of the cell's points."""
    return nearest_to_mean(volume.x, volume.cell)


@kernel
def nearest_to_mean(x, cell):
    """Number of that point of x (Q, d), by rising cell (Q,)."""
    cells, d = np.max(cell) + 1, x.shape[1]
    mean, number, best = np.zeros((cells, d)), np.zeros(cells, dtype=np.int64), np.full(cells, -1)
    for q in range(len(cell)):
        number[cell[q]] += 1
        for k in range(d):
            mean[cell[q], k] += x[q, k]
    nearest = np.empty(cells)
    for q in range(len(cell)):
        far = 0.0
        for k in range(d):
            far += (x[q, k] - mean[cell[q], k] / number[cell[q]]) ** 2
        if best[cell[q]] < 0 or far < nearest[cell[q]]:
            best[cell[q]], nearest[cell[q]] = q, far
    return best[number > 0]
