"""Exact quadrature of a ball cut by a three-dimensional grid.

At height z the sphere is a circle of radius rho(z), its area element is R dphi dz (Archimedes) and n_z dS = (z - c) dphi dz: the divergence
theorem along z needs only the arc of that circle inside each column of cells (one arc, as columns are split at the centre), and discs cut at the
grid's heights (mpm.scene.cut_boundary). Between heights at which the circle passes through a corner of the column the arc's ends are smooth in z, with square
roots at the touching heights, which z = a + (b - a) s^2 (3 - 2 s) takes away. Surface comes in blocks of ROWS.
Measured at four offsets, 2 to 10 cells a radius, against 32 heights: volume 3e-9, area 3e-9 of the whole; 2e-5 of a cell and of its face in the worst cell.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from mpm.scene.cut import EDGE, NONE, Arc, Batch, Cut, Skin, filled, gauss
from mpm.scene.cut_boundary import plane, strips

EIGHTHS = tuple(np.linspace(-np.pi, np.pi, 9).tolist())
ROWS = 2_500  # of points that are held at once


def circle(centre, radius: float) -> list[Arc]:
    """Eight arcs, so that none is long and the faces of `side` (left, top, ...) change at an end."""
    return [Arc(tuple(centre), radius, a, b) for a, b in pairwise(EIGHTHS)]


def halves(edges: np.ndarray, centre: float) -> tuple[np.ndarray, ...]:
    """Cells of one direction, split at the centre: (their number, the side of the centre they lie on (+1, -1), nearest and farthest distance from it)."""
    parts = np.unique(np.concatenate([edges, np.clip([centre], edges[0], edges[-1])]))
    number = np.searchsorted(edges, (parts[1:] + parts[:-1]) / 2, side="right") - 1
    far = np.abs(parts - centre)
    return number, np.where(parts[1:] + parts[:-1] > 2 * centre, 1.0, -1.0), np.minimum(far[1:], far[:-1]), np.maximum(far[1:], far[:-1])


def intervals(centre, radius: float, edges) -> tuple[np.ndarray, ...]:
    """Heights a < b (A,) between which the sphere crosses a column smoothly, within one layer of cells: a, b, cell, the column's signs (A, 2) and
    its nearest and farthest distances from the centre (A, 2)."""
    (X, Y, Z), cz = edges, centre[2]
    (i, sx, x0, x1), (j, sy, y0, y1) = halves(X, centre[0]), halves(Y, centre[1])
    p, q = np.nonzero(np.hypot.outer(x0, y0) < radius)
    signs, near, far = (np.stack([a[p], b[q]], axis=-1) for a, b in ((sx, sy), (x0, y0), (x1, y1)))
    corners = np.stack([np.hypot(a[:, 0], b[:, 1]) for a in (near, far) for b in (near, far)], axis=-1)
    rise = np.sqrt(np.maximum(radius**2 - corners**2, 0.0))
    levels = np.broadcast_to(np.append(Z, cz), (len(p), len(Z) + 1))
    z = np.sort(np.clip(np.concatenate([levels, cz + rise, cz - rise], axis=1), max(Z[0], cz - radius), min(Z[-1], cz + radius)), axis=1)
    low, high = cz - rise[:, 0], cz + rise[:, 0]  # of the sphere above the nearest corner; between those of the farthest the column is inside
    middle = (z[:, 1:] + z[:, :-1]) / 2
    crossed = (np.abs(middle - cz) > rise[:, 3, None]) & (middle > low[:, None]) & (middle < high[:, None])
    c, k = np.nonzero(crossed & (np.diff(z, axis=1) > EDGE * np.diff(Z).min()))
    slab = np.searchsorted(Z, middle[c, k], side="right") - 1
    cell = (i[p[c]] * (len(Y) - 1) + j[q[c]]) * (len(Z) - 1) + slab
    return z[c, k], z[c, k + 1], cell, signs[c], near[c], far[c]


def patches(centre, radius: float, a, b, cell, signs, near, far, order: int) -> Skin:
    """Points of the sphere: heights between a and b times angles, a row a cell."""
    (s, sw), (g, gw) = gauss(max(12, 2 * order)), gauss(order // 2 + 2)
    up = (a[:, None] + (b - a)[:, None] * (s * s * (3 - 2 * s))) - centre[2]
    dz = (b - a)[:, None] * (6 * s * (1 - s) * sw)
    rho = np.sqrt(np.maximum(radius**2 - up**2, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):  # at a pole
        (x0, y0), (x1, y1) = ([np.clip(side[:, k, None] / rho, 0.0, 1.0) for k in range(2)] for side in (near, far))
    first, last = np.maximum(np.arcsin(y0), np.arccos(x1)), np.minimum(np.arcsin(y1), np.arccos(x0))
    run = np.maximum(last - first, 0.0)
    phi = first[..., None] + run[..., None] * g
    normal = np.empty((*phi.shape, 3))
    normal[..., 0] = signs[:, 0, None, None] * (rho[..., None] * np.cos(phi))
    normal[..., 1] = signs[:, 1, None, None] * (rho[..., None] * np.sin(phi))
    normal[..., 2] = up[..., None]
    normal = normal.reshape(len(a), -1, 3) / radius
    area = ((radius * dz * run)[..., None] * gw).reshape(len(a), -1)
    return Skin(np.asarray(centre) + radius * normal, area, normal, cell, np.zeros(len(cell), dtype=np.int64))


def ball(centre, radius: float, edges, order: int) -> Iterator[Cut]:
    """The ball of `radius` round `centre` (3,) cut by the cells of three directions: surface and strips, then what the discs add, then whole cells."""
    X, Y, Z = edges
    slabs = len(Z) - 1
    upper = Z[1:] + Z[:-1] > 2 * centre[2]  # strips from the bottom face, where most of the surface faces up; and the reverse
    found = intervals(centre, radius, edges)
    crossed = np.zeros((len(X) - 1, len(Y) - 1, slabs), dtype=bool)
    crossed.reshape(-1)[found[2]] = True
    for start in range(0, len(found[0]), ROWS):
        skin = patches(centre, radius, *(a[start : start + ROWS] for a in found), order)
        ref = np.where(upper, Z[:-1], Z[1:])[skin.cell % slabs]
        yield Cut(NONE, (strips(skin.x, skin.normal[..., 2] * skin.w, ref[:, None], skin.cell, order),), (skin,))

    for slab in range(slabs):
        wanted = crossed[..., slab].ravel()
        rho2 = radius**2 - ((Z[slab + 1] if upper[slab] else Z[slab]) - centre[2]) ** 2
        if rho2 > (EDGE * radius) ** 2 and wanted.any():
            yield raised(disc(centre[:2], float(np.sqrt(rho2)), edges[:2], order), wanted, edges, slab, order)

    corner = [np.maximum(np.abs(e[1:] - c), np.abs(e[:-1] - c)) for e, c in zip(edges, centre, strict=True)]
    yield Cut(np.flatnonzero((corner[0][:, None, None] ** 2 + corner[1][:, None] ** 2 + corner[2] ** 2 <= radius**2) & ~crossed))


def disc(centre, radius: float, edges, order: int) -> Cut:
    """A disc cut by the cells of two directions."""
    return plane(circle(centre, radius), lambda x: np.hypot(x[:, 0] - centre[0], x[:, 1] - centre[1]) - radius, edges, order)


def raised(base: Cut, wanted: np.ndarray, edges, slab: int, order: int) -> Cut:
    """What a plane region has in the columns `wanted` (C,), through one layer of cells."""
    (g, gw), Z = gauss(order // 2 + 1), edges[2]
    slabs, height = len(Z) - 1, Z[slab + 1] - Z[slab]
    found = [filled(base.whole[wanted[base.whole]] * slabs + slab, edges, order)]
    for flat in base.volume:
        here = wanted[flat.cell]
        x, w = np.repeat(flat.x[here], len(g), axis=1), np.repeat(flat.w[here], len(g), axis=1)
        z = np.broadcast_to(np.tile(Z[slab] + height * g, flat.w.shape[1]), w.shape)
        weights = w * (height * np.tile(gw, flat.w.shape[1]))
        found.append(Batch(np.concatenate([x, z[..., None]], axis=-1), weights, flat.cell[here] * slabs + slab))
    return Cut(NONE, tuple(found))
