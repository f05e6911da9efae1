"""Results on disk, as exports, movies and reports ask for them: a dataset that is opened and not read, its points by name, their snapshots one at a time.

    found = Results("results/loaf")          sweep.nc, else run.nc; or a dataset file
    found.points(["kappa=0.35,beta=13"])     points by what they are called; `beta=all` is one a value; a dimension that is left out stays at the chosen point
    point.shots[k]                           Frame: time, fields on the grid, fields of particles; reads that snapshot alone

May use     plots (how a dataset is read and named), records                              May not  see config, sweep or anything that computes
"""

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.frames import Frame
from mpm.text import visible


class UnknownPoint(ValueError):
    """A point that the dataset does not have, or one without what is asked of it."""


@dataclass(frozen=True)
class Point:
    """One point: its place in the swept dimensions, its swept values in words, and its snapshots."""

    at: dict[str, int]
    label: str
    stem: str  # the same as part of a file's name, in plain letters
    shots: "Shots"


class Results:
    """A dataset, open. Snapshots are read by h5netcdf alone: to import xarray takes longer than to export those of a run."""

    def __init__(self, out: Path | str):
        import h5netcdf

        from mpm.plots import dataset_of

        self.path = dataset_of(Path(out))
        self.file = h5netcdf.File(self.path)

    @cached_property
    def tree(self) -> Any:
        """All of it as an xarray.DataTree."""
        import xarray

        return xarray.open_datatree(self.path, engine="h5netcdf")

    @cached_property
    def view(self) -> Any:
        """What figures see (mpm.plots.view)."""
        from mpm.plots.view import View

        return View(self.tree)

    def __enter__(self) -> "Results":
        return self

    def __exit__(self, *_: Any) -> None:
        self.file.close()
        if "tree" in self.__dict__:
            self.tree.close()

    @property
    def dimension(self) -> Any:
        """The dimension of the scene, as configs say it."""
        return (json.loads(self.file.attrs.get("config_resolved") or "{}").get("grid") or {}).get("dimension")

    @property
    def swept(self) -> bool:
        """Whether there are more points than one."""
        return bool(self.file.variables["status"].dimensions)

    def points(self, said: Iterable[str] = ()) -> list[Point]:
        """The points that are named; the one that stands for the sweep unless any is."""
        return [self.point(at) for text in (list(said) or [""]) for at in self.places(text)]

    def point(self, at: dict[str, int]) -> Point:
        """The point at a place."""
        if not at:
            return Point({}, "", "", Shots(self, {}))
        view = self.view
        words = view.named(at)
        plain = [f"{axis.name.rsplit('.', 1)[-1]}={axis.text(at[axis.dim])}" for axis in view.own]
        stem = re.sub(r"[^A-Za-z0-9_.+=-]+", "_", "-".join(plain) if view.design is None else "-".join([*plain, f"{view.design}={at[view.design]}"]))
        return Point(at, visible(", ".join(words)), stem, Shots(self, at))

    def places(self, text: str) -> list[dict[str, int]]:
        """What one POINT names."""
        found = [dict(self.view.chosen) if self.swept else {}]
        for pair in filter(None, map(str.strip, text.split(","))):
            name, sign, value = map(str.strip, pair.partition("="))
            dim = self.dim(name)
            if not sign or dim is None:
                allowed = ", ".join(f"{name}=..." for name in self.view.dims) or "no point, as there is one only"
                raise UnknownPoint(f"point {visible(pair)!r}: say {allowed}")
            indices = range(self.view.sizes[dim]) if value == "all" else [self.index(dim, name, value)]
            found = [{**at, dim: index} for at in found for index in indices]
        return found

    def dim(self, name: str) -> str | None:
        """The swept dimension that a name means: its own, or that of a coordinate along it."""
        if name in self.view.dims:
            return name
        coordinate = self.view.root.coords.get(name)
        return str(coordinate.dims[0]) if coordinate is not None and coordinate.dims in {(dim,) for dim in self.view.dims} else None

    def index(self, dim: str, name: str, value: str) -> int:
        """Where a value lies on a dimension: the nearest number, or the text; a number of a sample."""
        coordinate = self.view.root.coords.get(name)
        if coordinate is None:
            if value.isdigit() and int(value) < self.view.sizes[dim]:
                return int(value)
            raise UnknownPoint(f"{name}={visible(value)}: say a number from 0 to {self.view.sizes[dim] - 1}")
        values = coordinate.values
        if values.dtype.kind in "fiu":
            try:
                wanted = float(value)
            except ValueError:
                raise UnknownPoint(f"{name}={visible(value)}: that is no number") from None
            gaps = np.where(values == wanted, 0.0, np.abs(values.astype(float) - wanted))
            nearest = int(np.nanargmin(gaps))
            if gaps[nearest] > max(0.02 * abs(wanted), 1e-12):
                raise UnknownPoint(f"{name}={value}: there is no such point; there are {', '.join(f'{one:.4g}' for one in values[:12])}")
            return nearest
        if value not in (texts := [str(one) for one in values]):
            raise UnknownPoint(f"{name}={visible(value)}: there is no such point; there are {', '.join(map(visible, texts[:12]))}")
        return texts.index(value)


class Shots:
    """Snapshots of one point. `len`, `times` [s], and `shots[k]`, which reads that one alone."""

    def __init__(self, results: Results, at: dict[str, int]):
        self.at = at
        self.grid, self.particles = (self.kept(results.file.groups.get(name)) for name in ("grid", "particles"))
        self.entries: Any = None
        self.near: dict[str, tuple[int, np.ndarray]] = {}  # of each field the rows that were read last, from the first on
        self.rows = None if self.particles is None else [self.part(self.particles[name]) for name in ("row_start", "row_size")]
        outside = next((group for group in map(results.file.groups.get, ("particles", "grid")) if group is not None and "file" in group.variables), None)
        if outside is not None and (file := self.part(outside.variables["file"]).item()):
            self.entries = elsewhere(results.path.parent / (file.decode() if isinstance(file, bytes) else file))
        here = [group for group in (self.particles, self.grid) if group is not None]
        self.times, self.numbers = np.zeros(0), np.zeros(0, int)
        if self.entries is not None:
            self.times = self.entries.times
        elif here:
            self.times = np.asarray(here[0]["snapshot"][...], float)
            if self.rows is not None:
                self.numbers = np.flatnonzero(self.rows[1])  # of a point that stopped early the last are empty
                self.times = self.times[self.numbers]
            else:
                self.numbers = np.arange(len(self.times))

    @staticmethod
    def kept(group: Any) -> Any:
        """Variables of a group whose fields lie in the dataset."""
        there = group is not None and "snapshot" in group.variables and len(group.variables["snapshot"]) and "file" not in group.variables
        return group.variables if there else None

    def part(self, row: Any, **chosen: Any) -> np.ndarray:
        """A variable at this point, and at what is chosen of its other dimensions."""
        return np.asarray(row[tuple({**self.at, **chosen}.get(dim, slice(None)) for dim in row.dimensions) or ...])

    @cached_property
    def fields(self) -> dict[str, dict[str, Any]]:
        """Variables of fields, of the grid and of particles."""
        grid = {name: row for name, row in (self.grid or {}).items() if "snapshot" in row.dimensions and name != "snapshot"}
        return {"grid": grid, "particles": {name: row for name, row in (self.particles or {}).items() if "obs" in row.dimensions}}

    def __len__(self) -> int:
        return len(self.times)

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """Coordinates of the grid's nodes by axis, the last direction first; none without fields on the grid."""
        if self.entries is not None:
            return self.entries.axes
        space = [dim for dim in next(iter(self.fields["grid"].values())).dimensions if dim not in (*self.at, "snapshot")] if self.grid else []
        return {dim: np.asarray(self.grid[dim][...]) for dim in space}

    def __getitem__(self, k: int) -> Frame:
        if self.entries is not None:
            return self.entries[k]
        number = int(self.numbers[k])
        grid, particles = {name: self.part(row, snapshot=number) for name, row in self.fields["grid"].items()}, {}
        if self.rows is not None:
            begin, size = (int(values[number]) for values in self.rows)
            particles = {name: self.read(name, row, begin, begin + size) for name, row in self.fields["particles"].items()}
        return Frame(float(self.times[k]), grid, particles)

    def read(self, name: str, row: Any, begin: int, end: int) -> np.ndarray:
        """Rows of a field of particles. Whole chunks of the file are read and the last kept: the next snapshot often lies in the same."""
        first, values = self.near.get(name, (0, np.zeros(0)))
        if not first <= begin <= end <= first + len(values):
            chunk = (row.chunks or (1,))[0]
            first, last = begin // chunk * chunk, min(-(-end // chunk) * chunk, row.shape[0])
            values = row[first:last]
            self.near[name] = first, values
        return values[begin - first : end - first]


def elsewhere(path: Path) -> Any:
    """Snapshots in a point's own file, or in the file of its frames beside it."""
    from mpm.records.point import read

    return Kept(read(path.with_suffix(".nc")))


class Kept:
    """Snapshots of a record."""

    def __init__(self, record: Any):
        self.record, self.times = record, record.snapshot_times
        self.axes = {name: record.axes[name] for name in ("z", "y", "r", "x") if name in record.axes}
        self.ends = np.cumsum(record.row_size)

    def __getitem__(self, k: int) -> Frame:
        record = self.record
        if record.frames is not None:
            return record.frames[k]
        rows = slice(self.ends[k] - record.row_size[k], self.ends[k]) if len(self.ends) else slice(0)
        grid = {name: values[k] for name, values in record.grid.items()}
        return Frame(float(self.times[k]), grid, {name: values[rows] for name, values in record.particles.items()})
