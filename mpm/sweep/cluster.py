"""Cluster: an Executor over the workers of a Dask cluster, one that runs already (`tcp://host:8786`) or one of this machine (`local`).

Each task is bound to one worker, and a worker has one task a thread, so that it is known what runs where: a worker that is gone costs the tasks it had,
as on this machine, and Dask repeats nothing by itself. A scheduler that does not answer is waited for (PATIENCE); what was in flight then runs again.
Results come over the wire (the engine writes them), or lie in the sweep's folder already (`shared`: every worker sees it under the same path).
Points and records travel as JSON and sealed bytes; the names of the functions below and the plain values around them travel as Dask does it.

A worker is used once it has shown that it has the same source as the engine, and has compiled what the sweep needs; one at a time on each host.
Nothing here listens, except a scheduler and workers that are `local` (mpm.sweep.local), on 127.0.0.1.
"""

import asyncio
import contextlib
import functools
import json
import logging
import math
import queue
import secrets
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from mpm.records.provenance import source_hash
from mpm.sweep.executors import Beat, BrokenWorkers, Done, Event, Lost, Note, Task, Unwritten, event
from mpm.sweep.local import Local
from mpm.sweep.remote import prepare, stop, work
from mpm.sweep.resources import resident, size
from mpm.sweep.store import Refused, Store

LOOK = 1.0  # s between two looks at which workers there are
PATIENCE = 600.0  # s without a scheduler before the sweep gives up; also without a single worker
SAID = 5.0  # s without a worker before that is said
ANSWER = 5.0  # s that the scheduler has to answer


class Cluster:
    """An Executor over a Dask cluster. `warm` is the config (plain JSON) to compile for; `shared` as above; `jobs` workers where it is `local`."""

    def __init__(self, address: str, runner: str, warm: dict | None, shared: bool, out: Path, jobs: int = 1, memory: float = math.inf):
        self.distributed = loaded()
        self.runner, self.warm, self.shared, self.out = runner, json.dumps(warm) if warm else "", shared, out
        self.wanted = jobs
        self.topic = f"mpm-{secrets.token_hex(4)}"
        self.news: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()  # ("beat", message) or ("over", future)
        self.slots: dict[str, int] = {}  # worker -> threads, of those that are ready
        self.preparing: dict[str, Any] = {}  # worker -> future
        self.refused: dict[str, str] = {}
        self.flights: dict[str, tuple[str, Any, Task]] = {}  # task -> worker, future, the task itself
        self.killed: dict[str, str] = {}  # task -> why
        self.asked: set[tuple[str, str]] = set()  # tasks, with the key of their future, that were asked to stop
        self.memory = memory  # most bytes of a worker, where it is `local`
        self.heavy: set[str] = set()  # tasks that took more
        self.looked = 0.0
        self.alive = time.monotonic()  # when there was a worker last, or hope of one
        self.pids: dict[str, int] = {}
        self.waiting = False  # and it was said
        self.local = Local(self.distributed, jobs) if address == "local" else None
        self.address = self.local.address if self.local else address
        self.client: Any = None
        try:
            self.connect(ANSWER)
        except BrokenWorkers as error:
            raise Refused(f"{error}; --scheduler takes the address of one that runs, as tcp://host:8786, or local") from None

    def connect(self, patience: float) -> None:
        """A client of the scheduler. It is asked first who it is: a client of what never answers, or is none, hangs, and speaks when Python ends."""
        try:
            with ThreadPoolExecutor(1) as apart:  # the caller may have a loop of its own
                who = apart.submit(asyncio.run, identity(self.distributed, self.address, patience)).result()
            if who.get("type") != "Scheduler":
                raise ValueError(f"that is a {who.get('type')}")
            self.client = self.distributed.Client(self.address, timeout=patience, set_as_default=False, name="mpm")
        except Exception as error:  # whatever Dask and its transports raise
            why = f"{type(error).__name__}: {error}".strip(": ").splitlines()[0]
            raise BrokenWorkers(f"no Dask scheduler answers at {self.address or 'an empty address'} ({why})") from None
        self.client.subscribe_topic(self.topic, lambda one: self.news.put(("beat", one[1] if isinstance(one, tuple) else one)))

    @property
    def free(self) -> int:
        """Threads of ready workers that have no task."""
        return sum(self.slots.values()) - len(self.flights)

    def submit(self, task: Task) -> None:
        """Give a task to a worker with a free thread."""
        load = {worker: 0 for worker in self.slots}
        for worker, _, _ in self.flights.values():
            load[worker] = load.get(worker, 0) + 1
        worker = max(self.slots, key=lambda name: self.slots[name] - load[name])
        text = json.dumps(task.message())
        key = f"{self.topic}-{task.id}-{secrets.token_hex(4)}"
        future = self.client.submit(work, text, self.runner, self.topic, self.shared, workers=[worker], key=key, pure=False, retries=0)
        self.flights[task.id] = (worker, future, task)
        future.add_done_callback(functools.partial(self.over, task.id))

    def over(self, name: str, future: Any) -> None:
        """Called in a thread of the client's when a future ends."""
        self.news.put((name, future))

    def poll(self, timeout: float) -> list[Event]:
        """Wait for news of any task; now and then look which workers there are."""
        events: list[Event] = []
        if self.local:
            self.weigh()
            if self.local.grow(self.wanted):
                self.looked = 0.0
            events += [Note(self.local.notes.pop()) for _ in range(len(self.local.notes))]
        if time.monotonic() - self.looked > LOOK:
            events += self.look()
        with contextlib.suppress(queue.Empty):
            events += self.hear(*self.news.get(timeout=0.0 if events else timeout))
            while True:
                events += self.hear(*self.news.get_nowait())
        return events

    def hear(self, name: str, what: Any) -> list[Event]:
        """One piece of news: a beat, or a future that ended."""
        if name == "beat":
            return [Beat(what["task"], what["run_id"], what["fraction"], what["time"])] if what["task"] in self.flights else []
        if name in self.preparing and self.preparing[name] is what:
            return self.prepared(name, what)
        if name not in self.flights or self.flights[name][1] is not what:
            return []  # given up before
        if what.status == "finished":
            message, files = what.result()
            return [self.land(name, message, files)]
        if what.status == "error":
            return [self.drop(name, f"the worker gave up: {error_line(what)}")]
        return []  # cancelled: its worker or the scheduler is gone, as the next look will show

    def land(self, name: str, message: dict, files: dict[str, bytes]) -> Event:
        """A task's records are here: on disk with them, and only then told."""
        del self.flights[name]
        try:
            for path, data in files.items():
                Store(self.out).put(self.out / path, data)
        except OSError as error:
            return Unwritten(name, f"{error.filename}: {error.strerror}")
        return event(message)

    def drop(self, name: str, why: str) -> Lost:
        """A task is lost."""
        _, future, _ = self.flights.pop(name)
        with contextlib.suppress(Exception):
            future.cancel()
        heavy = name in self.heavy
        self.heavy.discard(name)
        return Lost(name, self.killed.pop(name, "") or why, heavy)

    def weigh(self) -> None:
        """End local workers that take more memory than a point may."""
        for name, (worker, _, _) in self.flights.items():
            if name not in self.heavy and (taken := resident(self.pids[worker])) > self.memory:
                self.heavy.add(name)
                self.kill(name, f"took {size(taken)} of memory, and {size(self.memory)} are allowed")

    def look(self) -> list[Event]:
        """Which workers there are: new ones are prepared, the tasks of those that are gone are lost."""
        self.looked = time.monotonic()
        if self.client is None and not self.reconnect():
            return []
        try:
            there = self.client.sync(self.client.scheduler.ncores, callback_timeout=ANSWER) if self.client.status == "running" else None
        except Exception:  # whatever Dask raises when its scheduler is gone
            there = None
        if there is None:
            return self.lost_scheduler()
        events: list[Event] = []
        for worker in [*self.slots, *self.preparing]:
            if worker not in there:
                self.slots.pop(worker, None)
                self.preparing.pop(worker, None)
                lost = [self.drop(name, f"worker {worker} is gone") for name, (at, _, _) in list(self.flights.items()) if at == worker]
                events += [Note(f"worker {worker} is gone{', with what it ran' if lost else ''}"), *lost]
        self.begin({worker: threads for worker, threads in there.items() if worker not in self.slots and worker not in self.refused})
        if self.slots or self.preparing:
            self.alive, self.waiting = self.looked, False
        elif self.refused and set(there) <= set(self.refused):
            raise BrokenWorkers("no worker of the cluster can be used: " + "; ".join(sorted(set(self.refused.values()))))
        elif self.looked - self.alive > SAID and not self.waiting:
            self.waiting = True
            events.append(Note(f"the cluster at {self.address} has no workers; waiting for some, {PATIENCE:.0f} s at most"))
        elif self.looked - self.alive > PATIENCE:
            raise BrokenWorkers(f"the cluster at {self.address} has had no workers for {PATIENCE:.0f} s")
        return events

    def begin(self, new: dict[str, int]) -> None:
        """Prepare new workers, one at a time on a host, as they may share a compile cache."""
        busy = {host(worker) for worker in self.preparing}
        for worker in new:
            if worker not in self.preparing and host(worker) not in busy:
                busy.add(host(worker))
                key = f"{self.topic}-prepare-{secrets.token_hex(4)}"
                future = self.client.submit(prepare, self.runner, self.warm, workers=[worker], key=key, pure=False, retries=0)
                self.preparing[worker] = future
                future.add_done_callback(functools.partial(self.over, worker))

    def prepared(self, worker: str, future: Any) -> list[Event]:
        """A worker is ready, or cannot be used."""
        del self.preparing[worker]
        self.looked = 0.0  # the next on its host
        source, self.pids[worker] = future.result() if future.status == "finished" else ("", 0)
        if source == source_hash():
            self.slots[worker] = self.client.nthreads()[worker] if worker in self.client.nthreads() else 1
            return []
        if future.status == "cancelled":
            return []
        why = f"its mpm is of other source ({source}, here {source_hash()})" if source else error_line(future)
        self.refused[worker] = why
        return [Note(f"worker {worker} is not used: {why}")]

    def lost_scheduler(self) -> list[Event]:
        """What was in flight is in vain, and that is no point's fault. The next looks try to reach the scheduler again."""
        events: list[Event] = [Done(name, (), tuple(job.run_id for job in task.jobs)) for name, (_, _, task) in self.flights.items()]
        self.flights.clear()
        self.slots.clear()
        self.preparing.clear()
        with contextlib.suppress(Exception):
            self.client.close(timeout=0.5)
        self.client = None
        return [*events, Note(f"the scheduler at {self.address} does not answer; waiting for it, {PATIENCE:.0f} s at most")]

    def reconnect(self) -> bool:
        """Whether the scheduler answers again."""
        try:
            self.connect(1.0)
        except BrokenWorkers:
            if time.monotonic() - self.alive > PATIENCE:
                raise
            return False
        return True

    def cancel(self, task: str, why: str) -> None:
        """Ask the worker to stop at its next beat; once, as each time costs a round trip."""
        if task in self.flights and (task, self.flights[task][1].key) not in self.asked and self.client is not None:
            self.asked.add((task, self.flights[task][1].key))
            with contextlib.suppress(Exception):
                self.client.run(stop, task, why, workers=[self.flights[task][0]], wait=False)

    def kill(self, task: str, why: str) -> None:
        """End the worker of a task, with all it runs; its nanny starts another."""
        if task in self.flights:
            worker = self.flights[task][0]
            self.killed[task] = why
            if self.local:
                self.local.kill(self.pids[worker])
                return
            with contextlib.suppress(Exception):
                self.client.restart_workers([worker], timeout=ANSWER, raise_for_error=False)

    def close(self) -> None:
        """Ask what runs to stop, and leave; a `local` cluster ends."""
        for task in list(self.flights):
            self.cancel(task, "cancel")
        with contextlib.suppress(Exception):
            self.client.cancel([future for _, future, _ in self.flights.values()], force=True)
        if self.client is not None:
            with contextlib.suppress(Exception):
                self.client.close(timeout=0.8)
        if self.local:
            self.local.close()


async def identity(distributed: Any, address: str, patience: float) -> dict:
    """What a Dask server says it is."""
    how = distributed.Security().get_connection_args("client")
    async with distributed.rpc(address, timeout=patience, connection_args=how) as server:
        return await asyncio.wait_for(server.identity(), patience)


def host(worker: str) -> str:
    """`10.0.0.7` of `tcp://10.0.0.7:4321`."""
    return worker.partition("://")[2].rpartition(":")[0]


def error_line(future: Any) -> str:
    """What went wrong on a worker, in a line."""
    error = future.exception()
    return f"{type(error).__name__}: {(str(error).strip().splitlines() or ['no message'])[0][:300]}"


def loaded() -> Any:
    """The package `distributed`, quiet."""
    try:
        import distributed
    except ImportError:
        raise Refused("--scheduler needs Dask: pip install 'mpm[cluster]'") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is lost is told by the engine, once
    return distributed
