"""Processes: spawned worker processes on this machine, one thread and one private socket each.

Each is a fresh interpreter (never a fork: a fork after a threaded kernel kills the child), told by its environment to use one thread. The
first to be ready compiles what the sweep needs; the others import meanwhile and wait, so that a cold cache is filled once. A worker that dies
is replaced, and only its point is lost; so is one that stands still (uses no processor time) before it has taken a point. What workers print goes to an
unnamed file, quoted when one dies.
"""

import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from multiprocessing.connection import Connection, Pipe, wait
from typing import Any, cast

from mpm import cache
from mpm.sweep.executors import BrokenWorkers, Event, Lost, Note, Task, event
from mpm.sweep.resources import Pulse, resident, size

ONE_THREAD = {name: "1" for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")}
START_FAILURES = 3
STALL = 40.0  # s without any processor time, while it starts or compiles, after which a worker is replaced
WEIGH = 0.2  # s between two looks at the workers' memory
# with the parent's module path, so that a worker imports the same files whatever the current folder holds
START = "import json, sys; sys.path[:] = json.loads(sys.argv[3]); from mpm.sweep.worker import main; main()"


class Child:
    """The parent's side of one worker."""

    def __init__(self, runner: str, memory: float):
        self.pipe, theirs = Pipe(duplex=True)
        self.log = tempfile.TemporaryFile(mode="ab+")
        command = [sys.executable, "-P", "-c", START, str(theirs.fileno()), runner, json.dumps(sys.path), str(memory)]
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log, pass_fds=[theirs.fileno()], env={**os.environ, **ONE_THREAD}
        )
        theirs.close()
        self.state = "starting"  # then idle, warming, busy
        self.task: Task | None = None
        self.why = ""  # it was killed for
        self.heavy = False  # it was killed as it took too much memory
        self.pulse = Pulse(self.process.pid)

    def order(self, message: dict) -> None:
        """Send an order; a worker that is gone is noticed in `poll`."""
        try:
            self.pipe.send_bytes(json.dumps(message).encode())
        except OSError:
            self.process.kill()

    def stalled(self) -> bool:
        """Whether it has done nothing for STALL seconds while it started or compiled; a point may wait for something."""
        if self.state in ("idle", "busy"):
            self.pulse.beat()
        return self.pulse.still(STALL)

    def last_words(self) -> str:
        """How the process ended, and the last line it printed."""
        return ended("worker", self.process, self.log)

    def close(self) -> None:
        """Release what the parent holds."""
        self.pipe.close()
        self.log.close()


def ended(who: str, process: subprocess.Popen, log: Any) -> str:
    """How a process ended, and the last line that it left in its log."""
    code = process.wait()
    if code < 0:
        name = signal.Signals(-code).name
        return f"{who} ended by signal {-code} ({name}{', perhaps for want of memory' if name == 'SIGKILL' else ''})"
    log.seek(max(0, log.seek(0, os.SEEK_END) - 4000))
    lines = [line for line in log.read().decode(errors="replace").splitlines() if line.strip()]
    said = re.sub(r"[^\x20-\x7e\u00a0-\uffff]", "?", lines[-1].strip())[:300] if lines else "without a word"
    return f"{who} ended with code {code}: {said}"


class Processes:
    """An Executor over `jobs` processes. `warm` is the config (plain JSON) that the first worker compiles for; None to skip it.

    memory   most bytes of a worker: one that takes more is ended
    """

    def __init__(self, jobs: int, runner: str, warm: dict | None, memory: float = math.inf):
        self.jobs = jobs
        self.wanted = jobs
        self.runner = runner
        self.warm = warm
        self.memory = memory
        self.weighed = 0.0
        self.failed_starts = 0
        self.children: dict[Connection, Child] = {}
        cache.base()  # one for all workers
        self.grow()

    def grow(self) -> None:
        """Start workers up to the number worth having."""
        while len(self.children) < min(self.jobs, self.wanted):
            child = Child(self.runner, self.memory)
            self.children[child.pipe] = child

    @property
    def free(self) -> int:
        """Workers that could take a point now: none before the compile cache is warm."""
        if self.warm is not None or any(child.state == "warming" for child in self.children.values()):
            return 0
        return sum(child.state == "idle" for child in self.children.values())

    def submit(self, task: Task) -> None:
        """Give a task to an idle worker."""
        child = next(child for child in self.children.values() if child.state == "idle")
        child.state, child.task = "busy", task.sent
        child.order({"do": "task", "task": task.message()})

    def poll(self, timeout: float) -> list[Event]:
        """Wait for news from any worker."""
        self.grow()
        self.weigh()
        events: list[Event] = []
        for child in [child for child in self.children.values() if not child.why and child.stalled()]:
            child.why = f"a worker did nothing for {STALL:.0f} s while it was {child.state}"
            child.process.kill()
        for pipe in cast(list[Connection], wait(list(self.children), timeout)):  # those that it was given
            child = self.children[pipe]
            try:
                while pipe.poll():
                    events += self.hear(child, json.loads(pipe.recv_bytes()))
            except (EOFError, OSError):
                events += self.bury(child)
        return events

    def weigh(self) -> None:
        """End workers that take more memory than a point may."""
        if math.isinf(self.memory) or time.monotonic() - self.weighed < WEIGH:
            return
        self.weighed = time.monotonic()
        for child in self.children.values():
            if child.state == "busy" and not child.heavy and (taken := resident(child.process.pid)) > self.memory:
                child.why, child.heavy = f"took {size(taken)} of memory, and {size(self.memory)} are allowed", True
                child.process.kill()

    def hear(self, child: Child, message: dict[str, Any]) -> list[Event]:
        """One message of a worker."""
        kind = message["is"]
        if kind == "ready":
            self.failed_starts = 0
            child.state = "idle"
            if self.warm is not None:
                child.state = "warming"
                child.order({"do": "warm", "config": self.warm})
                self.warm = None
            fresh = [text for text in message["words"] if text not in cache.words]
            cache.words += fresh
            return [Note(text) for text in fresh]
        if kind == "warmed":
            child.state = "idle"
            return [Note(message["text"])] if message["text"] else []
        if kind not in ("beat", "note", "compiling"):
            child.state, child.task = "idle", None
        return [event(message)]

    def bury(self, child: Child) -> list[Event]:
        """A worker is gone: say what was lost with it."""
        child.process.kill()
        words = child.last_words()
        del self.children[child.pipe]
        child.close()
        if child.state == "starting":
            self.failed_starts += 1
            if self.failed_starts >= START_FAILURES:
                raise BrokenWorkers(f"{START_FAILURES} workers in a row ended before they were ready; the last: {child.why or words}")
            if child.why:
                return [Note(f"{child.why}; it is replaced")]
        if child.state == "warming":
            return [Note(f"compiling ahead failed: {child.why or words}")]
        return [Lost(child.task.id, child.why or words, child.heavy)] if child.task else []

    def cancel(self, task: str, why: str) -> None:
        """Ask the worker to stop at its next beat."""
        for child in self.children.values():
            if child.task and child.task.id == task:
                child.order({"do": "stop", "why": why})

    def kill(self, task: str, why: str) -> None:
        """End the worker of a task; `poll` tells its loss, with `why` in place of the signal."""
        for child in self.children.values():
            if child.task and child.task.id == task:
                child.why = why
                child.process.kill()

    def close(self) -> None:
        """End all workers: idle ones leave by themselves, others are killed."""
        for child in self.children.values():
            child.order({"do": "quit"}) if child.state == "idle" else child.process.kill()
        end = time.monotonic() + 1.0
        for child in self.children.values():
            try:
                child.process.wait(max(0.0, end - time.monotonic()))
            except subprocess.TimeoutExpired:
                child.process.kill()
                child.process.wait()
            child.close()
        self.children.clear()
