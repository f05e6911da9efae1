"""Collect: the points of a sweep on disk to one labelled dataset, `sweep.nc` (interface.md section 3).

    /           one number a point: status, error, outcome, run_id, steps, wall_time, attempts and the final observables; NaN where a point is not ok
    /series     observables over time
    /grid       fields on the grid, float32; where the points' grids differ, or all fields exceed LIMIT bytes, only `file`: where each point's fields lie
    /particles  contiguous ragged: obs, with row_size and row_start on swept dimensions and snapshot

Points without a record are `pending`, points that `where` dropped are `skipped`; a half-done sweep is a valid file.
"""

import hashlib
import json
from typing import Any

import numpy as np

from mpm.records.netcdf import Array, DamagedFile, Group, seal, summary, to_bytes, write_whole
from mpm.records.provenance import git_revision, machine, versions
from mpm.records.variables import OK, PENDING, SKIPPED, STATUS, describe
from mpm.sweep.align import axis, places
from mpm.sweep.store import Store

LIMIT = 2 * 2**30  # bytes of fields that go into one file
AXES = ("x", "r", "y", "z")


def collect(store: Store, plan: Any, about: dict, lines: dict[str, dict]) -> bool:
    """Write sweep.nc unless it holds just this already; whether it was written. `about` is experiment.json."""
    digest = fingerprint(about, lines)
    try:
        old = summary(store.dataset)
    except DamagedFile:
        old = None  # a dataset is made anew from the points, whatever it was
    if old is not None and old.get("digest") == digest:
        return False
    write_whole(store.dataset, seal(assemble(store, plan, about, lines), {"digest": digest, "points": len(plan.cases)}))
    return True


def fingerprint(about: dict, lines: dict[str, dict]) -> str:
    """A hash of all that goes into the dataset: point by point, as their text together would be large."""
    digest = hashlib.sha256(json.dumps(about, sort_keys=True).encode())
    for run_id in sorted(lines):
        digest.update(json.dumps(lines[run_id], sort_keys=True).encode())
    return digest.hexdigest()


def assemble(store: Store, plan: Any, about: dict, lines: dict[str, dict]) -> bytes:
    """The bytes of the dataset."""
    fits = store.bytes(lines) <= LIMIT
    records: dict[str, Any] = {}
    damaged: dict[str, str] = {}
    for run_id, record in store.load_all(list(lines), fields=fits):
        if isinstance(record, DamagedFile):
            file = store.path(store.places([run_id])[run_id]).relative_to(store.out)
            damaged[run_id] = f"pending: {file} is damaged; `mpm verify` sets it aside, and the next sweep runs the point again"
        else:
            record.config = {}  # the plan has it; 10 000 of them are 60 MB
            records[run_id] = record
    return dataset(plan, about, records, damaged, None if fits else {run_id: str(store.path(run_id).relative_to(store.out)) for run_id in records})


def dataset(plan: Any, about: dict, records: dict[str, Any], damaged: dict[str, str], files: dict[str, str] | None) -> bytes:
    """The dataset of a plan from its records by run id; `files` instead of fields where those stay outside."""
    table = Table(plan, records)
    root = table.root(damaged, about["swept"])
    groups = {"/": root, "series": table.series(), "grid": table.grid(files), "particles": table.particles(files)}
    return to_bytes(groups, attributes(about, plan, records))


def attributes(about: dict, plan: Any, records: dict[str, Any]) -> dict[str, Any]:
    """Provenance of the whole."""
    sources = sorted({record.source for record in records.values() if record.source})
    return {
        "Conventions": "CF-1.11",
        "title": about["title"] or about["name"],
        "name": about["name"],
        "config": about["source"],
        "config_resolved": about["resolved"],
        "smoke": about["smoke"],
        "versions": versions(),
        "source_hash": sources[0] if len(sources) == 1 else sources,
        "git_revision": git_revision(),
        "machine": machine(),
        "threads": 1,
        "points": len(plan.cases),
        "started": min((record.started for record in records.values() if record.started), default=""),
        "finished": max((record.finished for record in records.values() if record.finished), default=""),
        "facts": next((record.facts for record in records.values() if record.facts), {}),
    }


def described(name: str, dims: tuple[str, ...], data: Any, **more: Any) -> Array:
    """An array with the units and the long name of the table."""
    found = describe(name)
    return Array(dims, data, {"units": found.units, "long_name": found.long_name, **more})


class Table:
    """Records laid out on the swept dimensions."""

    def __init__(self, plan: Any, records: dict[str, Any]):
        self.plan = plan
        self.dims = tuple(dim.name for dim in plan.dims)
        self.shape = tuple(dim.size for dim in plan.dims)
        self.places = [(tuple(case.index), records[case.run_id]) for case in plan.cases if case.run_id in records]
        self.records = list({id(record): record for _, record in self.places}.values())

    def full(self, value: Any, dtype: Any, tail: tuple[int, ...] = ()) -> np.ndarray:
        """An array over the swept dimensions and `tail`."""
        array = np.empty((*self.shape, *tail), dtype=dtype)
        array[...] = value
        return array

    def names(self, attribute: str) -> list[str]:
        """Names in any record, in the order they are first seen."""
        return list({name: None for record in self.records for name in getattr(record, attribute)})

    def root(self, damaged: dict[str, str], swept: list[str]) -> Group:
        """One number a point."""
        from mpm.sweep.coordinates import fixed, planned

        status, error, run_id, outcome = self.full(SKIPPED, np.int8), self.full("", object), self.full("", object), self.full("", object)
        steps, wall, attempts = self.full(np.nan, float), self.full(np.nan, float), self.full(0, np.int32)
        finals = {name: self.full(np.nan, float) for name in self.names("finals")}
        for case in self.plan.cases:
            index = tuple(case.index)
            status[index], run_id[index], error[index] = PENDING, case.run_id, damaged.get(case.run_id, "")
        for index, record in self.places:
            status[index], error[index], attempts[index], outcome[index] = record.status, record.error, record.attempts, record.outcome
            if record.status == OK:
                steps[index], wall[index] = record.steps, record.wall_time
                for name, value in record.finals.items():
                    finals[name][index] = value
        flags = {"flag_values": np.arange(len(STATUS), dtype=np.int8), "flag_meanings": " ".join(STATUS)}
        models = {"model_name": self.models()} if any("model" in record.facts for record in self.records) else {}
        columns = {"status": status, "error": error, "outcome": outcome, "run_id": run_id, "steps": steps, "wall_time": wall, "attempts": attempts}
        columns |= models | finals
        group = Group(planned(self.plan) | fixed(self.plan, swept, set(columns) | set(self.names("series"))))
        coordinates = " ".join(name for name in group.variables if name not in self.dims)
        for name, values in columns.items():
            group.variables[name] = described(name, self.dims, values, **(flags if name == "status" else {}))
            if coordinates:
                group.variables[name].attrs["coordinates"] = coordinates
        return group

    def models(self) -> np.ndarray:
        """Which model answered each point, where the config left it open."""
        model = self.full("", object)
        for index, record in self.places:
            model[index] = record.facts.get("model", {}).get("name", "full")
        return model

    def series(self) -> Group:
        """Observables over time."""
        time = axis([record.times for record in self.records], [record.status == OK for record in self.records])
        group = Group()
        if not len(time):
            return group
        group.variables["time"] = described("time", ("time",), time, standard_name="time", axis="T")
        columns = {name: self.full(np.nan, float, (len(time),)) for name in self.names("series")}
        for index, record in self.places:
            samples, onto = places(record.times, time)
            for name, values in record.series.items():
                columns[name][(*index, onto)] = values[samples]
        for name, values in columns.items():
            group.variables[name] = described(name, (*self.dims, "time"), values)
        group.variables |= self.measured()
        return group

    def measured(self) -> dict[str, Array]:
        """Measured curves of the config, each over its own times."""
        found = {}
        for probe, curve in self.plan.cases[0].experiment.output.measured.items() if self.plan.cases else ():
            samples, dim = np.array(curve.samples), f"measured_time_{probe}"
            found[dim] = Array((dim,), samples[:, 0], {"units": "s", "long_name": f"times measured at {probe.replace('_', ' ')}"})
            found[f"measured_temperature_{probe}"] = described(f"measured_temperature_{probe}", (dim,), samples[:, 1], source=curve.file)
        return found

    def snapshots(self) -> np.ndarray:
        """Times of the snapshots."""
        return axis([record.snapshot_times for record in self.records], [record.status == OK for record in self.records])

    def grid(self, files: dict[str, str] | None) -> Group:
        """Fields on the grid."""
        group, first = Group(), next((record for record in self.records if record.grid), None)
        if files is None and first is None:
            return group
        if files is not None or any(not same(first.axes, record.axes) for record in self.records if record.grid):
            return self.elsewhere(files)
        time = self.snapshots()
        names = tuple(name for name in reversed(AXES) if name in first.axes)
        group.variables["snapshot"] = described("snapshot", ("snapshot",), time)
        for name in names:
            group.variables[name] = described(name, (name,), first.axes[name])
        for field in self.names("grid"):
            values = self.full(np.nan, np.float32, (len(time), *(len(first.axes[name]) for name in names)))
            for index, record in self.places:
                if field in record.grid:
                    samples, onto = places(record.snapshot_times, time)
                    values[(*index, onto)] = record.grid[field][samples]
            group.variables[field] = described(field, (*self.dims, "snapshot", *names), values)
        return group

    def particles(self, files: dict[str, str] | None) -> Group:
        """Snapshots of particles, one after another."""
        group = Group()
        if files is not None:
            return self.elsewhere(files)
        if not any(len(record.row_size) for record in self.records):
            return group
        time = self.snapshots()
        sizes, starts = self.full(0, np.int64, (len(time),)), self.full(0, np.int64, (len(time),))
        rows: dict[str, list[np.ndarray]] = {name: [] for name in self.names("particles")}
        count = 0
        for index, record in self.places:
            begins = np.cumsum(record.row_size) - record.row_size
            for sample, onto in zip(*places(record.snapshot_times, time), strict=True):
                begin, size = begins[sample], record.row_size[sample]
                sizes[(*index, onto)], starts[(*index, onto)] = size, count
                count += size
                for name, parts in rows.items():
                    parts.append(record.particles[name][begin : begin + size])
        group.variables["snapshot"] = described("snapshot", ("snapshot",), time)
        group.variables["row_size"] = described("row_size", (*self.dims, "snapshot"), sizes, sample_dimension="obs")
        group.variables["row_start"] = described("row_start", (*self.dims, "snapshot"), starts)
        for name, parts in rows.items():
            values = np.concatenate(parts)
            group.variables[name] = described(name, ("obs", "direction")[: values.ndim], values)
        return group

    def elsewhere(self, files: dict[str, str] | None) -> Group:
        """Where the fields of each point lie, as they do not fit into one array or one file."""
        file = self.full("", object)
        for index, record in self.places:
            file[index] = files[record.run_id] if files else f"points/{record.run_id[:2]}/{record.run_id}.nc"
        return Group({"file": Array(self.dims, file, {"units": "1", "long_name": "point file that holds the fields, beside this one"})})


def same(one: dict[str, np.ndarray], two: dict[str, np.ndarray]) -> bool:
    """Whether two grids are equal."""
    return list(one) == list(two) and all(np.array_equal(one[name], two[name]) for name in one)
