"""Plane regions on a grid: their boundary split where it crosses grid lines, and the Gauss points of what it encloses (mpm.scene.cut).

Work goes with the cells that the boundary crosses; the others are told inside from outside in runs up a column of cells without boundary between them.
"""

import numpy as np

from mpm.scene.cut import EDGE, Arc, Batch, Cut, Segment, Skin, block, gauss, locate

TURN = 2 * np.pi


def split(t: np.ndarray, first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(piece, start, run) of the parts of each piece between its ends and those of its parameters t (P, T) that lie between them."""
    piece, column = np.nonzero((t > first[:, None]) & (t < last[:, None]))
    every = np.arange(len(first))
    number, at = np.concatenate([every, piece, every]), np.concatenate([first, t[piece, column], last])
    order = np.lexsort((at, number))
    number, at = number[order], at[order]
    same = number[1:] == number[:-1]
    return number[1:][same], at[:-1][same], np.diff(at)[same]


def straight(pieces: list[Segment], edges, n: int, tiny: float) -> tuple[np.ndarray, ...]:
    """x (A, n, 2), ds (A, n), normal (A, n, 2), side (A,) of the parts of segments."""
    start, end = (np.array([getattr(p, name) for p in pieces], dtype=float).reshape(-1, 2) for name in ("start", "end"))
    run = end - start
    length = np.hypot(*run.T)
    with np.errstate(divide="ignore", invalid="ignore"):  # along a direction nothing is crossed: infinite, or no number
        t = np.concatenate([(edges[k] - start[:, k, None]) / run[:, k, None] for k in range(2)], axis=1)
    piece, at, dt = split(t, np.zeros(len(pieces)), np.ones(len(pieces)))
    kept = dt * length[piece] > tiny
    piece, at, dt = piece[kept], at[kept], dt[kept]
    g, gw = gauss(n)
    x = start[piece, None] + (at[:, None] + dt[:, None] * g)[..., None] * run[piece, None]
    normal = np.stack([run[piece, 1], -run[piece, 0]], axis=-1) / length[piece, None]
    return x, (dt * length[piece])[:, None] * gw, np.repeat(normal[:, None], n, axis=1), np.array([p.side for p in pieces], dtype=np.int64)[piece]


def curved(pieces: list[Arc], edges, n: int, tiny: float) -> tuple[np.ndarray, ...]:
    """As `straight`, of arcs."""
    centre = np.array([p.centre for p in pieces], dtype=float).reshape(-1, 2)
    radius, first, last, outward = np.array([(p.radius, p.start, p.end, p.outward) for p in pieces], dtype=float).reshape(-1, 4).T
    with np.errstate(invalid="ignore"):  # lines beside the circle
        a, b = np.arccos((edges[0] - centre[:, :1]) / radius[:, None]), np.arcsin((edges[1] - centre[:, 1:]) / radius[:, None])
    t = first[:, None] + np.mod(np.concatenate([a, -a, b, np.pi - b], axis=1) - first[:, None], TURN)
    piece, at, dt = split(t, first, last)
    kept = dt * radius[piece] > tiny
    piece, at, dt = piece[kept], at[kept], dt[kept]
    g, gw = gauss(n)
    angle = at[:, None] + dt[:, None] * g
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    x = centre[piece, None] + radius[piece, None, None] * ray
    return x, (dt * radius[piece])[:, None] * gw, outward[piece, None, None] * ray, np.array([p.side for p in pieces], dtype=np.int64)[piece]


def outline(pieces, edges, n: int, tiny: float) -> tuple[Skin, np.ndarray]:
    """The boundary split at the grid lines, and which parts run along one (A,)."""
    kinds = [[p for p in pieces if isinstance(p, kind)] for kind in (Segment, Arc)]
    found = zip(straight(kinds[0], edges, n, tiny), curved(kinds[1], edges, n, tiny), strict=True)
    x, ds, normal, side = (np.concatenate(pair) for pair in found)
    middle = x[:, n // 2]
    cell = locate(middle - 2 * tiny * normal[:, n // 2], edges)
    on_line = np.zeros(len(x), dtype=bool)
    for k, e in enumerate(edges):
        near = np.searchsorted(e, middle[:, k], side="right") - 1
        for step in range(2):
            on_line |= (np.abs(x[..., k] - e[np.clip(near + step, 0, len(e) - 1)][:, None]) < tiny).all(axis=1)
    kept = cell >= 0
    return Skin(x[kept], ds[kept], normal[kept], cell[kept], side[kept]), on_line[kept]


def runs(cut: np.ndarray, marked: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells (I, J) that are not cut: which begin a run up a column without boundary between its cells (R,); the run (F,) of each, in order."""
    free = ~cut
    begins = free.copy()
    begins[:, 1:] &= cut[:, :-1] | marked[:, :-1] | marked[:, 1:]
    return np.flatnonzero(begins), (np.cumsum(begins) - 1)[free.ravel()]


def spans(pieces, y: np.ndarray, left: np.ndarray, right: np.ndarray, tiny: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(number (S,), from, to): lines y (C,) between left and right, split where the boundary crosses."""
    ends = [left, right]
    for cx, cy, radius in dict.fromkeys((*p.centre, p.radius) for p in pieces if isinstance(p, Arc)):
        half = np.sqrt(np.maximum(radius**2 - (y - cy) ** 2, 0.0))
        ends += [cx - half, cx + half]
    for p in pieces:
        run = p.end[1] - p.start[1] if isinstance(p, Segment) else 0.0
        if run != 0.0:
            t = (y - p.start[1]) / run
            ends.append(np.where((t >= 0) & (t <= 1), p.start[0] + t * (p.end[0] - p.start[0]), left))
    cuts = np.sort(np.clip(np.stack(ends, axis=1), left[:, None], right[:, None]), axis=1)
    number, k = np.nonzero(np.diff(cuts, axis=1) > tiny)
    return number, cuts[number, k], cuts[number, k + 1]


def plane(pieces, distance, edges, order: int) -> Cut:
    """The region bounded by `pieces` cut by the cells of two directions; `distance(x) -> signed distance` tells inside from outside."""
    X, Y = edges
    columns, rows = len(X) - 1, len(Y) - 1
    tiny = EDGE * min(np.diff(X).min(), np.diff(Y).min())
    skin, on_line = outline(pieces, edges, order + 2, tiny)
    rise = skin.normal[..., 1] * skin.w
    crossing, marked = np.zeros((2, columns * rows), dtype=bool)
    crossing[skin.cell[~on_line]] = True
    marked[skin.cell] = True
    up = np.bincount(skin.cell, weights=np.where(on_line, 0.0, rise.sum(1)), minlength=columns * rows) >= 0

    begins, run = runs(crossing.reshape(columns, rows), marked.reshape(columns, rows))
    i, j = begins // rows, begins % rows
    inside = distance(np.stack([(X[i] + X[i + 1]) / 2, (Y[j] + Y[j + 1]) / 2], axis=-1)) < 0
    whole = np.flatnonzero(~crossing)[inside[run]]

    home = np.flatnonzero(crossing)
    i, j = home // rows, home % rows
    y = np.where(up[home], Y[j + 1], Y[j])
    number, left, right = spans(pieces, y, X[i], X[i + 1], tiny)
    level = y + np.where(up[home], -4, 4) * tiny  # the inner side of the edge: a boundary that runs along it is then unambiguous
    kept = distance(np.stack([(left + right) / 2, level[number]], axis=-1)) < 0
    number, left, right = number[kept], left[kept], right[kept]
    low = Y[j[number]]
    opposite = block([left, low], [right - left, Y[j[number] + 1] - low], home[number], order)

    sloped = rise.any(axis=1) & ~on_line  # upright sides carry no strips
    cell, x, rise = skin.cell[sloped], skin.x[sloped], rise[sloped]
    ref = np.where(up[cell], Y[cell % rows], Y[cell % rows + 1])[:, None]
    return Cut(whole, (strips(x, rise, ref, cell, order), opposite), (skin,))


def strips(x: np.ndarray, rise: np.ndarray, ref: np.ndarray, cell: np.ndarray, order: int) -> Batch:
    """Gauss points between points of surface x (A, n, d) and the heights ref (A, 1) or (A, n) in the last direction; rise (A, n): the last n_k dS."""
    g, gw = gauss(order // 2 + 1)
    height = x[..., -1] - ref
    points = np.repeat(x, len(g), axis=1)
    points[..., -1] = (ref[..., None] + height[..., None] * g).reshape(points.shape[:2])
    return Batch(points, ((rise * height)[..., None] * gw).reshape(points.shape[:2]), cell)
