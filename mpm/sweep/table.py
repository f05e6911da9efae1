"""Table: records laid out on the swept dimensions, one after another. It holds the arrays of the dataset and no record, so that a collect needs no more
memory than they take; series of more than SERIES bytes are left to `shards`.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from mpm.records.frames import Entries, Frame, Stream
from mpm.records.large import Parts
from mpm.records.netcdf import Array, Group
from mpm.records.point import Record
from mpm.records.variables import OK, PENDING, SKIPPED, STATUS, components, describe, is_total
from mpm.sweep.coordinates import fixed, planned
from mpm.sweep.time_axis import places
from mpm.sweep.time_columns import TimeColumns
from mpm.warned import KINDS, flags

LIMIT = 2**31  # bytes of fields (as they lie in the points' files) that go into sweep.nc
SERIES = 2**29  # bytes of series that do: a collect takes some two and a half times as much memory
AXES = ("x", "r", "y", "z")
TEXTS = ("error", "advice", "outcome")
CHOSEN = {"model_name": ("model", "name"), "frame_name": ("frame", "name"), "frame_why": ("frame", "why")}


def dimension_of(plan: Any) -> int | str | None:
    """The dimension of the scene; None where it is swept, as totals have no one unit then."""
    swept = any(coordinate.config_path.startswith("grid.dimension") for dim in plan.dims for coordinate in dim.coords)
    return plan.cases[0].experiment.grid.dimension if plan.cases and not swept else None


def described(name: str, dims: tuple[str, ...], data: Any, dimension: int | str | None = None, probes: Any = (), bodies: Any = (), **more: Any) -> Array:
    """An array with the units and the long name of the table, for scenes of one dimension; `probes` and `bodies` as in `records.variables.describe`."""
    found = describe(name, dimension, probes, bodies)
    apart = ", per metre of depth where grid.dimension is 2, per square metre where it is 1" if dimension is None and is_total(name) else ""
    return Array(dims, data, {"units": found.units, "long_name": found.long_name + apart, **more})


class Table:
    """`files`: paths by run id of the points' files, which keep the fields where these stay `outside`, or do not fit together."""

    def __init__(self, plan: Any, files: dict[str, str] | None = None, outside: bool = False):
        self.plan, self.files, self.outside = plan, files or {}, outside
        self.dimension, self.bodies = dimension_of(plan), tuple(plan.cases[0].experiment.bodies) if plan.cases else ()
        self.dims = tuple(dim.name for dim in plan.dims)
        self.shape = tuple(dim.size for dim in plan.dims)
        self.count = math.prod(self.shape)
        self.place: dict[str, int] = {}
        self.more: dict[str, list[int]] = {}  # further places of points that stand at several
        self.status, self.attempts = np.full(self.count, SKIPPED, np.int8), np.zeros(self.count, np.int32)
        self.text = {name: np.full(self.count, "", object) for name in (*TEXTS, "warnings", "run_id", "file")}
        self.flags = np.zeros(self.count, np.int32)
        self.numbers = {name: np.full(self.count, np.nan) for name in ("steps", "wall_time")}
        self.finals: dict[str, np.ndarray] = {}
        self.chosen: dict[str, np.ndarray] = {}  # which model and frame answered each point, where the config left it open
        self.series_names: dict[str, None] = {}
        self.series_over, self.fields = TimeColumns(self.count), TimeColumns(self.count)
        self.axes: dict[str, np.ndarray] | None = None
        self.apart = False  # whether the points' grids differ
        self.rows: list[tuple[int, np.ndarray, Any]] = []  # place, times and frames of records that have particles
        self.sources: set[str] = set()
        self.started, self.finished = "", ""
        self.facts: dict[str, Any] = {}
        for case in plan.cases:
            self.status[case.flat], self.text["run_id"][case.flat] = PENDING, case.run_id
            if self.place.setdefault(case.run_id, case.flat) != case.flat:
                self.more.setdefault(case.run_id, []).append(case.flat)

    def places(self, run_id: str) -> list[int]:
        """Where a point stands; equal points are one."""
        return [self.place[run_id], *self.more.get(run_id, ())] if run_id in self.place else []

    def damaged(self, run_id: str, why: str) -> None:
        """A point that is there, and cannot be read."""
        for place in self.places(run_id):
            self.text["error"][place] = why

    def add(self, record: Record) -> None:
        """Put a point where it stands; in the order of the plan, which is that of the particles in the dataset."""
        self.sources.update({record.source} - {""})
        self.started = min(self.started or record.started, record.started or self.started)
        self.finished = max(self.finished, record.finished)
        self.facts = self.facts or record.facts
        self.series_names |= dict.fromkeys(record.series)
        for name in record.finals:
            if name not in self.finals:
                self.finals[name] = np.full(self.count, np.nan)
        for place in self.places(record.run_id):
            self.put(place, record)

    def put(self, place: int, record: Record) -> None:
        """All of a record at one place."""
        ok = record.status == OK
        self.status[place], self.attempts[place] = record.status, record.attempts
        for name in TEXTS:
            self.text[name][place] = getattr(record, name)
        self.text["warnings"][place], self.flags[place] = "\n".join(record.warnings), flags(record.warnings)
        if self.outside or record.grid or record.frames is not None:
            file = self.files.get(record.run_id, "")
            self.text["file"][place] = file if record.frames is None else file.removesuffix(".nc") + ".frames"
        if ok:
            self.numbers["steps"][place], self.numbers["wall_time"][place] = record.steps, record.wall_time
            for name, value in record.finals.items():
                self.finals[name][place] = value
        for name, (fact, part) in CHOSEN.items():
            if fact in record.facts:
                self.chosen.setdefault(name, np.full(self.count, "", object))[place] = record.facts[fact].get(part, "full")
        if self.series_over.keep and self.count * len(record.times) * 8 * len(record.series) > SERIES:
            self.series_over.drop()
        self.series_over.add(place, record.times, record.series, ok)
        grid, frames = record.grid, record.frames.opened() if isinstance(record.frames, Entries | Stream) else None
        if frames is not None and record.axes:
            shots = [frame.grid for frame in frames]
            grid = {name: np.stack([shot[name] for shot in shots]) for name in shots[0]}
        if grid:
            self.axes = record.axes if self.axes is None else self.axes
            self.apart = self.apart or not same(self.axes, record.axes)
            if self.apart:
                self.fields.drop()
        self.fields.add(place, record.snapshot_times, grid, ok)
        if len(record.row_size) or frames is not None:
            self.rows.append((place, record.snapshot_times, Rows(record) if frames is None else frames))

    def full(self, values: np.ndarray) -> np.ndarray:
        """(count, ...) over the swept dimensions."""
        return values.reshape((*self.shape, *values.shape[1:]))

    def root(self, swept: list[str]) -> Group:
        """One number a point."""
        meanings: dict[str, dict[str, Any]] = {
            "status": {"flag_values": np.arange(len(STATUS), dtype=np.int8), "flag_meanings": " ".join(STATUS)},
            "warnings": {"flag_meanings": " ".join(KINDS)},
            "warning_flags": {"flag_masks": 1 << np.arange(len(KINDS), dtype=np.int32), "flag_meanings": " ".join(KINDS)},
        }
        columns = {"status": self.status} | {name: self.text[name] for name in (*TEXTS, "warnings", "run_id")} | {"warning_flags": self.flags}
        columns |= self.numbers | {"attempts": self.attempts}
        columns |= self.chosen | self.finals
        probes = self.plan.cases[0].experiment.output.probes if self.plan.cases else ()
        first = self.plan.cases[0].experiment if self.plan.cases else None
        meanings |= {f"misfit_{name}": misfit(first, name, curve) for name, curve in (first.output.measured.items() if first is not None else ())}
        said = lambda name, values: described(name, self.dims, self.full(values), self.dimension, probes, self.bodies, **meanings.get(name, {}))  # noqa: E731
        group = Group({name: said(name, values) for name, values in columns.items()})
        coordinates = planned(self.plan) | fixed(self.plan, swept, set(columns) | set(self.series_names))
        if twice := sorted(set(coordinates) & set(columns)):
            raise ValueError(f"a parameter and a result are both called {', '.join(twice)}")
        return with_axes(group, coordinates)

    def series(self, shards: list[str] | None = None) -> Group:
        """Observables over time; or which file holds those of each value along the first dimension."""
        time, columns = (self.series_over.axis(), {}) if shards else self.series_over.laid()
        group = Group()
        if not len(time):
            return group
        group.variables["time"] = described("time", ("time",), time, standard_name="time", axis="T")
        for name, values in columns.items():
            group.variables[name] = described(name, (*self.dims, "time"), self.full(values), self.dimension, bodies=self.bodies)
        if shards:
            about = {"units": "1", "long_name": "file that holds the series of these points, beside this one"}
            group.variables["file"] = Array((self.dims[0],), np.array(shards, dtype=object), about)
        return with_axes(group, planned(self.plan), self.measured())

    def measured(self) -> dict[str, Array]:
        """Measured curves of the config, each over its own times."""
        from mpm.config.measured import recorded

        found, experiment = {}, self.plan.cases[0].experiment if self.plan.cases else None
        for name, curve in experiment.output.measured.items() if experiment is not None else ():
            (variable, units), dim = recorded(experiment, name, curve), f"measured_time_{name}"
            if not curve.samples:
                continue  # one number a run: its misfit says it
            samples, known = np.array([row[:2] for row in curve.samples]), f"measured_{variable}"
            found[dim] = Array((dim,), samples[:, 0], {"units": "s", "long_name": f"times measured, {name.replace('_', ' ')}"})
            about = {"units": units, "long_name": f"measured {describe(variable).long_name}", "source": curve.file}
            found[f"{known}_{name}" if known in found else known] = Array((dim,), samples[:, 1], about)
        return found

    def grid(self) -> Group:
        """Fields on the grid."""
        group = Group()
        if self.outside or self.apart:
            return self.elsewhere()
        if self.axes is None:
            return group
        time, columns = self.fields.laid()
        names = tuple(name for name in reversed(AXES) if name in self.axes)
        group.variables["snapshot"] = described("snapshot", ("snapshot",), time)
        for name in names:
            group.variables[name] = described(name, (name,), self.axes[name])
        for field, values in columns.items():
            group.variables[field] = described(field, (*self.dims, "snapshot", *names), self.full(values.astype(np.float32, copy=False)))
        return with_axes(group, planned(self.plan))

    def particles(self) -> Group:
        """Snapshots of particles, one after another."""
        group = Group()
        if self.outside:
            return self.elsewhere()
        if not self.rows:
            return group
        time = self.fields.axis()
        sizes, starts = np.zeros((self.count, len(time)), np.int64), np.zeros((self.count, len(time)), np.int64)
        first: dict[str, np.ndarray] = {}
        taken, count = [], 0
        for place, times, frames in self.rows:
            for sample, onto in zip(*places(times, time), strict=True):
                fields = frames[sample].particles
                first = first or fields
                size = len(next(iter(fields.values()), ()))
                sizes[place, onto], starts[place, onto] = size, count
                count += size
                taken.append((frames, sample))
        group.variables["snapshot"] = described("snapshot", ("snapshot",), time)
        group.variables["row_size"] = described("row_size", (*self.dims, "snapshot"), self.full(sizes), sample_dimension="obs")
        group.variables["row_start"] = described("row_start", (*self.dims, "snapshot"), self.full(starts))
        whole = all(isinstance(frames, Rows) for _, _, frames in self.rows)
        for name, like in first.items():
            parts = lambda name=name: (frames.part(sample, name) for frames, sample in taken)  # noqa: E731
            values = np.concatenate(list(parts())) if whole else Parts((count, *like.shape[1:]), like.dtype, parts)
            columns = components(name, self.dimension)
            kind, more = ("entry" if name == "velocity_gradient" else "component", {"components": columns}) if columns else ("direction", {})
            group.variables[name] = described(name, ("obs", kind)[: values.ndim], values, self.dimension, **more)
        return with_axes(group, planned(self.plan))

    def elsewhere(self) -> Group:
        """Where the fields of each point lie, as they do not fit into one array or one file."""
        about = {"units": "1", "long_name": "point file that holds the fields, beside this one"}
        return with_axes(Group({"file": Array(self.dims, self.full(self.text["file"]), about)}), planned(self.plan))


class Rows(Sequence):
    """Snapshots of a record that holds them one after another."""

    def __init__(self, record: Record):
        self.times, self.particles, self.ends = record.snapshot_times, record.particles, np.cumsum(record.row_size)
        self.sizes = record.row_size

    def __len__(self) -> int:
        return len(self.ends)

    def __getitem__(self, k: int) -> Frame:  # type: ignore[override]  # one at a time: no slices
        return Frame(float(self.times[k]), {}, {name: self.part(k, name) for name in self.particles})

    def part(self, k: int, name: str) -> np.ndarray:
        """One field of the particles of snapshot k."""
        return self.particles[name][self.ends[k] - self.sizes[k] : self.ends[k]]


def misfit(experiment: Any, name: str, curve: Any) -> dict[str, str]:
    """Unit and long name of how far a point is from a measured curve."""
    from mpm.config.measured import recorded

    variable, units = recorded(experiment, name, curve)
    long_name = describe(variable, None, experiment.output.probes).long_name
    return {"units": units, "long_name": f"{'' if curve.equals is not None else 'root-mean-square '}difference from the measured {long_name} ({name})"}


def with_axes(group: Group, coordinates: dict[str, Array], more: dict[str, Array] | None = None) -> Group:
    """The group with its coordinates before its variables, which name those that are no dimension; `more` variables have none of them."""
    apart = {name: array.dims for name, array in coordinates.items() if array.dims != (name,)}
    for variable in group.variables.values():
        if named := " ".join(name for name, dims in apart.items() if set(dims) <= set(variable.dims) and name not in group.variables):
            variable.attrs["coordinates"] = named
    return Group(coordinates | group.variables | (more or {}))


def same(one: dict[str, np.ndarray], two: dict[str, np.ndarray]) -> bool:
    """Whether two grids are equal."""
    return list(one) == list(two) and all(np.array_equal(one[name], two[name]) for name in one)
