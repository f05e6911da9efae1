"""How much a quantity changes in a run: what an error of it is a share of, where nothing is exact (`mpm chart`, `mpm plan --tol`, smaller models, limits).

Temperatures       100 % is the range of temperatures in the run, or what the caller knows to drive it
Motion, momentum   position, extent, radius, displacement, ...: 100 % is the largest change since the start, along any direction that is told.
                   The origin of coordinates, and how far off it a body lies, are no part of that
All else           100 % is the range over the run, at least STEADY of its size: energies, volumes, pressures
Times to reach     the time itself
Fails when: a quantity hardly changes and only by what the method errs (J of a body that keeps its volume): its error then is of the order of 100 %, or STEADY.
"""

import math
from collections.abc import Mapping

import numpy as np

STEADY = 1e-3
ROUND = 1e-12  # of a quantity's size: a change below it is none
MOTION = ("position_", "extent_", "radius_", "displacement_", "momentum_")
ENDS = ("x", "y", "z", "r")


def spread(series: Mapping[str, np.ndarray]) -> float:
    """The range of temperatures in a run [K]; 0 where it tells none."""
    if "temperature_max" not in series:
        return 0.0
    low, high = np.nanmin(series["temperature_min"]), np.nanmax(series["temperature_max"])
    return float(high - low) if np.isfinite(high - low) else 0.0


def together(name: str, series: Mapping[str, np.ndarray]) -> list[str]:
    """The series of one vector: `position_mean_x` and `position_mean_y`; the name alone where it has no direction."""
    stem, _, end = name.rpartition("_")
    if end not in ENDS:
        return [name]
    return [other for axis in ENDS if (other := f"{stem}_{axis}") in series]


def moved(values: np.ndarray) -> float:
    """Largest change since the start."""
    known = values[np.isfinite(values)]
    return float(np.max(np.abs(known - known[0]))) if len(known) else 0.0


def size(name: str, series: Mapping[str, np.ndarray], last: float, kelvin: float = 0.0) -> float:
    """What counts as 100 % of the quantity `name` in a run with these series, and this last value; `kelvin` that of temperatures, their range unless given."""
    if name.startswith("temperature_") and (kelvin or spread(series)):
        return kelvin or spread(series)
    values = series.get(name)
    if values is None or not np.isfinite(values).any():
        return abs(last) if math.isfinite(last) and last else 1.0
    most = float(np.nanmax(np.abs(values)))
    if name.startswith(MOTION):
        found = max(map(moved, (series[one] for one in together(name, series))))
        return found if found > ROUND * most else most or 1.0
    return max(float(np.nanmax(values) - np.nanmin(values)), STEADY * most) or 1.0
