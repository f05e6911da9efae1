"""What a report says: words and tables of plain text and numbers, which the template escapes."""

import json
from typing import Any

import numpy as np

from mpm.opened import Results
from mpm.plots import words
from mpm.plots.view import View
from mpm.records.variables import STATUS
from mpm.text import visible

MOST_FINALS = 12  # finals that have a column
OPEN = 30  # rows of a table that is shown at once; longer ones are folded
MOMENTS = 6  # times of a series in its table


def content(found: Results, beside: list[str]) -> dict[str, Any]:
    """Everything but the figures and the studies, whose names are `beside`."""
    view, attrs = found.view, found.view.root.attrs
    table = points(view)
    return {
        "title": view.title,
        "name": visible(str(attrs.get("name", ""))),
        "single": view.status.size == 1,
        "counts": [{"status": STATUS[code], "count": int(count)} for code, count in zip(*np.unique(view.status, return_counts=True), strict=True)],
        "varied": [varied(axis, view) for axis in (view.parameters if view.design is not None else view.axes)],
        "config": visible(str(attrs.get("config", "")), keep="\n\t"),
        "table": table,
        "folded": len(table["rows"]) > OPEN,
        "series": moments(view),
        "failures": failures(view),
        "warnings": warnings(view),
        "costs": costs(view),
        "provenance": provenance(attrs),
        "again": again(view, attrs, beside),
        "data": data(table),
    }


def varied(axis: Any, view: View) -> dict[str, Any]:
    """A row of what varied: name, meaning, path, values."""
    coordinate = view.root.coords[axis.name].attrs
    values = list(dict.fromkeys(axis.text(i) for i in range(axis.size)))
    ends = f"{words.number(axis.values.min())} to {words.number(axis.values.max())}" if len(values) > 12 else ", ".join(values)
    said = f"{ends} {axis.units}".strip() + (f", {len(values)} values" if len(values) > 12 else "")
    about = visible(words.short(str(coordinate.get("long_name", ""))))
    return {"name": visible(axis.name), "about": about, "path": visible(str(coordinate.get("config_path", ""))), "said": said}


def points(view: View) -> dict[str, Any]:
    """A row a point: swept values, status, finals in the units of the figures."""
    told = [name for name in view.finals if not view.round_off(name)]
    names, columns, cells = (told or view.finals)[:MOST_FINALS], [], []
    shape = view.status.shape
    axes = (view.parameters if view.design is not None else view.axes) if view.dims else []
    for axis in axes:
        where = [view.sizes[dim] if dim == axis.dim else 1 for dim in view.dims]
        values = np.broadcast_to(axis.values.reshape(where), shape).ravel()
        columns.append({"name": visible(axis.name), "label": visible(axis.called if axis.category else axis.title), "swept": True})
        cells.append([plain(value) for value in values])
    for name in names:
        scale = view.scale(name)
        values = scale(np.asarray(view.root[name].transpose(*view.dims).values, float)).ravel()
        columns.append({"name": visible(name), "label": visible(view.label(name, scale.units)), "swept": False})
        cells.append([plain(value) for value in values])
    rows = [{"status": STATUS[int(code)], "cells": [column[i] for column in cells]} for i, code in enumerate(view.status.ravel())]
    return {"columns": columns, "rows": rows}


def plain(value: Any) -> Any:
    """A number with six digits; None where there is none; text as it is."""
    if isinstance(value, str):
        return visible(value)
    return float(f"{value:.6g}") if np.isfinite(value) else None


def shown(value: Any) -> str:
    """A cell for people."""
    return "–" if value is None else value if isinstance(value, str) else words.number(value, 4)


def moments(view: View) -> dict[str, Any]:
    """Series of the chosen point at a few times."""
    names = view.series_names()[:8]
    if not names:
        return {"columns": [], "rows": []}
    time = np.asarray(view.series["time"].values, float)
    clock, chosen = words.scale(time, "s"), np.unique(np.linspace(0, len(time) - 1, MOMENTS).round().astype(int))
    columns, values = [words.with_units("Time", clock.units)], [clock(time[chosen])]
    for name in names:
        scale = view.scale(name, view.series)
        columns.append(visible(words.with_units(words.title_case(words.short(view.long_name(name))), scale.units)))
        values.append(scale(np.asarray(view.series[name].isel(view.chosen).values, float)[chosen]))
    return {"columns": columns, "rows": [[shown(plain(value)) for value in row] for row in zip(*values, strict=True)]}


def failures(view: View) -> list[dict[str, Any]]:
    """Reasons, how many points have each, the full words of one, and what would help."""
    told, reasons = [], view.reasons
    errors, advice = (np.broadcast_to(view.root[name].values if name in view.root else np.array(""), view.status.shape) for name in ("error", "advice"))
    for reason, count in view.counted_reasons().items():
        at = tuple(np.argwhere(reasons == reason)[0])
        told.append({"reason": reason, "count": count, "example": visible(str(errors[at])), "advice": visible(str(advice[at]))})
    return told


def warnings(view: View) -> list[dict[str, Any]]:
    """Different warnings, and how many points have each kind; the words of the first."""
    texts = np.ravel(view.root["warnings"].values) if "warnings" in view.root else np.zeros(0, str)
    found: dict[str, dict[str, Any]] = {}
    for text in texts:
        for line in filter(None, str(text).split("\n")):
            kind = visible(line.partition(":")[0])
            found.setdefault(kind, {"kind": kind, "count": 0, "example": visible(line)})["count"] += 1
    return list(found.values())


def costs(view: View) -> list[tuple[str, str]]:
    """Time and steps."""
    time, steps = (np.asarray(view.root[name].values, float) for name in ("wall_time", "steps"))
    if not np.isfinite(time).any():
        return []
    clock = words.scale(float(np.nansum(time)), "s")
    return [
        ("points that ran to their end", str(int(np.isfinite(time).sum()))),
        ("time of all points, one after another", f"{words.number(float(clock(np.nansum(time))))} {clock.units}"),
        ("time of a point, median and longest", f"{words.number(float(np.nanmedian(time)))} s, {words.number(float(np.nanmax(time)))} s"),
        ("steps of a point, fewest and most", f"{np.nanmin(steps):.0f}, {np.nanmax(steps):.0f}"),
    ]


def provenance(attrs: dict[str, Any]) -> list[tuple[str, str]]:
    """Where the numbers come from."""
    told = [(name.replace("_", " "), attrs.get(name)) for name in ("started", "finished", "source_hash", "git_revision", "threads")]
    for name in ("versions", "machine"):
        try:
            told += [(f"{key}", value) for key, value in json.loads(attrs.get(name) or "{}").items()]
        except (ValueError, AttributeError):
            continue
    return [(visible(str(name)), visible(str(value))) for name, value in told if value not in (None, "")]


def again(view: View, attrs: dict[str, Any], beside: list[str]) -> str:
    """The command that makes the numbers again from the config above; `beside`: the studies of the folder."""
    command = next((name for name in ("fit", "stability", "chart") if name in beside), "sweep" if view.dims else "run")
    told = f"mpm {command} {visible(str(attrs.get('name', 'experiment')))}.yaml"
    return f"{told} -o OUT && mpm sensitivity OUT" if "sensitivity" in beside else told


def data(table: dict[str, Any]) -> dict[str, Any]:
    """What the script draws: the table of points, column by column."""
    rows = table["rows"]
    return {
        "columns": [{**column, "values": [row["cells"][k] for row in rows]} for k, column in enumerate(table["columns"])],
        "status": [row["status"] for row in rows],
    }
