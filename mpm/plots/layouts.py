"""Whole figures from panels: the overview of a dataset, its finals, its series."""

import math
from typing import Any

import numpy as np

from mpm.plots import UnknownFigure, finals, series, words
from mpm.plots.sample import FEWEST, chief, scatter
from mpm.plots.style import INK, QUIET, figure, styled
from mpm.plots.view import Axis, View, spread

THIRD = 36  # letters of a legend under a panel of three in a row


def overview(view: View) -> Any:
    """The figure that answers the question of the dataset, by what is in it."""
    from mpm.plots import refined

    with styled():
        if not view.ok.any():
            return nothing(view)
        if view.sampled and chief(view):
            return noted(refined.plane(view) if refined.asked(view) else scatter(view), view)
        return noted(swept(view) if view.axes and view.finals else families(view, along(view)), view)


def noted(fig: Any, view: View) -> Any:
    """The figure with words under it: thresholds that nothing reached, warnings of a single point."""
    told = [f"{words.title_case(words.short(view.long_name(name)))}: not reached{' by any point' if view.status.size > 1 else ''}" for name in view.unreached]
    if view.status.size == 1 and view.warned.any():
        told.append(view.warnings_told())
    if view.sampled and view.ok.sum() < FEWEST:
        told.append(f"{words.counted(int(view.ok.sum()), 'point')} ok: too few for rank correlations")
    if told:
        fig.supxlabel("\n".join(told), x=0.012, ha="left", color=QUIET, fontsize=9)
    return fig


def nothing(view: View) -> Any:
    """No point is ok: say so, and why."""
    reasons, points = view.counted_reasons(), view.status.size
    head = f"None of {words.counted(points, 'point')} is ok." if points > 1 else "The point is not ok."
    if set(reasons) <= {"pending"}:
        head = "No point has run yet."
    rows = [f"{count} ×  {text}" for text, count in list(reasons.items())[:8]]
    if len(reasons) > 8:
        rows.append(f"and {len(reasons) - 8} other reasons")
    return stated(view, head, rows)


def numbers(view: View) -> Any:
    """Results of points over which nothing can be drawn."""
    rows, at = [], tuple(view.chosen.values())
    for name in view.finals[:8]:
        scale = view.scale(name)
        rows.append(f"{view.label(name, '')}: {words.number(float(scale(view.root[name].values[at])))} {scale.units}".rstrip())
    return stated(view, f"{view.ok.sum()} of {words.counted(view.ok.size, 'point')} ok.", rows or ["No result or series has a number."])


def stated(view: View, head: str, rows: list[str]) -> Any:
    """Words in place of a figure."""
    fig = figure(view.title, 1.8 + 0.24 * len(rows))
    ax = fig.add_subplot()
    ax.set_axis_off()
    ax.text(0.0, 0.95, head, fontsize=13, color=INK, transform=ax.transAxes, va="top")
    under: dict[str, Any] = {"xycoords": "axes fraction", "xytext": (0, -30), "textcoords": "offset points"}
    ax.annotate("\n".join(rows), (0.0, 0.95), fontsize=10.5, color=QUIET, va="top", linespacing=1.6, **under)
    return fig


def along(view: View) -> Axis | None:
    """The axis that colours tell in figures of series; None of a single point."""
    x, lines, _ = arrange(view) if view.axes or view.sampled else (None, None, [])
    return lines or x


def arrange(view: View, name: str = "") -> tuple[Axis, Axis | None, list[Axis]]:
    """Which axis runs along the figure, which is told by colour, and the rest: numbers first, the longest along; for errors the cell or the step.
    Of a sample the parameter that is asked for, or its first: all the others differ."""
    if view.sampled:
        return next((axis for axis in view.parameters if axis.name == view.along), view.parameters[0]), None, []
    fine = ("cell", "step") if name.startswith("error_") else ()
    order = sorted(view.axes, key=lambda axis: (axis.name != view.along, axis.category, axis.name not in fine, -axis.size))
    return order[0], order[1] if len(order) > 1 else None, order[2:]


def swept(view: View) -> Any:
    """A final over one axis with a line a value of another (a panel a value of a third), beside the series of a few points."""
    at, name = dict(view.chosen), view.finals[0]
    x, lines, rest = arrange(view, name)
    facets = spread(rest[0].size, 3) if rest else [None]
    names = series_of(view)
    count = len(facets) + bool(names)
    columns = count if count < 4 else 2
    rows = math.ceil(count / columns)
    fig = figure(view.title, 5.0 * rows if rows > 1 else 5.2)
    grid = fig.subplots(rows, columns, squeeze=False).ravel()
    for ax in grid[count:]:
        ax.set_axis_off()
    for ax, facet in zip(grid, facets, strict=False):
        here = at if facet is None else {**at, rest[0].dim: facet}
        if name.endswith("_l2") and lines is None:
            finals.errors(ax, view, x, here, name)
        else:
            finals.panel(ax, view, name, x, lines, here, key=facet in (None, facets[0]))
        fixed = [axis.says(here[axis.dim]) for axis in rest]
        ax.set_title(", ".join(fixed))
    if len(facets) > 1:
        share(grid[: len(facets)])
    if names:
        ax, colour = grid[len(facets)], lines or x
        series.panel(ax, view, names, colour, at)
        ax.set_title(", ".join(axis.says(at[axis.dim]) for axis in view.axes if axis is not colour))
        if told := series.agreement(view, names, at):
            series.note(ax, f"{colour.says(at[colour.dim])}, {told}")
    return fig


def series_of(view: View) -> list[str]:
    """The series that the overview shows: what it is asked for, else probes' temperatures, else errors, else the first family."""
    there = view.series_names()
    if asked := [name for name in view.asked if view.series is not None and name in view.series and "time" in view.series[name].dims]:
        return [name for name in asked if view.kin(name) == view.kin(asked[0])][:4]
    errors = [name for name in there if name.startswith("error_")]
    errors = [name for name in errors if view.kin(name) == view.kin(errors[0])][:4]
    probes = [name for name in view.probes if name in there]
    return probes[:4] or errors or (view.families()[0][:4] if there else [])


def share(axes: Any) -> None:
    """One vertical range for panels of the same quantity."""
    limits = np.array([ax.get_ylim() for ax in axes])
    for ax in axes:
        ax.set_ylim(limits[:, 0].min(), limits[:, 1].max())


def all_series(view: View) -> Any:
    """Every family of series: of one point, or of a few along the axis that colours tell. UnknownFigure where there are none."""
    if view.ok.any() and not view.series_names():
        raise UnknownFigure("the dataset holds no series with a number")
    with styled():
        return families(view, along(view)) if view.series_names() else nothing(view)


def families(view: View, lines: Axis | None) -> Any:
    """A panel a family of series, six at most."""
    groups = view.families()[:6]
    if not groups:
        return numbers(view)
    long = any(len(label) > THIRD for names in groups if len(names) > 1 for label in series.labels(view, names[:5]))
    columns = 1 if len(groups) == 1 else 2 if len(groups) in (2, 4) or long else 3
    rows = math.ceil(len(groups) / columns)
    fig = figure(view.title, 4.8 if rows == 1 else 3.9 * rows)
    grid = fig.subplots(rows, columns, squeeze=False).ravel()
    at = dict(view.chosen)
    if lines is not None and view.sampled and lines.dim == view.design:
        grid[0].set_title(f"Some points of the sample, by {lines.called}; all parameters differ")
    elif lines is not None:
        grid[0].set_title(", ".join(axis.says(at[axis.dim]) for axis in view.axes if axis is not lines))
    for ax, names in zip(grid, groups, strict=False):
        series.panel(ax, view, names[:5], lines, at)
        if told := series.agreement(view, names, at):
            series.note(ax, f"{lines.says(at[lines.dim])}, {told}" if lines else told)
    for ax in grid[len(groups) :]:
        ax.set_axis_off()
    return fig


def all_finals(view: View) -> Any:
    """Up to six finals over the first axis: those that vary. UnknownFigure where nothing was swept, or nothing has a number."""
    if not view.axes and not view.sampled:
        raise UnknownFigure(
            "finals are drawn over what a sweep varies, and this is one point: `mpm plot OUT series` draws it over time; its numbers are what"
            " `mpm run` prints, and `mpm export OUT --to numbers.csv` writes"
        )
    if view.ok.any() and not view.finals:
        raise UnknownFigure("the dataset holds no finals with a number")
    with styled():
        if not view.ok.any():
            return nothing(view)
        if view.sampled and view.along is None:
            return scatter(view, most=1 if view.wanted else 6)
        x, lines, _ = arrange(view)
        told = [name for name in view.finals if not (view.constant(name) or view.round_off(name))] or view.finals
        names = [view.wanted] if view.wanted else told[:6]
        columns = min(3, len(names))
        rows = math.ceil(len(names) / columns)
        fig = figure(view.title, 4.6 if rows == 1 else 3.9 * rows)
        grid = fig.subplots(rows, columns, squeeze=False).ravel()
        for ax, name in zip(grid, names, strict=False):
            finals.panel(ax, view, name, x, lines, dict(view.chosen), key=name == names[0])
        if view.sampled:
            grid[0].set_title("All parameters differ")
        for ax in grid[len(names) :]:
            ax.set_axis_off()
        return fig
