"""Failing is an answer too: which ranges fail, and what that does to indices.

table      for each parameter the share that failed in the lower, middle and upper third of its range, and p, the chance of as large a difference between those
           that failed and those that are ok if the parameter had nothing to do with it (Kolmogorov and Smirnov, two samples, times the number of parameters)
bounded    indices of all points where some y are unknown, and failing depends on a parameter: y of the failed is set to the nearest known one, the lowest, the
           highest, draws from the known, the sum of all main effects, and for each parameter its main effect and its opposite; the interval holds those of all
           ways. It knows of no y outside the known range
"""

from dataclasses import dataclass

import numpy as np

from mpm.sensitivity.projection import Indices, chosen, estimate

SURE = 0.01
EFFECT = 9  # polynomials of a main effect


@dataclass(frozen=True)
class Row:
    """One parameter of the table."""

    name: str
    shares: tuple[float, ...]  # of the lower, the middle and the upper third of its range
    edges: tuple[float, ...]  # between them
    p: float


def table(parameters: list, unit: np.ndarray, bad: np.ndarray) -> list[Row]:
    """Every parameter, the one that tells most first; empty where none or all failed."""
    from scipy.stats import ks_2samp

    if not bad.any() or bad.all():
        return []
    rows = []
    for k, parameter in enumerate(parameters):
        third = np.clip((unit[:, k] * 3).astype(int), 0, 2)
        shares = tuple(float(bad[third == t].mean()) if (third == t).any() else float("nan") for t in range(3))
        p = min(1.0, len(parameters) * float(ks_2samp(unit[bad, k], unit[~bad, k]).pvalue))
        rows.append(Row(parameter.name, shares, tuple(map(float, parameter.back(np.array([1 / 3, 2 / 3])))), p))
    return sorted(rows, key=lambda row: row.p)


def bounded(unit: np.ndarray, y: np.ndarray, known: np.ndarray, seed: int = 0) -> Indices:
    """First and total indices of all points, those of the nearest known ones as value, from the lowest to the highest over all ways to fill in."""
    from scipy.spatial import cKDTree

    fill = lambda values: np.where(known, y, values)  # noqa: E731
    low, high = y[known].min(), y[known].max()
    nearest = y[known][cKDTree(unit[known]).query(unit)[1]]
    basis = chosen(unit, nearest)
    mean, effects = nearest.mean(), []
    for single in basis.single:
        effects.append(single[:, 1:EFFECT] @ np.mean(single[:, 1:EFFECT] * (nearest - mean)[:, None], axis=0))
    ways = [nearest, low, high, np.random.default_rng(seed).choice(y[known], len(y)), mean + sum(effects)]
    ways = [fill(np.clip(way, low, high)) for way in (*ways, *(mean + sign * effect for effect in effects for sign in (1, -1)))]
    found = [estimate(basis, way, seed, groups=0) for way in ways]
    span = lambda all_: np.clip(np.stack([all_[0][:, 0], np.min(all_, axis=0)[:, 1], np.max(all_, axis=0)[:, 2]], axis=1), 0, 1)  # noqa: E731
    return Indices(span([one.first for one in found]), span([one.total for one in found]), found[0].explained)
