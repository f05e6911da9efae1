"""Exact quadrature of a region cut by a grid.

A plane region is bounded by `Segment`s and `Arc`s, run so that the inside is on the left. Each is split where it crosses
a grid line (cut_boundary.py), and over a cut cell the divergence theorem turns the area integral of f into strips between the boundary and an edge of the cell,

    int_cell f dA = sum_pieces int (int_ref^y f dy') n_y ds + int_(opposite edge, inside) (int_ref^opposite f dy') dx ,

Gauss points along the piece times Gauss points along the strip. `ref` is the bottom edge where most of the boundary faces up, else the top:
with one smooth piece in the cell all weights are positive; with several some may be negative, and sums stay exact.
Order p is exact for monomials x^a y^b, a, b <= p (and one more power of x, the r of axisymmetric bodies) on straight sides; on arcs
(45 degrees at most each) order 4 leaves 5e-10 with one cell a radius, 1e-14 with four. Fails when a feature is thinner than 1e-11 of a cell: it is not seen.

Points come in rows of one cell (`Batch`, `Skin`), and cells without surface by their number alone (`Cut.whole`), so that sums over cells
(mpm.scene.contents) need no point of them; `flat` makes a plain quadrature.
"""

import functools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

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

    def at(self, some: np.ndarray) -> "Surface":
        """Some of the points, by numbers or by a mask."""
        return Surface(self.x[some], self.w[some], self.normal[some], self.cell[some], self.side[some])


class Batch(NamedTuple):
    """Points of volume: x (A, q, d), w (A, q), all of a row in one cell (A,)."""

    x: np.ndarray
    w: np.ndarray
    cell: np.ndarray


class Skin(NamedTuple):
    """Points of surface: x (A, q, d), w (A, q), normal (A, q, d), all of a row in one cell (A,) and on one side (A,)."""

    x: np.ndarray
    w: np.ndarray
    normal: np.ndarray
    cell: np.ndarray
    side: np.ndarray


class Cut(NamedTuple):
    """Of a body, or of a part of it: cells that it fills (W,), points of volume in others, points of surface."""

    whole: np.ndarray
    volume: tuple[Batch, ...] = ()
    surface: tuple[Skin, ...] = ()


NONE = np.zeros(0, dtype=np.int64)


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


def block(lower: list[np.ndarray], size: list[np.ndarray], cell: np.ndarray, order: int) -> Batch:
    """Gauss points of blocks with the corners `lower` and the edges `size`, an array (A,) a direction."""
    d, (g, gw) = len(lower), gauss(order // 2 + 1)
    local = np.stack(np.meshgrid(*[g] * d, indexing="ij"), axis=-1).reshape(-1, d)
    weights = functools.reduce(np.multiply.outer, [gw] * d).ravel()
    edge = np.stack(size, axis=-1)
    return Batch(np.stack(lower, axis=-1)[:, None] + edge[:, None] * local, edge.prod(1)[:, None] * weights, cell)


def filled(cell: np.ndarray, edges: list[np.ndarray], order: int) -> Batch:
    """Gauss points of whole cells."""
    index = np.unravel_index(cell, [len(e) - 1 for e in edges])
    return block([e[i] for e, i in zip(edges, index, strict=True)], [np.diff(e)[i] for e, i in zip(edges, index, strict=True)], cell, order)


def flat(cuts: Iterable[Cut], edges: list[np.ndarray], order: int) -> tuple[Quadrature, Surface]:
    """The points of all cuts one after another, those of filled cells among them."""
    d, volumes, surfaces = len(edges), [], []
    for cut in cuts:
        volumes += [filled(cut.whole, edges, order), *cut.volume]
        surfaces += cut.surface
    x, w = (np.concatenate([getattr(v, name).reshape(shape) for v in volumes]) for name, shape in (("x", (-1, d)), ("w", -1)))
    volume = Quadrature(x, w, np.concatenate([np.repeat(v.cell, v.w.shape[1]) for v in volumes]))
    points = [np.concatenate([getattr(s, name).reshape(shape) for s in surfaces]) for name, shape in (("x", (-1, d)), ("w", -1), ("normal", (-1, d)))]
    homes = [np.concatenate([np.repeat(getattr(s, name), s.w.shape[1]) for s in surfaces]) for name in ("cell", "side")]
    return volume, Surface(*points, *homes)


def line(lower: float, upper: float, edges: np.ndarray, order: int) -> Cut:
    """The interval [lower, upper] cut by the cells of one direction."""
    tiny = EDGE * np.diff(edges).min()
    a, b = np.maximum(edges[:-1], lower), np.minimum(edges[1:], upper)
    cell = np.flatnonzero(b - a > tiny)
    ends = np.array([[lower], [upper]])
    normal = np.array([[-1.0], [1.0]])
    home = locate(ends - 2 * tiny * normal, [edges])
    kept = home >= 0
    skin = Skin(ends[kept, None], np.ones((2, 1))[kept], normal[kept, None], home[kept], np.arange(2)[kept])
    return Cut(NONE, (block([a[cell]], [(b - a)[cell]], cell, order),), (skin,))


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
