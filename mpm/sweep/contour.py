"""Contour: where to look next for the line on which an answer of two parameters crosses a level, from all points that are known.

Points are joined into triangles (Delaunay). Through each that the line crosses it runs straight by linear interpolation; cubic radial basis functions through
all points say how far it is off in the middle. The new point is where they put the line, or the middle, where that is beyond the triangle; so are the places at
which the line leaves the region. New points lie on the line, half of `until` apart or more; between them it is nearly straight, which takes fewer points than
cells whose corners lie on both sides of it. Values that are far from the level would bend the functions near it, so they are tamed where that predicts the
points near the line better, each from all others.
Source  Ranjan, Bingham and Michailidis, Technometrics 50 (2008) 527 (designs that follow a contour). Rippa, Adv. Comput. Math. 11
        (1999) 193 (each point from all others by one inverse). Fails when: the line is shorter than the first triangles
"""

import numpy as np

SURE = 0.35  # of `until`: what a triangle may be off by in the middle; elsewhere it is off by more
STEP = 1e-4  # of the ranges, for slopes
DIGITS = 4
FAR = (1.0, 2.0, 4.0, 8.0, np.inf)  # times the median distance from the level, from which values grow as their logarithm
MOST_POINTS = 1000  # points of one set of functions


def follow(places: np.ndarray, values: np.ndarray, level: float, until: float) -> np.ndarray:
    """New points, those first where the line is known worst; all in units of the ranges, shape (points, 2). None where it is known to `until`."""
    from scipy.interpolate import RBFInterpolator
    from scipy.spatial import Delaunay

    values = values - level
    triangles, over = Delaunay(places), values > 0
    cross = lambda i, j: places[i] + (places[j] - places[i]) * values[i] / (values[i] - values[j])  # noqa: E731
    crossings: list[np.ndarray] = []
    sides: list[np.ndarray] = []
    reach: list[float] = []
    for corners in triangles.simplices:
        met = [cross(i, j) for i, j in zip(corners, np.roll(corners, 1), strict=True) if over[i] != over[j]]
        if met:
            crossings.append(np.mean(met, axis=0))
            sides.append(np.zeros(2))
            reach.append(float(np.max(np.linalg.norm(places[corners] - crossings[-1], axis=1))))
    for i, j in triangles.convex_hull:
        if over[i] != over[j]:
            crossings.append(cross(i, j))
            reach.append(float(np.linalg.norm(places[j] - places[i])))
            sides.append((places[j] - places[i]) / reach[-1])
    if not crossings:
        return np.empty((0, 2))
    at, along = np.array(crossings), np.array(sides)
    smooth = RBFInterpolator(places, tamed(places, values), kernel="cubic", degree=1, neighbors=100 if len(places) > MOST_POINTS else None)
    slope = np.stack([smooth(at + STEP * axis) - smooth(at - STEP * axis) for axis in np.eye(2)], axis=1) / (2 * STEP)
    on_side = along.any(axis=1)
    slope[on_side] = along[on_side] * np.sum(along * slope, axis=1)[on_side, None]
    steep = np.maximum(np.linalg.norm(slope, axis=1), 1e-300)
    off = smooth(at) / steep
    to = np.where((np.abs(off) < reach)[:, None], np.clip(at - (off / steep)[:, None] * slope, 0, 1), at).round(DIGITS)
    found: list[np.ndarray] = []
    for k in np.argsort(-np.abs(off), kind="stable"):
        if abs(off[k]) <= SURE * until:
            break
        if np.min(np.linalg.norm(np.vstack([places, *found]) - to[k], axis=1)) > until / 2:
            found.append(to[k])
    return np.array(found).reshape(-1, 2)


def tamed(places: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The distances from the level, those that are far grown as their logarithm where the nearer half is then predicted better."""
    size = np.abs(values)
    median = np.median(size[size > 0])
    far = np.minimum(np.array(FAR) * median, size.max())[:, None]
    ways = np.where(size <= far, values, np.sign(values) * far * (1 + np.log(np.maximum(size, far) / far)))
    near = np.argsort(size, kind="stable")[:MOST_POINTS]
    x = places[near]
    flat = np.hstack([np.ones((len(x), 1)), x])
    matrix = np.block([[np.linalg.norm(x[:, None] - x, axis=2) ** 3, flat], [flat.T, np.zeros((3, 3))]])
    inverse = np.linalg.pinv(matrix)[: len(x), : len(x)]
    errors = (ways[:, near] @ inverse.T / np.diag(inverse))[:, size[near] <= median]
    return ways[np.argmin(np.sum(errors**2, axis=1))]
