"""Tables of a sweep as CSV or Parquet.

wide    a row a point: coordinates, finals, status, error, warnings
long    a row a number: coordinates, time [s] (empty for finals), variable, units, value
Numbers are SI, as in the dataset. A text that a spreadsheet would take for a formula begins with an apostrophe in CSV.
"""

from pathlib import Path
from typing import Any

import numpy as np

from mpm.exports import needed, replaced
from mpm.opened import Results
from mpm.plots.view import BOOKKEEPING


def write(found: Results, path: Path, long: bool = False) -> list[Path]:
    """The table of all points."""
    table, units = longer(found) if long else wider(found)
    temporary, settle = replaced(path)
    try:
        if path.suffix.lower() == ".csv":
            texts = table.select_dtypes(exclude="number").columns
            table[texts] = table[texts].map(lambda text: f"'{text}" if str(text)[:1] in "=+-@\t\r" and str(text) else text)
            table.rename(columns={name: f"{name} [{unit}]" for name, unit in units.items() if unit not in ("", "1")}).to_csv(temporary, index=False)
        else:
            arrow = needed("pyarrow", "parquet")
            made = arrow.Table.from_pandas(table, preserve_index=False)
            fields = [field.with_metadata({"units": units[field.name]}) if field.name in units else field for field in made.schema]
            needed("pyarrow.parquet", "parquet").write_table(made.cast(arrow.schema(fields, made.schema.metadata)), temporary)
        settle()
    finally:
        temporary.unlink(missing_ok=True)
    return [path]


def wider(found: Results) -> tuple[Any, dict[str, str]]:
    """A row a point, and units by column."""
    from mpm.records.variables import STATUS

    root, dims = found.view.root, list(found.view.dims)
    frame = root.to_dataframe().reset_index() if dims else root.reset_coords().expand_dims("point").to_dataframe().reset_index(drop=True)
    frame["status"] = [STATUS[int(code)] for code in frame["status"]]
    return frame, {str(name): str(row.attrs.get("units", "1")) for name, row in root.variables.items() if row.dtype.kind == "f"}


def longer(found: Results) -> tuple[Any, dict[str, str]]:
    """A row a number, and units of the coordinates and of time."""
    import pandas

    view, rows = found.view, []
    names = [name for name in view.root.coords if set(view.root[name].dims) <= set(view.dims) and view.root[name].dims]
    finals = [str(name) for name, row in view.root.data_vars.items() if row.dims == view.dims and row.dtype.kind in "fiu" and name not in BOOKKEEPING]
    series = [] if view.series is None else [str(name) for name, row in view.series.data_vars.items() if row.dims == (*view.dims, "time")]
    shape = tuple(view.sizes.values())
    for group, chosen in ((view.root, finals), *([(view.series, series)] if series else [])):
        time = np.array([np.nan]) if group is view.root else np.asarray(group["time"].values, float)
        for name in chosen:
            values = np.asarray(group[name].transpose(*view.dims, ...).values, float).reshape(*shape, len(time))
            known = np.isfinite(values)
            at = np.nonzero(known)
            columns = {str(one): along(view, one, shape)[at[:-1]] if shape else np.full(known.sum(), view.root[one].values) for one in names}
            units = str(group[name].attrs.get("units", "1"))
            rows.append(pandas.DataFrame(columns | {"time": time[at[-1]], "variable": name, "units": units, "value": values[known]}))
    return pandas.concat(rows, ignore_index=True), {str(name): str(view.root[name].attrs.get("units", "1")) for name in names} | {"time": "s"}


def along(view: Any, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """A coordinate at every point."""
    row = view.root[name]
    return np.broadcast_to(row.values.reshape([view.sizes[dim] if dim in row.dims else 1 for dim in view.dims]), shape)
