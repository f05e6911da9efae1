"""One snapshot of particles out of the ragged rows of a dataset, as a plain table."""

from typing import Any

import numpy as np


def particles(tree: Any, snapshot: float | None = None, **point: Any) -> Any:
    """An xarray.Dataset of one snapshot: dim `particle`, numbered by `id` where the snapshot has it, tensors with named components.

    tree      what `mpm.run`, `mpm.sweep` or xarray.open_datatree gave
    snapshot  time [s], the nearest is taken, KeyError before the first or past the last; the last unless given
    point     values of swept dimensions, the nearest where they are numbers; KeyError where one is missing or unknown
    """
    group = tree["particles"].to_dataset(inherit=True)
    if "row_size" not in group:
        raise KeyError("the dataset has no particles: output.snapshots.particles says which fields to keep")
    rows, swept = group[["row_size", "row_start"]], [name for name in group.row_size.dims if name != "snapshot"]
    if set(point) != set(swept):
        raise KeyError(f"one value for each of {', '.join(swept) or 'no dimension'}, not for {', '.join(point) or 'none'}")
    for name, value in point.items():
        rows = rows.sel({name: value}, method="nearest" if isinstance(value, int | float) else None)
    first, last = float(rows.snapshot[0]), float(rows.snapshot[-1])
    if snapshot is not None and not first - 1e-9 * last <= snapshot <= last * (1 + 1e-9):
        raise KeyError(f"snapshot is a time, from {first:g} to {last:g} s, not {snapshot:g}")
    rows = rows.isel(snapshot=-1) if snapshot is None else rows.sel(snapshot=snapshot, method="nearest")
    begin, size = int(rows.row_start), int(rows.row_size)
    made = group[[name for name in group.data_vars if "obs" in group[name].dims]].isel(obs=slice(begin, begin + size)).rename(obs="particle")
    named = {dim: variable.attrs["components"].split() for variable in made.values() if "components" in variable.attrs for dim in variable.dims[1:]}
    number = made["id"].values if "id" in made else np.arange(size)
    return made.drop_vars("id", errors="ignore").assign_coords(particle=number, **named).assign_attrs(time=float(rows.snapshot))
