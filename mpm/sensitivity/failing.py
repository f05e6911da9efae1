"""Failing is an answer too: which ranges fail, and what that does to indices.

table      for each parameter the share that failed in the lower, middle and upper third of its range, and p, the chance of as large a difference between those
           that failed and those that are ok if the parameter had nothing to do with it (Kolmogorov and Smirnov, two samples, times the number of parameters)
bounded    indices of all points where some y are unknown, and failing depends on a parameter: y of the failed is set to the lowest, to the highest, and to the
           nearest known one, to draws from the known, and each way analysed; the interval holds all of theirs. It knows of no y outside the known range
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

SURE = 0.01


@dataclass(frozen=True)
class Row:
    """One parameter of the table."""

    name: str
    shares: tuple[float, float, float]
    edges: tuple[float, float]
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


def bounded(unit: np.ndarray, y: np.ndarray, known: np.ndarray, analyse: Callable[[np.ndarray, np.ndarray], np.ndarray], seed: int = 0) -> np.ndarray:
    """(value from the known alone, lower, upper) of each parameter over all ways to fill in what is not known."""
    from scipy.spatial import cKDTree

    nearest = y[known][cKDTree(unit[known]).query(unit[~known])[1]]
    ways = [np.full((~known).sum(), edge) for edge in (y[known].min(), y[known].max())]
    ways += [nearest, np.random.default_rng(seed).choice(y[known], (~known).sum())]
    found = [analyse(unit[known], y[known])]
    for way in ways:
        filled = y.copy()
        filled[~known] = way
        found.append(analyse(unit, filled))
    stacked = np.array(found)
    return np.stack([found[0][:, 0], stacked[:, :, 1].min(axis=0), stacked[:, :, 2].max(axis=0)], axis=1)
