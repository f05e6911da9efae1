"""Results on disk, as exports, movies and reports ask for them: a dataset that is opened and not read, its points by name, their snapshots one at a time.

    found = Results("results/loaf")          sweep.nc, else run.nc; or a dataset file
    found.points(["kappa=0.35,beta=13"])     points by what they are called; `beta=all` is one a value; a dimension that is left out stays at the chosen point
    point.shots[k]                           Frame: time, fields on the grid, fields of particles; reads that snapshot alone

May use     plots (how a dataset is read and named), records                              May not  see config, sweep or anything that computes
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
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
    """A dataset, open. `view` is what figures see (mpm.plots.view)."""

    def __init__(self, out: Path | str):
        import xarray

        from mpm.plots import dataset_of
        from mpm.plots.view import View

        self.path = dataset_of(Path(out))
        self.tree = xarray.open_datatree(self.path, engine="h5netcdf")
        self.view = View(self.tree)

    def __enter__(self) -> "Results":
        return self

    def __exit__(self, *_: Any) -> None:
        self.tree.close()

    @property
    def dimension(self) -> Any:
        """The dimension of the scene, as configs say it."""
        return (self.view.config.get("grid") or {}).get("dimension")

    def points(self, said: Iterable[str] = ()) -> list[Point]:
        """The points that are named; the one that stands for the sweep unless any is."""
        return [self.point(at) for text in (list(said) or [""]) for at in self.places(text)]

    def point(self, at: dict[str, int]) -> Point:
        """The point at a place."""
        view = self.view
        words = view.named(at)
        plain = [f"{axis.name.rsplit('.', 1)[-1]}={axis.text(at[axis.dim])}" for axis in view.axes]
        stem = re.sub(r"[^A-Za-z0-9_.+=-]+", "_", "-".join(plain) if view.design is None else "-".join([*plain, f"{view.design}={at[view.design]}"]))
        return Point(at, visible(", ".join(words)), stem, Shots(self, at))

    def places(self, text: str) -> list[dict[str, int]]:
        """What one POINT names."""
        found = [dict(self.view.chosen)]
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
        groups, self.at = results.view.groups, at
        self.grid, self.particles = (self.kept(groups.get(name), at) for name in ("grid", "particles"))
        self.entries: Any = None
        self.near: dict[str, tuple[int, np.ndarray]] = {}  # of each field the rows that were read last, from the first on
        self.rows = None if self.particles is None else [np.asarray(self.particles[name].values) for name in ("row_start", "row_size")]
        outside = next((group for group in map(groups.get, ("particles", "grid")) if group is not None and "file" in group), None)
        if outside is not None and (file := str(outside["file"].isel({dim: at[dim] for dim in outside["file"].dims}).values)):
            self.entries = elsewhere(results.path.parent / file)
        here = [group for group in (self.particles, self.grid) if group is not None]
        self.times, self.numbers = np.zeros(0), np.zeros(0, int)
        if self.entries is not None:
            self.times = self.entries.times
        elif here:
            self.times = np.asarray(here[0]["snapshot"].values, float)
            if self.rows is not None:
                self.numbers = np.flatnonzero(self.rows[1])  # of a point that stopped early the last are empty
                self.times = self.times[self.numbers]
            else:
                self.numbers = np.arange(len(self.times))

    @staticmethod
    def kept(group: Any, at: dict[str, int]) -> Any:
        """A group whose fields lie in the dataset."""
        there = group is not None and "snapshot" in group.dims and group.sizes["snapshot"] and "file" not in group
        return group.isel({dim: index for dim, index in at.items() if dim in group.dims}) if there else None

    def __len__(self) -> int:
        return len(self.times)

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """Coordinates of the grid's nodes by axis, the last direction first; none without fields on the grid."""
        if self.entries is not None:
            return self.entries.axes
        return {str(dim): np.asarray(self.grid[dim].values) for dim in next(iter(self.grid.data_vars.values())).dims if dim != "snapshot"} if self.grid else {}

    def __getitem__(self, k: int) -> Frame:
        if self.entries is not None:
            return self.entries[k]
        number = int(self.numbers[k])
        grid = {} if self.grid is None else {str(name): row.isel(snapshot=number).values for name, row in self.grid.data_vars.items() if "snapshot" in row.dims}
        particles = {}
        if self.particles is not None:
            begin, size = (int(values[number]) for values in self.rows)
            rows = [(str(name), row) for name, row in self.particles.data_vars.items() if "obs" in row.dims]
            particles = {name: self.read(name, row, begin, begin + size) for name, row in rows}
        return Frame(float(self.times[k]), grid, particles)

    def read(self, name: str, row: Any, begin: int, end: int) -> np.ndarray:
        """Rows of a field of particles. Whole chunks of the file are read and the last kept: the next snapshot often lies in the same."""
        first, values = self.near.get(name, (0, np.zeros(0)))
        if not first <= begin <= end <= first + len(values):
            chunk = (row.encoding.get("chunksizes") or (1,))[0]
            first, last = begin // chunk * chunk, min(-(-end // chunk) * chunk, row.sizes["obs"])
            values = row.isel(obs=slice(first, last)).values
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
