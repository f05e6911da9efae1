"""A reference where there is no exact solution: the limit of a method's own refinement (Richardson 1911; Roache 1994), with its error.

f(h) = f* + C h^p through the three finest: p from (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p),  f* = f3 + (f3 - f2)/((h2/h3)^p - 1),
error of f* taken as 1.25 |f* - f3| (Roache's factor for three grids).
Slower than p = 0.5 is taken as 0.5. Where the three finest do not fall alike (no p up to 6), p = 1 is taken, and the error is 1.25 |f3 - f2|.
Fails when: something that is not refined with h (a tolerance of time steps, moving through the grid) is the larger error, which cannot be seen from here.
Errors below the reference's mean nothing.
"""

import math
from typing import Any

import numpy as np

from mpm.records.variables import OK
from mpm.reduce.change import size

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
    """p of three values: (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), by bisection, 0.5 where they fall slower; None where there is none up to 6."""
    if f[1] == f[2]:
        return None
    wanted = (f[0] - f[1]) / (f[1] - f[2])

    def excess(p: float) -> float:
        return (h[0] ** p - h[1] ** p) / (h[1] ** p - h[2] ** p) - wanted

    low, high = ORDERS
    if wanted > 0 and excess(low) > 0:
        return low
    if excess(low) * excess(high) > 0:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(low) * excess(middle) > 0 else (low, middle)
    return low


def observed(experiment: Any) -> list[str]:
    """The finals that a config wants right, by dataset name: those of `chart.observables`, else its observables and the temperatures of its probes."""
    from mpm.records.variables import dataset_name

    if experiment.chart is not None and experiment.chart.observables:
        return list(map(dataset_name, experiment.chart.observables))
    return [*map(dataset_name, experiment.output.observables), *(f"temperature_{probe}" for probe in experiment.output.probes)]


def against_limit(experiment: Any, tree: Any) -> tuple[np.ndarray, float]:
    """(error of every setting, error of the reference), the largest over `observed`, each over its size (mpm.reduce.change) in the reference's finest run
    or over `chart.scale`."""
    root, series = tree.to_dataset(), tree["series"].to_dataset()
    method = experiment.chart.reference or next(iter(experiment.chart.methods))
    rows = np.flatnonzero(root["method"].values == method)
    rows = rows[root["path"].values[rows] == root["path"].values[rows[0]]] if len(rows) else rows
    refined = experiment.chart.methods[method].refine or experiment.chart.refine
    path = str(root["path"].values[rows[0]]) if len(rows) else ""
    sizes = np.array(next(iter(refined[path].values())), dtype=float)
    sound = [row for row in rows if root["status"].values[row] == OK]
    finest = {str(name): series[name].values[sound[-1]] for name in series.data_vars} if sound else {}
    worst, own = np.zeros(len(root["method"])), 0.0
    for name in observed(experiment):
        if name not in root:
            continue  # a temperature at a probe of a body without heat
        values = root[name].values.astype(float)
        value, error = limit(sizes, values[rows])
        given = None if name.startswith("time_to_") else experiment.chart.scale
        full = given or size(name, finest, abs(value))
        worst, own = np.fmax(worst, np.abs(values - value) / full) + 0 * values, max(own, error / full)
    return worst, own
