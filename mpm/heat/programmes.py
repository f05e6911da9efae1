"""Numbers over time: a temperature, a coefficient, a flux as a table or a sine, or one after another with jumps between. A number is itself.

at(programme, t)      value; at a jump that after it        during(programme, t)   what holds from t on to the next jump: without jumps
bounds(programme) -> (lowest, highest)                      longest(programme)     no step may be longer and still see it [s]
before(programme, t)                   what holds up to t                          integral(programme, begin, end)   over time, exact
turns(programme) -> times of its jumps [s]                  spell(programme, begin, end)   the same within [begin, end), nothing outside
"""

import math
from itertools import pairwise
from typing import Any, NamedTuple

from mpm.materials.laws import Table
from mpm.materials.roles import enthalpy, value

SAME = 1e-9  # of a time: what is nearer to a jump is at it


class Sine(NamedTuple):
    """mean + amplitude sin(2 pi t/period + phase)."""

    mean: float
    amplitude: float
    period: float  # [s]
    phase: float  # [rad]


class Parts(NamedTuple):
    """One programme after another, each up to its jump."""

    jumps: tuple[float, ...]  # rising [s]
    parts: tuple[Any, ...]  # one more


def at(programme, t: float) -> float:
    """The value at time t; a table (mpm.materials.laws.table over time) is flat beyond its ends."""
    if isinstance(programme, Table):
        return float(value(programme, t))
    if isinstance(programme, Sine):
        return programme.mean + programme.amplitude * math.sin(2 * math.pi * t / programme.period + programme.phase)
    if isinstance(programme, Parts):
        return at(during(programme, t), t)
    return programme


def integral(programme, begin: float, end: float) -> float:
    """Over time from begin to end."""
    if isinstance(programme, Table):
        return float(enthalpy(programme, end) - enthalpy(programme, begin))
    if isinstance(programme, Sine):
        rate, swing = 2 * math.pi / programme.period, [math.cos(2 * math.pi * t / programme.period + programme.phase) for t in (begin, end)]
        return programme.mean * (end - begin) + programme.amplitude * (swing[0] - swing[1]) / rate
    if isinstance(programme, Parts):
        ends = [begin, *(min(max(jump, begin), end) for jump in programme.jumps), end]
        return sum(integral(part, *span) for part, span in zip(programme.parts, pairwise(ends), strict=True))
    return programme * (end - begin)


def during(programme, t: float):
    """What holds from t to the next jump."""
    if not isinstance(programme, Parts):
        return programme
    return programme.parts[sum(jump <= t * (1 + SAME) for jump in programme.jumps)]


def before(programme, t: float):
    """What holds up to t from the jump before it."""
    if not isinstance(programme, Parts):
        return programme
    return programme.parts[sum(jump < t * (1 - SAME) for jump in programme.jumps)]


def turns(programme) -> tuple[float, ...]:
    """Times of the jumps."""
    return programme.jumps if isinstance(programme, Parts) else ()


def changes(programme) -> bool:
    """Whether it is anything but a number."""
    return isinstance(programme, Table | Sine | Parts)


def spell(programme, begin: float = 0.0, end: float | None = None):
    """The programme within [begin, end), 0 before and after."""
    jumps, parts = (list(programme.jumps), list(programme.parts)) if isinstance(programme, Parts) else ([], [programme])
    if begin > 0:
        first = sum(jump <= begin for jump in jumps)
        jumps, parts = [begin, *jumps[first:]], [0.0, *parts[first:]]
    if end is not None:
        last = sum(jump < end for jump in jumps)
        jumps, parts = [*jumps[:last], end], [*parts[: last + 1], 0.0]
    return Parts(tuple(jumps), tuple(parts)) if jumps else parts[0]


def bounds(programme) -> tuple[float, float]:
    """Lowest and highest value that it ever takes; a table of either interpolation stays between its values."""
    if isinstance(programme, Table):
        values = [float(value(programme, t)) for t in programme.theta]
        return min(values), max(values)
    if isinstance(programme, Sine):
        return programme.mean - abs(programme.amplitude), programme.mean + abs(programme.amplitude)
    if isinstance(programme, Parts):
        each = [bounds(part) for part in programme.parts]
        return min(low for low, _ in each), max(high for _, high in each)
    return programme, programme


def longest(programme) -> float:
    """A quarter of the shortest interval of a table, a sixteenth of a period."""
    if isinstance(programme, Table):
        return float((programme.theta[1:] - programme.theta[:-1]).min()) / 4
    if isinstance(programme, Parts):
        return min(longest(part) for part in programme.parts)
    return programme.period / 16 if isinstance(programme, Sine) else math.inf
