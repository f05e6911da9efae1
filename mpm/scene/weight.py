"""Gravity of a config as one number a direction, where it may change over time."""

import math

import numpy as np

from mpm.heat.programmes import at, bounds
from mpm.scene.exchange import programme


def start(experiment) -> list[float]:
    """At the start [m/s2]; zeros where there is none."""
    return [at(programme(one), 0.0) for one in experiment.gravity or [0.0] * experiment.grid.directions]


def strongest(experiment) -> tuple[float, ...] | None:
    """Of the largest size that it ever has, direction by direction [m/s2]; None where there is none."""
    return None if experiment.gravity is None else tuple(max(bounds(programme(one)), key=abs) for one in experiment.gravity)


def heaviest(experiment) -> float:
    """The largest size that it can have [m/s2]."""
    return math.hypot(*(strongest(experiment) or (0.0,)))


def both_ways(experiment) -> np.ndarray:
    """How strong it ever pulls towards the lower and the upper side of each direction (D, 2) [m/s2]."""
    ends = [bounds(programme(one)) for one in experiment.gravity or [0.0] * experiment.grid.directions]
    return np.maximum(0.0, np.array([[-low, high] for low, high in ends]))
