"""Contour: where to look next for the line on which an answer of two parameters crosses a level, from all points that are known.

Points are joined into triangles (Delaunay). Through each that the line crosses it runs straight by linear interpolation; cubic radial basis functions through
all points say how far it is off in the middle, and the new point is where they put the line. So are the places at which the line leaves the region. New points
lie on the line, `until` apart or more; between them it is nearly straight, which takes fewer points than cells whose corners lie on both sides of it.
Source  Ranjan, Bingham and Michailidis, Technometrics 50 (2008) 527 (designs that follow a contour). Fails when: the line is shorter than the first triangles
"""

import numpy as np

SURE = 0.35  # of `until`: what a triangle may be off by in the middle; elsewhere it is off by more
STEP = 1e-4  # of the ranges, for slopes
DIGITS = 4


def follow(places: np.ndarray, values: np.ndarray, level: float, until: float) -> np.ndarray:
    """New points, those first where the line is known worst; all in units of the ranges, shape (points, 2). None where it is known to `until`."""
    from scipy.interpolate import RBFInterpolator
    from scipy.spatial import Delaunay

    smooth = RBFInterpolator(places, values, kernel="cubic", degree=1, neighbors=100 if len(places) > 1000 else None)
    triangles, over = Delaunay(places), values > level
    cross = lambda i, j: places[i] + (places[j] - places[i]) * (level - values[i]) / (values[j] - values[i])  # noqa: E731
    at, along = [], []
    for corners in triangles.simplices:
        met = [cross(i, j) for i, j in zip(corners, np.roll(corners, 1), strict=True) if over[i] != over[j]]
        if met:
            at.append(np.mean(met, axis=0))
            along.append(np.zeros(2))
    for i, j in triangles.convex_hull:
        if over[i] != over[j]:
            at.append(cross(i, j))
            along.append((places[j] - places[i]) / np.linalg.norm(places[j] - places[i]))
    if not at:
        return np.empty((0, 2))
    at, along = np.array(at), np.array(along)
    slope = np.stack([smooth(at + STEP * axis) - smooth(at - STEP * axis) for axis in np.eye(2)], axis=1) / (2 * STEP)
    on_side = along.any(axis=1)
    slope[on_side] = along[on_side] * np.sum(along * slope, axis=1)[on_side, None]
    steep = np.maximum(np.linalg.norm(slope, axis=1), 1e-300)
    off = (smooth(at) - level) / steep
    to = np.clip(at - (off / steep)[:, None] * slope, 0, 1).round(DIGITS)
    found: list[np.ndarray] = []
    for k in np.argsort(-np.abs(off), kind="stable"):
        if abs(off[k]) <= SURE * until:
            break
        if np.min(np.linalg.norm(np.vstack([places, *found]) - to[k], axis=1)) > until:
            found.append(to[k])
    return np.array(found).reshape(-1, 2)
