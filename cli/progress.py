"""Progress: a bar with the time left on a terminal; plain lines, one a finished point, off it or with CI, NO_COLOR or TERM=dumb."""

import contextlib
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, TextIO

from mpm_cli.talk import end, shown

from mpm.sweep.report import Reporter

LONG = 2.0  # s of compiling that are worth a line of their own
LEAVE = 1.5  # s that a run has to stop after the first signal


def reporter(as_json: bool, quiet: bool) -> Reporter:
    """The reporter that fits the place where a command runs."""
    stream = sys.stderr if as_json else sys.stdout
    if quiet:
        return Plain(sys.stderr, failures_only=True)
    plain = not stream.isatty() or os.environ.get("TERM") == "dumb" or any(os.environ.get(name) for name in ("CI", "NO_COLOR"))
    return Plain(stream) if plain else Bar(stream)


def finished_line(label: str, line: dict, again: bool) -> str:
    """A finished point in a line."""
    name = label or "the point"
    if line["status"] == 0:
        return f"{name}: ok, {line['steps']} steps, {line['wall_time']:.3g} s"
    return f"{name}: {line['error']}" + ("; trying again" if again else "")


class Plain(Reporter):
    """Lines, flushed as they come."""

    def __init__(self, stream: TextIO, failures_only: bool = False):
        self.stream, self.failures_only = stream, failures_only
        self.total = self.done = 0
        self.compiled = ""  # what was last said to be compiled

    def write(self, text: str) -> None:
        """A line, written at once."""
        self.stream.write(shown(text) + "\n")
        self.stream.flush()

    def start(self, total: int, done: int, jobs: int) -> None:
        """How many points there are, and how many are done already."""
        self.total, self.done = total, done
        if not self.failures_only:
            self.write(f"{total} point{'s' * (total != 1)}, {done} already there")

    def finished(self, label: str, line: dict, again: bool) -> None:
        """A line a point, or a failed point."""
        self.done += not again
        if not self.failures_only or line["status"] != 0:
            self.write((f"[{self.done}/{self.total}] " if self.total else "") + finished_line(label, line, again))

    def compiling(self, text: str, expected: float) -> None:
        """Said once of each kernel that takes long; `expected` in seconds."""
        what = text.partition(":")[0].removesuffix(", once on this machine")
        if what and what != self.compiled and expected > LONG and not self.failures_only:
            which = f", kernel {text.rpartition('kernel ')[2].partition(',')[0]}" if "kernel " in text else ""
            self.write(f"{what}{which}, once on this machine: about {expected:.0f} s")
        self.compiled = what or self.compiled

    def note(self, text: str) -> None:
        """A line."""
        self.write(text)


class Bar(Reporter):
    """A rich progress bar: points done, failed, running, time left. Failures are lines above it."""

    def __init__(self, stream: TextIO):
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        self.console = Console(file=stream, highlight=False, soft_wrap=True)
        columns = (SpinnerColumn(), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"), TimeElapsedColumn(), TextColumn("{task.fields[left]}"))
        self.progress = Progress(*columns, console=self.console, transient=True)
        self.done = self.failed = self.total = self.ran = 0
        self.began = time.monotonic()

    def start(self, total: int, done: int, jobs: int) -> None:
        """Show the bar."""
        self.total, self.done = total, done
        self.task = self.progress.add_task("starting workers", total=total, completed=done, left="")
        self.progress.start()
        self.began = time.monotonic()

    def beat(self, running: dict[str, float]) -> None:
        """The bar moves with the fractions of the points that run, and tells how long the rest takes."""
        parts = self.ran + sum(running.values())
        elapsed = time.monotonic() - self.began
        left = f"{clock(elapsed / parts * (self.total - self.done - sum(running.values())))} left" if parts > 0.01 else ""
        failed = f", [red]{self.failed} failed[/red]" if self.failed else ""
        said = f"{len(running)} running{failed}" if running else "starting workers, compiling where needed"
        self.progress.update(self.task, completed=self.done + sum(running.values()), description=said, left=left)

    def finished(self, label: str, line: dict, again: bool) -> None:
        """One more point; a failed one is told above the bar."""
        self.done += not again
        self.ran += not again
        if line["status"] != 0:
            self.failed += not again
            self.say(finished_line(label, line, again))
        self.progress.update(self.task, completed=self.done)

    def compiling(self, text: str, expected: float) -> None:
        """What is compiled, in the bar's own text."""
        if text:
            self.progress.update(self.task, description=text)

    def note(self, text: str) -> None:
        """A line above the bar."""
        self.say(text)

    def say(self, text: str) -> None:
        """A line above the bar, as it is: neither markup nor names of emoji are read from it."""
        self.console.print(shown(text), markup=False, emoji=False)

    def close(self) -> None:
        """The bar stands still."""
        self.progress.stop()


@contextlib.contextmanager
def counter(what: str, as_json: bool, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """A bar for something that is made piece by piece; nothing off a terminal."""
    where = reporter(as_json, quiet)
    if not isinstance(where, Bar):
        yield lambda done, total: None
        return
    with where.progress as bar:
        task = bar.add_task(what, total=None, left="")
        yield lambda done, total: bar.update(task, completed=done, total=total)


def clock(seconds: float) -> str:
    """`1:05:07`, `5:07`."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


class Single:
    """Progress of one run in this process: `beat` for `run_point`; Ctrl-C stops at the next beat, a second one at once."""

    def __init__(self, as_json: bool, quiet: bool):
        self.reporter = reporter(as_json, quiet)
        if isinstance(self.reporter, Bar):
            self.reporter.start(1, 0, 1)
        self.stopped = ""
        self.end: threading.Timer | None = None

    def signal(self, kind: str) -> None:
        """The first stops the run at its next beat, or ends the process after LEAVE seconds; the second is a KeyboardInterrupt at once."""
        if self.stopped:
            raise KeyboardInterrupt
        self.stopped = kind
        self.end = threading.Timer(LEAVE, self.leave)
        self.end.daemon = True
        self.end.start()

    def leave(self) -> None:
        """The run has not come to a place where it can stop (it compiles, or takes one long step): end without it."""
        sys.stderr.write("stopped; what ran since the last checkpoint is lost\n")
        sys.stderr.flush()
        end({"interrupted": 130, "terminated": 143}[self.stopped])

    def note(self, text: str) -> None:
        """Passed on."""
        self.reporter.note(text)

    def close(self) -> None:
        """The run is over, one way or the other."""
        if self.end is not None:
            self.end.cancel()
        self.reporter.close()

    def beat(self, fraction: float, when: float) -> bool:
        """Passed on; true where the run is to stop."""
        self.reporter.beat({"": fraction})
        return bool(self.stopped)

    def compiling(self, text: str, expected: float, took: float) -> None:
        """Passed on; `expected` and `took` in seconds."""
        self.reporter.compiling(text, expected)

    def finished(self, name: str, record: Any, compiled: float) -> None:
        """The record is written; `compiled` seconds went into compiling, which the record's wall time leaves out."""
        self.reporter.finished(name, record.line, False)
        if compiled >= LONG:
            self.reporter.note(f"compiling, once on this machine, took {compiled:.1f} s more")
        if record.advice:
            self.reporter.note(record.advice)
        self.reporter.close()
