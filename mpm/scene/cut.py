"""Exact quadrature of a region cut by a grid, and one particle a cut cell.

A plane region is bounded by `Segment`s and `Arc`s, run so that the inside is on the left. Each is split where it crosses a
grid line, and over a cut cell the divergence theorem turns the area integral of f into strips between the boundary and one edge of the cell,

    int_cell f dA = sum_pieces int (int_ref^y f dy') n_y ds + int_(opposite edge, inside) (int_ref^opposite f dy') dx ,

Gauss points along the piece times Gauss points along the strip. `ref` is the bottom edge where most of the boundary faces up, else the top:
with one smooth piece in the cell all weights are positive; with several some may be negative, and sums stay exact.
Order p is exact for monomials x^a y^b, a, b <= p (and one more power of x, the r of axisymmetric bodies) on straight sides; on arcs
(45 degrees at most each) order 4 leaves 5e-10 with one cell a radius, 1e-14 with four. Fails when a feature is thinner than 1e-11 of a cell: it is not seen.
"""

import functools
from dataclasses import dataclass, field

import numpy as np

EDGE = 1e-11  # of a cell: what is nearer to a grid line lies on it


@dataclass(frozen=True)
class Segment:
    """From `start` to `end`, the inside on the left; `side` numbers the smooth sides of a shape."""

    start: tuple[float, float]
    end: tuple[float, float]
    side: int = 0


@dataclass(frozen=True)
class Arc:
    """Of the circle round `centre` from angle `start` to `end` > start [rad]; `outward` is +1 where the body lies inside the circle, -1 round a hole."""

    centre: tuple[float, float]
    radius: float
    start: float
    end: float
    outward: int = 1
    side: int = 0


@dataclass(frozen=True)
class Quadrature:
    """Points x (Q, d) [m], weights w (Q,) [m^d] without any factor r, flat cell index (Q,) in C order."""

    x: np.ndarray
    w: np.ndarray
    cell: np.ndarray


@dataclass(frozen=True)
class Surface:
    """Points x (S, d) [m], weights w (S,) [m^(d-1)], outward unit normals (S, d), the cell inside (S,), the smooth side (S,)."""

    x: np.ndarray
    w: np.ndarray
    normal: np.ndarray
    cell: np.ndarray
    side: np.ndarray


@dataclass(frozen=True)
class CutCells:
    """One particle a cell: volume (P,), centroid (P, d), flat cell index (P,); and pieces of surface, one a smooth side within a particle:
    owner (S,) is its particle, area (S,), centroid point (S, d), mean outward unit normal (S, d), side (S,)."""

    volume: np.ndarray
    centroid: np.ndarray
    cell: np.ndarray
    owner: np.ndarray = field(repr=False)
    area: np.ndarray = field(repr=False)
    point: np.ndarray = field(repr=False)
    normal: np.ndarray = field(repr=False)
    side: np.ndarray = field(repr=False)


@functools.lru_cache(maxsize=32)
def gauss(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre points and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(n)
    x, w = 0.5 * (x + 1), 0.5 * w
    x.flags.writeable = w.flags.writeable = False
    return x, w


def locate(x: np.ndarray, edges: list[np.ndarray]) -> np.ndarray:
    """Flat index of the cell that holds each point of x (N, d); -1 outside the grid."""
    index, shape = np.zeros(len(x), dtype=np.int64), [len(e) - 1 for e in edges]
    outside = np.zeros(len(x), dtype=bool)
    for k, e in enumerate(edges):
        i = np.searchsorted(e, x[:, k], side="right") - 1
        outside |= (i < 0) | (i >= shape[k])
        index = index * shape[k] + i
    return np.where(outside, -1, index)


def line(lower: float, upper: float, edges: np.ndarray, order: int) -> tuple[Quadrature, Surface]:
    """The interval [lower, upper] cut by the cells of one direction."""
    tiny = EDGE * np.diff(edges).min()
    a, b = np.maximum(edges[:-1], lower), np.minimum(edges[1:], upper)
    cell = np.flatnonzero(b - a > tiny)
    g, gw = gauss(order // 2 + 1)
    x = a[cell, None] + (b - a)[cell, None] * g
    w = (b - a)[cell, None] * gw
    ends = np.array([[lower], [upper]])
    normal = np.array([[-1.0], [1.0]])
    home = locate(ends - 2 * tiny * normal, [edges])
    kept = home >= 0
    surface = Surface(ends[kept], np.ones(2)[kept], normal[kept], home[kept], np.arange(2)[kept])
    return Quadrature(x.reshape(-1, 1), w.ravel(), np.repeat(cell, len(g))), surface


def plane(pieces, distance, edges, order: int) -> tuple[Quadrature, Surface]:
    """The region bounded by `pieces` cut by the cells of two directions; `distance(x) -> signed distance` tells inside from outside."""
    X, Y = edges
    g, gw = gauss(order + 2)
    from mpm.scene.trace import packed, points, trace  # compiled: a process that cuts nothing (a sweep's own, `mpm plan`) does without Numba

    found = trace(*packed(pieces), X, Y, g, gw, EDGE * min(np.diff(X).min(), np.diff(Y).min()))
    x, w, cell = points(found, distance(found.asked) < 0, X, Y, *gauss(order // 2 + 1))
    surface = (found.x.reshape(-1, 2), found.ds.ravel(), found.normal.reshape(-1, 2), np.repeat(found.cell, len(g)), np.repeat(found.side, len(g)))
    return Quadrature(x, w, cell), Surface(*surface)


def _cross(a_x, a_w, a_cell, b_x, b_w, b_cell, columns):
    """All pairs of points of a (plane) and b (line): x (A B, d), w, cell."""
    x = np.concatenate([np.repeat(a_x, len(b_x), axis=0), np.tile(b_x, (len(a_x), 1))], axis=1)
    return x, np.outer(a_w, b_w).ravel(), (a_cell[:, None] * columns + b_cell).ravel()


def extrude(base: tuple[Quadrature, Surface], along: tuple[Quadrature, Surface], columns: int) -> tuple[Quadrature, Surface]:
    """A plane region times an interval of the last direction, which has `columns` cells."""
    (area, rim), (length, ends) = base, along
    volume = Quadrature(*_cross(area.x, area.w, area.cell, length.x, length.w, length.cell, columns))
    lateral = _cross(rim.x, rim.w, rim.cell, length.x, length.w, length.cell, columns)
    caps = _cross(area.x, area.w, area.cell, ends.x, ends.w, ends.cell, columns)
    sides = np.concatenate([np.repeat(rim.side, len(length.w)), np.tile(ends.side, len(area.w)) + rim.side.max(initial=-1) + 1])
    flat = np.concatenate([np.repeat(rim.normal, len(length.w), axis=0), np.zeros((len(rim.w) * len(length.w), 1))], axis=1)
    up = np.concatenate([np.zeros((len(area.w) * len(ends.w), 2)), np.tile(ends.normal, (len(area.w), 1))], axis=1)
    x, w, cell = (np.concatenate(pair) for pair in zip(lateral, caps, strict=True))
    return volume, Surface(x, w, np.concatenate([flat, up]), cell, sides)


def _sums(key, n, *columns):
    """Sums of each column (N, d) over equal keys in 0..n-1: (n, d)."""
    return [np.stack([np.bincount(key, weights=c, minlength=n) for c in column.T], axis=-1) for column in columns]


def particles(volume: Quadrature, surface: Surface, edges, radial: bool = False, least: float = 0.01) -> CutCells:
    """One particle a cell (physics.md 11, item 1): centroids and volumes, pieces of surface with their centroids and mean normals.

    Cells less than `least` full go to the nearest kept particle, volume, first moment and surface, so sums and first moments stay
    exact. `radial` weighs everything with the first coordinate (per radian).
    """
    w = volume.w * volume.x[:, 0] if radial else volume.w
    s = surface.w * surface.x[:, 0] if radial else surface.w
    cell, key = np.unique(volume.cell, return_inverse=True)
    totals, moment = _sums(key, len(cell), np.stack([w, volume.w], axis=-1), w[:, None] * volume.x)
    plain = totals[:, 1]
    index = np.unravel_index(cell, [len(e) - 1 for e in edges])
    size = np.prod([np.diff(e)[i] for e, i in zip(edges, index, strict=True)], axis=0)
    kept = plain >= least * size
    if not kept.any():
        kept = plain >= plain.max()
    centre = np.stack([(e[:-1] + e[1:])[i] / 2 for e, i in zip(edges, index, strict=True)], axis=-1)
    heir = np.arange(len(cell))
    keepers = np.flatnonzero(kept)
    for k in np.flatnonzero(~kept):
        heir[k] = keepers[np.argmin(((centre[keepers] - centre[k]) ** 2).sum(-1))]
    new = np.cumsum(kept) - 1
    home = new[heir]
    total, first = _sums(home, len(keepers), totals[:, :1], moment)

    at = np.searchsorted(cell, surface.cell)
    at = np.where((at < len(cell)) & (cell[np.minimum(at, len(cell) - 1)] == surface.cell), at, -1)
    for k in np.flatnonzero(at < 0):  # a sliver without volume: nearest cell
        at[k] = np.argmin(((centre - surface.x[k]) ** 2).sum(-1))
    pair, piece = np.unique(np.stack([home[at], surface.side]), axis=1, return_inverse=True)
    area, point, normal = _sums(piece.ravel(), pair.shape[1], s[:, None], s[:, None] * surface.x, s[:, None] * surface.normal)
    some = area[:, 0] > 0
    area, normal = area[some], normal[some] / np.linalg.norm(normal[some], axis=1, keepdims=True)
    return CutCells(total[:, 0], first / total, cell[keepers], pair[0][some], area[:, 0], point[some] / area, normal, pair[1][some])
