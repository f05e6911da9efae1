"""Worker: a process that lives through a sweep, runs one task at a time and puts its records on disk before it says so.

Messages are JSON on one private socket. In: {do: warm|task|stop|quit}. Out: {is: ready|warmed|beat|note|done|unwritten}.
A thread listens, so that the parent's end (EOF) ends the worker at once, whatever compiled code is running: no orphan outlives the parent.
"""

import functools
import importlib
import json
import math
import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from mpm.cache import words
from mpm.sweep.executors import Task

QUIET = 0.2  # least seconds between two beats told
FENCE = 300_000_000  # bytes that a process reserves without using them


def perform(task: Task, runner: str, stopped: Callable[[str, float, float], str], store: Any = None, note: Callable[[str], None] | None = None) -> dict:
    """Run a task, save its records in its folder or in `store`, and return the message that tells it.

    `stopped(run_id, fraction, time)` is called at every beat and returns "", "timeout" (stop, keep the series as a record) or "cancel" (stop, keep nothing).
    A point that stops leaves a checkpoint; one that is done forgets it. `note` hears what went wrong with that.
    """
    from mpm.records.checkpoint import Checkpoint
    from mpm.records.variables import TIMEOUT
    from mpm.sweep.store import Store

    keeper = None
    if task.checkpoint > 0 and len(task.jobs) == 1:
        keeper = Checkpoint(Store(task.out).checkpoint(task.id), task.id, task.checkpoint, note)
    try:
        records, left = results(task, runner, stopped, keeper)
        (store or Store(task.out)).save_batch(records, task.batch)
    except OSError as error:
        return {"is": "unwritten", "task": task.id, "why": f"{error.filename}: {error.strerror}"}
    if keeper is not None and any(record.status != TIMEOUT for record in records):
        keeper.drop()
    return {"is": "done", "task": task.id, "lines": [record.line for record in records], "left": left}


def results(task: Task, runner: str, stopped: Callable[[str, float, float], str], keeper: Any = None) -> tuple[list[Any], list[str]]:
    """The records of a task's points, and the points that were left when it was stopped."""
    from mpm.config import restore

    if len(task.jobs) > 1 and (found := together(task, runner)) is not None:
        return found, []
    records: list[Any] = []
    why = ""
    for place, job in enumerate(task.jobs):

        def beat(fraction: float, when: float, run_id: str = job.run_id) -> bool:
            nonlocal why
            why = why or stopped(run_id, fraction, when)
            return bool(why)

        if len(task.jobs) > 1 and beat(0.0, 0.0):
            return records, [other.run_id for other in task.jobs[place:]]
        record = compute(job.run_id, functools.partial(restore, job.config), runner, beat, keeper, attempts=job.attempt, config=job.config)
        if record.outcome == "budget" and (why == "cancel" or (why and len(task.jobs) > 1)):
            return records, [other.run_id for other in task.jobs[place:]]
        records.append(record)
    return records, []


def together(task: Task, runner: str) -> list[Any] | None:
    """Records of material points, from one compiled call; None where the points must run one by one (which also tells which of them fails)."""
    from mpm.config import restore
    from mpm.records import point
    from mpm.records.provenance import now, source_hash

    run_points = getattr(importlib.import_module(runner), "run_points", None)
    if run_points is None or any(job.config["grid"]["dimension"] != 0 for job in task.jobs):
        return None
    calls = {"source": source_hash(), "started": now()}
    try:
        runs = run_points([restore(job.config) for job in task.jobs])
    except Exception:  # one of them cannot run: one by one, each tells for itself
        return None
    finished = now()
    return [
        point.from_run(job.run_id, run, attempts=job.attempt, config=job.config, **calls, finished=finished) for job, run in zip(task.jobs, runs, strict=True)
    ]


def compute(
    run_id: str, experiment: Callable[[], Any], runner: str, beat: Callable[[float, float], bool] | None, keeper: Any = None, threads: int = 1, **calls: Any
) -> Any:
    """The record of a point. Whatever the model raises is this point's failure, not the sweep's: status `failed`, with the place but no values."""
    from mpm.records import point, variables
    from mpm.records.frames import Unwritten
    from mpm.records.provenance import now, source_hash

    calls |= {"source": source_hash(), "started": now()}
    began = time.perf_counter()
    try:
        more = {"threads": threads} if threads > 1 else {}
        return point.from_run(run_id, importlib.import_module(runner).run_point(experiment(), beat, keeper=keeper, **more), **calls, finished=now())
    except MemoryError:
        text = f"{variables.STATUS[variables.KILLED]}: wants more memory than is allowed or free"
        return point.Record(run_id, variables.KILLED, text, variables.MEMORY, wall_time=time.perf_counter() - began, finished=now(), **calls)
    except Unwritten:
        raise
    except Exception as error:
        text = f"{variables.STATUS[variables.FAILED]}: {error_in_words(error)}"
        return point.Record(run_id, variables.FAILED, text, wall_time=time.perf_counter() - began, finished=now(), **calls)


def error_in_words(error: Exception) -> str:
    """What cannot be run says what to change; anything else is told with its type and place."""
    from mpm.scene.refusal import SceneError

    return first_line(error) if isinstance(error, SceneError) else f"{type(error).__name__}: {first_line(error)}{where(error)}"


def first_line(error: BaseException) -> str:
    """What an error says, on one line."""
    return (str(error).strip().splitlines() or ["no message"])[0][:500]


def where(error: BaseException) -> str:
    """` (file.py:12)`: the innermost line, for a report; never values."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return f" ({os.path.basename(trace.tb_frame.f_code.co_filename)}:{trace.tb_lineno})" if trace else ""


class Worker:
    """The child's side of one socket."""

    def __init__(self, descriptor: int, runner: str):
        from multiprocessing.connection import Connection

        self.pipe = Connection(descriptor)
        self.runner = runner
        self.orders: queue.SimpleQueue[dict] = queue.SimpleQueue()
        self.stop = ""
        self.told = 0.0

    def tell(self, message: dict) -> None:
        """Send a message. With the parent gone, end: an error here would else be taken for the point's own."""
        try:
            self.pipe.send_bytes(json.dumps(message).encode())
        except OSError:
            os._exit(1)

    def listen(self) -> None:
        """Thread: queue orders, note stops, end with the parent."""
        while True:
            try:
                order = json.loads(self.pipe.recv_bytes())
            except (EOFError, OSError):
                os._exit(1)
            if order["do"] == "stop":
                self.stop = order["why"]
            else:
                self.stop = ""  # a stop that came before this order was for the point before it
                self.orders.put(order)

    def live(self) -> None:
        """Import, then obey until told to quit.

        The runner may list in NEEDS what it would else import under the first point. `mpm.jit` names the compile cache after the source:
        imported now, all workers of a sweep share one, even while somebody edits.
        """
        threading.Thread(target=self.listen, daemon=True).start()
        runner = importlib.import_module(self.runner)
        for module in ("mpm.records.point", "h5py", *getattr(runner, "NEEDS", ("mpm.jit",))):
            importlib.import_module(module)
        config = importlib.import_module("mpm.config")
        self.tell({"is": "ready", "words": words})
        compiling = importlib.import_module("mpm.compiling")
        with compiling.say(self.compiling):
            self.obey(runner, config)

    def obey(self, runner: Any, config: Any) -> None:
        """One order after the other, until told to quit."""
        while (order := self.orders.get())["do"] != "quit":
            if order["do"] == "warm":
                try:
                    runner.warm(config.load(order["config"]))
                    self.tell({"is": "warmed", "text": ""})
                except Exception as error:  # the points will say the same, each in its own record
                    self.tell({"is": "warmed", "text": f"compiling ahead failed: {first_line(error)}{where(error)}"})
            else:
                task = Task.of(order["task"])
                self.tell(perform(task, self.runner, functools.partial(self.beat, task.id), note=self.note))

    def compiling(self, text: str, expected: float, took: float) -> None:
        """What is compiled, now and then; how long it took, when it is ready."""
        if took or time.monotonic() - self.told > QUIET:
            self.told = time.monotonic()
            self.tell({"is": "compiling", "text": text, "expected": expected, "took": took})

    def note(self, text: str) -> None:
        """Something to tell the user."""
        self.tell({"is": "note", "text": text})

    def beat(self, task: str, run_id: str, fraction: float, when: float) -> str:
        """Tell progress now and then; return the reason to stop, if any."""
        if time.monotonic() - self.told > QUIET:
            self.told = time.monotonic()
            self.tell({"is": "beat", "task": task, "run_id": run_id, "fraction": float(fraction), "time": float(when)})
        return self.stop


def fence(memory: float) -> None:
    """Let an allocation far over the limit fail at once; what creeps over it is ended by the parent."""
    import resource

    if math.isfinite(memory):
        most = int(1.2 * memory) + FENCE
        hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
        resource.setrlimit(resource.RLIMIT_DATA, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def main() -> None:
    """Started by `processes.Child` with the socket's descriptor, the runner's name, the module path and the memory limit as arguments."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # they reach the whole group; what to do about them is the parent's choice
        signal.signal(number, signal.SIG_IGN)
    fence(float(sys.argv[4]))
    worker = Worker(int(sys.argv[1]), sys.argv[2])
    worker.live()
    os._exit(0)  # the listener sits in a read; nothing here is left to tidy
