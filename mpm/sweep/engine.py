"""Engine: takes the points of a sweep that have no record yet, and gives each one.

    plan -> lock -> claim the folder -> which are missing -> hand out, hear, retry, stop -> collect -> exit code

The engine owns order, retries, time limits and signals; an executor owns processes; the store owns the disk. A point counts when its file
is on disk, so killing the engine at any moment loses only what was running.

Signals   first Ctrl-C: finish what runs, collect; second: stop now. SIGTERM: stop now (running points are lost), collect if that is quick.
"""

import math
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mpm.records.provenance import now, source_hash
from mpm.records.variables import FAILED, KILLED, OK, STATUS, TIMEOUT
from mpm.sweep.executors import Beat, Cancelled, Done, Event, Executor, Lost, Task, Unwritten
from mpm.sweep.report import Reporter, label
from mpm.sweep.store import Store

POLL = 0.2  # s
COLLECT = 30.0  # least seconds between two datasets while running; 20 times the cost of one, if that is more
GRACE = 2.0  # s that a point over its time has to stop by itself
KILLED_AGAIN = 3  # retries of a point whose worker died, unless told
RUNNER = "mpm.runner"  # the module that computes: run_point, warm, estimate
EXIT = {"interrupted": 130, "terminated": 143, "budget": 75}


@dataclass(frozen=True)
class Options:
    """How to sweep. Times in seconds; None means no limit.

    retries    for killed and timed-out points only, as a model's own failure repeats; None: 3 for killed, 0 for timed out
    rerun      None (only what has no record), "failed" (and what is not ok), "stale" (and what other source made), "all"
    """

    jobs: int = 1
    timeout: float | None = None
    retries: int | None = None
    time_budget: float | None = None
    max_failures: int | None = None
    rerun: str | None = None
    smoke: bool = False
    runner: str = field(default_factory=lambda: RUNNER)


@dataclass
class Result:
    """What a sweep came to."""

    out: Any
    lines: dict[str, dict]
    counts: dict[str, int]
    ran: int
    stopped: str
    exit_code: int
    seconds: float
    collected: bool = False


@dataclass
class Points:
    """The points of a plan by run id: equal points are one."""

    cases: dict[str, Any]
    total: int
    counts: Counter = field(default_factory=Counter)

    @classmethod
    def of(cls, plan: Any) -> "Points":
        cases: dict[str, Any] = {}
        for case in plan.cases:
            cases.setdefault(case.run_id, case)
        return cls(cases, len(plan.cases), Counter(case.run_id for case in plan.cases))


def missing(points: Points, lines: dict[str, dict], rerun: str | None) -> list[str]:
    """Run ids that are to run, in the plan's order."""
    source = source_hash() if rerun == "stale" else ""

    def due(run_id: str) -> bool:
        line = lines.get(run_id)
        if line is None or rerun == "all":
            return True
        return (rerun == "failed" and line["status"] != OK) or (rerun == "stale" and line["source"] != source)

    return [run_id for run_id in points.cases if due(run_id)]


class Engine:
    """One pass over the points that are due."""

    def __init__(self, store: Store, points: Points, lines: dict[str, dict], options: Options, reporter: Reporter, partial: Callable[[], None]):
        self.store, self.points, self.lines, self.options, self.reporter = store, points, lines, options, reporter
        self.partial = partial  # collects what is there; called now and then
        self.due: deque[str] = deque(missing(points, lines, options.rerun))
        self.running: dict[str, float] = {}  # run id -> start (monotonic)
        self.fractions: dict[str, float] = {}
        self.attempts: Counter = Counter()
        self.asked: dict[str, float] = {}  # run id -> when it was asked to stop
        self.failures = self.ran = self.signals = 0
        self.stopped = self.broken = ""
        self.began = self.collected = time.monotonic()
        self.cost = 0.0
        self.executor: Executor | None = None

    def signal(self, kind: str) -> None:
        """A signal came: "interrupted" or "terminated". Safe to call from a handler."""
        self.signals += 2 if kind == "terminated" else 1
        self.stopped = kind

    def run(self, executor: Executor) -> None:
        """Until every due point has a record, or something stops the sweep."""
        self.executor = executor
        try:
            while (self.due and not self.stopped) or self.running:
                executor.wanted = len(self.running) + (0 if self.stopped else len(self.due))
                while executor.free and self.due and not self.stopped:
                    self.hand_out(executor)
                if self.stopped and (self.signals > 1 or self.stopped != "interrupted"):
                    break
                for event in executor.poll(POLL):
                    self.hear(event)
                self.look_at_the_clock()
        finally:
            executor.close()
        for run_id in list(self.running):  # stopped, but a record may have reached the disk before its news reached us
            self.leave(run_id)
            self.news(run_id)

    def hand_out(self, executor: Executor) -> None:
        """Start the next point."""
        run_id = self.due.popleft()
        self.attempts[run_id] += 1
        self.running[run_id] = time.monotonic()
        executor.submit(Task(run_id, self.points.cases[run_id].experiment.resolved(), str(self.store.out), self.attempts[run_id]))

    def hear(self, event: Event) -> None:
        """One event of the executor."""
        if isinstance(event, Beat):
            self.heed(event)
        elif isinstance(event, Done):
            self.leave(event.run_id)
            self.finish(event.run_id, event.line)
        elif isinstance(event, Lost):
            asked = self.leave(event.run_id)
            self.lost(event.run_id, f"no answer after {self.options.timeout:g} s" if asked else event.why, TIMEOUT if asked else KILLED)
        elif isinstance(event, Cancelled):
            self.leave(event.run_id)
        elif isinstance(event, Unwritten):
            self.leave(event.run_id)
            self.stopped = self.stopped or "broken"
            self.broken = f"{event.why}; finished points are kept, run the same command again when there is room"
        else:
            self.reporter.note(event.text)

    def heed(self, beat: Beat) -> None:
        """A point is alive. (`Serial` calls this from inside the point, so it must also keep the clock.)"""
        self.fractions[beat.run_id] = beat.fraction
        self.look_at_the_clock()

    def leave(self, run_id: str) -> bool:
        """A point runs no more; whether it had been asked to stop."""
        self.running.pop(run_id, None)
        self.fractions.pop(run_id, None)
        return self.asked.pop(run_id, None) is not None

    def news(self, run_id: str) -> bool:
        """Whether the disk has a record of this point that we have not heard of; if so it counts."""
        found, _ = self.store.lines([run_id])
        if not found or found[run_id] == self.lines.get(run_id):
            return False
        self.finish(run_id, found[run_id])
        return True

    def lost(self, run_id: str, why: str, status: int) -> None:
        """The worker died under a point: the engine writes its record, unless the worker still had."""
        from mpm.records.point import Record

        if self.news(run_id):
            return
        record = Record(run_id, status, f"{STATUS[status]}: {why}", attempts=self.attempts[run_id], source=source_hash(), finished=now())
        self.store.save(record)
        self.finish(run_id, record.line)

    def finish(self, run_id: str, line: dict) -> None:
        """A record is on disk: count it, or try the point again."""
        status = line["status"]
        self.lines[run_id] = line
        self.ran += 1
        retries = self.options.retries if self.options.retries is not None else {KILLED: KILLED_AGAIN}.get(status, 0)
        again = status in (KILLED, TIMEOUT) and self.attempts[run_id] <= retries and not self.stopped
        if again:
            self.due.append(run_id)
        self.failures += status != OK and not again
        self.reporter.finished(label(self.points.cases[run_id]), line, again)
        if self.options.max_failures is not None and self.failures >= self.options.max_failures and (self.due or self.running):
            self.stopped = self.stopped or "failures"

    def look_at_the_clock(self) -> None:
        """Time limits, progress, a dataset of what is there."""
        clock, options = time.monotonic(), self.options
        if options.time_budget is not None and clock - self.began > options.time_budget and not self.stopped:
            self.stopped = "budget"
        if self.stopped and (self.signals > 1 or self.stopped != "interrupted"):
            for run_id in self.running:
                self.executor.cancel(run_id, "cancel")
        for run_id, start in self.running.items():
            if options.timeout is not None and clock - start > options.timeout and run_id not in self.asked:
                self.asked[run_id] = clock
                self.executor.cancel(run_id, "timeout")
            elif run_id in self.asked and clock - self.asked[run_id] > GRACE:
                self.asked[run_id] = math.inf
                self.executor.kill(run_id)
        self.reporter.beat({run_id: self.fractions.get(run_id, 0.0) for run_id in self.running})
        if clock - self.collected > max(COLLECT, 20 * self.cost) and self.ran:
            self.partial()
            self.collected = time.monotonic()
            self.cost = self.collected - clock


def counts(points: Points, lines: dict[str, dict], skipped: int) -> dict[str, int]:
    """Points by status; equal points count each."""
    found = Counter({name: 0 for name in STATUS})
    for run_id, times in points.counts.items():
        found[STATUS[lines[run_id]["status"]] if run_id in lines else "pending"] += times
    found["skipped"] += skipped
    return dict(found)


def exit_code(found: dict[str, int], stopped: str) -> int:
    """interface.md section 2."""
    if stopped in EXIT:
        return EXIT[stopped]
    bad = sum(found[STATUS[status]] for status in (FAILED, TIMEOUT, KILLED)) + found["diverged"]
    if stopped == "broken":
        return 1
    return 0 if not bad else 4 if not found["ok"] and not found["pending"] else 3
