"""Alone: one point of an experiment, in this process, to OUT/run.nc.

The folder is that of a sweep, with the same rules: one writer, one experiment, a finished point is finished, a stopped one goes on from its checkpoint.
So a sweep over the same folder finds the points that were run alone, and the other way round.
"""

import hashlib
import importlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpm.records.checkpoint import EVERY, Checkpoint
from mpm.records.netcdf import DamagedFile, summary
from mpm.records.variables import PENDING, STATUS
from mpm.sweep import engine
from mpm.sweep.case_list import swept_paths
from mpm.sweep.folder import sound, taken
from mpm.sweep.lock import Refused
from mpm.sweep.manifest import about_one
from mpm.sweep.queue import Points, missing, stale
from mpm.sweep.report import label
from mpm.sweep.resources import Resources
from mpm.sweep.store import Store


@dataclass
class One:
    """What came of it."""

    record: Any
    dataset: Path
    ran: bool  # False where it was finished before
    label: str = ""  # its swept values
    kept: bool = False  # it was stopped, and a checkpoint is there to go on from


def run_in(
    experiment: Any,
    out: Path,
    beat: Callable[[float, float], bool],
    note: Callable[[str], None],
    *,
    rerun: str | None = None,
    every: float = EVERY,
    threads: int = 1,
    smoke: bool = False,
    max_runs: int = 10_000,
) -> One:
    """Run the first point of an experiment unless it is there, and write its dataset.

    beat     called with (fraction, time); whether to stop: the point then stays due, and its dataset has what it came to, `pending`
    note     hears what a user should know
    rerun    as in `engine.Options`
    every    seconds between two checkpoints
    """
    from mpm.sweep.cases import plan as plan_of
    from mpm.sweep.worker import compute

    plan = plan_of(experiment, max_runs=max_runs)
    case, store = plan.cases[0], Store(out)
    if (rerun or not store.places([case.run_id])) and (refuse := getattr(importlib.import_module(engine.RUNNER), "refuse", None)):
        refuse(case.experiment)
    points = Points.of(plan_of(case.experiment))
    with taken(store, note):
        store.claim(experiment, swept_paths(plan), smoke, take_over=rerun in ("stale", "all") and not store.dataset.exists(), join=True)
        lines = sound(store, points, note)
        if not len(missing(points, lines, rerun)):
            if len(stale(lines)):
                note("the point that is there was made by other source; --rerun stale runs it again")
            record = store.load(case.run_id)
            return One(record, write(store, experiment, case, record, smoke), False, label(case))
        if rerun == "all":
            store.forget([case.run_id])
        room = Resources(store.out, None, far=False)
        if refusal := room.refusal(room.need(case.experiment)):
            raise Refused(f"the point {refusal}; a coarser grid.cell, fewer particles a cell or fewer snapshots need less")
        keeper = Checkpoint(store.checkpoint(case.run_id), case.run_id, every, note)
        record = compute(case.run_id, lambda: case.experiment, engine.RUNNER, beat, keeper, threads, config=case.experiment.resolved())
        if record.outcome == "budget":
            record.status, record.error = PENDING, record.error.replace(STATUS[record.status], STATUS[PENDING], 1)
            return One(record, store.out / "run.nc" if whole(store) else write(store, experiment, case, record, smoke), True, label(case), keeper.there)
        store.save(record)
        keeper.drop()
        return One(record, write(store, experiment, case, record, smoke), True, label(case))


def whole(store: Store) -> bool:
    """Whether run.nc holds a point that is finished, which one that was stopped must not replace."""
    try:
        line = summary(store.out / "run.nc")
    except DamagedFile:
        return False
    return line is not None and line.get("status") != PENDING


def write(store: Store, experiment: Any, case: Any, record: Any, smoke: bool) -> Path:
    """OUT/run.nc of a record, unless it holds just this already."""
    from mpm.sweep.cases import plan as plan_of
    from mpm.sweep.collect import dataset, put

    path, about = store.out / "run.nc", about_one(experiment, case, record, smoke)
    digest = hashlib.sha256(json.dumps([about, record.line], sort_keys=True).encode()).hexdigest()
    try:
        old = summary(path)
    except DamagedFile:
        old = None
    if old is None or old.get("digest") != digest:
        put(path, *dataset(plan_of(case.experiment), about, {case.run_id: record}), record.line | {"digest": digest})
    return path
