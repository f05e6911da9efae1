"""Exports: results in the files of other programs, chosen by the file's suffix.

    .vtkhdf          snapshots over time for ParaView: particles with all fields; fields on the grid beside them in <stem>.grid.vtkhdf (vtkhdf.py)
    .usd .usda .usdc snapshots over time for Houdini, Blender and Omniverse: points with primvars (usd.py; pip install 'mpm[usd]')
    .csv .parquet    tables of a sweep: wide, a row a point; long, a row a number, series too (tables.py; Parquet: pip install 'mpm[parquet]')
    .zarr            the whole dataset for the cloud (pip install 'mpm[zarr]')

May use     opened, plots.words                                                        May not  see config, sweep or anything that computes

Further files
    space   fields in three directions, as other programs have them
"""

import importlib
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from mpm.opened import Results, UnknownPoint
from mpm.plots import place

KINDS = {".vtkhdf": "vtkhdf", ".usd": "usd", ".usda": "usd", ".usdc": "usd", ".csv": "tables", ".parquet": "tables", ".zarr": "zarr"}


class ExportError(ValueError):
    """What cannot be exported so, with what would do."""


def export(out: Path | str, points: str | Iterable[str] = (), to: Path | str | None = None, long: bool = False) -> list[Path]:
    """Write results as other programs read them; the paths written. The same as `mpm export`.

    out      folder of a sweep or a run, or a dataset file
    points   `kappa=0.35,beta=13`, one or several; the one that stands for the sweep unless given. Tables and Zarr hold all points.
    to       file; its suffix says the format; OUT/<name>.vtkhdf unless given. Several points are several files, `<stem>-<point><suffix>`.
    long     of tables: a row a number rather than a row a point
    Raises ExportError for a suffix that no format here has, UnknownPoint, FileNotFoundError where there is no dataset.
    """
    with Results(out) as found:
        target = Path(to) if to is not None else found.path.with_suffix(".vtkhdf")
        if target.suffix.lower() not in KINDS:
            raise ExportError(f"{target}: the suffix says the format; there are {', '.join(KINDS)}")
        place(target)
        writer = importlib.import_module(f"mpm.exports.{KINDS[target.suffix.lower()]}")
        words = [points] if isinstance(points, str) else list(points)
        if KINDS[target.suffix.lower()] in ("tables", "zarr"):
            if words:
                raise ExportError(f"{target}: {target.suffix} holds all points; leave the point out")
            return writer.write(found, target, long) if long else writer.write(found, target)
        chosen, written = found.points(words), []
        for point in chosen:
            if not len(point.shots):
                raise UnknownPoint(f"{point.label or found.path}: there are no snapshots; output.snapshots in the config asks for them")
            file = target if len(chosen) == 1 else target.with_name(f"{target.stem}-{point.stem}{target.suffix}")
            written += writer.write(found, point, file)
        return written


def replaced(path: Path) -> Any:
    """A name beside `path` to write to, and what puts it in its place."""
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    return temporary, lambda: os.replace(temporary, path)


def needed(module: str, extra: str) -> Any:
    """A package that an extra brings."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise ExportError(f"this needs {module}: pip install 'mpm[{extra}]'") from None
