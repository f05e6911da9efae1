"""Figures of a sample: observables against each parameter, and how strongly ranks go together.

Rank correlation (Spearman): the correlation of the ranks of parameter and observable over the points that are ok; it sees monotone effects only.
Intervals: 95 %, percentile bootstrap over points, 2000 resamples with a fixed seed. A bar whose interval holds zero is drawn pale: this sample does not
show an effect. Below FEWEST points there are no bars, as an interval from so few means nothing. Points of a low-discrepancy design are not independent,
which makes the intervals somewhat too wide rather than too narrow.
"""

import math
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.transforms import blended_transform_factory

from mpm.plots import series, words
from mpm.plots.finals import until, wide
from mpm.plots.style import INK, MARKS, OKABE_ITO, QUIET, figure, plain_ticks
from mpm.plots.view import Axis, View

FEWEST = 10
RESAMPLES = 2000
MOST_PARAMETERS = 6
TRIANGLE: dict[str, Any] = {"color": OKABE_ITO[0], "mfc": "white", "ms": 5, "mew": 1.2, "ls": "None", "marker": "^"}  # a threshold that was not reached
RING: dict[str, Any] = {"color": OKABE_ITO[0], "mfc": "white", "ms": 4, "mew": 1.2, "ls": "None"}  # a point with warnings


def scatter(view: View, most: int = 3) -> Any:
    """Small multiples: a row an observable, a column a parameter, rank correlations at the end of the row."""
    parameters = view.parameters[:MOST_PARAMETERS]
    names = chief(view)[:most]
    columns, order = len(parameters), view.dims
    blocks = [spread_over(view, axis) for axis in parameters]
    curves = [name for name in view.series_names() if view.measured(name) is not None][:4]
    below = 3.9 if curves else 0.0
    fig = figure(view.title, 1.1 + 2.35 * len(names) + below)
    upper, lower = fig.subfigures(2, 1, squeeze=False, height_ratios=[1.1 + 2.35 * len(names), below])[:, 0] if curves else (fig, fig)
    enough = int(view.ok.sum() >= FEWEST)
    grid = upper.subplots(len(names), columns + enough, squeeze=False, sharey=False, width_ratios=[1.0] * columns + [1.25] * enough)
    bad = view.reasons.astype(bool)
    for i, name in enumerate(names):
        values = np.asarray(view.root[name].transpose(*order).values, dtype=float)
        scale = view.scale(name)
        for j, (axis, places) in enumerate(zip(parameters, blocks, strict=True)):
            ax = grid[i, j]
            ax.plot(places[~view.warned], scale(values)[~view.warned], "o", color=OKABE_ITO[0], ms=4, mew=0, alpha=0.75)
            if view.warned.any():
                ax.plot(places[view.warned], scale(values)[view.warned], marker="o", **RING)
            crosses(ax, view, places, bad)
            late(ax, places, view.ok & ~np.isfinite(values))
            dress(ax, view, axis, name, scale, values, first=j == 0, last=i == len(names) - 1)
        for j in range(columns if i else 0):
            grid[i, j].sharex(grid[0, j])
        for ax in grid[i, 1:columns]:
            ax.sharey(grid[i, 0])
            ax.tick_params(labelleft=False)
        if enough:
            bars(grid[i, columns], view, parameters, blocks, values, title=i == 0, last=i == len(names) - 1)
    failures(upper, view, [name for name in names if (view.ok & ~np.isfinite(view.root[name].transpose(*order).values)).any()])
    upper.align_ylabels(grid[:, 0])
    if curves:
        against(lower.subplots(), view, curves, parameters[0])
    return fig


def against(ax: Any, view: View, curves: list[str], axis: Axis) -> None:
    """Some points of the sample over time beside what was measured, the nearest to it among them."""
    at = dict(view.chosen)
    series.panel(ax, view, curves, axis if axis.dim == view.design else None, at)
    ax.set_title(f"Some points of the sample, by {axis.called}; all parameters differ")
    if told := series.agreement(view, curves, at):
        series.note(ax, f"{axis.says(at[axis.dim])}, {told}")


def late(ax: Any, places: np.ndarray, here: np.ndarray) -> None:
    """Points that are ok and did not reach a threshold, at the top of the panel."""
    place = blended_transform_factory(ax.transData, ax.transAxes)
    ax.plot(places[here], np.full(here.sum(), 0.96), transform=place, **TRIANGLE)


def chief(view: View) -> list[str]:
    """Finals that vary and are not book-keeping of the method, the config's own first."""
    dull = ("heat_ledger", "mass_total")
    varies = [name for name in view.finals if name not in dull and np.nanstd(view.root[name].values) > 1e-9 * np.nanmax(np.abs(view.root[name].values))]
    varies = varies or [name for name in view.finals if name not in dull]  # of a single point that is ok nothing varies
    listed = [name for name in varies if name.startswith(("time_to_", "error_")) or name in view.listed]
    return listed or varies


def spread_over(view: View, axis: Axis) -> np.ndarray:
    """An axis's positions at every point."""
    shape = [view.sizes[dim] if dim == axis.dim else 1 for dim in view.dims]
    return np.broadcast_to(axis.positions.reshape(shape), view.status.shape)


def dress(ax: Any, view: View, axis: Axis, name: str, scale: words.Scale, values: np.ndarray, first: bool, last: bool) -> None:
    """Scales and labels: units of the observable at the left, of the parameter at the foot."""
    if axis.log:
        ax.set_xscale("log")
        plain_ticks(ax.xaxis)
    else:
        ax.locator_params(axis="x", nbins=3)
    wide(ax, scale(values), name)
    ax.margins(0.08, 0.12)
    if first:
        ax.set_ylabel(words.wrapped(view.label(name, scale.units), 24), fontsize=9)
    if last:
        ax.set_xlabel(words.with_units(axis.called, axis.units))
    else:
        ax.tick_params(labelbottom=False)
    ax.tick_params(labelsize=8.5)


def crosses(ax: Any, view: View, places: np.ndarray, bad: np.ndarray) -> None:
    """Points without numbers, at the foot of the panel."""
    place = blended_transform_factory(ax.transData, ax.transAxes)
    for mark, text in zip(MARKS, view.counted_reasons(), strict=False):
        here = bad & (view.reasons == text)
        ax.plot(places[here], np.full(here.sum(), 0.04), transform=place, **look(mark, text))


def look(mark: str, text: str) -> dict[str, Any]:
    """How a point without numbers is marked: a cross of its kind, or a faint dot where it is still to run."""
    if text == "pending":
        return {"ls": "None", "marker": ".", "color": QUIET, "ms": 4}
    return {"ls": "None", "marker": mark, "color": OKABE_ITO[1], "ms": 5.5, "mew": 1.4}


def failures(fig: Any, view: View, unreached: list[str]) -> None:
    """What crosses, triangles and rings mean, under the panels."""
    rows = list(view.counted_reasons().items())[: len(MARKS)]
    handles = [Line2D([], [], label=f"{text} ({words.counted(count, 'point')})", **look(mark, text)) for mark, (text, count) in zip(MARKS, rows, strict=False)]
    if unreached:
        handles.append(Line2D([], [], label=until(view) if all(name.startswith("time_to_") for name in unreached) else "no value", **TRIANGLE))
    if told := view.warnings_told():
        handles.append(Line2D([], [], marker="o", label=told, **RING))
    if handles:
        fig.legend(handles=handles, loc="outside lower left", ncols=min(3, len(handles)), handlelength=1.0)


def bars(ax: Any, view: View, parameters: list[Axis], blocks: list[np.ndarray], values: np.ndarray, title: bool, last: bool) -> None:
    """Rank correlation of each parameter with the observable, with its interval."""
    ok = np.isfinite(values)
    count = int(ok.sum())
    rows = np.arange(len(parameters))[::-1]
    ax.set_xlim(-1, 1)
    ax.set_ylim(-0.6, len(parameters) - 0.4)
    ax.set_yticks(rows, [axis.called for axis in parameters])
    ax.axvline(0, color=QUIET, lw=0.8)
    ax.grid(axis="y", visible=False)
    ax.tick_params(labelsize=8.5, labelbottom=last)
    ax.set_title(f"Rank correlation, n = {count}" if title else f"n = {count}", fontsize=9.5)
    if last:
        ax.set_xlabel("Spearman, 95 % bootstrap", fontsize=9)
    if count < FEWEST:
        ax.text(0, (len(parameters) - 1) / 2, f"{words.counted(count, 'point')}:\ntoo few", ha="center", va="center", color=QUIET, fontsize=9)
        return
    for row, places in zip(rows, blocks, strict=True):
        middle, low, high = spearman(places[ok], values[ok], groups(view, ok))
        clear = low > 0 or high < 0
        ax.barh(row, middle, height=0.55, color=OKABE_ITO[0] if clear else "#b9c7d1", zorder=2)
        ax.plot([low, high], [row, row], color=INK, lw=1.2, zorder=3, solid_capstyle="butt")


def groups(view: View, ok: np.ndarray) -> np.ndarray:
    """Which point of the sample each value belongs to: they are resampled together."""
    shape = [view.sizes[dim] if dim == view.design else 1 for dim in view.dims]
    return np.broadcast_to(np.arange(math.prod(shape)).reshape(shape), view.status.shape)[ok]


def ranks(values: np.ndarray) -> np.ndarray:
    """Ranks, ties sharing their mean."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(counts) - (counts - 1) / 2.0)[inverse]


def correlation(one: np.ndarray, two: np.ndarray) -> float:
    """Spearman's coefficient; 0 where one side does not vary."""
    a, b = ranks(one), ranks(two)
    a, b = a - a.mean(), b - b.mean()
    size = np.sqrt((a @ a) * (b @ b))
    return float(a @ b / size) if size > 0 else 0.0


def spearman(one: np.ndarray, two: np.ndarray, group: np.ndarray, seed: int = 0) -> tuple[float, float, float]:
    """Coefficient and its 95 % percentile interval, resampling whole groups."""
    random, names = np.random.default_rng(seed), np.unique(group)
    members = [np.flatnonzero(group == name) for name in names]
    drawn = np.empty(RESAMPLES)
    alone = np.concatenate(members) if len(names) == len(group) else None  # each point is a group
    for k in range(RESAMPLES):
        picked = random.integers(0, len(names), len(names))
        rows = alone[picked] if alone is not None else np.concatenate([members[i] for i in picked])
        drawn[k] = correlation(one[rows], two[rows])
    low, high = np.percentile(drawn, [2.5, 97.5])
    return correlation(one, two), float(low), float(high)
