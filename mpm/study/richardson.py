"""A reference where there is no exact solution: the limit of a method's own refinement (Richardson 1911; Roache 1994), with its error.

f(h) = f* + C h^p through the three finest: p from (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p),  f* = f3 + (f3 - f2)/((h2/h3)^p - 1),
error of f* taken as 1.25 |f* - f3| (Roache's factor for three grids).
Fails when: something that is not refined with h (a tolerance of time steps) is the larger error, which cannot be seen from here; or the three finest do not
fall alike (p outside [0.5, 6]): p = 1 is then taken, and the error is 1.25 |f3 - f2|. Errors below the reference's mean nothing.
"""

import math
from typing import Any

import numpy as np

ORDERS = (0.5, 6.0)
SAFETY = 1.25


def limit(sizes: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """(f*, its error) from values at sizes, coarse to fine, at any ratios; NaN with fewer than two."""
    known = np.isfinite(values)
    h, f = sizes[known][-3:], values[known][-3:]
    if len(f) < 2:
        return math.nan, math.nan
    last, p = f[-1] - f[-2], order(h, f) if len(f) > 2 else None
    if p is None:
        return float(f[-1] + last / (h[-2] / h[-1] - 1)), SAFETY * abs(float(last))
    step = last / ((h[-2] / h[-1]) ** p - 1)
    return float(f[-1] + step), SAFETY * abs(float(step))


def order(h: np.ndarray, f: np.ndarray) -> float | None:
    """p of three values: (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), by bisection; None where there is none in [0.5, 6]."""
    if f[1] == f[2]:
        return None
    wanted = (f[0] - f[1]) / (f[1] - f[2])

    def excess(p: float) -> float:
        return (h[0] ** p - h[1] ** p) / (h[1] ** p - h[2] ** p) - wanted

    low, high = ORDERS
    if excess(low) * excess(high) > 0:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(low) * excess(middle) > 0 else (low, middle)
    return low


def against_limit(experiment: Any, root: Any, scale: float) -> tuple[np.ndarray, float]:
    """(error of every setting, error of the reference), the largest over `chart.observables`; temperatures over `scale`, other finals over their limit."""
    names = experiment.chart.observables or tuple(name for name in root.data_vars if name.startswith("time_to_"))
    if not names:
        raise ValueError("a chart needs `exact:`, or `chart.observables`: the finals that are compared with their limit, as [temperature_centre]")
    method = experiment.chart.reference or next(iter(experiment.chart.methods))
    rows = np.flatnonzero(root["method"].values == method)
    rows = rows[root["path"].values[rows] == root["path"].values[rows[0]]] if len(rows) else rows
    refined = experiment.chart.methods[method].refine or experiment.chart.refine
    path = str(root["path"].values[rows[0]]) if len(rows) else ""
    sizes = np.array(next(iter(refined[path].values())), dtype=float)
    worst, own = np.zeros(len(root["method"])), 0.0
    for name in names:
        if name not in root:
            raise ValueError(f"chart.observables: no run has {name}; there are {', '.join(root.data_vars)}")
        values = root[name].values.astype(float)
        value, error = limit(sizes, values[rows])
        size = scale if root[name].attrs.get("units") == "K" else abs(value) or 1.0
        worst, own = np.fmax(worst, np.abs(values - value) / size) + 0 * values, max(own, error / size)
    return worst, own
