"""The dataset of a sweep, now and then while it runs and at its end. Small ones are made by a fork of the sweep's process, which waits; larger ones by a
fresh interpreter beside, so that the sweep's process hands out points meanwhile, and can leave at once. It grows by neither.

That interpreter reads the folder as `mpm collect` does, says in a line of JSON what came of it, and ends with its parent.
"""

import functools
import importlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpm.sweep.manifest import claimed
from mpm.sweep.processes import ONE_THREAD, ended
from mpm.sweep.resources import output
from mpm.sweep.store import Store

EVERY = 30.0  # least seconds between two datasets while running; SHARE times what one took, if that is more
SHARE = 20
SMALL = 8_000_000  # bytes of results that are waited for: a few tenths of a second
QUICK = 200  # points that are collected even when told to leave at once
LOOK = 0.02  # s between two looks whether it is done
START = "import json, sys; sys.path[:] = json.loads(sys.argv[2]); from mpm.sweep.collect_apart import main; main()"


class NotCollected(Exception):
    """The process that collects died."""


def forked(task: Callable[[], bool]) -> bool:
    """`task()` in a fork, whose memory goes with it (h5py alone takes 10 MB); in this process where that is there already, or threads make a fork unsafe."""
    if not hasattr(os, "fork") or threading.active_count() > 1 or {"h5py", "numba"} & set(sys.modules):
        return task()
    (ours, theirs), (parent, alive) = os.pipe(), os.pipe()
    if not (child := os.fork()):
        try:
            os.close(alive)
            threading.Thread(target=lambda: (os.read(parent, 1), os._exit(1)), daemon=True).start()  # ends with its parent, which has the other end
            with open(theirs, "w", encoding="utf-8") as stream:
                json.dump(told(task), stream)
        finally:
            os._exit(0)
    os.close(theirs)
    with open(ours, encoding="utf-8") as stream:
        said = stream.read()
    _, status = os.waitpid(child, 0)
    os.close(alive)
    os.close(parent)
    if os.WIFSIGNALED(status):
        raise NotCollected("the dataset was not made: the process that makes it died; the points are kept, and the same command tries again")
    return heard(json.loads(said)) if said else task()  # what is wrong with the task is raised here


def told(task: Callable[[], bool]) -> dict[str, Any]:
    """What came of a task, as JSON can say it: what it returned, or the OSError that it met."""
    try:
        return {"written": task()}
    except OSError as error:
        if error.errno is None:
            raise
        return {"errno": error.errno, "strerror": error.strerror, "filename": error.filename}


def heard(found: dict[str, Any]) -> bool:
    """The same in the process that asked."""
    if "errno" in found:
        raise OSError(found["errno"], found["strerror"], found["filename"])
    return bool(found["written"])


class Beside:
    """A process that collects a folder. Its standard input is a pipe that nobody writes to: it closes when we end."""

    def __init__(self, out: Path):
        self.out, self.began, self.log = out, time.monotonic(), tempfile.TemporaryFile(mode="ab+")
        command = [sys.executable, "-P", "-c", START, str(out.resolve()), json.dumps(sys.path)]
        environment = {**os.environ, **ONE_THREAD}
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, env=environment)

    def over(self) -> bool | None:
        """Whether it wrote a dataset; None while it works. OSError as it met it; NotCollected where it died."""
        if self.process.poll() is None:
            return None
        said = self.process.stdout.read() if self.process.stdout else b""
        words = ended("it", self.process, self.log)
        self.close()
        try:
            found = json.loads(said)
        except ValueError:
            raise NotCollected(f"the dataset was not made: {words}; the points are kept, `mpm collect {self.out}` tries again") from None
        return heard(found)

    def end(self) -> None:
        """Stop it, and remove what it left half written."""
        self.process.kill()
        self.process.wait()
        self.close()
        for path in [*self.out.glob(".*.tmp"), *self.out.glob("series/.*.tmp")]:
            path.unlink(missing_ok=True)

    def close(self) -> None:
        """Release what this side holds."""
        for stream in (self.process.stdin, self.process.stdout, self.log):
            if stream is not None:
                stream.close()


class Gather:
    """Collects a folder whose points are `lines` so far. `note` hears of trouble while the sweep runs."""

    def __init__(self, store: Store, plan: Any, lines: Any, note: Callable[[str], None]):
        self.store, self.plan, self.lines, self.note = store, plan, lines, note
        self.cost, self.ended, self.ran = 0.0, time.monotonic(), 0
        self.child: Beside | None = None

    @functools.cached_property
    def each(self) -> int:
        """Bytes of a point, about."""
        return output(self.plan.cases[0].experiment) if self.plan.cases else 0

    @property
    def small(self) -> bool:
        """Whether it is waited for."""
        return len(self.lines) * self.each <= SMALL

    @property
    def quick(self) -> bool:
        """Whether it can be made even when the sweep is told to leave."""
        return self.small and len(self.lines) < QUICK

    def prepare(self) -> None:
        """Import what a quick one needs, while points have the time that they get to leave."""
        if self.quick:
            importlib.import_module("h5netcdf")

    def due(self) -> bool:
        """Whether the dataset does not hold just this already."""
        from mpm.sweep.collect import due

        return bool(due(self.store, claimed(self.store.out), self.lines))

    def here(self) -> bool:
        """By a fork: whether it was written."""
        from mpm.sweep.collect import collect

        return forked(lambda: collect(self.store, self.plan, claimed(self.store.out), self.lines))

    def now_and_then(self, ran: int) -> None:
        """Called often while points run, with how many have. Trouble is told, and the sweep goes on."""
        try:
            if self.child is not None:
                if self.child.over() is not None:
                    self.paid(self.child.began)
            elif ran > self.ran and time.monotonic() - self.ended > max(EVERY, SHARE * self.cost):
                self.ran = ran
                if len(self.plan.cases) * self.each <= SMALL:  # else the last one is made beside, and so are those on the way
                    began = time.monotonic()
                    self.here()
                    self.paid(began)
                else:
                    self.child = Beside(self.store.out)
        except OSError as error:
            self.note(f"cannot collect yet: {error.filename}: {error.strerror}")
            self.paid(self.child.began if self.child else time.monotonic())
        except NotCollected as error:
            self.note(str(error))
            self.paid(self.child.began if self.child else time.monotonic())

    def paid(self, began: float) -> None:
        """One is over."""
        self.child, self.ended = None, time.monotonic()
        self.cost = self.ended - began

    def last(self, stop: Callable[[], bool]) -> bool:
        """All that is there now: whether it was written, and not because `stop` said so meanwhile."""
        self.close()
        if not self.due():
            return False
        if self.small:
            return self.here()
        self.child = Beside(self.store.out)
        while (written := self.child.over()) is None and not stop():
            time.sleep(LOOK)
        if written is not None:
            self.child = None
        self.close()
        return bool(written)

    def close(self) -> None:
        """No more."""
        if self.child is not None:
            self.child.end()
            self.child = None
