"""Rounds: points that are asked for a few at a time, as a fit does, each a point of an ordinary sweep in one folder: on disk, resumed, never run twice.

    with Rounds(experiment, paths, out, options, reporter) as rounds:
        records = rounds.run([(0.35, 13.1), (0.36, 13.1)])       one Record a point, in order, from disk or run now; `Stopped` when told to stop
    rounds.collect()                                             OUT/sweep.nc of every point asked for

The folder is locked and the workers live as long as the block, so that a round of two points costs milliseconds and not the start of processes.
"""

import contextlib
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpm.config.sweep import Sweep
from mpm.sweep.case_list import skipped, swept_paths
from mpm.sweep.cases import plan as plan_of
from mpm.sweep.engine import Engine, Options
from mpm.sweep.folder import signals, sound, taken
from mpm.sweep.manifest import claimed
from mpm.sweep.queue import EXIT, Points, counts
from mpm.sweep.report import Reporter
from mpm.sweep.store import Store

MOST_RUNS = 10**6


class Stopped(Exception):
    """The rounds were told to stop: Ctrl-C, SIGTERM, the time budget, or no more can be written. `code` as of a sweep."""

    def __init__(self, why: str, said: str = ""):
        super().__init__(said or why)
        self.why, self.code = why, EXIT.get(why, 1)


class Kept:
    """An executor whose workers stay between two engines."""

    def __init__(self, inner: Any):
        self.inner = inner

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "inner":
            object.__setattr__(self, name, value)
        else:
            setattr(self.inner, name, value)

    def close(self) -> None:
        """Not yet."""


class Rounds:
    """Points over `paths` of an experiment that has no sweep of its own."""

    def __init__(self, experiment: Any, paths: Sequence[str], out: Path, options: Options | None = None, reporter: Reporter | None = None,
                 derive: dict[str, str] | None = None, axis: bool = False):  # fmt: skip
        self.experiment, self.paths = experiment.model_copy(update={"sweep": None}), tuple(paths)
        self.experiment._placed(experiment)
        self.refine = experiment.sweep and experiment.sweep.refine
        self.derive, self.axis = derive or {}, axis  # axis: the one path is a dimension of its own in the dataset
        self.options, self.reporter = options or Options(), reporter or Reporter()
        self.store, self.ran, self.compiling = Store(out), 0, 0.0
        self.asked: dict[str, tuple[float, ...]] = {}
        self.executor: Any = None
        self.stack = contextlib.ExitStack()
        self.engine: Engine | None = None
        self.stopped, self.began = "", time.monotonic()

    def __enter__(self) -> "Rounds":
        self.stack.enter_context(taken(self.store, self.reporter.note, jobs=self.options.jobs))
        self.stack.enter_context(signals(self.heard))
        self.stack.callback(self.reporter.close)
        self.stack.callback(lambda: self.executor and self.executor.inner.close())
        return self

    def __exit__(self, *error: Any) -> None:
        self.stack.close()

    def heard(self, kind: str) -> None:
        """A signal: the engine that runs hears it, and no further round begins."""
        self.stopped = kind
        if self.engine is not None:
            self.engine.signal(kind)

    def heed(self, beat: Any) -> None:
        """A beat of a point in this process goes to the engine of its round."""
        if self.engine is not None:
            self.engine.heed(beat)

    def sweep(self, points: Sequence[Sequence[float]]) -> Any:
        """The experiment with these points alone."""
        return self.with_sweep(Sweep(points=tuple(dict(zip(self.paths, map(float, point), strict=True)) for point in points), derive=self.derive))

    def with_sweep(self, listed: Sweep) -> Any:
        """The experiment with a sweep."""
        made = self.experiment.model_copy(update={"sweep": listed})
        made._placed(self.experiment)
        return made

    def run(self, points: Sequence[Sequence[float]]) -> list[Any]:
        """A record for each point."""
        if self.stopped:
            raise Stopped(self.stopped)
        experiment = self.sweep(points)
        plan = plan_of(experiment, max_runs=MOST_RUNS)
        if not self.asked:
            self.store.claim(experiment, swept_paths(plan), self.options.smoke, take_over=self.options.rerun in ("stale", "all"), kind="sweep", join=True)
        ids = [case.run_id for case in plan.cases]
        self.asked |= {run_id: tuple(map(float, point)) for run_id, point in zip(ids, points, strict=True)}
        listed = Points.of(plan)
        lines = sound(self.store, listed, self.reporter.note)
        self.engine = engine = Engine(self.store, listed, lines, self.budgeted(), self.reporter)
        if engine.due:
            try:
                self.work(engine, plan)
            finally:
                self.ran, self.compiling = self.ran + engine.ran, self.compiling + engine.compiling
        self.stopped = self.stopped or engine.stopped
        found = {run_id: record for run_id, record in self.store.load_all(list(dict.fromkeys(ids)), fields=False)}
        if engine.broken:
            raise Stopped("broken", engine.broken)
        if any(run_id not in found for run_id in ids):
            raise Stopped(self.stopped or "broken", "" if self.stopped else "a point has no record")
        return [found[run_id] for run_id in ids]

    def budgeted(self) -> Options:
        """The options, with what is left of the time."""
        from dataclasses import replace

        budget = self.options.time_budget
        return self.options if budget is None else replace(self.options, time_budget=max(0.0, budget - (time.monotonic() - self.began)))

    def work(self, engine: Engine, plan: Any) -> None:
        """Run what is due, with the workers that are there."""
        from mpm.sweep.processes import Processes
        from mpm.sweep.serial import Serial

        options = self.options
        if not engine.any_can_run():
            return
        if self.executor is None:
            first = plan.cases[0].experiment.resolved()
            if options.jobs == 0:
                self.executor = Kept(Serial(options.runner, self.heed))
            elif options.scheduler is not None:
                from mpm.sweep.cluster import Cluster

                out = self.store.out.resolve()
                self.executor = Kept(Cluster(options.scheduler, options.runner, first, options.shared, out, options.jobs, engine.resources.limit))
            else:
                self.executor = Kept(Processes(options.jobs, options.runner, first, engine.resources.limit))
        engine.run(self.executor)

    def all(self) -> Any:
        """The experiment with every point that was asked for, each once."""
        points = list(self.asked.values())
        made = self.with_sweep(Sweep(axes={self.paths[0]: [value for (value,) in sorted(points)]}, derive=self.derive)) if self.axis else self.sweep(points)
        made.sweep.__dict__["refine"] = self.refine  # the dataset tells what it follows
        return made

    def collect(self) -> tuple[Any, dict[str, int]]:
        """OUT/sweep.nc of every point asked for: the plan, and counts by status."""
        from mpm.sweep.collect import collect

        experiment = self.all()
        plan = plan_of(experiment, max_runs=MOST_RUNS)
        self.store.claim(experiment, swept_paths(plan), self.options.smoke, take_over=False)
        points = Points.of(plan)
        lines, _ = self.store.lines(points.ids)
        collect(self.store, plan, claimed(self.store.out), lines)
        return plan, counts(points, lines, skipped(plan))
