"""Variation: what a sweep section comes to: groups of parameters, formulas and a condition. `vary` makes it."""

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from mpm.config.condition import Condition, Formula
from mpm.config.schema_paths import Path, Slot


@dataclass
class Parameter:
    """One varied parameter: `values` as SI numbers or plain data, or a range `low`..`high`, even in the number or its logarithm."""

    name: str
    path: Path
    slot: Slot
    where: Path  # in the config's data, for errors
    values: list[Any] = field(default_factory=list)
    low: float = math.nan
    high: float = math.nan
    log: bool = False
    short: str = ""
    spoken: str = ""


@dataclass
class Group:
    """A dimension of the sweep."""

    form: str  # axis, zip, sample, points
    parameters: list[Parameter]
    size: int
    where: Path
    design: str = ""
    seed: int = 0


@dataclass
class Derived:
    """A parameter that follows from others by a formula, whose names stand for paths."""

    parameter: Parameter
    formula: Formula
    names: dict[str, Path]


@dataclass
class Variation:
    """All groups in the order of the file's forms, what follows from them, and the condition."""

    groups: list[Group]
    derived: list[Derived] = field(default_factory=list)
    condition: Condition | None = None
    names: dict[str, Path] = field(default_factory=dict)  # of the condition

    @property
    def size(self) -> int:
        """Number of points, as an exact integer."""
        return math.prod(group.size for group in self.groups)

    def parameters(self) -> Iterator[Parameter]:
        """Every varied parameter."""
        for group in self.groups:
            yield from group.parameters
        for one in self.derived:
            yield one.parameter


def at_path(data: Any, path: Path) -> Any:
    """The plain data at a path; a bare kind's name counts as its mapping."""
    for key in path:
        data = data[key]
    return data


def label(value: Any) -> str:
    """A short text for a value that is no number: the kind `{flip: {blend: 0.1}}` as `flip(blend=0.1)`, entries as `xx=0, yy=0`; what is absent is left out."""
    if isinstance(value, dict):
        return ", ".join(entry(key, inner) for key, inner in value.items() if inner is not None) or "none"
    if isinstance(value, list | tuple) and len(value) == 1 and isinstance(value[0], float | int):
        return label(value[0])  # a place in 1-D is a number
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(label, value)) + "]"
    return exactly(value) if isinstance(value, float) else "none" if value is None else str(value)


def exactly(value: float) -> str:
    """A number with as many digits as it takes: no other has the same text."""
    short = f"{value:g}"
    return short if float(short) == value else repr(value)


def digits(values: Iterable[float], least: int = 6) -> int:
    """How many significant digits it takes to tell numbers apart; 17 where all are needed."""
    numbers = sorted({value for value in values if math.isfinite(value)})
    wanted = least
    for low, high in itertools.pairwise(numbers):
        size = max(abs(low), abs(high))
        if high - low < size * 10.0 ** (1 - wanted):
            wanted = max(wanted, math.floor(math.log10(size)) + 1 + math.ceil(-math.log10(high - low)))
    return min(wanted, 17)


def rounded(value: float, places: int) -> str:
    """A number in so many significant digits; past 15, which no longer shorten it, as Python writes it."""
    return f"{value:.{places}g}" if places <= 15 else repr(value)


def entry(key: Any, inner: Any) -> str:
    """A key of a mapping with what lies under it."""
    if isinstance(inner, dict):
        return f"{key}({entries(inner)})" if entries(inner) else str(key)
    return f"{key}={label(inner)}"


def entries(inner: Any) -> str:
    """What stands in the brackets of a label."""
    return ", ".join(f"{name}={label(item)}" for name, item in inner.items() if item is not None) if isinstance(inner, dict) else label(inner)
