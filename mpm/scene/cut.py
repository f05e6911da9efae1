"""Exact quadrature of a region cut by a grid, and one particle a cut cell.

A plane region is bounded by `Segment`s and `Arc`s, run so that the inside is on the left. Each is split where it crosses a
grid line, and over a cut cell the divergence theorem turns the area integral of f into strips between the boundary and one edge of the cell,

    int_cell f dA = sum_pieces int (int_ref^y f dy') n_y ds + int_(opposite edge, inside) (int_ref^opposite f dy') dx ,

Gauss points along the piece times Gauss points along the strip. `ref` is the bottom edge where most of the boundary faces up, else the top:
with one smooth piece in the cell all weights are positive; with several some may be negative, and sums stay exact.
Order p is exact for monomials x^a y^b, a, b <= p (and one more power of x, the r of axisymmetric bodies) on straight sides; on arcs
(45 degrees at most each) order 4 leaves 5e-10 with one cell a radius, 1e-14 with four. Fails when a feature is thinner than 1e-11 of a cell: it is not seen.
"""

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


def gauss(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre points and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(n)
    return 0.5 * (x + 1), 0.5 * w


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


def _crossings(piece, edges) -> np.ndarray:
    """Parameters t (fraction of a segment, angle of an arc) at which the piece crosses grid lines, its ends included, sorted."""
    found = []
    for k, e in enumerate(edges):
        if isinstance(piece, Segment):
            run = piece.end[k] - piece.start[k]
            if run != 0.0:
                found.append((e - piece.start[k]) / run)
        else:
            c = (e - piece.centre[k]) / piece.radius
            c = c[np.abs(c) <= 1]
            angle = np.arccos(c) if k == 0 else np.arcsin(c)
            both = np.concatenate([angle, -angle if k == 0 else np.pi - angle])
            found.append(piece.start + np.mod(both - piece.start, 2 * np.pi))
    lo, hi = (0.0, 1.0) if isinstance(piece, Segment) else (piece.start, piece.end)
    t = np.concatenate(found) if found else np.empty(0)
    return np.concatenate([[lo], np.sort(t[(t > lo) & (t < hi)]), [hi]])


def _boundary(pieces, edges, n):
    """Every piece split at the grid lines, n Gauss points a part: x (A, n, 2), ds (A, n), normal (A, n, 2), cell (A,), side (A,), on_line (A,)."""
    g, gw = gauss(n)
    parts = []
    tiny = EDGE * min(np.diff(e).min() for e in edges)
    for piece in pieces:
        t = _crossings(piece, edges)
        if isinstance(piece, Segment):
            start, run = np.array(piece.start), np.subtract(piece.end, piece.start)
            length = np.hypot(*run)
        else:
            length = piece.radius
        keep = np.diff(t) * length > tiny
        a, dt = t[:-1][keep], np.diff(t)[keep]
        at = a[:, None] + dt[:, None] * g
        if isinstance(piece, Segment):
            x = start + at[..., None] * run
            normal = np.broadcast_to(np.array([run[1], -run[0]]) / length, x.shape)
        else:
            radial = np.stack([np.cos(at), np.sin(at)], axis=-1)
            x, normal = np.array(piece.centre) + piece.radius * radial, piece.outward * radial
        middle, inward = x[:, n // 2], normal[:, n // 2]
        cell = locate(middle - 2 * tiny * inward, edges)
        on_line = np.zeros(len(a), dtype=bool)
        for k, e in enumerate(edges):
            nearest = np.abs(x[..., k, None] - e[np.clip(np.searchsorted(e, middle[:, k])[:, None] + [-1, 0], 0, len(e) - 1)][:, None, :]).max(1).min(-1)
            on_line |= nearest < tiny
        inside = cell >= 0
        parts.append((x[inside], (dt[:, None] * length * gw)[inside], normal[inside], cell[inside], np.full(inside.sum(), piece.side), on_line[inside]))
    return [np.concatenate(columns) for columns in zip(*parts, strict=True)]


def _edge_spans(pieces, y, left, right):
    """Spans of the horizontal lines y (C,) between left and right, split where the boundary crosses: (C, K) starts and ends."""
    cuts = [left, right]
    circles = {(p.centre, p.radius) for p in pieces if isinstance(p, Arc)}
    for centre, radius in sorted(circles):
        half = np.sqrt(np.maximum(radius**2 - (y - centre[1]) ** 2, 0.0))
        cuts += [centre[0] - half, centre[0] + half]
    for p in pieces:
        if isinstance(p, Segment) and p.start[1] != p.end[1]:
            t = (y - p.start[1]) / (p.end[1] - p.start[1])
            cuts.append(np.where((t >= 0) & (t <= 1), p.start[0] + t * (p.end[0] - p.start[0]), left))
    cuts = np.sort(np.clip(np.stack(cuts, axis=-1), left[:, None], right[:, None]), axis=-1)
    return cuts[:, :-1], cuts[:, 1:]


def plane(pieces, distance, edges, order: int) -> tuple[Quadrature, Surface]:
    """The region bounded by `pieces` cut by the cells of two directions; `distance(x) -> signed distance` tells inside from outside."""
    (X, Y), n = edges, order + 2
    tiny = EDGE * min(np.diff(X).min(), np.diff(Y).min())
    sx, ds, normal, cell, side, on_line = _boundary(pieces, edges, n)
    surface = Surface(sx.reshape(-1, 2), ds.ravel(), normal.reshape(-1, 2), np.repeat(cell, n), np.repeat(side, n))
    rows = len(Y) - 1
    g, gw = gauss(order // 2 + 1)

    cuts = np.unique(cell[~on_line])
    whole = np.ones((len(X) - 1, rows), dtype=bool)
    whole.ravel()[cuts] = False
    i, j = np.nonzero(whole)
    inside = distance(np.stack([X[i] + X[i + 1], Y[j] + Y[j + 1]], axis=-1) / 2) < 0
    i, j = i[inside], j[inside]
    hx, hy = X[i + 1] - X[i], Y[j + 1] - Y[j]
    shape = (len(i), len(g), len(g))
    full = [np.broadcast_to((X[i, None] + hx[:, None] * g)[:, :, None], shape), np.broadcast_to((Y[j, None] + hy[:, None] * g)[:, None, :], shape)]
    points, weights = [np.stack(full, axis=-1).reshape(-1, 2)], [((hx * hy)[:, None, None] * (gw[:, None] * gw)).ravel()]
    homes = [np.repeat(i * rows + j, len(g) ** 2)]

    faces = normal[..., 1] * ds
    up = np.bincount(cell, weights=np.where(on_line, 0.0, faces.sum(1)), minlength=whole.size) >= 0
    a = ~on_line & np.any(faces != 0, axis=1)  # upright sides carry no strips
    j = cell[a] % rows
    ref = np.where(up[cell[a]], Y[j], Y[j + 1])
    height = sx[a][..., 1] - ref[:, None]
    x = np.broadcast_to(sx[a][..., 0, None], (*height.shape, len(g)))
    y = ref[:, None, None] + height[..., None] * g
    points.append(np.stack([x, y], axis=-1).reshape(-1, 2))
    weights.append(((faces[a] * height)[..., None] * gw).ravel())
    homes.append(np.repeat(cell[a], n * len(g)))

    i, j = cuts // rows, cuts % rows
    start, end = _edge_spans(pieces, np.where(up[cuts], Y[j + 1], Y[j]), X[i], X[i + 1])
    level = np.where(up[cuts], Y[j + 1] - 4 * tiny, Y[j] + 4 * tiny)  # the inner side of the edge: a boundary that runs along it is then unambiguous
    c, k = np.nonzero(end - start > tiny)
    start, end = start[c, k], end[c, k]
    inside = distance(np.stack([(start + end) / 2, level[c]], axis=-1)) < 0
    start, length, c = start[inside], (end - start)[inside], c[inside]
    shape = (len(c), len(g), len(g))
    bottom, top = Y[j[c]], Y[j[c] + 1]
    x = np.broadcast_to((start[:, None] + length[:, None] * g)[:, :, None], shape)
    y = np.broadcast_to((bottom[:, None] + (top - bottom)[:, None] * g)[:, None, :], shape)
    points.append(np.stack([x, y], axis=-1).reshape(-1, 2))
    weights.append(((length * (top - bottom))[:, None, None] * (gw[:, None] * gw)).ravel())
    homes.append(np.repeat(cuts[c], len(g) ** 2))
    return Quadrature(np.concatenate(points), np.concatenate(weights), np.concatenate(homes)), surface


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
