"""Executors: where points run. One interface, so that a cluster can stand beside `Serial` and `Processes`.

    submit(task)            start a point; only while `free` > 0
    poll(timeout) -> list   what happened since: Started, Beat, Done, Cancelled, Lost, Unwritten, Note; returns early when something did
    cancel(run_id, why)     ask a point to stop at its next beat: "timeout" keeps what it has as a record, "cancel" keeps nothing
    kill(run_id)            end it now; `Lost` follows
    close()                 end all workers

An executor knows nothing of retries, order or progress: that is the engine's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol


class BrokenWorkers(Exception):
    """Workers end before they are ready: nothing can run. The text holds what they said."""


@dataclass(frozen=True)
class Task:
    """A point to run: its config as plain JSON, and where its record goes."""

    run_id: str
    config: dict
    out: str
    attempt: int = 1


@dataclass(frozen=True)
class Beat:
    """A point is alive; fraction done, simulated time [s]."""

    run_id: str
    fraction: float
    time: float


@dataclass(frozen=True)
class Done:
    """A point's record is on disk; `line` is its summary."""

    run_id: str
    line: dict


@dataclass(frozen=True)
class Cancelled:
    """A point stopped as asked and left no record."""

    run_id: str


@dataclass(frozen=True)
class Lost:
    """The worker died with this point."""

    run_id: str
    why: str


@dataclass(frozen=True)
class Unwritten:
    """The point ran but its record could not be written: the disk's fault, not the point's."""

    run_id: str
    why: str


@dataclass(frozen=True)
class Note:
    """Something to tell the user."""

    text: str


Event = Beat | Done | Cancelled | Lost | Unwritten | Note


class Executor(Protocol):
    """What the engine asks of any place to run points."""

    wanted: int  # workers worth having now; fewer points left need fewer workers

    @property
    def free(self) -> int: ...
    def submit(self, task: Task) -> None: ...
    def poll(self, timeout: float) -> list[Event]: ...
    def cancel(self, run_id: str, why: str) -> None: ...
    def kill(self, run_id: str) -> None: ...
    def close(self) -> None: ...


class Serial:
    """Points one after another in this process: for a debugger, for coverage, for tests. A crash takes the sweep with it.

    `heed(event)` sees every beat, as `poll` does not return while a point runs; it may call `cancel`.
    """

    def __init__(self, runner: str, heed: Callable[[Beat], None]):
        self.runner = runner
        self.heed = heed
        self.wanted = 1
        self.task: Task | None = None
        self.stop = ""

    @property
    def free(self) -> int:
        """1 when nothing waits."""
        return int(self.task is None)

    def submit(self, task: Task) -> None:
        """Take a point; it runs in `poll`."""
        self.task, self.stop = task, ""

    def poll(self, timeout: float) -> list[Event]:
        """Run the point that waits."""
        from mpm.sweep.worker import perform

        if self.task is None:
            return []
        task = self.task

        def beat(fraction: float, time: float) -> str:
            self.heed(Beat(task.run_id, fraction, time))
            return self.stop

        message = perform(task, self.runner, beat)
        self.task = None
        return [event(message)]

    def cancel(self, run_id: str, why: str) -> None:
        """Stop the running point at its next beat."""
        if self.task is not None and self.task.run_id == run_id:
            self.stop = why

    def kill(self, run_id: str) -> None:
        """As `cancel`: there is no other process to end."""
        self.cancel(run_id, "cancel")

    def close(self) -> None:
        """Nothing to end."""


def event(message: dict[str, Any]) -> Event:
    """A worker's message as an event."""
    kind, run_id = message["is"], message.get("run_id", "")
    if kind == "beat":
        return Beat(run_id, message["fraction"], message["time"])
    if kind == "done":
        return Done(run_id, message["line"])
    if kind == "cancelled":
        return Cancelled(run_id)
    if kind == "unwritten":
        return Unwritten(run_id, message["why"])
    return Note(message["text"])
