"""The figure of two refined axes: every point in its place, coloured by the answer that refinement follows, and the line on which it crosses the level."""

import math
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.tri import Triangulation

from mpm.plots import words
from mpm.plots.axis import log_spaced
from mpm.plots.sample import TRIANGLE, look
from mpm.plots.style import INK, MARKS, OKABE_ITO, figure, legend_below, plain_ticks
from mpm.plots.view import View
from mpm.records.variables import dataset_name

SIDES = LinearSegmentedColormap.from_list("sides", [OKABE_ITO[0], "#e8f0f6", "#fbeee2", OKABE_ITO[1]])
FAR = 80  # percentile of the distance from the level at which colours are full


def refined(view: View) -> dict[str, Any]:
    """What the config says of refinement."""
    return (view.config.get("sweep") or {}).get("refine") or {}


def asked(view: View) -> bool:
    """Whether the dataset is that of two refined axes, and some point has the answer."""
    name = dataset_name(refined(view).get("of", ""))
    there = name in view.root and view.design is not None and len(view.parameters) == 2
    return there and bool(np.isfinite(view.root[name].values[view.ok]).any())


def plane(view: View) -> Any:
    """Both parameters, the points, and the line."""
    name, level = dataset_name(refined(view)["of"]), refined(view).get("level")
    x, y = view.parameters
    scale, values = view.scale(name), view.root[name].values.astype(float)
    known = view.ok & np.isfinite(values)
    u, v, shown = x.positions, y.positions, scale(values)
    low, high = float(shown[known].min()), float(shown[known].max())
    at = math.nan if level is None else float(scale(level))
    sides = low < at < high
    log_x, log_y = spread_in_logarithm(u), spread_in_logarithm(v)
    fig = figure(view.title, 6.4)
    ax = fig.add_subplot()
    ax.set_xscale("log" if log_x else "linear")
    ax.set_yscale("log" if log_y else "linear")
    reach = np.percentile(np.abs(shown[known] - at), FAR) if sides else 0.0
    norm, colours = (Normalize(at - reach, at + reach), SIDES) if reach > 0 else (Normalize(low, high), "viridis")
    dots = ax.scatter(u[known], v[known], c=shown[known], cmap=colours, norm=norm, s=26, edgecolors=INK, linewidths=0.5, zorder=3, clip_on=False)
    fig.colorbar(dots, label=words.wrapped(view.label(name, scale.units), 48), extend="both" if reach > 0 else "neither")
    handles = []
    if sides and known.sum() > 3:
        ax.add_collection(LineCollection(crossing(u[known], v[known], shown[known] - at, log_x, log_y), colors=INK, linewidths=1.6))
        handles.append(Line2D([], [], color=INK, lw=1.6, label=f"{words.number(at)} {scale.units}, straight between the points"))
    late = view.ok & ~known
    if late.any():
        ax.plot(u[late], v[late], **TRIANGLE)
        handles.append(Line2D([], [], label=f"not reached ({words.counted(int(late.sum()), 'point')})", **TRIANGLE))
    for mark, (text, count) in zip(MARKS, view.counted_reasons().items(), strict=False):
        here = view.reasons == text
        ax.plot(u[here], v[here], **look(mark, text))
        handles.append(Line2D([], [], label=f"{text} ({words.counted(count, 'point')})", **look(mark, text)))
    ax.set(xlabel=x.label, ylabel=y.label, title=f"{words.counted(len(values), 'point')}, where refinement put them")
    for axis, log in ((ax.xaxis, log_x), (ax.yaxis, log_y)):
        if log:
            plain_ticks(axis)
    if handles:
        legend_below(ax, [handles])
    return fig


def spread_in_logarithm(values: np.ndarray) -> bool:
    """Whether the axis's own values, at which several points lie, are even in the logarithm."""
    own, count = np.unique(values, return_counts=True)
    return log_spaced(own[count > 2])


def crossing(u: np.ndarray, v: np.ndarray, values: np.ndarray, log_u: bool, log_v: bool) -> list[np.ndarray]:
    """Stretches on which values are zero, straight within triangles over the ranges, in the logarithm where an axis is logarithmic."""
    places = np.stack([np.log(w) if log else w for w, log in ((u, log_u), (v, log_v))], axis=1)
    found = []
    for corners in Triangulation(*((places - places.min(axis=0)) / np.ptp(places, axis=0)).T).triangles:
        ends = [(i, j) for i, j in zip(corners, np.roll(corners, 1), strict=True) if (values[i] > 0) != (values[j] > 0)]
        found += [np.array([places[i] + (places[j] - places[i]) * values[i] / (values[i] - values[j]) for i, j in ends])] if ends else []
    return [np.stack([np.exp(part[:, 0]) if log_u else part[:, 0], np.exp(part[:, 1]) if log_v else part[:, 1]], axis=1) for part in found]
