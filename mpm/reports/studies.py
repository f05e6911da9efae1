"""What a report adds where a fit, a sensitivity analysis, a stability map or a chart lies beside the sweep: its answer in sentences, its figure, its tables.

To add      a kind: a line in STUDIES and a function Dataset -> tables
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from mpm.plots import words
from mpm.text import visible

ROWS = 400  # of a table; a longer one says how many it leaves out


def studies(folder: Path) -> Iterator[dict[str, Any]]:
    """The studies of a folder, the answer first: name, title, sentences, figure, tables."""
    import xarray

    for name, (title, alt, figure, tables) in STUDIES.items():
        path = folder / f"{name}.nc"
        if not path.is_file():
            continue
        with xarray.open_datatree(path, engine="h5netcdf") as tree:
            found = tree.load()
        yield {"name": name, "title": title, "alt": alt, "sentences": sentences_of(found.attrs), "figure": figure(found), "tables": tables(found.to_dataset())}


def sentences_of(attrs: dict[Any, Any]) -> list[str]:
    """The answer in words, as the command printed it."""
    told = attrs.get("sentences", attrs.get("answer", ""))
    if isinstance(told, str):
        told = json.loads(told) if told.startswith("[") else told.splitlines()
    return [visible(str(line)) for line in np.atleast_1d(told)]


def table(caption: str, columns: list[str], rows: list[list[Any]]) -> dict[str, Any]:
    """A table of plain text."""
    shown = [[visible(str(cell)) if isinstance(cell, str) else amount(cell) for cell in row] for row in rows[:ROWS]]
    left = f"; {len(rows) - ROWS} more rows are in the dataset" if len(rows) > ROWS else ""
    return {"caption": f"{caption}{left}", "columns": [visible(column) for column in columns], "rows": shown}


def amount(value: Any) -> str:
    """A number for people; a dash where there is none."""
    return words.number(float(value), 4) if np.isfinite(value) else "–"


def plain(units: Any) -> str:
    """A unit behind a number; of a share none."""
    return words.units_text(str(units))


def fit_tables(root: Any) -> list[dict[str, Any]]:
    """Parameters, how they go together, and how well each curve is met."""
    names = list(map(str, root.parameter.values))
    best = [
        [name, best, error, low, high, plain(units), str(path)]
        for name, best, error, (low, high), units, path in zip(
            names, root.best.values, root.standard_error.values, root.interval.values, root.parameter_units.values, root.config_path.values, strict=True
        )
    ]
    columns = ["parameter", "best", "standard error", "lower", "upper", "unit", "in the config"]
    together = [[name, *row] for name, row in zip(names, root.correlation.values, strict=True)]
    held = ["predicted" if held else "fitted" for held in root.held_out.values]
    curves = [list(row) for row in zip(map(str, root.curve.values), held, root.misfit.values, map(plain, root.curve_units.values), strict=True)]
    return [
        table("Parameters with 95 % intervals", columns, best),
        table("Correlation of the parameters", ["", *names], together),
        table("How well each curve is met", ["curve", "", "root-mean-square residual", "unit"], curves),
    ]


def sensitivity_tables(root: Any) -> list[dict[str, Any]]:
    """Indices and rank correlations with their intervals; where points failed."""
    names, rows = list(map(str, root.parameter.values)), []
    for k, observable in enumerate(map(str, root.observable.values)):
        for j, name in enumerate(names):
            cells = [interval(root[kind].values[k, j]) for kind in ("spearman", "first", "total")]
            rows.append([observable, name, *cells])
    found = [table("Rank correlations and indices with 95 % intervals", ["observable", "parameter", "rank correlation", "first-order", "total"], rows)]
    if (root.failed.values > 0).any():
        failed = [[name, *(100 * shares), p] for name, shares, p in zip(names, root.failed.values, root.failed_p.values, strict=True)]
        found.append(table("Share that failed in each third of a range", ["parameter", "lower third [%]", "middle [%]", "upper [%]", "p by chance"], failed))
    return found


def interval(values: np.ndarray) -> str:
    """`0.41 (0.2 to 0.6)`."""
    value, low, high = map(float, values)
    return f"{words.number(value)} ({words.number(low)} to {words.number(high)})" if np.isfinite(value) else "–"


def stability_tables(root: Any) -> list[dict[str, Any]]:
    """The boundary of every column, and theory beside it."""
    across = [str(label) for label in root.across_label.values] if "across_label" in root else list(root.across.values)
    lines = list(map(str, root.line_label.values)) if "expected" in root else []
    rows = []
    for panel, name in enumerate(map(str, root.panel.values)):
        for place, at in enumerate(across):
            measured = [root[key].values[panel, place] for key in ("within", "boundary", "beyond")]
            rows.append([name or "the method", at, *measured, str(root.reason.values[panel, place]), *(root.expected.values[:, panel, place] if lines else ())])
    along, x = (str(root[key].attrs.get("long_name", key)) for key in ("boundary", "across"))
    columns = ["method", x, "last within", "boundary", "first beyond", "how it fails", *lines]
    return [table(f"Boundary: {along}", columns, rows)]


def chart_tables(root: Any) -> list[dict[str, Any]]:
    """Every setting: error and time, the quickest of the front first."""
    order = np.lexsort((root.cpu_min.values, 1 - root.front.values))
    rows = [
        [str(root.label.values[i]), 100 * root.relative_error.values[i], 1e3 * root.cpu_min.values[i], 1e3 * root.cpu_median.values[i],
         "yes" if root.front.values[i] else "", str(root.error.values[i])] for i in order
    ]  # fmt: skip
    about = str(root.relative_error.attrs.get("long_name", "error"))
    return [table(f"Settings: {about}", ["setting", "error [%]", "least time [ms]", "median time [ms]", "on the front", "failed by"], rows)]


def fit_figure(tree: Any) -> Any:
    """Measured and fitted curves."""
    from mpm.plots.fit import draw

    return draw(tree)


def sensitivity_figure(tree: Any) -> Any:
    """The indices of every parameter."""
    from mpm.plots.sensitivity import draw

    return draw(tree.to_dataset())


def stability_figure(tree: Any) -> Any:
    """The map."""
    from mpm.plots.stability import draw

    return draw(tree)


def chart_figure(tree: Any) -> Any:
    """Error of every setting over the time that it takes."""
    from mpm.plots.chart import speed_accuracy

    return speed_accuracy(tree.to_dataset())


STUDIES = {
    "fit": ("The fit", "Fit: measured curves with the model, residuals, and the profile of each parameter.", fit_figure, fit_tables),
    "sensitivity": ("Sensitivity", "Sensitivity: which parameter moves which result, with intervals.", sensitivity_figure, sensitivity_tables),
    "stability": ("The map", "Stability map: where each method fails, beside theory.", stability_figure, stability_tables),
    "chart": ("The chart", "Chart: error against time of every setting, and the front of the best.", chart_figure, chart_tables),
}
