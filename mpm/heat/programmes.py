"""Temperatures over time: an oven programme as a table, or a sine. A number is itself.

    at(programme, t) [K]        bounds(programme) -> (lowest, highest) [K]      longest(programme): no step may be longer and still see it [s]
"""

import math
from typing import NamedTuple

from mpm.materials.laws import Table
from mpm.materials.roles import value


class Sine(NamedTuple):
    """mean + amplitude sin(2 pi t/period + phase)."""

    mean: float  # [K]
    amplitude: float  # [K]
    period: float  # [s]
    phase: float  # [rad]


def at(programme, t: float) -> float:
    """The temperature at time t; a table (mpm.materials.laws.table over time) is flat beyond its ends."""
    if isinstance(programme, Table):
        return float(value(programme, t))
    if isinstance(programme, Sine):
        return programme.mean + programme.amplitude * math.sin(2 * math.pi * t / programme.period + programme.phase)
    return programme


def bounds(programme) -> tuple[float, float]:
    """Lowest and highest temperature that it ever takes; a table of either interpolation stays between its values."""
    if isinstance(programme, Table):
        values = [float(value(programme, t)) for t in programme.theta]
        return min(values), max(values)
    if isinstance(programme, Sine):
        return programme.mean - abs(programme.amplitude), programme.mean + abs(programme.amplitude)
    return programme, programme


def longest(programme) -> float:
    """A quarter of the shortest interval of a table, a sixteenth of a period."""
    if isinstance(programme, Table):
        return float((programme.theta[1:] - programme.theta[:-1]).min()) / 4
    return programme.period / 16 if isinstance(programme, Sine) else math.inf
