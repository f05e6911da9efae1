"""The compiled part of mpm.scene.cut: boundaries split where they cross grid lines, and the Gauss points of what they enclose.

A piece is a row of numbers (`packed`): ARC or not, start or centre x, y, run x, y or radius, 0, first and last value of its parameter t (fraction of a
segment, angle of an arc), outward, side. Two calls, with the shape's own `distance` between them: `trace` asks at places that tell inside from outside.
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel

ARC, X, Y, RUN_X, RUN_Y, FIRST, LAST, OUTWARD, SIDE = range(9)
TURN = 2 * np.pi


class Outline(NamedTuple):
    """What `trace` found: parts of the boundary with their n Gauss points, and what the cells that they leave may hold."""

    x: np.ndarray  # (A, n, 2)
    ds: np.ndarray  # (A, n)
    normal: np.ndarray  # (A, n, 2)
    cell: np.ndarray  # (A,) inside the part
    side: np.ndarray  # (A,)
    on_line: np.ndarray  # (A,) runs along a grid line
    up: np.ndarray  # (cells,) strips go from the bottom edge
    whole: np.ndarray  # (W,) cells without boundary
    spans: np.ndarray  # (S, 2) of the edge opposite to the strips
    home: np.ndarray  # (S,) their cells
    asked: np.ndarray  # (W + S, 2) middles


def packed(pieces) -> tuple[np.ndarray, np.ndarray]:
    """Rows of pieces (mpm.scene.cut.Segment, Arc), and the circles among them (centre, radius)."""
    rows, circles = [], {}
    for p in pieces:
        if hasattr(p, "radius"):
            rows.append((1.0, *p.centre, p.radius, 0.0, p.start, p.end, p.outward, p.side))
            circles[p.centre, p.radius] = (*p.centre, p.radius)
        else:
            rows.append((0.0, *p.start, p.end[0] - p.start[0], p.end[1] - p.start[1], 0.0, 1.0, 1.0, p.side))
    return np.array(rows, dtype=float).reshape(-1, 9), np.array(list(circles.values()), dtype=float).reshape(-1, 3)


@kernel
def last_at_most(e, x):
    """Number of the last of rising e that is not above x; -1 where all are."""
    low, high = -1, len(e)
    while high - low > 1:
        middle = (low + high) // 2
        if e[middle] <= x:
            low = middle
        else:
            high = middle
    return low


@kernel
def insert(t, count, new):
    """Puts a number among the first `count` of t, which rise."""
    k = count
    while k > 0 and t[k - 1] > new:
        t[k] = t[k - 1]
        k -= 1
    t[k] = new


@kernel
def crossings(piece, edges, axis, t, count):
    """Adds the parameters at which the piece crosses the lines `edges` of a direction to t, sorted; how many there are then."""
    if piece[ARC] == 0.0:
        if piece[RUN_X + axis] != 0.0:
            for e in edges:
                new = (e - piece[X + axis]) / piece[RUN_X + axis]
                if piece[FIRST] < new < piece[LAST]:
                    insert(t, count, new)
                    count += 1
        return count
    for e in edges:
        c = (e - piece[X + axis]) / piece[RUN_X]
        if abs(c) <= 1.0:
            angle = np.arccos(c) if axis == 0 else np.arcsin(c)
            for other in range(2):
                one = angle if other == 0 else -angle if axis == 0 else np.pi - angle
                new = piece[FIRST] + np.mod(one - piece[FIRST], TURN)
                if piece[FIRST] < new < piece[LAST]:
                    insert(t, count, new)
                    count += 1
    return count


@kernel
def along(line, x, axis, tiny):
    """Whether all points x (n, 2) lie on a grid line."""
    for q in range(len(x)):
        if not abs(x[q, axis] - line) < tiny:
            return False
    return True


@kernel
def parts(pieces, edges_x, edges_y, g, gw, tiny):
    """Every piece split at the grid lines: x, ds, normal, cell, side, on_line of Outline."""
    n, most = len(g), 2 * (len(edges_x) + len(edges_y)) + 1
    x, ds, normal = np.empty((len(pieces) * most, n, 2)), np.empty((len(pieces) * most, n)), np.empty((len(pieces) * most, n, 2))
    cell, side = np.empty(len(pieces) * most, dtype=np.int64), np.empty(len(pieces) * most, dtype=np.int64)
    on_line = np.zeros(len(pieces) * most, dtype=np.bool_)
    t = np.empty(most + 1)
    columns, rows, found = len(edges_x) - 1, len(edges_y) - 1, 0
    for piece in pieces:
        arc = piece[ARC] == 1.0
        length = piece[RUN_X] if arc else np.hypot(piece[RUN_X], piece[RUN_Y])
        t[0] = piece[FIRST]
        count = crossings(piece, edges_x, 0, t[1:], 0)
        count = crossings(piece, edges_y, 1, t[1:], count)
        t[count + 1] = piece[LAST]
        for k in range(count + 1):
            dt = t[k + 1] - t[k]
            if not dt * length > tiny:
                continue
            for q in range(n):
                at = t[k] + dt * g[q]
                if arc:
                    c, s = np.cos(at), np.sin(at)
                    x[found, q, 0], x[found, q, 1] = piece[X] + piece[RUN_X] * c, piece[Y] + piece[RUN_X] * s
                    normal[found, q, 0], normal[found, q, 1] = piece[OUTWARD] * c, piece[OUTWARD] * s
                else:
                    x[found, q, 0], x[found, q, 1] = piece[X] + at * piece[RUN_X], piece[Y] + at * piece[RUN_Y]
                    normal[found, q, 0], normal[found, q, 1] = piece[RUN_Y] / length, -piece[RUN_X] / length
                ds[found, q] = dt * length * gw[q]
            middle, inward = x[found, n // 2], normal[found, n // 2]
            i, j = last_at_most(edges_x, middle[0] - 2 * tiny * inward[0]), last_at_most(edges_y, middle[1] - 2 * tiny * inward[1])
            if i < 0 or i >= columns or j < 0 or j >= rows:
                continue
            on = False
            for axis in range(2):
                edges = edges_x if axis == 0 else edges_y
                near = last_at_most(edges, middle[axis])
                for line in range(max(near, 0), min(near + 2, len(edges))):
                    on = on or along(edges[line], x[found], axis, tiny)
            cell[found], side[found], on_line[found] = i * rows + j, int(piece[SIDE]), on
            found += 1
    return x[:found], ds[:found], normal[:found], cell[:found], side[:found], on_line[:found]


@kernel
def edge_cuts(pieces, circles, y, left, right, cuts):
    """Ends of the spans of the line y between left and right, split where the boundary crosses, sorted, into `cuts`; how many."""
    cuts[0], cuts[1], count = left, right, 2
    for circle in circles:
        half = np.sqrt(max(circle[2] ** 2 - (y - circle[1]) ** 2, 0.0))
        insert(cuts, count, min(max(circle[0] - half, left), right))
        insert(cuts, count + 1, min(max(circle[0] + half, left), right))
        count += 2
    for p in pieces:
        if p[ARC] == 0.0 and p[RUN_Y] != 0.0:
            t = (y - p[Y]) / p[RUN_Y]
            if 0.0 <= t <= 1.0:
                insert(cuts, count, min(max(p[X] + t * p[RUN_X], left), right))
                count += 1
    return count


@kernel
def trace(pieces, circles, edges_x, edges_y, g, gw, tiny):
    """The Outline of a region on a grid: pieces and circles from `packed`, Gauss points g, gw of a part, what is nearer than `tiny` is the same."""
    x, ds, normal, cell, side, on_line = parts(pieces, edges_x, edges_y, g, gw, tiny)
    columns, rows, n = len(edges_x) - 1, len(edges_y) - 1, len(g)
    facing, cut = np.zeros(columns * rows), np.zeros(columns * rows, dtype=np.bool_)
    for a in range(len(cell)):
        if not on_line[a]:
            cut[cell[a]] = True
            for q in range(n):
                facing[cell[a]] += normal[a, q, 1] * ds[a, q]
    up = facing >= 0.0
    split = np.sum(cut)
    whole, asked = np.empty(len(cut) - split, dtype=np.int64), np.empty((len(cut) + split * (len(pieces) + 2 * len(circles) + 1), 2))
    spans, home = np.empty((len(asked), 2)), np.empty(len(asked), dtype=np.int64)
    cuts = np.empty(2 + 2 * len(circles) + len(pieces))
    at = 0
    for c in range(len(cut)):
        if not cut[c]:
            i, j = c // rows, c % rows
            whole[at] = c
            asked[at, 0], asked[at, 1] = (edges_x[i] + edges_x[i + 1]) / 2, (edges_y[j] + edges_y[j + 1]) / 2
            at += 1
    found = 0
    for c in range(len(cut)):
        if cut[c]:
            i, j = c // rows, c % rows
            y = edges_y[j + 1] if up[c] else edges_y[j]
            level = y - 4 * tiny if up[c] else y + 4 * tiny  # the inner side of the edge: a boundary that runs along it is then unambiguous
            count = edge_cuts(pieces, circles, y, edges_x[i], edges_x[i + 1], cuts)
            for k in range(count - 1):
                if cuts[k + 1] - cuts[k] > tiny:
                    spans[found, 0], spans[found, 1], home[found] = cuts[k], cuts[k + 1], c
                    asked[at + found, 0], asked[at + found, 1] = (cuts[k] + cuts[k + 1]) / 2, level
                    found += 1
    return Outline(x, ds, normal, cell, side, on_line, up, whole, spans[:found], home[:found], asked[: at + found])


@kernel
def block(x0, hx, y0, hy, cell, g, gw, x, w, home, at):
    """Gauss points of a rectangle, from place `at` on; the next place."""
    for a in range(len(g)):
        for b in range(len(g)):
            x[at, 0], x[at, 1] = x0 + hx * g[a], y0 + hy * g[b]
            w[at], home[at] = hx * hy * (gw[a] * gw[b]), cell
            at += 1
    return at


@kernel
def points(found, inside, edges_x, edges_y, g, gw):
    """Quadrature of the region: x (Q, 2), w (Q,), cell (Q,) over whole cells, strips from the boundary to an edge, and the rest of the opposite edge.

    inside (W + S,): what the distance said of found.asked
    """
    rows, m, n, middle = len(edges_y) - 1, len(g), found.ds.shape[1], len(found.whole)
    most = np.sum(inside) * m * m + len(found.cell) * n * m
    x, w, home, at = np.empty((most, 2)), np.empty(most), np.empty(most, dtype=np.int64), 0
    for k in range(middle):
        if inside[k]:
            i, j = found.whole[k] // rows, found.whole[k] % rows
            at = block(edges_x[i], edges_x[i + 1] - edges_x[i], edges_y[j], edges_y[j + 1] - edges_y[j], found.whole[k], g, gw, x, w, home, at)
    for a in range(len(found.cell)):
        upright = True  # such sides carry no strips
        for q in range(n):
            upright = upright and found.normal[a, q, 1] * found.ds[a, q] == 0.0
        if upright or found.on_line[a]:
            continue
        c = found.cell[a]
        ref = edges_y[c % rows] if found.up[c] else edges_y[c % rows + 1]
        for q in range(n):
            height = found.x[a, q, 1] - ref
            strip = found.normal[a, q, 1] * found.ds[a, q] * height
            for r in range(m):
                x[at, 0], x[at, 1] = found.x[a, q, 0], ref + height * g[r]
                w[at], home[at] = strip * gw[r], c
                at += 1
    for s in range(len(found.home)):
        if inside[middle + s]:
            c = found.home[s]
            bottom, top = edges_y[c % rows], edges_y[c % rows + 1]
            at = block(found.spans[s, 0], found.spans[s, 1] - found.spans[s, 0], bottom, top - bottom, c, g, gw, x, w, home, at)
    return x[:at].copy(), w[:at].copy(), home[:at].copy()
