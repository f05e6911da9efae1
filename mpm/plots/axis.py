"""A swept dimension as an axis of a figure: where its values lie, and how they are called."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from mpm.plots import words

FEW = 64  # values that are told apart by their digits
LETTERS = 105.0  # of ticks across a figure
LOG_RATIO = 50.0  # values that span more than this are read on a logarithmic axis
UNBROKEN = "\u00a0"  # a space at which no line ends, as within `Pa s`
SHORT = 26  # letters of a heading in a legend


@dataclass(frozen=True)
class Axis:
    """A swept dimension: where its values lie on a figure and how they are called. Infinity lies one step past the largest number."""

    name: str
    dim: str
    values: np.ndarray
    label: str
    title: str
    units: str
    log: bool
    category: bool
    positions: np.ndarray = field(repr=False)

    @classmethod
    def of(cls, coordinate: Any, dim: str, log: bool | None = None) -> "Axis":
        """The axis of a coordinate along `dim`; logarithmic where the values say so, unless told."""
        name, raw, attrs = str(coordinate.name), coordinate.values, coordinate.attrs
        path, units = attrs.get("config_path", ""), attrs.get("units", "1")
        if raw.dtype.kind not in "fiu":
            values = np.array([str(value) for value in raw], dtype=object)
            label = words.compose(path or name, attrs.get("long_name", name), "")
            return cls(name, dim, values, label, label, "", False, True, np.arange(len(values), dtype=float))
        long = str(attrs.get("long_name", "")).lower()
        named = long.startswith("temperature") and "difference" not in long  # a parameter of the user's own
        scale = words.scale(raw, units, words.is_temperature_path(path) or named)
        values = scale(raw)
        log = log_spaced(values) and not scale.shift if log is None else bool(log and (values > 0).all())
        called, long = words.called(name), words.short(attrs.get("long_name", name))
        title, label = called if words.symbol(name) or len(long) > SHORT else long, words.compose(name, attrs.get("long_name", name), scale.units)
        if name.endswith("_" + path.rsplit(".", 1)[-1]):  # several have one: say whose it is
            title, label = called, words.with_units(f"{words.title_case(long)}, {called}", scale.units)
        return cls(name, dim, values, label, words.with_units(title, scale.units), scale.units, log, False, placed(values, log))

    @property
    def size(self) -> int:
        """Number of values."""
        return len(self.values)

    def colours(self) -> list[Any]:
        """A colour a value: in order for numbers, apart for kinds."""
        from mpm.plots.style import OKABE_ITO, ordered  # matplotlib, which exports do without

        if self.category:
            return [OKABE_ITO[i % len(OKABE_ITO)] for i in range(self.size)]
        order = ordered(self.size)
        return [order[rank] for rank in self.ranks()]

    def ranks(self) -> np.ndarray:
        """Place of each value in ascending order."""
        return np.argsort(np.argsort(self.positions, kind="stable"), kind="stable")

    @cached_property
    def texts(self) -> list[str]:
        """Every value in words, those that differ in different ones; on long axes in three digits."""
        return words.numbers(self.values) if self.size <= FEW else [words.number(value) for value in self.values]

    def text(self, index: int) -> str:
        """A value in words."""
        return self.texts[index]

    def says(self, index: int) -> str:
        """`κ = 0.35 W/m/K`."""
        return f"{self.called} = {self.text(index)} {self.units.replace(' ', UNBROKEN)}".strip()

    @property
    def called(self) -> str:
        """The letter of the parameter, else its name as words."""
        return words.called(self.name)

    def apply(self, ax: Any) -> None:
        """Scale, ticks and label of the horizontal axis."""
        from mpm.plots.style import plain_ticks

        if self.log:
            ax.set_xscale("log")
        if self.size <= 9 or self.category or not np.isfinite(self.values).all():
            chosen = spread(self.size, 12)
            ax.set_xticks(self.positions[chosen], apart(self.positions[chosen], [self.text(i) for i in chosen], self.log, room(ax)))
            ax.minorticks_off()
        elif self.log:
            plain_ticks(ax.xaxis)
        ax.set_xlabel(self.label if len(self.label) < 0.95 * room(ax) else self.title)


def room(ax: Any) -> float:
    """About how many letters of ticks fit along the horizontal axis."""
    place = ax.get_subplotspec()
    return LETTERS / (place.get_gridspec().ncols if place is not None else 1)


def apart(positions: np.ndarray, texts: list[str], log: bool, letters: float) -> list[str]:
    """The texts of ticks, blank where they would run into their neighbours: both ends stay, then from the left what fits."""
    at = np.log(positions) if log else positions
    at = (at - at.min()) / max(float(np.ptp(at)), 1e-300) * letters
    order, half = np.argsort(at, kind="stable"), [0.5 * len(text) + 0.6 for text in texts]
    first, last, shown = order[0], order[-1], {int(order[0]), int(order[-1])}
    near = first
    for i in order[1:-1]:
        if at[i] - half[i] >= at[near] + half[near] and at[i] + half[i] <= at[last] - half[last]:
            shown.add(int(i))
            near = i
    return [text if i in shown else "" for i, text in enumerate(texts)]


def log_spaced(values: np.ndarray) -> bool:
    """Whether values want a logarithmic axis: evenly spaced in the logarithm, or spanning a wide range."""
    finite = np.unique(values[np.isfinite(values)])
    if len(finite) < 2 or finite[0] <= 0:
        return False
    steps = np.diff(np.log(finite))
    even = len(finite) > 2 and np.ptp(steps) < 0.02 * steps.mean() and finite[-1] / finite[0] > 3
    return bool(even or finite[-1] / finite[0] > LOG_RATIO)


def placed(values: np.ndarray, log: bool) -> np.ndarray:
    """Positions on the axis; an infinite value lies one step past the largest finite one."""
    finite = np.unique(values[np.isfinite(values)])
    if len(finite) == len(np.unique(values)):
        return values
    if not len(finite):
        return np.arange(len(values), dtype=float)
    if log:
        past = finite[-1] * (finite[-1] / finite[-2] if len(finite) > 1 else 10.0)
    else:
        past = finite[-1] + (finite[-1] - finite[-2] if len(finite) > 1 else 1.0)
    return np.where(np.isfinite(values), values, past)


def spread(size: int, most: int) -> list[int]:
    """At most `most` indices, evenly spread, ends included."""
    return list(range(size)) if size <= most else sorted({round(float(i)) for i in np.linspace(0, size - 1, most)})
