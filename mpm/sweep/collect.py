"""Collect: the points of a sweep on disk to one labelled dataset, `sweep.nc`.

    /           one number a point: status, error, advice, warnings, outcome, run_id, steps, wall_time, attempts and finals; NaN where a point is not ok
    /series     observables over time; where they exceed SERIES bytes, `file`: which of OUT/series/*.nc holds them for each value along the first dimension
    /grid       fields on the grid, float32; where the points' grids differ, or all fields exceed LIMIT bytes, only `file`: where each point's fields lie
    /particles  contiguous ragged: obs, with row_size and row_start on swept dimensions and snapshot

Points without a record are `pending`, points that `where` dropped are `skipped`; a half-done sweep is a valid file. Files are read one by one.
"""

import hashlib
import json
import os
from pathlib import Path
from typing import Any

from mpm.records.large import Parts, write_sealed
from mpm.records.netcdf import DamagedFile, Group, seal, summary, to_bytes, write_whole
from mpm.records.provenance import git_revision, machine, versions
from mpm.sweep import shards, table
from mpm.sweep.store import BATCH, Store
from mpm.sweep.summaries import Summaries
from mpm.sweep.table import Table


def collect(store: Store, plan: Any, about: dict, lines: Summaries, target: Path | None = None) -> bool:
    """Write sweep.nc (or `target`) unless it holds just this already; whether it was written. `about` is experiment.json."""
    target = target or store.dataset
    digest = due(store, about, lines, target)
    if not digest:
        return False
    groups, attrs, outside = assemble(store, plan, about, lines, target.parent)
    put(target, groups, attrs, {"digest": digest, "points": len(plan.cases)} | ({"files": outside} if outside else {}))
    return True


def put(target: Path, groups: dict[str, Group], attrs: dict[str, Any], line: dict) -> None:
    """A sealed dataset on disk, piece by piece where frames lie in files of their own."""
    if any(isinstance(variable.data, Parts) for group in groups.values() for variable in group.variables.values()):
        write_sealed(target, groups, attrs, line)
    else:
        write_whole(target, seal(to_bytes(groups, attrs), line))


def due(store: Store, about: dict, lines: Summaries, target: Path | None = None) -> str:
    """The fingerprint of the dataset to write; empty where it is there."""
    digest, target = fingerprint(about, lines), target or store.dataset
    try:
        old = summary(target)
    except DamagedFile:
        old = None  # a dataset is made anew from the points, whatever it was
    there = old is not None and old.get("digest") == digest and all((target.parent / file).exists() for file in old.get("files", ()))
    return "" if there else digest


def fingerprint(about: dict, lines: Summaries) -> str:
    """A hash of all that goes into the dataset."""
    digest = hashlib.sha256(json.dumps(about, sort_keys=True).encode())
    for part in lines.content():
        digest.update(part)
    return digest.hexdigest()


def assemble(store: Store, plan: Any, about: dict, lines: Summaries, folder: Path) -> tuple[dict[str, Group], dict[str, Any], list[str]]:
    """Groups and attributes of a dataset in `folder`, and the files that hold what does not fit into it, which are there when this returns."""
    order = [run_id for run_id in dict.fromkeys(case.run_id for case in plan.cases) if run_id in lines]
    names = store.places(order)
    fits = store.bytes(order) <= table.LIMIT
    own = {run_id: os.path.relpath(store.path(name), folder) for run_id, name in names.items() if not name.startswith(BATCH)}
    laid = Table(plan, own, outside=not fits)
    for run_id, record in store.load_all(order, fields=fits):
        if isinstance(record, DamagedFile):
            file = store.path(names[run_id]).relative_to(store.out)
            laid.damaged(run_id, f"pending: {file} is damaged; `mpm verify` sets it aside, and the next sweep runs the point again")
        else:
            laid.add(record)
    outside = shards.write(store, plan, about, laid, folder)
    return *written(laid, about, outside), sorted(set(outside))


def dataset(plan: Any, about: dict, records: dict[str, Any]) -> tuple[dict[str, Group], dict[str, Any]]:
    """The dataset of a plan from its records by run id, whose files lie where a `Store` puts them."""
    laid = Table(plan, {run_id: f"points/{run_id[:2]}/{run_id}.nc" for run_id in records})
    for record in records.values():
        laid.add(record)
    return written(laid, about, [])


def written(laid: Table, about: dict, outside: list[str]) -> tuple[dict[str, Group], dict[str, Any]]:
    """Groups and attributes of the dataset of a table."""
    groups = {"/": laid.root(about["swept"]), "series": laid.series(outside), "grid": laid.grid(), "particles": laid.particles()}
    return groups, attributes(about, laid)


def attributes(about: dict, laid: Table) -> dict[str, Any]:
    """Provenance of the whole."""
    sources = sorted(laid.sources)
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
        "threads": about.get("threads", 1),
        "points": len(laid.plan.cases),
        "started": laid.started,
        "finished": laid.finished,
        "facts": laid.facts,
    }
