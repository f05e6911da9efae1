"""Fronts: which settings are worth their time, and what may be ranked.

Two settings are ranked only where their times do not overlap: a time is the interval from the smallest of its rounds to their median. What lies within the
spread of the cheapest is told beside it, never below it.
"""

from dataclasses import dataclass

import numpy as np

TOLERANCES = (0.1, 0.01, 0.001)


@dataclass(frozen=True)
class Cheapest:
    """The cheapest setting within a tolerance; `ties` cannot be told from it."""

    tolerance: float
    index: int | None
    ties: tuple[int, ...] = ()


def pareto(error: np.ndarray, least: np.ndarray) -> np.ndarray:
    """True for settings (N,) that no other beats in both error and time, of those with both."""
    known = np.isfinite(error) & np.isfinite(least)
    front, best = np.zeros(len(error), dtype=bool), np.inf
    for i in np.lexsort((error, least)):
        if known[i] and error[i] < best:
            front[i], best = True, error[i]
    return front


def cheapest(error: np.ndarray, least: np.ndarray, median: np.ndarray, tolerance: float) -> Cheapest:
    """The setting of the least time with an error of at most `tolerance`, and those that overlap with it."""
    fit = np.flatnonzero(np.isfinite(error) & np.isfinite(least) & (error <= tolerance))
    if not len(fit):
        return Cheapest(tolerance, None)
    best = int(fit[np.argmin(least[fit])])
    ties = tuple(int(i) for i in fit if i != best and least[i] <= median[best])
    return Cheapest(tolerance, best, ties)


def sentence(found: Cheapest, names: list[str], error: np.ndarray, least: np.ndarray, median: np.ndarray, own: float = 0.0) -> str:
    """`for 1 %: APIC, cell 0.125: 3.2 ms (median 3.4), error 0.4 %`. `own` is the error of what is compared with: nothing is said of what lies below it."""
    if own > found.tolerance:
        return f"for {percent(found.tolerance)}: cannot be told, as the limit compared with is itself known to {percent(own)} only: refine further"
    if found.index is None:
        known = error[np.isfinite(error)]
        return f"for {percent(found.tolerance)}: no setting here; the least error is {percent(known.min())}" if len(known) else "no setting has an error"
    i = found.index
    said = f"for {percent(found.tolerance)}: {names[i]}: {duration(least[i])} (median {duration(median[i])}), error {percent(error[i])}"
    if found.ties:
        said += f"; within the spread, so not ranked: {', '.join(names[k] for k in found.ties[:4])}"
        said += f" and {len(found.ties) - 4} more" if len(found.ties) > 4 else ""
    return said


def percent(value: float) -> str:
    """0.01 as `1 %`."""
    return f"{100 * value:.2g} %"


def duration(seconds: float) -> str:
    """Seconds in the unit that reads best."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"
