"""Executors: where points run. One interface, so that a cluster can stand beside `Serial` and `Processes`.

    submit(task)            start a task, one point or a batch of tiny ones; only while `free` > 0
    poll(timeout) -> list   what happened since: Beat, Done, Lost, Unwritten, Note; returns early when something did
    cancel(task, why)       ask a task, by its id, to stop at its next beat: "timeout" keeps what the point has as a record, "cancel" keeps nothing of it
    kill(task, why)         end it now; `Lost` follows
    close()                 end all workers

An executor knows nothing of retries, order or progress: that is the engine's.
"""

import functools
import json
from dataclasses import dataclass, replace
from typing import Any, Protocol


class BrokenWorkers(Exception):
    """Workers end before they are ready: nothing can run. The text holds what they said."""


@dataclass(frozen=True)
class Job:
    """A point to run: its config as JSON text, which is made ahead while workers are busy."""

    run_id: str
    text: str
    attempt: int = 1

    @functools.cached_property
    def config(self) -> dict:
        """Its config."""
        return json.loads(self.text)


@dataclass(frozen=True)
class Task:
    """What a worker takes at once: one point, or a batch of tiny ones whose records share a file, `batch`. `out` is the sweep's folder."""

    jobs: tuple[Job, ...]
    out: str
    batch: str = ""
    checkpoint: float = 0.0  # seconds between checkpoints of a point that is alone; 0: none

    @property
    def id(self) -> str:
        """Its first point's run id: no point is in two tasks at once."""
        return self.jobs[0].run_id

    @property
    def sent(self) -> "Task":
        """What is kept of it once a worker has it: the same without configs, which take more than all else that a sweep holds of its points."""
        return replace(self, jobs=tuple(replace(job, text="") for job in self.jobs))

    def message(self) -> dict:
        """As plain JSON."""
        return {"jobs": [(job.run_id, job.text, job.attempt) for job in self.jobs], "out": self.out, "batch": self.batch, "checkpoint": self.checkpoint}

    @classmethod
    def of(cls, message: dict) -> "Task":
        """From `message()`."""
        return cls(tuple(Job(*job) for job in message["jobs"]), message["out"], message["batch"], message["checkpoint"])


@dataclass(frozen=True)
class Beat:
    """A task is alive; the point that runs, its fraction done, its simulated time [s]."""

    task: str
    run_id: str
    fraction: float
    time: float


@dataclass(frozen=True)
class Done:
    """A task is over: the summaries of the records that are on disk now, and the points that stopped as asked and left none."""

    task: str
    lines: tuple[dict, ...]
    left: tuple[str, ...] = ()


@dataclass(frozen=True)
class Lost:
    """The worker died with this task; `memory`: it was ended as it took too much, and would again."""

    task: str
    why: str
    memory: bool = False


@dataclass(frozen=True)
class Unwritten:
    """The points ran but their records could not be written: the disk's fault, not the points'."""

    task: str
    why: str


@dataclass(frozen=True)
class Note:
    """Something to tell the user."""

    text: str


@dataclass(frozen=True)
class Compiling:
    """A worker compiles: a sentence, the seconds that it expects the kernel to take, and once it is ready those it took."""

    text: str
    expected: float
    took: float


Event = Beat | Done | Lost | Unwritten | Note | Compiling


class Executor(Protocol):
    """What the engine asks of any place to run points."""

    wanted: int  # workers worth having now; fewer points left need fewer workers

    @property
    def free(self) -> int:
        """How many tasks it would take now."""

    def submit(self, task: Task) -> None:
        """Start a task."""

    def poll(self, timeout: float) -> list[Event]:
        """What has happened, after at most `timeout` seconds."""

    def cancel(self, task: str, why: str) -> None:
        """Ask a task to stop: "timeout" keeps a record of it, "cancel" keeps none."""

    def kill(self, task: str, why: str) -> None:
        """End the worker of a task; `poll` tells its loss, with `why` in place of the signal."""

    def close(self) -> None:
        """End all workers."""


def event(message: dict[str, Any]) -> Event:
    """A worker's message as an event."""
    kind = message["is"]
    if kind == "beat":
        return Beat(message["task"], message["run_id"], message["fraction"], message["time"])
    if kind == "done":
        return Done(message["task"], tuple(message["lines"]), tuple(message["left"]))
    if kind == "unwritten":
        return Unwritten(message["task"], message["why"])
    if kind == "compiling":
        return Compiling(message["text"], message["expected"], message["took"])
    return Note(message["text"])
