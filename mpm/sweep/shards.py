"""Shards: series of a sweep that are too large for one file (table.SERIES), cut along the first dimension into OUT/series/0000.nc, 0001.nc, ...

Each is a NetCDF-4 file of its own, sealed, with the coordinates of its part; `file` in sweep.nc's /series says which holds what. Made one after another,
so that no more than SHARD bytes of series are in memory at once.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.netcdf import Array, DamagedFile, Group, seal, to_bytes, write_whole
from mpm.records.variables import OK
from mpm.sweep.coordinates import planned
from mpm.sweep.store import Store
from mpm.sweep.table import Table, described, with_axes
from mpm.sweep.time_columns import TimeColumns

SHARD = 2**28  # bytes of series in a shard


def write(store: Store, plan: Any, about: dict, laid: Table, out: Path) -> list[str]:
    """The shards of a table that holds no series, if there are any, in a folder of `out`: for each value along the first dimension the shard's file.

    Older ones are removed.
    """
    folder = out / "series"
    if laid.series_over.keep or not laid.shape:
        remove(folder, 0)
        return []
    time, names = laid.series_over.axis(), list(laid.series_names)
    inner = math.prod(laid.shape[1:])
    rows = max(1, SHARD // max(1, inner * len(time) * 8 * len(names)))
    run_ids = laid.text["run_id"]
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for number, begin in enumerate(range(0, laid.shape[0], rows)):
        end = min(begin + rows, laid.shape[0])
        part = TimeColumns((end - begin) * inner)
        places: dict[str, list[int]] = {}
        for place in range(begin * inner, end * inner):
            if run_ids[place]:
                places.setdefault(run_ids[place], []).append(place - begin * inner)
        for run_id, record in store.load_all(list(places), fields=False):
            for place in [] if isinstance(record, DamagedFile) else places[run_id]:
                part.add(place, record.times, record.series, record.status == OK)
        file = folder / f"{number:04d}.nc"
        attributes = {"Conventions": "CF-1.11", "title": about["title"] or about["name"]}
        write_whole(file, seal(to_bytes({"/": group(laid, part, time, slice(begin, end))}, attributes), {}))
        files += [str(file.relative_to(out))] * (end - begin)
    remove(folder, len(set(files)))
    return files


def group(laid: Table, part: TimeColumns, time: np.ndarray, rows: slice) -> Group:
    """Coordinates and series of some values along the first dimension."""
    found, axes = Group(), {}
    for name, array in planned(laid.plan).items():
        cut = tuple(rows if dim == laid.dims[0] else slice(None) for dim in array.dims)
        axes[name] = Array(array.dims, np.asarray(array.data)[cut], array.attrs)
    found.variables["time"] = described("time", ("time",), time, standard_name="time", axis="T")
    for name, values in part.laid(time)[1].items():
        found.variables[name] = described(name, (*laid.dims, "time"), values.reshape((-1, *laid.shape[1:], len(time))), laid.dimension, bodies=laid.bodies)
    return with_axes(found, axes)


def remove(folder: Any, first: int) -> None:
    """Shards from a number on, of an earlier dataset."""
    for path in folder.glob("[0-9]*.nc"):
        if int(path.stem) >= first:
            path.unlink(missing_ok=True)
