"""What each cell of a grid holds of a body, and one particle a cell.

Filled cells are weighed in closed form, cut ones by their points (mpm.scene.cut), a prism by its base and its height: nothing is ever held a
point of a filled cell. Sums and first moments are those of the quadrature; surface is kept by cell and smooth side.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from mpm.scene.cut import Cut

LEAST = 0.01  # of a cell: what is less full gives what it holds to the nearest that is fuller


class Contents(NamedTuple):
    """Of the cells (C,), rising: size (C,) [m^d], volume (C,) (with the weight r where radial), first moment (C, d).

    Of pieces of surface, in any order: the cell inside `home` (S,), side (S,), area (S,), its first moment `point` (S, d), area times outward normal (S, d).
    """

    cell: np.ndarray
    size: np.ndarray
    volume: np.ndarray
    moment: np.ndarray
    home: np.ndarray
    side: np.ndarray
    area: np.ndarray
    point: np.ndarray
    normal: np.ndarray


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


def centres(index, edges) -> np.ndarray:
    """Middles (N, d) of the cells with the numbers `index` (N,) in each direction."""
    return np.stack([((e[:-1] + e[1:]) / 2)[i] for e, i in zip(edges, index, strict=True)], axis=-1)


def sizes(index, edges) -> np.ndarray:
    """(N,) [m^d] of cells."""
    return np.prod([np.diff(e)[i] for e, i in zip(edges, index, strict=True)], axis=0)


def filled(cell: np.ndarray, edges, radial: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Size, volume and first moment of whole cells."""
    index = np.unravel_index(cell, [len(e) - 1 for e in edges])
    size, moment = sizes(index, edges), centres(index, edges)
    volume = size * moment[:, 0] if radial else size
    moment *= volume[:, None]
    if radial:
        moment[:, 0] += size * np.diff(edges[0])[index[0]] ** 2 / 12
    return size, volume, moment


def sums_over(key: np.ndarray, values: np.ndarray, n: int) -> np.ndarray:
    """Sums of values (N,) or (N, d) over equal keys in 0..n-1."""
    total = np.empty((n, *values.shape[1:]))
    for column, one in zip(total.reshape(n, math.prod(values.shape[1:])).T, values.reshape(len(values), math.prod(values.shape[1:])).T, strict=True):
        column[:] = np.bincount(key, weights=one, minlength=n)
    return total


def weigh(cuts: Iterable[Cut], edges, radial: bool = False) -> Contents:
    """Sums over the cells of all cuts; `radial` weighs everything with the first coordinate (per radian)."""
    whole, volumes, surfaces = [], [], []
    for cut in cuts:
        whole.append(cut.whole)
        for x, w, cell in cut.volume:
            wr = w * x[..., 0] if radial else w
            volumes.append((cell, w.sum(1), wr.sum(1), np.einsum("aq,aqd->ad", wr, x)))
        for x, w, normal, cell, side in cut.surface:
            wr = w * x[..., 0] if radial else w
            surfaces.append((cell, side, wr.sum(1), np.einsum("aq,aqd->ad", wr, x), np.einsum("aq,aqd->ad", wr, normal)))
    full = np.concatenate(whole)
    part, *sums = (np.concatenate(column) for column in zip(*volumes, strict=True))
    held = np.zeros(math.prod(len(e) - 1 for e in edges), dtype=bool)
    held[full] = held[part] = True
    cell, place = np.flatnonzero(held), np.cumsum(held) - 1
    found = []
    for one, more in zip(filled(full, edges, radial), sums, strict=True):
        total = sums_over(place[part], more, len(cell))
        total[place[full]] = one
        found.append(total)
    return Contents(cell, *found, *(np.concatenate(column) for column in zip(*surfaces, strict=True)))


def stacked(base: Contents, upright: Contents, layers: int) -> Contents:
    """A plane body times an interval of the last direction, which has `layers` cells: all products of what their cells hold."""

    def pairs(a, b):
        return np.multiply.outer(a, b).reshape(-1)

    def moments(a, first, b, last):
        """Of products: first moments (A, 2) with the weights a, and (B, 1) with the weights b."""
        return np.concatenate([np.multiply.outer(first, b).swapaxes(1, 2).reshape(-1, 2), pairs(a, last[:, 0])[:, None]], axis=1)

    def places(a, b):
        return np.add.outer(a * layers, b).reshape(-1)

    lateral = (
        places(base.home, upright.cell), np.repeat(base.side, len(upright.cell)), pairs(base.area, upright.volume),
        moments(base.area, base.point, upright.volume, upright.moment), moments(base.area, base.normal, upright.volume, 0 * upright.moment),
    )  # fmt: skip
    sides = base.side.max(initial=-1) + 1
    caps = (
        places(base.cell, upright.home), np.tile(upright.side + sides, len(base.cell)), pairs(base.volume, upright.area),
        moments(base.volume, base.moment, upright.area, upright.point), moments(base.volume, 0 * base.moment, upright.area, upright.normal),
    )  # fmt: skip
    cells = (
        places(base.cell, upright.cell), pairs(base.size, upright.size), pairs(base.volume, upright.volume),
        moments(base.volume, base.moment, upright.volume, upright.moment),
    )  # fmt: skip
    return Contents(*cells, *(np.concatenate(pair) for pair in zip(lateral, caps, strict=True)))


def nearest(index: np.ndarray, x: np.ndarray, known: np.ndarray, edges, places: np.ndarray | None = None) -> np.ndarray:
    """Numbers (K,) among the rising cells `known` of the one nearest to each x (K, d), in the cell `index` (d, K); the first of equals.

    A cell is where its middle is, or at `places`, within it.
    """
    shape, d = [len(e) - 1 for e in edges], len(edges)
    around = index[:, :, None] + np.indices([3] * d).reshape(d, 1, -1) - 1
    within = np.all((around >= 0) & (around < np.reshape(shape, (d, 1, 1))), axis=0)
    cell = np.ravel_multi_index(around, shape, mode="clip")
    at = np.minimum(np.searchsorted(known, cell), len(known) - 1)
    away = (((centres(np.unravel_index(cell, shape), edges) if places is None else places[at]) - x[:, None]) ** 2).sum(-1)
    away[~(within & (known[at] == cell))] = np.inf
    found = at[np.arange(len(x)), np.argmin(away, axis=1)]
    beyond = np.full(len(x), np.inf)  # how near what lies outside these 3^d cells may be
    for k, e in enumerate(edges):
        low, high = ((e[:-1] + e[1:]) / 2,) * 2 if places is None else (e[1:], e[:-1])
        low, high = (np.concatenate([[-np.inf] * 2, bound, [np.inf] * 2]) for bound in (low, high))
        beyond = np.minimum(beyond, np.minimum(x[:, k] - low[index[k]], high[index[k] + 4] - x[:, k]) ** 2)
    far = np.flatnonzero(away.min(axis=1) >= beyond)
    if len(far):
        from scipy.spatial import cKDTree  # rare: a needle's point, a sheet thinner than LEAST

        found[far] = cKDTree(centres(np.unravel_index(known, shape), edges) if places is None else places).query(x[far])[1]
    return found


def particles(held: Contents, edges) -> CutCells:
    """One particle a cell: centroids and volumes, pieces of surface with their centroids and mean normals.

    Cells less than LEAST full go to the nearest kept particle, volume, first moment and surface, so sums and first moments stay exact.
    """
    shape = [len(e) - 1 for e in edges]
    kept = held.size >= LEAST * sizes(np.unravel_index(held.cell, shape), edges)
    if not kept.any():
        kept = held.size >= held.size.max()
    small, cell, volume, moment = np.flatnonzero(~kept), held.cell[kept], held.volume[kept], held.moment[kept]
    new = np.cumsum(kept) - 1
    if len(small):
        index = np.array(np.unravel_index(held.cell[small], shape))
        new[small] = nearest(index, centres(index, edges), cell, edges)
        np.add.at(volume, new[small], held.volume[small])
        np.add.at(moment, new[small], held.moment[small])
    moment /= volume[:, None]

    at = np.minimum(np.searchsorted(held.cell, held.home), len(held.cell) - 1)
    lost = np.flatnonzero((held.cell[at] != held.home) & (held.area > 0))  # slivers without volume
    if len(lost):
        at[lost] = nearest(np.array(np.unravel_index(held.home[lost], shape)), held.point[lost] / held.area[lost, None], held.cell, edges)
    sides = held.side.max(initial=0) + 1
    pair, piece = np.unique(new[at] * sides + held.side, return_inverse=True)
    area, point, normal = (sums_over(piece, values, len(pair)) for values in (held.area, held.point, held.normal))
    some = area > 0
    area, normal = area[some], normal[some] / np.linalg.norm(normal[some], axis=1, keepdims=True)
    return CutCells(volume, moment, cell, pair[some] // sides, area, point[some] / area[:, None], normal, pair[some] % sides)


def by_nodes(cut, h: float):
    """Particles in the order of the nodes nearest to them, so that those that share a stencil follow one another (transfer/rows.py).

    Half-way between two nodes it is always the upper one, whatever round-off says.
    """
    nearest = np.floor(cut.centroid / h + 0.5 + 1e-9).astype(np.int64)
    low, high = nearest.min(axis=0), nearest.max(axis=0)
    order = np.argsort(np.ravel_multi_index(tuple((nearest - low).T), high - low + 1), kind="stable")
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return replace(cut, volume=cut.volume[order], centroid=cut.centroid[order], cell=cut.cell[order], owner=back[cut.owner])
