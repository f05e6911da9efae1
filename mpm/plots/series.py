"""Panels of observables over time: a few points of the sweep, coloured by the swept value, with the measured curve as dots."""

import itertools
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from mpm.plots import words
from mpm.plots.style import DASHES, FAINT, INK, OKABE_ITO, QUIET, heading, legend_below, level
from mpm.plots.view import NOTHING, Axis, View, spread

MOST_LINES = 5
DOTS = ("o", "s", "D", "^", "v")
TEMPERATURE = "Temperature"
LATER = 1.3  # of the run's end
THIN = 0.015  # of the range of a panel's values: lines closer than that hide one another
ABOVE = (0, (4, 4))  # dashes through which the line below is seen


def panel(ax: Any, view: View, names: list[str], lines: Axis | None, at: dict[str, int]) -> None:
    """Series `names` (one unit) over time; one colour a value of `lines`, one dash a series. Without `lines`, one colour a series."""
    time = np.asarray(view.series["time"].values, dtype=float)
    clock, scale = words.scale(time, "s"), together(view, names)
    indices: list[int] = []
    if lines is not None:
        indices = picked(lines, at, [i for i in range(lines.size) if any(known(view, name, {**at, lines.dim: i}) for name in names)])
    colours = OKABE_ITO if lines is None else lines.colours()
    above = coincident(view, names, at) if lines is None else set()
    ended = False
    for i, here in [(0, at)] if lines is None else [(i, {**at, lines.dim: i}) for i in indices]:
        for j, name in enumerate(names):
            colour, dash = (colours[j % len(colours)], ABOVE if names[j] in above else "-") if lines is None else (colours[i], DASHES[j % len(DASHES)])
            drawn = scale(row(view, name, here))
            ax.plot(clock(time), drawn, color=colour, ls=dash, zorder=3)
            ended |= stopped(ax, view, here, clock(time), drawn, colour)
            crossings(ax, view, name, here, clock, colour)
    for name in names:
        levels(ax, view, name)
    ax.set_xlabel(words.with_units("Time", clock.units))
    place = ax.get_subplotspec()
    letters = 28 if place is not None and place.get_gridspec().nrows > 1 else 42
    ax.set_ylabel(words.wrapped(words.with_units(shared_label(view, names), scale.units), letters))
    ax.margins(x=0.01)
    most = scale.factor * view.largest(view.series[names[0]].attrs.get("units", "1"))
    calm(ax, np.concatenate([scale(row(view, name, at)) for name in names]), floor=NOTHING * most)
    dots = [dot for j, name in enumerate(names) if (dot := measured(ax, view, name, j, clock, scale, OKABE_ITO[j % len(OKABE_ITO)] if lines is None else INK))]
    if dots and ax.get_xlim()[1] > LATER * clock(time[-1]):
        ax.set_xlim(right=1.03 * clock(time[-1]))  # what was measured long after the run's end answers nothing
    kinds = entries(view, names, lines, above) if len(names) > 1 or dots else []
    cross = [Line2D([], [], color=INK, marker="x", ls="None", ms=7, mew=1.8, label="the run ended here")] if ended else []
    values: list[Any] = []
    if lines is not None:
        texts = words.numbers(lines.values[indices]) if not lines.category else [lines.text(i) for i in indices]
        values = [heading(lines.title), *(Line2D([], [], color=colours[i], label=text) for i, text in zip(indices, texts, strict=True))]
    legend_below(ax, [values, kinds + dots, cross] if len(kinds + dots) < 4 else [values, kinds, dots, cross])


def entries(view: View, names: list[str], lines: Axis | None, above: set[str]) -> list[Any]:
    """Legend entries of the series: colours, or dashes where colours tell the swept value."""
    own = [ABOVE if name in above else DASHES[0] for name in names]
    looks = [(OKABE_ITO[j % len(OKABE_ITO)], own[j]) if lines is None else (INK, DASHES[j % len(DASHES)]) for j in range(len(names))]
    return [Line2D([], [], color=colour, ls=dash, label=label) for label, (colour, dash) in zip(labels(view, names), looks, strict=True)]


def coincident(view: View, names: list[str], at: dict[str, int]) -> set[str]:
    """Series that lie on one before them: heat taken in and heat content, say."""
    rows = [row(view, name, at) for name in names]
    width = THIN * np.ptp([value for values in rows for value in values[np.isfinite(values)]] or [0.0])
    return {names[j] for j in range(len(rows)) if any(np.nanmax(np.abs(rows[j] - other), initial=0.0) <= width for other in rows[:j])}


def labels(view: View, names: list[str]) -> list[str]:
    """Series in one legend, apart by the parts of their names that differ where the first is the same: `heat, hot between` of two pairs of bodies."""
    texts = [called(view, name) for name in names]
    parts = [words.short(view.long_name(name)).split(", ") for name in names]
    alike = [[other for one, other in zip(texts, parts, strict=True) if one == text] for text in texts]
    differ = [[part for k, part in enumerate(own) if len({tuple(other[k : k + 1]) for other in same}) > 1] for own, same in zip(parts, alike, strict=True)]
    return [", ".join([name.split("_", 1)[0], *own]) if own else text for name, text, own in zip(names, texts, differ, strict=True)]


def picked(lines: Axis, at: dict[str, int], there: list[int]) -> list[int]:
    """Values of the axis to draw, of those that are there: a few, in order, the chosen point among them."""
    order = [int(i) for i in np.argsort(lines.ranks()) if i in there]
    places = spread(len(order), MOST_LINES)
    if at[lines.dim] in order and (home := order.index(at[lines.dim])) not in places:
        nearest = min(range(len(places)), key=lambda k: abs(places[k] - home))
        places[nearest] = home
    return [order[place] for place in places]


def known(view: View, name: str, at: dict[str, int]) -> bool:
    """Whether a series has a number at a point."""
    return bool(np.isfinite(row(view, name, at)).any())


def row(view: View, name: str, at: dict[str, int]) -> np.ndarray:
    """A series at a point."""
    return np.asarray(view.series[name].isel({dim: at[dim] for dim in view.dims}).values, dtype=float)


def together(view: View, names: list[str]) -> words.Scale:
    """One scale for all series of a panel."""
    units = view.series[names[0]].attrs.get("units", "1")
    return words.scale(np.concatenate([view.series[name].values.ravel() for name in names]), units, words.is_temperature(names[0]))


def called(view: View, name: str) -> str:
    """A series in the legend: the probe's name where it has one."""
    if name in view.probes:
        return name.removeprefix("temperature_").replace("_", " ")
    text = words.short(view.long_name(name)).removesuffix(" against the exact solution")
    head = text.split(",")[0]
    return head if " " in head else text  # not `kinetic` for `kinetic, elastic and gravitational energy`


def shared_label(view: View, names: list[str]) -> str:
    """What the series of a panel have in common."""
    if len(names) == 1:
        return words.title_case(words.short(view.long_name(names[0])))
    family = names[0].split("_")[0]
    if len(family) > 1:
        return words.title_case(family)
    ends = zip(*(reversed(words.short(view.long_name(name)).split(" ")) for name in names), strict=False)
    common = [each[0] for each in itertools.takewhile(lambda each: len(set(each)) == 1, ends)]  # of the smallest and the largest volume ratio det F
    return words.title_case(" ".join(reversed(common))) or family


def calm(ax: Any, values: np.ndarray, floor: float) -> None:
    """A series that stays as it is, to round-off, is drawn as a level line, not as noise; below `floor` as nothing."""
    finite = values[np.isfinite(values)]
    low, high = ax.get_ylim()
    if max(abs(low), abs(high)) < floor:
        ax.set_ylim(-1e6 * floor, 1e6 * floor)  # beside what others of its unit are
    level(ax, finite, 1e-9)


def stopped(ax: Any, view: View, at: dict[str, int], time: np.ndarray, values: np.ndarray, colour: Any) -> bool:
    """Mark where the series of a point that is not ok ends; whether it did."""
    known = np.flatnonzero(np.isfinite(values))
    if view.ok[tuple(at[dim] for dim in view.dims)] or not len(known):
        return False
    ax.plot(time[known[-1]], values[known[-1]], "x", color=colour, ms=7, mew=1.8, zorder=5)
    return True


def levels(ax: Any, view: View, name: str) -> None:
    """A thin line at each threshold of a probe, its number at the end where fewer lines pass."""
    for _, celsius in view.thresholds(name):
        (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
        lines = [np.array(line.get_data(), float) for line in ax.lines if line.get_transform() == ax.transData and len(line.get_xdata())]
        drawn = [[np.interp(np.linspace(0, len(side) - 1, 20 * len(side)), np.arange(len(side)), side) for side in line] for line in lines]
        near = np.concatenate([x[(y > celsius) & (y < celsius + 0.08 * (high - low))] for x, y in drawn] or [np.zeros(0)])
        late = np.sum(near < left + 0.12 * (right - left)) > np.sum(near > right - 0.12 * (right - left))
        ax.axhline(celsius, color=QUIET, lw=0.8, ls=(0, (1, 2)), zorder=1)
        at = {"xycoords": ("axes fraction", "data"), "xytext": (-4 if late else 4, 3), "textcoords": "offset points", "ha": "right" if late else "left"}
        text = ax.annotate(f"{words.number(celsius)} °C", (float(late), celsius), color=QUIET, fontsize=8.5, zorder=6, **at)
        text.set_path_effects([withStroke(linewidth=3, foreground="white")])  # lines may pass behind it


def crossings(ax: Any, view: View, name: str, at: dict[str, int], clock: words.Scale, colour: Any) -> None:
    """A ring where a line crosses a threshold, at the time that the run found."""
    for final, celsius in view.thresholds(name):
        when = float(view.root[final].isel({dim: at[dim] for dim in view.dims}).values)
        if np.isfinite(when):
            ax.plot(clock(when), celsius, "o", color=colour, mfc="white", mew=1.5, ms=5.5, zorder=5)


def measured(ax: Any, view: View, name: str, index: int, clock: words.Scale, scale: words.Scale, colour: Any) -> Any:
    """The measured curve of a series as dots, and its legend entry."""
    found = view.measured(name)
    if found is None:
        return None
    times, values, _ = found
    style = {"marker": DOTS[index % len(DOTS)], "ls": "None", "color": colour, "mfc": "white", "mec": colour, "mew": 1.3, "ms": 5.5}
    ax.plot(clock(times), scale(values), **{**style, "mfc": FAINT}, zorder=6)
    return Line2D([], [], **{**style, "mfc": FAINT}, label=f"{called(view, name)}, measured")


def agreement(view: View, names: list[str], at: dict[str, int]) -> str:
    """`rms off the measured curve: centre 2.0 K, crust 4.2 K`; empty without measured curves."""
    index, told = tuple(at[dim] for dim in view.dims), []
    for name in names:
        fit = view.misfit(name)
        if fit is not None and np.isfinite(fit[index]):
            told.append(f"{called(view, name)} {fit[index]:.1f} K")
    return "rms off the measured curve: " + ", ".join(told) if told else ""


def note(ax: Any, text: str) -> None:
    """A line of small print between the panel and its title."""
    title = ax.get_title(loc="left")
    if not title:
        ax.set_title(words.title_case(text), fontsize=8.5, color=QUIET)
        return
    ax.set_title(title, pad=20)
    at = {"xycoords": "axes fraction", "xytext": (0, 6), "textcoords": "offset points"}
    ax.annotate(words.title_case(text), (0.0, 1.0), fontsize=8.5, color=QUIET, **at).set_in_layout(False)  # long words must not narrow the panel
