"""Zarr: the whole dataset, group by group, for the cloud; xarray.open_datatree(FILE, engine="zarr") reads it."""

import shutil
from pathlib import Path

from mpm.exports import needed, replaced
from mpm.opened import Results


def write(found: Results, path: Path) -> list[Path]:
    """A Zarr store, a folder; one that is there is replaced."""
    needed("zarr", "zarr")
    temporary, settle = replaced(path)
    try:
        found.tree.map_over_datasets(lambda data: data.drop_encoding()).to_zarr(temporary, mode="w", consolidated=False)
        if path.exists():
            shutil.rmtree(path)
        settle()
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    return [path]
