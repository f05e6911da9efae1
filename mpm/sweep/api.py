"""What the shell and Python share: `execute` (a sweep to its folder), `run_one` (a point to its dataset; `alone` keeps it in a folder), `collect_folder`.

`sweep` and `run` are the Python face: the same, returning an xarray.DataTree (mpm.notebook adds what a notebook shows).
"""

import io
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

from mpm.records.provenance import cores
from mpm.sweep import engine
from mpm.sweep.background_collect import Gather, NotCollected
from mpm.sweep.case_list import skipped, swept_paths
from mpm.sweep.engine import Engine, Options
from mpm.sweep.folder import signals, sound, taken
from mpm.sweep.lock import Refused
from mpm.sweep.manifest import about_one
from mpm.sweep.queue import Points, counts, exit_code, stale, warned
from mpm.sweep.report import Reporter
from mpm.sweep.result import Result
from mpm.sweep.store import Store
from mpm.sweep.summaries import Summaries

TOLD = 1.0  # s of compiling that are worth a line


def default_out(experiment: Any) -> Path:
    """`results/<config name>`."""
    return Path("results") / experiment.name


def planned(experiment: Any, kind: str = "sweep", max_runs: int = 10_000) -> Any:
    """The points of a `sweep`, or of a `chart` (sweep/settings.py)."""
    from mpm.sweep import cases, settings

    return {"sweep": cases, "chart": settings}[kind].plan(experiment, max_runs=max_runs)


def execute(
    experiment: Any, out: Path | None = None, options: Options | None = None, reporter: Reporter | None = None, max_runs: int = 10_000, kind: str = "sweep"
) -> Result:
    """Run what is missing of a sweep, then collect. Nothing is written before the whole plan is valid. `kind` as in `planned`."""
    options, reporter = options or Options(), reporter or Reporter()
    began = time.monotonic()
    if kind == "sweep" and experiment.sweep is not None and experiment.sweep.refine is not None:
        from mpm.sweep.refine import refine

        return refine(experiment, out or default_out(experiment), options, reporter)
    plan = planned(experiment, kind, max_runs)
    store, points = Store(out or default_out(experiment)), Points.of(plan)
    with taken(store, reporter.note, jobs=options.jobs):
        store.claim(experiment, swept_paths(plan), options.smoke, take_over=options.rerun in ("stale", "all"), kind=kind)
        lines = sound(store, points, reporter.note)
        gather = Gather(store, plan, lines, reporter.note)
        supervisor = Engine(store, points, lines, options, reporter, gather)
        with signals(supervisor.signal):
            try:
                reporter.start(points.total, points.total - int(points.times[supervisor.due.numbers].sum()), options.jobs)
                if others := 0 if options.rerun in ("stale", "all") else len(stale(lines)):
                    reporter.note(f"{others} of the points that are there were made by other source; --rerun stale runs them again")
                if supervisor.due:
                    if warning := supervisor.resources.warning(len(supervisor.due), points.cases[supervisor.due.first].experiment):
                        reporter.note(warning)
                    run_engine(supervisor, options)
            finally:
                reporter.close()
                gather.close()
            collected = collect_last(gather, supervisor)
    found = counts(points, lines, skipped(plan))
    stopped = supervisor.broken or supervisor.stopped
    if supervisor.broken:
        reporter.note(supervisor.broken)
    if supervisor.compiling >= TOLD:
        reporter.note(f"{supervisor.compiling:.1f} s went into compiling, once on this machine")
    code, hurried = exit_code(found, supervisor.stopped), supervisor.signals > 0
    took, told = time.monotonic() - began, warned(points, lines)
    return Result(store.out, lines, found, supervisor.ran, stopped, code, took, collected, hurried, told, supervisor.compiling)


def collect_last(gather: Gather, supervisor: Engine) -> bool:
    """The dataset at the end: whether it was written. Told to leave there are two seconds at most, and the next sweep collects too."""
    heard = supervisor.signals
    if heard > 1 or (heard and not gather.quick):
        return False
    try:
        return gather.last(lambda: supervisor.signals > heard)
    except NotCollected as error:
        supervisor.stopped, supervisor.broken = supervisor.stopped or "broken", str(error)
        return False


def run_engine(supervisor: Engine, options: Options) -> None:
    """Workers for what is due. `jobs=0` runs the points in this process."""
    from mpm.sweep.processes import Processes
    from mpm.sweep.serial import Serial

    if not supervisor.any_can_run():
        return
    if options.jobs == 0:
        supervisor.run(Serial(options.runner, supervisor.heed))
        return
    ahead = (len(supervisor.due) > 1 and options.jobs > 1) or options.timeout is not None  # compiling must not eat a point's time
    first = supervisor.points.cases[supervisor.due.first].experiment.resolved() if ahead or options.scheduler is not None else None
    if options.scheduler is not None:
        from mpm.sweep.cluster import Cluster

        out, memory = supervisor.store.out.resolve(), supervisor.resources.limit
        supervisor.run(Cluster(options.scheduler, options.runner, first, options.shared, out, options.jobs, memory))
        return
    supervisor.run(Processes(min(options.jobs, len(supervisor.due)), options.runner, first, supervisor.resources.limit))


def folder_plan(out: Path) -> tuple[Store, Any, Points, dict, Summaries, list[str]]:
    """A sweep's folder, read back: store, plan, its points, experiment.json, lines, damaged ids."""
    from mpm.config import load

    store = Store(out)
    about = store.experiment()
    if about is None:
        raise Refused(f"{out} holds no sweep (there is no experiment.json); give the folder that `mpm sweep` wrote")
    plan = planned(load(about["resolved"]), about.get("plan", "sweep"), 10**9)
    points = Points.of(plan)
    return store, plan, points, about, *store.lines(points.ids)


def collect_folder(out: Path, target: Path | None = None) -> tuple[Path, bool, dict[str, int]]:
    """Assemble sweep.nc from the points that are there, in the folder or at `target`: its path, whether it was written, counts by status."""
    from mpm.sweep.collect import collect

    store, plan, points, about, lines, _ = folder_plan(out)
    written = collect(store, plan, about, lines, target)
    return target or store.dataset, written, counts(points, lines, skipped(plan))


def run_one(experiment: Any, beat: Callable[[float, float], bool] | None = None, max_runs: int = 10_000, threads: int = 1) -> tuple[bytes, Any]:
    """The first point of an experiment in this process, kept nowhere: the bytes of its dataset, and its record. `threads` share one large run."""
    from mpm.records.netcdf import to_bytes
    from mpm.sweep.cases import plan as plan_of
    from mpm.sweep.collect import dataset
    from mpm.sweep.worker import compute

    case = plan_of(experiment, max_runs=max_runs).cases[0]
    record = compute(case.run_id, lambda: case.experiment, engine.RUNNER, beat, None, threads, config=case.experiment.resolved())
    alone = plan_of(case.experiment)
    return to_bytes(*dataset(alone, about_one(experiment, case, record), {alone.cases[0].run_id: record})), record


def tree_of(source: Any) -> Any:
    """A dataset file or its bytes as an xarray.DataTree in memory."""
    import xarray

    with xarray.open_datatree(io.BytesIO(source) if isinstance(source, bytes) else source, engine="h5netcdf") as tree:
        return tree.load()


def run(experiment: Any, beat: Callable[[float, float], bool] | None = None, threads: int = 1) -> Any:
    """`mpm.run`: the first point as an xarray.DataTree (/, series, grid, particles). A point that fails is `status` 4 with its `error`, not an exception."""
    caution(experiment)
    return tree_of(run_one(experiment, beat, threads=threads)[0])


def caution(experiment: Any) -> None:
    """A Python warning for what is valid in the config and seldom meant; the shell has lines of its own."""
    from mpm.config.cautions import cautions

    level = 1
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "mpm":
        level, frame = level + 1, frame.f_back  # the line that is warned of is the user's
    for text in cautions(experiment):
        warnings.warn(text, stacklevel=level)


def sweep(experiment: Any, out: Path | str | None = None, jobs: int | str = "auto", max_runs: int = 10_000, reporter: Any = None, **more: Any) -> Any:
    """`mpm.sweep`: run what is missing and return the dataset as an xarray.DataTree.

    out    folder; `results/<config name>` unless given
    jobs   worker processes; "auto" is one a core; 0 runs the points in this process
    more   the other fields of `engine.Options`: timeout, retries, time_budget, max_failures, rerun, smoke, scheduler, shared, checkpoint, memory
    Ctrl-C leaves checkpoints of what runs, collects, and raises KeyboardInterrupt; the same call again goes on from them.
    """
    if out is not None and not str(out).strip():
        raise Refused("out is empty; name a folder")
    caution(experiment)
    options = Options(jobs=cores() if jobs == "auto" else int(jobs), **more)
    result = execute(experiment, Path(out) if out is not None else None, options, reporter, max_runs)
    if result.stopped in ("interrupted", "terminated"):
        raise KeyboardInterrupt
    if result.exit_code == 1:
        raise OSError(result.stopped)
    return tree_of(result.out / "sweep.nc")
