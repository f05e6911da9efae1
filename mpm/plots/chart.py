"""The figure of a chart (`chart.nc`): error over time, a line a method and path of refinement.

Black line    the Pareto front: no setting has less error in less time
Bars          from the smallest time of the rounds to their median
Faint         the same with import and compilation, in a fresh process with an empty cache
Hollow        an error above 100 %;   crosses in the strip above: settings that failed, each with its reason below
Grey band     errors smaller than that of the reference itself (Richardson), where there is one
Circles       the cheapest setting within 10 %, 1 % and 0.1 %
"""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpm.plots.style import DASHES, INK, MARKS, OKABE_ITO, QUIET, figure, heading, legend_below, save, styled
from mpm.plots.words import number, wrapped

MARKERS = ("o", "s", "D", "^", "v", "P", "X", "<", ">", "h")
PEER = ("*", "p")
ABOVE, STRIP = 3.0, 0.055  # errors above this go into the strip; height of the strip in the panel's
TOLERANCES = (0.1, 0.01, 0.001)


def speed_accuracy(data: Any, path: Path | str | None = None) -> Any:
    """The figure of an xarray.Dataset as `mpm chart` writes it; to a file where a path is given."""
    with styled():
        fig = figure(f"{data.attrs.get('title', '')}: error against time", 7.2)
        ax = fig.subplots()
        draw(ax, data)
        if path is not None:
            save(fig, path)
    return fig


def draw(ax: Any, data: Any) -> None:
    """Everything of one panel."""
    error, least, median = (data[key].values.astype(float) for key in ("relative_error", "cpu_min", "cpu_median"))
    method, along = data["method"].values.astype(str), data["path"].values.astype(str)
    methods, paths = list(dict.fromkeys(method)), list(dict.fromkeys(along))
    ax.set_xscale("log")
    ax.set_yscale("log")
    looks = {name: (OKABE_ITO[k % len(OKABE_ITO)], MARKERS[k % len(MARKERS)]) for k, name in enumerate(methods)}
    compiling, shown = data["compiling"].values.astype(float), False
    for name in methods:
        colour, marker = looks[name]
        for k, one in enumerate(paths):
            rows = np.flatnonzero((method == name) & (along == one) & np.isfinite(error) & np.isfinite(least) & (error > 0) & (error <= ABOVE))
            if not len(rows):
                continue
            rows = rows[np.argsort(data["place"].values[rows])]
            ax.plot(least[rows], error[rows], color=colour, ls=DASHES[k % len(DASHES)], lw=1.4, zorder=3)
            ax.errorbar(least[rows], error[rows], xerr=[0 * rows, median[rows] - least[rows]], fmt="none", ecolor=colour, elinewidth=1, zorder=3)
            for i in rows:
                ax.plot(least[i], error[i], marker, ms=6, mfc="white" if error[i] > 1 else colour, mec=colour if error[i] > 1 else "white", mew=0.7, zorder=4)
            if np.isfinite(compiling[rows]).all():
                ax.plot(least[rows] + compiling[rows], error[rows], color=colour, ls=DASHES[k % len(DASHES)], lw=1, alpha=0.22, zorder=1)
                shown = True
    handles = [Line2D([], [], color=looks[name][0], marker=looks[name][1], ls="None", ms=6, label=name) for name in methods]
    more = [Line2D([], [], color=QUIET, ls=DASHES[k % len(DASHES)], lw=1.4, label=name) for k, name in enumerate(paths) if name]
    more = [heading("refined along"), *more] if len(more) > 1 else []
    rivals = rival(ax, data)
    circled = front(ax, data, error, least)
    signs = [Line2D([], [], color=INK, lw=3.2, alpha=0.85, label="Pareto front")]
    if circled:
        said = "cheapest within " + ", ".join(f"{100 * tolerance:g}" for tolerance in circled) + " %"
        signs.append(Line2D([], [], marker="o", ls="None", ms=11, mfc="none", mec=INK, mew=1.3, label=said))
    if shown:
        signs.append(Line2D([], [], color=QUIET, lw=1, alpha=0.45, label="with import and compilation"))
    finish(ax, data, error, least)
    legend_below(ax, [row for row in ([heading("method"), *handles], rivals, more + signs, *([one] for one in failures(ax, data, looks))) if row])


def front(ax: Any, data: Any, error: np.ndarray, least: np.ndarray) -> list[float]:
    """The front as a thick line, and circles at the cheapest settings; the tolerances that have one."""
    rows = np.flatnonzero(data["front"].values.astype(bool) & (error > 0))
    rows = rows[np.argsort(least[rows])]
    ax.plot(least[rows], error[rows], color=INK, lw=3.2, alpha=0.85, zorder=2, solid_joinstyle="round")
    own = float(data["relative_error"].attrs.get("reference_error", 0.0))
    told = [tolerance for tolerance in TOLERANCES if own <= tolerance]  # below the reference's own error nothing is cheapest
    for tolerance in told:
        fit = rows[error[rows] <= tolerance]
        if len(fit):
            ax.plot(least[fit[0]], error[fit[0]], "o", ms=13, mfc="none", mec=INK, mew=1.3, zorder=5)
    return [tolerance for tolerance in told if (error[rows] <= tolerance).any()]


def rival(ax: Any, data: Any) -> list[Any]:
    """Other programs, if any were measured."""
    if "peer" not in data:
        return []
    peer, handles = data["peer"].values.astype(str), []
    for k, name in enumerate(dict.fromkeys(peer)):
        rows = np.flatnonzero(peer == name)
        rows = rows[np.argsort(data["peer_min"].values[rows])]
        look: dict[str, Any] = {"color": QUIET, "marker": PEER[k % len(PEER)], "ms": 9, "lw": 1.2, "ls": DASHES[k % len(DASHES)], "mec": "white", "mew": 0.5}
        ax.plot(data["peer_min"].values[rows], data["peer_error"].values[rows], zorder=3, **look)
        handles.append(Line2D([], [], label=name, **look))
    return [heading("beside it"), *handles]


def finish(ax: Any, data: Any, error: np.ndarray, least: np.ndarray) -> None:
    """Limits, labels, tolerances, slope guides, and the reference's own error."""
    seen = np.isfinite(error) & (error > 0) & (error <= ABOVE) & np.isfinite(least)
    heights = [*error[seen], *(data["peer_error"].values if "peer" in data else ())]
    if not heights:
        ax.text(0.5, 0.5, "no setting has an error and a time", transform=ax.transAxes, ha="center", color=QUIET)
        return
    low, high = min(heights) / 2.5, min(max(heights), ABOVE) * 2
    ax.set_ylim(low, high * (high / low) ** (STRIP * 1.4))
    for tolerance in TOLERANCES:
        if low < tolerance < high:
            ax.axhline(tolerance, color=QUIET, lw=0.8, ls=(0, (1, 2)), zorder=1)
    own = float(data["relative_error"].attrs.get("reference_error", 0.0))
    if own > low:
        ax.axhspan(low, own, color="#eeeeee", zorder=0.5)
        ax.text(0.01, own, " error of the reference itself", transform=ax.get_yaxis_transform(), va="top", color=QUIET, fontsize=8)
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{number(100 * value)} %"))
    ax.xaxis.set_major_formatter(FuncFormatter(seconds))
    for axis in (ax.xaxis, ax.yaxis):
        least_shown, most_shown = sorted(axis.get_view_interval())
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if most_shown < 300 * least_shown else (1.0,), numticks=12))
        axis.set_minor_formatter(NullFormatter())
    load, rounds = data["load"].values, data.sizes["round"]
    said = f"least of {rounds} rounds (bars: to the median; load of the machine {load.min():.1f} to {load.max():.1f})"
    ax.set_xlabel(f"processor time of {data.attrs.get('time_of', 'a run')}, {said}")
    ax.set_ylabel(wrapped(str(data["relative_error"].attrs.get("long_name", "error")), 66))
    guides(ax)


def seconds(value: float, _: Any) -> str:
    """A tick of time."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= 0.999 * size:
            return f"{value / size:g} {unit}"
    return f"{value / 1e-9:g} ns"


def guides(ax: Any) -> None:
    """Slopes -1 and -2 in the emptiest corner; none where the times lie so close together that every slope is a wall."""
    (left, right), (low, high) = np.log10(ax.get_xlim()), np.log10(ax.get_ylim())
    width = max(0.05 * (right - left), 0.03 * (high - low))  # so that the two numbers stand apart
    if width > 0.2 * (right - left):
        return
    margin, room = 0.02 * (right - left), width + 0.03 * (right - left)  # with the numbers beside
    starts = [left + margin, right - margin - room]
    tops = [high - (STRIP + 0.03) * (high - low), low + 0.04 * (high - low) + 2 * width]
    x, y = drawn(ax)
    corners = [(start, top) for top in tops for start in starts]
    x, top = min(corners, key=lambda at: np.sum((x > at[0] - margin) & (x < at[0] + room) & (y < at[1] + margin) & (y > at[1] - 2.3 * width)))
    for slope in (1, 2):
        ax.plot(10 ** np.array([x, x + width]), 10 ** np.array([top, top - slope * width]), color=QUIET, lw=1, zorder=1)
        ax.text(10 ** (x + width), 10 ** (top - slope * width), f" -{slope}", color=QUIET, fontsize=8, va="center")
    ax.set_xlim(10**left, 10**right)
    ax.set_ylim(10**low, 10**high)


def drawn(ax: Any) -> np.ndarray:
    """Places (2, N) along all lines of a panel, in decades."""
    found = [np.zeros((2, 0))]
    for line in ax.lines:
        x, y = (np.asarray(values, float) for values in line.get_data())
        good = np.isfinite(x) & np.isfinite(y) & (x > 0) & (y > 0)
        x, y = np.log10(x[good]), np.log10(y[good])
        if line.get_transform() == ax.transData and len(x):
            dense = np.linspace(0, len(x) - 1, 20 * len(x))
            found.append(np.array([np.interp(dense, np.arange(len(x)), values) for values in (x, y)]))
    return np.concatenate(found, axis=1)


def failures(ax: Any, data: Any, looks: dict) -> list[Any]:
    """Marks in the strip for settings without a number, side by side; and their reasons."""
    error, method = data["relative_error"].values.astype(float), data["method"].values.astype(str)
    reasons = {int(i): str(data["error"].values[i]) for i in np.flatnonzero(~np.isfinite(error))}
    reasons |= {int(i): f"error above {100 * ABOVE:g} %" for i in np.flatnonzero(error > ABOVE)}
    if not reasons:
        return []
    kinds = Counter(short(reason) for reason in reasons.values())
    marks = dict(zip(kinds, np.resize(MARKS, len(kinds)), strict=True))

    for place, (i, reason) in enumerate(sorted(reasons.items())):
        at = 0.12 + 0.86 * (place + 0.5) / max(len(reasons), 24)
        ax.plot(at, 1 - STRIP / 2, str(marks[short(reason)]), color=looks[method[i]][0], ms=7, mew=1.8, transform=ax.transAxes, zorder=5, clip_on=False)
    ax.text(0.01, 1 - STRIP / 2, "failed", transform=ax.transAxes, va="center", color=QUIET, fontsize=9)
    ax.plot([0, 1], [1 - STRIP] * 2, color="#d9d9d9", lw=0.8, transform=ax.transAxes)
    return [Line2D([], [], color=INK, marker=str(marks[kind]), ls="None", ms=7, mew=1.8, label=f"{kind} ({count})") for kind, count in kinds.items()]


def short(reason: str) -> str:
    """A reason without its particle, time and step."""
    return reason.split(" at particle", maxsplit=1)[0].split(", t = ", maxsplit=1)[0].split(" (", maxsplit=1)[0][:110] or "no number"
