"""The figure of `mpm stability`: a panel a method; points by outcome, the measured boundary, theory's lines.

Blue dots completed, orange marks did not, a mark a reason; the darker, the faster grew what the map watches, darkest where a run ended before three
outputs could tell. Black: the boundary, refined between the last point within and the first beyond. Dashed: theory.
"""

import math
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.lines import Line2D

from mpm.plots import words
from mpm.plots.axis import room
from mpm.plots.style import DASHES, INK, MARKS, OKABE_ITO, figure, plain_ticks, styled
from mpm.records.variables import describe

WITHIN, BEYOND = OKABE_ITO[0], OKABE_ITO[1]
COLUMNS = 4
LINES = (OKABE_ITO[3], OKABE_ITO[4], OKABE_ITO[5], "#7a5195")
SAFE = OKABE_ITO[2]
RATES = LinearSegmentedColormap.from_list("rates", ["#f2a46b", BEYOND, "#6b2300"])
SLOWEST = 1e-3  # of the fastest growth: below it marks get no lighter


def draw(tree: Any) -> Any:
    """The figure of stability.nc."""
    with styled():
        return Figure(tree).draw()


class Figure:
    """One map."""

    def __init__(self, tree: Any):
        self.root, self.points = tree["/"].dataset, tree["points"].dataset
        self.panels = [str(name) for name in self.root.panel.values]
        self.x = self.root.across.values
        self.labels = [str(text) for text in self.root.across_label.values] if "across_label" in self.root else None
        self.up = self.root.attrs["toward"] == "larger"
        self.log_x = self.labels is None and positive(self.x) and wide(self.x)
        self.log_y = positive(self.points.along.values) and wide(self.points.along.values)
        causes: dict[str, int] = {}
        for cause in self.points.outcome.values[self.points.is_beyond.values == 1]:
            causes[str(cause)] = causes.get(str(cause), 0) + 1
        self.causes = sorted(causes, key=causes.__getitem__, reverse=True)
        self.norm = self.rates()

    def draw(self) -> Any:
        """All panels, and a legend that holds for all of them."""
        columns = 3 if len(self.panels) in (5, 6, 9) else min(COLUMNS, len(self.panels))
        rows = math.ceil(len(self.panels) / columns)
        fig = figure(str(self.root.attrs["title"]), 0.9 + (3.6 if columns > 2 else 4.4) * rows)
        axes = fig.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for index, ax in enumerate(axes.flat):
            if index < len(self.panels):
                self.panel(ax, index)
            else:
                ax.set_visible(False)
        for column in axes.T:
            lowest = [ax for ax in column if ax.get_visible()][-1]
            lowest.set_xlabel(words.wrapped(self.axis("across"), int(room(lowest))))
            lowest.tick_params(labelbottom=True)
        for ax in axes[:, 0]:
            ax.set_ylabel(self.axis("boundary"))
        self.legend(fig, axes)
        if self.norm is not None:
            self.bar(fig, axes)
        return fig

    def rates(self) -> LogNorm | None:
        """The range of growth rates of what failed; None where the map watches none, or none grew."""
        growth = self.points.growth.values[self.points.is_beyond.values == 1]
        growth = growth[np.isfinite(growth) & (growth > 0)]
        return LogNorm(max(growth.min(), SLOWEST * growth.max()) / 1.01, growth.max() * 1.01) if len(growth) else None

    def colours(self, growth: np.ndarray) -> Any:
        """A colour a failed point."""
        if self.norm is None:
            return BEYOND
        return RATES(self.norm(np.clip(np.where(np.isnan(growth), np.inf, growth), self.norm.vmin, self.norm.vmax)))

    def bar(self, fig: Any, axes: Any) -> None:
        """What the shades of the marks mean."""
        bar = fig.colorbar(ScalarMappable(self.norm, RATES), ax=axes, location="right", shrink=0.8, aspect=40, pad=0.01)
        plain_ticks(bar.ax.yaxis)
        said = f"growth of {words.short(describe(self.root.attrs['growth_of']).long_name)} where it failed, 1/{self.root.attrs['per']}"
        bar.set_label(f"{said}\n(darkest: faster, or ended before it could be told)", fontsize=8)
        bar.outline.set_visible(False)

    def axis(self, name: str) -> str:
        """What an axis is called: as the config says; nothing is added to a name that it chose."""
        return str(self.root[name].attrs["long_name"])

    def panel(self, ax: Any, index: int) -> None:
        """Points, boundary and theory of one panel."""
        mine = self.points.panel_of.values == index
        at, along, beyond, growth = (self.points[name].values[mine] for name in ("at", "along", "is_beyond", "growth"))
        outcome = self.points.outcome.values[mine]
        ok = beyond == 0
        ax.set_title(self.panels[index])
        if self.log_x:
            ax.set_xscale("log")
            plain_ticks(ax.xaxis)
        if self.log_y:
            ax.set_yscale("log")
            plain_ticks(ax.yaxis)
        ax.scatter(at[ok], along[ok], s=9, color=WITHIN, alpha=0.55, lw=0, zorder=2)
        for number, cause in enumerate(self.causes):
            here = ~ok & (outcome == cause)
            mark = MARKS[number % len(MARKS)]
            ax.scatter(at[here], along[here], s=16, color=self.colours(growth[here]), marker=mark, lw=0.9, alpha=0.85, zorder=2)
        low, high = np.min(self.points.along.values), np.max(self.points.along.values)
        within, after = self.root.within.values[index], self.root.beyond.values[index]
        known = np.isfinite(within) & np.isfinite(after)
        room = (high / low) ** 0.04 if self.log_y else 0.04 * (high - low)
        limits = (low / room, high * room) if self.log_y else (low - room, high + room)
        first, last = limits if self.up else limits[::-1]
        edge = np.where(known, self.root.boundary.values[index], np.where(np.isnan(after), last, first))  # where none failed nothing is shaded
        far = high * 10 if self.up else (low / 10 if self.log_y else low - abs(high))
        ax.fill_between(self.x, edge, far, color=BEYOND, alpha=0.10, lw=0, zorder=0)
        ax.plot(self.x, np.where(known, self.root.boundary.values[index], np.nan), "-o", color=INK, ms=3.5, lw=2.2, zorder=4)
        if "expected" in self.root:
            for line, look in enumerate(self.looks()):
                ax.plot(self.x, self.root.expected.values[line, index], lw=1.9, zorder=5, **look)
        ax.set_ylim(*limits)
        if self.labels is not None:
            ax.set_xticks(self.x, self.labels)

    def legend(self, fig: Any, axes: Any) -> None:
        """Under the first panel of the last row: marks, then theory."""
        found = np.isfinite(self.root.within.values) & np.isfinite(self.root.beyond.values)
        marks = [Line2D([], [], marker="o", ms=3.5, color=INK, label="measured boundary")] if found.any() else []
        marks += [Line2D([], [], ls="None", marker="o", ms=4, color=WITHIN, label="completed")]
        marks += [Line2D([], [], ls="None", marker=MARKS[k % len(MARKS)], color=BEYOND, label=in_words(cause)) for k, cause in enumerate(self.causes)]
        lines = []
        if "expected" in self.root:
            named = dict(zip(map(str, self.root.line_label.values), self.looks(), strict=True))  # lines of one name are one entry
            lines = [Line2D([], [], label=label, **look) for label, look in named.items()]
        entries = [*marks, *lines]
        longest = max(len(str(entry.get_label())) for entry in entries)
        fig.legend(handles=entries, loc="outside lower left", ncols=min(len(entries), max(2, 150 // (longest + 9))), handlelength=2.6)

    def looks(self) -> list[dict[str, Any]]:
        """Colour and dashes of every line of theory, one look a name: what is safe in one colour, what is expected in others."""
        found: dict[str, dict[str, Any]] = {}
        count = {"safe": 0, "expected": 0}
        for label, role in zip(self.root.line_label.values, self.root.line_role.values, strict=True):
            if label not in found:
                place, colour = count[role], SAFE if role == "safe" else LINES[count[role] % len(LINES)]
                found[label] = {"color": colour, "ls": DASHES[1 + place % 2] if role == "safe" else DASHES[2 + place % 3]}
                count[role] += 1
        return [found[label] for label in self.root.line_label.values]


def in_words(cause: str) -> str:
    """Why a point is beyond: an outcome, or `steps_failed above 0.5` by what it means, `steps that found no balance and were cut`."""
    name, above, most = cause.partition(" above ")
    if not above:
        return cause.replace("_", " ")
    try:
        meaning = describe(name).long_name
    except KeyError:
        return f"{name.replace('_', ' ')} above {most}"
    if name.startswith("steps_") and float(most) < 1:
        return meaning.rpartition(": ")[2]
    return f"{words.short(meaning)}: above {most}"


def positive(values: np.ndarray) -> bool:
    """Whether a logarithm can be taken of all."""
    return bool(np.min(values) > 0)


def wide(values: np.ndarray) -> bool:
    """Whether a logarithmic axis shows more."""
    return bool(np.max(values) > 8 * np.min(values))
