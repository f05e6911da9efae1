"""Engine: takes the points of a sweep that have no record yet, and gives each one.

    plan -> lock -> claim the folder -> which are missing -> hand out, hear, retry, stop -> collect -> exit code

The engine owns order, retries, time limits and signals; an executor owns processes; the store owns the disk. A point counts when its file
is on disk, so killing the engine at any moment loses only what was running.

Stopping  by Ctrl-C, SIGTERM, the time budget or too many failures: what runs has LEAVE seconds to end or to leave a checkpoint; then collect, where
          that is quick. A second signal: stop now. The same command again goes on from the checkpoints.
"""

import math
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

from mpm import compiling
from mpm.records.checkpoint import EVERY
from mpm.records.provenance import now, source_hash
from mpm.records.variables import FAILED, KILLED, MEMORY, OK, STATUS, TIMEOUT
from mpm.sweep.background_collect import Gather
from mpm.sweep.batch_size import BatchSize
from mpm.sweep.executors import Beat, Compiling, Done, Event, Executor, Job, Lost, Note, Task
from mpm.sweep.queue import Configs, Due, Points, missing
from mpm.sweep.report import Reporter, label
from mpm.sweep.resources import ADVICE, Resources
from mpm.sweep.store import Store
from mpm.sweep.summaries import Summaries

POLL, LEAVE, GRACE = 0.2, 1.0, 2.0  # s: between two looks; for points to leave a checkpoint when the sweep is stopped; for one over its time to stop
KILLED_AGAIN = 3  # retries of a point whose worker died, unless told
RUNNER = "mpm.runner"  # the module that computes: run_point, warm, estimate


@dataclass(frozen=True)
class Options:
    """How to sweep. Times in seconds; None means no limit.

    retries    for killed and timed-out points only, as a model's own failure repeats; None: 3 for killed, 0 for timed out
    rerun      None (only what has no record), "failed" (and what is not ok), "stale" (and what other source made), "all"
    scheduler  a Dask scheduler's address, or "local" for one of this machine with `jobs` workers; None: processes of our own
    memory     most bytes a point may take; None: what is free
    shared     its workers write into the sweep's folder, which all of them see; otherwise records come over the wire
    checkpoint seconds between two checkpoints of a running point; 0: none
    """

    jobs: int = 1
    timeout: float | None = None
    retries: int | None = None
    time_budget: float | None = None
    max_failures: int | None = None
    rerun: str | None = None
    smoke: bool = False
    scheduler: str | None = None
    shared: bool = False
    checkpoint: float = EVERY
    memory: float | None = None
    runner: str = field(default_factory=lambda: RUNNER)


@dataclass
class Running:
    """A task that a worker has."""

    task: Task
    start: float  # monotonic [s]
    asked: float = math.nan  # when it was asked to stop; infinite once it was killed
    fraction: float = 0.0


class Engine:
    """One pass over the points that are due."""

    def __init__(self, store: Store, points: Points, lines: Summaries, options: Options, reporter: Reporter, gather: Gather | None = None):
        self.store, self.points, self.lines, self.options, self.reporter, self.gather = store, points, lines, options, reporter, gather
        self.due = Due(points.ids, missing(points, lines, options.rerun))
        if options.rerun == "all":
            store.forget(self.due)
        self.alone: set[str] = store.own(self.due)  # also points that died, or were in a batch that died or overran
        self.running: dict[str, Running] = {}  # by the task's id
        self.attempts: Counter = Counter()
        self.batch_size, self.names, self.configs = BatchSize(), store.batch_names(), Configs(points)
        self.failures = self.ran = self.signals = 0
        self.told: list[dict] = []  # summaries of points that are done, to be counted once the next are handed out
        self.stopped = self.broken = ""
        self.compiling, self.asked = 0.0, math.nan  # s that workers spent on compiling; when all that runs was asked to leave
        self.began = time.monotonic()
        self.executor: Executor  # from `run` on
        self.resources = Resources(store.out, options.memory, far=options.scheduler not in (None, "local"))

    def signal(self, kind: str) -> None:
        """A signal came: "interrupted" or "terminated". Safe to call from a handler."""
        self.signals += 1
        self.stopped = kind

    def run(self, executor: Executor) -> None:
        """Until every due point has a record, or something stops the sweep."""
        self.executor = executor
        with compiling.say(self.heed_compiling):  # of `Serial`, which runs points in this process
            self.until_done(executor)
        self.settle()
        for gone in list(self.running.values()):  # stopped, but records may have reached the disk before their news reached us
            self.news(gone.task)
        self.running.clear()

    def until_done(self, executor: Executor) -> None:
        """Hand out and hear, until nothing is due and nothing runs, or the sweep is stopped."""
        try:
            while (self.due and not self.stopped) or self.running:
                executor.wanted = len(self.running) + (0 if self.stopped else len(self.due))
                while executor.free and self.due and not self.stopped and self.hand_out(executor):
                    pass
                self.settle()
                if self.stopped and self.left(executor):
                    break
                if not (executor.free or self.stopped):
                    self.configs.make(islice(self.due, self.batch_size.last))
                for event in executor.poll(POLL):
                    self.hear(event)
                self.look_at_the_clock()
        finally:
            executor.close()

    def left(self, executor: Executor) -> bool:
        """The sweep is stopped: ask what runs to leave; whether there is no more time for that."""
        if math.isnan(self.asked):
            self.asked = time.monotonic()
            for task in self.running:
                executor.cancel(task, "cancel")
            if self.gather is not None and self.signals:
                self.gather.prepare()
        return self.signals > 1 or time.monotonic() - self.asked > LEAVE

    def hand_out(self, executor: Executor) -> bool:
        """Start the next point, or the next few where they are tiny. False where it has to wait for those that run."""
        size = 1 if self.due.first in self.alone else self.batch_size.batch(len(self.due), len(self.running) + executor.free)
        if self.options.max_failures is not None:
            size = min(size, self.options.max_failures - self.failures)  # none runs after the last failure that is allowed
        first = self.points.cases[self.due.first].experiment
        need = self.resources.need(first)  # of a batch, the first speaks for all: they are tiny
        if self.refused(need):
            return True
        if not self.resources.fits(need) or not self.on_disk(size, first):
            return False
        run_ids = [self.due.take()]
        while len(run_ids) < size and self.due and self.due.first not in self.alone:
            run_ids.append(self.due.take())
        self.attempts.update(run_ids)
        jobs = tuple(Job(run_id, self.configs.take(run_id), self.attempts[run_id]) for run_id in run_ids)
        seen = self.options.checkpoint if self.options.scheduler in (None, "local") or self.options.shared else 0.0  # elsewhere a folder would not last
        task = Task(jobs, str(self.store.out.resolve()), next(self.names) if len(jobs) > 1 else "", seen)
        self.running[task.id] = Running(task.sent, time.monotonic())
        self.resources.given[task.id] = need
        executor.submit(task)
        return True

    def refused(self, need: int) -> bool:
        """Whether the next point needs more memory than there is; it has its record then."""
        if refusal := self.resources.refusal(need):
            self.attempts[self.due.first] += 1
            self.record(self.due.take(), FAILED, refusal, MEMORY, ADVICE)
        return bool(refusal)

    def any_can_run(self) -> bool:
        """Whether anything is left to start workers for, once the points at the front that need too much memory are refused."""
        while self.due and not self.stopped and self.refused(self.resources.need(self.points.cases[self.due.first].experiment)):
            pass
        return bool(self.due) and not self.stopped

    def on_disk(self, size: int, experiment: Any) -> bool:
        """Whether the disk has room for so many points more; where nothing runs that could end, the sweep stops."""
        why = self.resources.short(size + sum(len(at.task.jobs) for at in self.running.values()), experiment)
        if why and not self.running:
            self.stop_for_the_disk(why)
        return not why

    def stop_for_the_disk(self, why: str) -> None:
        """No more can be written."""
        self.stopped = self.stopped or "broken"
        self.broken = f"{why}; finished points are kept, run the same command again when there is room"

    def hear(self, event: Event) -> None:
        """One event of the executor."""
        if isinstance(event, Beat):
            self.heed(event)
        elif isinstance(event, Note):
            self.reporter.note(event.text)
        elif isinstance(event, Compiling):
            self.heed_compiling(event.text, event.expected, event.took)
        elif (gone := self.running.pop(event.task, None)) is None:
            return  # told twice, as a cluster may
        else:
            self.resources.given.pop(event.task, None)
            if isinstance(event, Done):
                self.done(gone, event)
            elif isinstance(event, Lost):
                self.lost(gone, event)
            else:
                self.stop_for_the_disk(event.why)

    def heed_compiling(self, text: str, expected: float, took: float) -> None:
        """A worker compiles."""
        self.compiling += took
        self.reporter.compiling(text, expected)

    def heed(self, beat: Beat) -> None:
        """A task is alive. (`Serial` calls this from inside the point, so it must also keep the clock.)"""
        if (at := self.running.get(beat.task)) is not None and len(at.task.jobs) == 1:
            at.fraction = beat.fraction
        self.look_at_the_clock()

    def done(self, gone: Running, event: Done) -> None:
        """A task is over: its records count, and what it left is due again, point by point."""
        if event.lines:
            self.batch_size.heard(time.monotonic() - gone.start, len(event.lines))
        self.told += event.lines
        if len(gone.task.jobs) == 1 or event.left or self.options.max_failures is not None:  # what is handed out next may depend on them
            self.settle()
        if event.left:
            missed = self.news(gone.task)
            self.again(run_id for run_id in event.left if run_id in missed)

    def settle(self) -> None:
        """Count what is done."""
        while self.told:
            self.finish(self.told.pop(0))

    def again(self, run_ids: Iterable[str]) -> None:
        """Points that ran in vain, through no fault that is known to be theirs: next, alone, and not as another attempt."""
        for run_id in reversed(list(run_ids)):
            self.attempts[run_id] -= 1
            self.alone.add(run_id)
            self.due.front.appendleft(run_id)

    def news(self, task: Task) -> list[str]:
        """Count what the disk has of a task that we have not heard of; the points of which it has nothing."""
        run_ids = [job.run_id for job in task.jobs]
        fresh = {line["run_id"]: line for line in self.store.news(run_ids, task.batch) if line != self.lines.get(line["run_id"])}
        for line in fresh.values():
            self.finish(line)
        return [run_id for run_id in run_ids if run_id not in fresh]

    def lost(self, gone: Running, event: Lost) -> None:
        """The worker died under a task: the engine writes the record of a point that was alone, unless the worker still had."""
        missed = self.news(gone.task)
        if len(gone.task.jobs) > 1:
            self.again(missed)
            return
        for run_id in missed:
            if math.isnan(gone.asked):
                self.record(run_id, KILLED, event.why, MEMORY if event.memory else "")
            else:
                self.record(run_id, TIMEOUT, f"no answer after {self.options.timeout:g} s")

    def record(self, run_id: str, status: int, why: str, outcome: str = "", advice: str = "") -> None:
        """The record of a point that no worker could write."""
        from mpm.records.point import Record

        said = f"{STATUS[status]}: {why}"
        record = Record(run_id, status, said, outcome, advice, attempts=self.attempts[run_id], source=source_hash(), finished=now())
        self.store.save(record)
        self.finish(record.line)

    def finish(self, line: dict) -> None:
        """A record is on disk: count it, or try the point again."""
        run_id, status = line["run_id"], line["status"]
        self.lines[run_id] = line
        self.ran += 1
        retries = self.options.retries if self.options.retries is not None else {KILLED: KILLED_AGAIN}.get(status, 0)
        again = status in (KILLED, TIMEOUT) and line["outcome"] != MEMORY and self.attempts[run_id] <= retries and not self.stopped
        if again:
            self.alone.add(run_id)
            self.due.back.append(run_id)
        else:
            self.attempts.pop(run_id, None)
        self.failures += status != OK and not again
        self.reporter.finished(label(self.points.cases[run_id]), line, again)
        if self.options.max_failures is not None and self.failures >= self.options.max_failures and (self.due or self.running):
            self.stopped = self.stopped or "failures"

    def look_at_the_clock(self) -> None:
        """Time limits, progress, a dataset of what is there."""
        clock, options = time.monotonic(), self.options
        if options.time_budget is not None and clock - self.began > options.time_budget and not self.stopped:
            self.stopped = "budget"
        for task, at in self.running.items():
            if self.stopped:
                self.executor.cancel(task, "cancel")
            elif options.timeout is not None and clock - at.start > options.timeout and math.isnan(at.asked):
                at.asked = clock
                self.executor.cancel(task, "timeout" if len(at.task.jobs) == 1 else "cancel")
            elif clock - at.asked > GRACE:
                at.asked = math.inf
                self.executor.kill(task, "")
        self.reporter.beat({task: at.fraction for task, at in self.running.items()})
        if self.gather is not None:
            self.gather.now_and_then(self.ran)
