"""Panels of one number a point: a final observable over a swept axis, a line for each value of another; what failed is marked and says why."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.transforms import blended_transform_factory

from mpm.plots import words
from mpm.plots.style import DASHES, INK, MARKS, OKABE_ITO, QUIET, heading, legend_below, level, plain_ticks
from mpm.plots.view import LOG_RATIO, Axis, View, tally

ROW = 0.045  # height of a row of marks, in the panel's height
MOST_IN_LEGEND = 8


def table(view: View, name: str, x: Axis, lines: Axis | None, at: dict[str, int]) -> np.ndarray:
    """A final as rows (lines) and columns (x), the other dimensions at `at`."""
    return slab(view, np.asarray(view.root[name].transpose(*view.dims).values, dtype=float), x, lines, at)


def slab(view: View, array: np.ndarray, x: Axis, lines: Axis | None, at: dict[str, int]) -> np.ndarray:
    """Rows and columns of any array over the swept dimensions."""
    kept = [dim for dim in view.dims if dim == x.dim or (lines is not None and dim == lines.dim)]
    cut = array[tuple(slice(None) if dim in kept else at[dim] for dim in view.dims)]
    if lines is None:
        return cut[None, :]
    return cut if kept.index(lines.dim) < kept.index(x.dim) else cut.T


def panel(ax: Any, view: View, name: str, x: Axis, lines: Axis | None, at: dict[str, int], key: bool = True) -> None:
    """A final over axis `x`; `key` says which colour is which value, and what marks mean."""
    values, colours = table(view, name, x, lines, at), [OKABE_ITO[0]] if lines is None else lines.colours()
    scale = view.scale(name)
    shown, order = scale(values), np.argsort(x.positions, kind="stable")
    for row, colour in zip(shown, colours, strict=True):
        ax.plot(x.positions[order], row[order], "o" if x.category or x.dim == view.design else "-o", color=colour, clip_on=False, zorder=3)
    doubts = hollow(ax, view, x, lines, at, shown, colours)
    x.apply(ax)
    place = ax.get_subplotspec()
    letters = 28 if place is not None and place.get_gridspec().nrows > 1 else 40
    ax.set_ylabel(words.wrapped(view.label(name, scale.units), letters))
    wide(ax, shown, name)
    level(ax, shown[np.isfinite(shown)], 1e-6)
    values_key = [] if lines is None or not key else keys(ax, lines, colours)
    reasons_key = marks(ax, view, name, x, lines, at, values, colours)
    if not np.isfinite(values).any():
        ax.text(0.5, 0.5, "no number here", transform=ax.transAxes, ha="center", color=QUIET)
    told = [*doubts, *reasons_key] if key else [one for one in reasons_key if one.get_marker() == "^"]
    legend_below(ax, [*values_key, *([one] for one in told)])


def hollow(ax: Any, view: View, x: Axis, lines: Axis | None, at: dict[str, int], shown: np.ndarray, colours: list[Any]) -> list[Any]:
    """Points with warnings as rings, and the entry of the legend that says which warnings."""
    warned = slab(view, view.warned, x, lines, at) & np.isfinite(shown)
    if not warned.any():
        return []
    for row, here, colour in zip(shown, warned, colours, strict=True):
        ax.plot(x.positions[here], row[here], "o", color=colour, mfc="white", mew=1.4, clip_on=False, zorder=3.5)
    return [Line2D([], [], color=INK, marker="o", mfc="white", mew=1.4, ls="None", label=view.warnings_told())]


def keys(ax: Any, lines: Axis, colours: list[Any]) -> list[list[Any]]:
    """Rows of legend entries of the lines; a colour bar instead where they are many numbers."""
    rank = np.argsort(lines.ranks())
    if lines.size <= MOST_IN_LEGEND or lines.category:
        entries = [heading(lines.title), *(Line2D([], [], color=colours[i], marker="o", label=lines.text(i)) for i in rank)]
        return [entries]
    steps = BoundaryNorm(np.arange(lines.size + 1) - 0.5, lines.size)
    bar = ax.figure.colorbar(ScalarMappable(steps, ListedColormap([colours[i] for i in rank])), ax=ax, pad=0.02)
    ticks = [i for i in range(lines.size) if i % max(1, (lines.size - 1) // 6) == 0]
    bar.set_ticks(ticks, labels=[lines.text(rank[i]) for i in ticks])
    bar.set_label(lines.label)
    bar.minorticks_off()
    return []


def wide(ax: Any, values: np.ndarray, name: str) -> None:
    """A logarithmic vertical axis where the values are positive and span a wide range, and for errors; not for degrees, whose zero is a convention."""
    finite = values[np.isfinite(values)]
    if finite.size and not words.is_temperature(name) and (finite > 0).all() and (name.startswith("error_") or finite.max() / finite.min() > LOG_RATIO):
        ax.set_yscale("log")
        plain_ticks(ax.yaxis)


def marks(ax: Any, view: View, name: str, x: Axis, lines: Axis | None, at: dict[str, int], values: np.ndarray, colours: list[Any]) -> list[Any]:
    """Crosses for points without a number, in rows under the data, a row a line; triangles above it for a threshold that was not reached."""
    reasons, ok = slab(view, view.reasons, x, lines, at), slab(view, view.ok, x, lines, at)
    late = ok & ~np.isfinite(values)
    texts = tally(reasons)
    rows_below = [i for i in range(len(values)) if any(reasons[i])]
    rows_above = [i for i in range(len(values)) if late[i].any()]
    height = min(ROW, 0.25 / max(1, len(rows_below), len(rows_above)))
    size = 7 * min(1.0, 0.4 + 0.6 * height / ROW)
    room(ax, height * (len(rows_below) + 0.6) if rows_below else 0.0, height * (len(rows_above) + 0.6) if rows_above else 0.0)
    place, handles = blended_transform_factory(ax.transData, ax.transAxes), []
    for mark, text, count in zip(np.resize(MARKS, len(texts)), texts, texts.values(), strict=True):
        pending = text == "pending"
        for row, i in enumerate(rows_below):
            here = reasons[i] == text
            heights = np.full(here.sum(), height * (row + 0.6))
            ax.plot(x.positions[here], heights, "." if pending else mark, color=colours[i], ms=4 if pending else size, mew=1.8, transform=place, zorder=4)
        label = f"{text} ({words.counted(int(count), 'point')})"
        handles.append(Line2D([], [], color=INK, marker="." if pending else mark, ls="None", ms=4 if pending else 7, mew=1.8, label=label))
    for row, i in enumerate(rows_above):
        heights = np.full(late[i].sum(), 1 - height * (row + 0.6))
        ax.plot(x.positions[late[i]], heights, "^", mfc="white", color=colours[i], mew=1.4, ms=size - 1, transform=place, zorder=4)
    if rows_above:
        text = f"{until(view)} ({words.counted(int(late.sum()), 'point')})" if name.startswith("time_to_") else "no value"
        handles.append(Line2D([], [], color=INK, marker="^", mfc="white", ls="None", mew=1.4, ms=6, label=text))
    for rows, low in ((len(rows_below), 0.0), (len(rows_above), 1 - height * (len(rows_above) + 0.2))):
        if rows:
            ax.add_patch(Rectangle((0.0, low), 1.0, height * (rows + 0.2), transform=ax.transAxes, color="#f1f1f1", lw=0, zorder=0.4))
    return handles


def until(view: View) -> str:
    """Why a threshold has no time."""
    if view.series is None or "time" not in view.series:
        return "not reached"
    end = float(view.series["time"].values[-1])
    clock = words.scale(end, "s")
    return f"not reached within {words.number(float(clock(end)))} {clock.units}"


def room(ax: Any, down: float, up: float) -> None:
    """Stretch the vertical axis so that rows of marks, of these heights in the panel's, do not touch the data."""
    low, high = (transform := ax.yaxis.get_transform()).transform(np.array(ax.get_ylim()))
    span = (high - low) / max(0.3, 1 - down - up)
    ax.set_ylim(transform.inverted().transform(np.array([low - span * down, high + span * up])))


def errors(ax: Any, view: View, x: Axis, at: dict[str, int], name: str) -> None:
    """An error against the exact solution, root mean square `name` and largest, over an axis, logarithmic both where they can be; over a cell or a step,
    the slope that they fall with."""
    largest = f"{name.removesuffix('_l2')}_max"
    names = [name, *([largest] if largest in view.finals else [])]
    scale, order, handles = view.scale(names[0]), np.argsort(x.positions, kind="stable"), []
    for each, colour, dash in zip(names, OKABE_ITO, DASHES, strict=False):
        values = scale(table(view, each, x, None, at))[0]
        ax.plot(x.positions[order], values[order], color=colour, ls=dash, marker="o", clip_on=False, zorder=3)
        said = "root mean square" if each == name else "largest"
        if x.name in ("cell", "step") and (rate := slope(x.values, values)) is not None:
            said += f", order {round(rate, 2) + 0.0:.2f}".replace("-", "−")
        handles.append(Line2D([], [], color=colour, ls=dash, marker="o", ms=4, label=said))
    handles += hollow(ax, view, x, None, at, scale(table(view, names[0], x, None, at)), [OKABE_ITO[0]])
    x.apply(ax)
    ax.set_ylabel(words.wrapped(view.label(name, scale.units).replace("Root-mean-square error", "Error"), 40))
    every = np.concatenate([table(view, each, x, None, at).ravel() for each in names])
    wide(ax, every, names[0])
    reasons = marks(ax, view, names[0], x, None, at, table(view, names[0], x, None, at), [INK])
    legend_below(ax, [handles, *([key] for key in reasons)])


def slope(sizes: np.ndarray, values: np.ndarray) -> float | None:
    """Least-squares slope of log(values) over log(sizes); None with fewer than three points."""
    known = np.isfinite(values) & (values > 0) & (sizes > 0)
    return float(np.polyfit(np.log(sizes[known]), np.log(values[known]), 1)[0]) if known.sum() > 2 else None
