"""Where bodies that do not move touch: on which points of one surface another body lies.

A point x of a surface with the outward normal n lies on another body where that body's surface is nearer than TOUCH cells and faces it:
|d(x)| <= TOUCH h, grad d . n < -FACING, d the other body's signed distance.
A cut by the grid is also cut by the other body's box, so that what it covers ends at an end of a piece: exact where its ends are those of its box.
"""

from dataclasses import replace

import numpy as np

TOUCH, FACING, STEP = 0.05, 0.7, 1e-3  # of a cell; cosine; of a cell, for the slope of the distance
SAME = 1e-9  # of a cell


def covered(x: np.ndarray, normal: np.ndarray, others, h: float) -> np.ndarray:
    """Which points x (S, d) of a surface lie on any of `others`."""
    found = np.zeros(len(x), dtype=bool)
    for other in others:
        near = np.flatnonzero(~found & (np.abs(other.distance(x)) <= TOUCH * h)) if len(x) else np.zeros(0, dtype=int)
        if len(near):
            step = STEP * h * normal[near]
            found[near] = other.distance(x[near] + step) - other.distance(x[near] - step) < -2 * FACING * STEP * h
    return found


def split(edges, others, h: float) -> list[np.ndarray]:
    """The grid's lines with those of the boxes of `others` between them."""
    finer = []
    for k, lines in enumerate(edges):
        more = [bound[k] for other in others for bound in other.bounds() if lines[0] < bound[k] < lines[-1]]
        more = [at for at in more if np.min(np.abs(lines - at)) > SAME * h]
        finer.append(np.unique(np.concatenate([lines, more])))
    return finer


def surface_beside(shape, others, edges, order: int, h: float):
    """The surface of `shape` (mpm.scene.cut.Surface), its cells those of `edges`, rising, cut by the boxes of `others` too."""
    finer = split(edges, others, h)
    _, surface = shape.cut(finer, order)
    index = np.unravel_index(surface.cell, [len(lines) - 1 for lines in finer])
    home = [np.searchsorted(lines, 0.5 * (fine[i] + fine[i + 1]), side="right") - 1 for lines, fine, i in zip(edges, finer, index, strict=True)]
    cell = np.ravel_multi_index(home, [len(lines) - 1 for lines in edges])
    rank = np.argsort(cell, kind="stable")
    return replace(surface.at(rank), cell=cell[rank])


def touch(one, two, h: float) -> bool:
    """Whether a part of their surfaces, more than points, lies on the other's."""
    (low, high), (least, most) = one.bounds(), two.bounds()
    if np.any(np.maximum(low, least) - np.minimum(high, most) > TOUCH * h):
        return False
    return bool(len(patch(one, two, [lines_of(one, h, k) for k in range(len(low))], 2, h)[1]))


def lines_of(shape, h: float, k: int) -> np.ndarray:
    """Lines about h apart that cut a shape in direction k."""
    low, high = (bound[k] for bound in shape.bounds())
    return np.linspace(low - 0.1 * h, high + 0.1 * h, max(2, int(np.ceil((high - low) / h)) + 2))


def patch(one, two, edges, order: int, h: float):
    """Points (S, d), weights and outward normals of that part of the surface of `one` that lies on `two`."""
    surface = surface_beside(one, (two,), edges, order, h)
    here = surface.at(covered(surface.x, surface.normal, (two,), h))
    return here.x, here.w, here.normal
