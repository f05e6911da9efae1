"""From the verdicts of a map to its dataset, and to sentences.

OUT/stability.nc   dims panel, place (across), line, entry (every point)
    /         boundary, within, beyond (panel, place); reason (panel, place); expected (line, panel, place)
    /points   panel, across, along, beyond, outcome, growth, run_id (entry)
    attributes: title, config, names of the axes, sentences
"""

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from mpm.config.formula import Formula
from mpm.records.netcdf import Array, Group, to_bytes, write_whole
from mpm.records.provenance import git_revision, machine, versions


def edges(asked: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(within, beyond) of every column, and the reason just beyond; NaN where a column never changes."""
    shape = (len(asked.panels), len(asked.across.values))
    within, beyond, reason = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, "", dtype=object)
    for column in asked.columns:
        at = column.panel, column.place
        within[at], beyond[at] = column.bracket(asked.stability.toward)
        if not math.isnan(beyond[at]):
            reason[at] = column.verdicts[beyond[at]].outcome
    return within, beyond, reason


def numbers(coordinate: Any) -> np.ndarray:
    """Values of an axis as numbers: labels count."""
    return np.asarray(coordinate.values, float) if coordinate.values.dtype != object else np.arange(len(coordinate.values), dtype=float)


def theory(asked: Any) -> np.ndarray:
    """Every line at every column; NaN in panels that it is not for."""
    x, lines = numbers(asked.across), asked.stability.lines
    found = np.full((len(lines), len(asked.panels), len(x)), np.nan)
    for index, line in enumerate(lines):
        for panel, label in enumerate(asked.panels):
            if not line.panels or label in line.panels:
                found[index, panel] = np.broadcast_to(Formula(line.formula)(x), x.shape)
    return found


def sentences(asked: Any) -> list[str]:
    """The answer in words, a panel and a line of theory each."""
    within, beyond, reason = edges(asked)
    middle = np.sqrt(np.abs(within * beyond))
    expected, told = theory(asked), []
    for panel, label in enumerate(asked.panels):
        name = label or "the method"
        measured = middle[panel][np.isfinite(middle[panel])]
        never = int(np.sum(np.isnan(beyond[panel])))
        always = int(np.sum(np.isnan(within[panel]) & ~np.isnan(beyond[panel])))
        said = f"{name}: "
        said += f"boundary at {span(measured)}" if len(measured) else "no boundary"
        said += f"; {never} of {len(beyond[panel])} columns never fail up to {max(asked.along.values):.3g}" if never else ""
        said += f"; {always} fail everywhere" if always else ""
        causes = Counter(text for text in reason[panel] if text)
        said += f"; it fails by {', '.join(f'{cause} ({count})' for cause, count in causes.most_common(3))}" if causes else ""
        told.append(said)
        for index, line in enumerate(asked.stability.lines):
            ratio = middle[panel] / expected[index, panel]
            ratio = ratio[np.isfinite(ratio)]
            if len(ratio):
                told.append(f"  against {line.label}: measured over theory {span(ratio)}" + (", safe" if line.role == "safe" and ratio.min() >= 1 else
                            ", NOT safe" if line.role == "safe" else ""))  # fmt: skip
    return told


def span(values: np.ndarray) -> str:
    """`0.49`, or `0.48 to 1.2 (median 0.5)`."""
    low, high, middle = np.min(values), np.max(values), np.median(values)
    return f"{low:.3g}" if high <= low * 1.005 else f"{low:.3g} to {high:.3g} (median {middle:.3g})"


def write(asked: Any, out: Path) -> Path:
    """OUT/stability.nc."""
    stability = asked.stability
    within, beyond, reason = edges(asked)
    across, along = asked.across, asked.along
    names = stability.names
    entries = [(column, value, verdict) for column in asked.columns for value, verdict in sorted(column.verdicts.items())]
    root = Group({
        "panel": Array(("panel",), np.array(asked.panels, dtype=object)),
        "across": Array(("place",), numbers(across), {"units": across.units or "1", "long_name": names.get("across", across.long_name)}),
        "boundary": Array(("panel", "place"), np.sqrt(np.abs(within * beyond)), {"units": along.units, "long_name": names.get("along", along.long_name)}),
        "within": Array(("panel", "place"), within, {"units": along.units, "long_name": "last value within"}),
        "beyond": Array(("panel", "place"), beyond, {"units": along.units, "long_name": "first value beyond"}),
        "reason": Array(("panel", "place"), reason, {"long_name": "outcome at the first value beyond"}),
    })  # fmt: skip
    if across.values.dtype == object:
        root.variables["across_label"] = Array(("place",), across.values)
    if stability.lines:
        root.variables["expected"] = Array(("line", "panel", "place"), theory(asked), {"units": along.units, "long_name": "boundary of theory"})
        for key in ("label", "source", "role", "formula"):
            root.variables[f"line_{key}"] = Array(("line",), np.array([getattr(line, key) for line in stability.lines], dtype=object))
    points = Group({
        "panel_of": Array(("entry",), np.array([column.panel for column, _, _ in entries], np.int32), {"long_name": "panel of the point"}),
        "at": Array(("entry",), numbers(across)[[column.place for column, _, _ in entries]], {"units": across.units or "1", "long_name": "value across"}),
        "along": Array(("entry",), np.array([value for _, value, _ in entries]), {"units": along.units, "long_name": "value along"}),
        "is_beyond": Array(("entry",), np.array([verdict.beyond for _, _, verdict in entries], np.int8), {"long_name": "1 where the point failed"}),
        "growth": Array(("entry",), np.array([verdict.growth for _, _, verdict in entries]), {"units": "1", "long_name": "growth rate"}),
        "outcome": Array(("entry",), np.array([verdict.outcome for _, _, verdict in entries], dtype=object), {"long_name": "how the run ended"}),
        "run_id": Array(("entry",), np.array([verdict.run_id for _, _, verdict in entries], dtype=object), {"long_name": "hash of the point's config"}),
    })  # fmt: skip
    attrs = {"Conventions": "CF-1.11", "title": asked.experiment.title or asked.experiment.name, "config": asked.experiment.source,
             "config_resolved": asked.experiment.resolved(), "toward": stability.toward, "per": "step" if stability.steps is not None else "second",
             "growth_of": stability.growth.of if stability.growth else "", "sentences": sentences(asked), "versions": versions(),
             "git_revision": git_revision(), "machine": machine()}  # fmt: skip
    path = out / "stability.nc"
    write_whole(path, to_bytes({"/": root, "points": points}, attrs))
    return path
