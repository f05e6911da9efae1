"""Remote: what runs in a worker of a Dask cluster; `cluster` is the engine's side. Text and bytes in, text and bytes out."""

import json
import time
from pathlib import Path

from mpm.records.provenance import source_hash
from mpm.sweep.executors import Task
from mpm.sweep.store import Store

QUIET = 1.0  # least seconds between two beats told

stops: dict[str, str] = {}  # in a worker: task -> why it is to stop


class Parcel(Store):
    """A store that keeps its files in memory, by their path under the sweep's folder: what a worker sends over the wire."""

    def __init__(self) -> None:
        super().__init__(Path())
        self.files: dict[str, bytes] = {}

    def put(self, path: Path, data: bytes) -> None:
        """A file of the parcel."""
        self.files[str(path)] = data


def prepare(runner: str, config: str) -> tuple[str, int]:
    """On a worker: compile (or load) what the sweep needs; the hash of the worker's source, and its process."""
    import importlib
    import os

    from mpm.config import restore

    if config:
        importlib.import_module(runner).warm(restore(json.loads(config)))
    return source_hash(), os.getpid()


def work(text: str, runner: str, topic: str, shared: bool) -> tuple[dict, dict[str, bytes]]:
    """On a worker: run a task; its message, and its files where they go over the wire."""
    from distributed import get_worker

    from mpm.sweep.worker import perform

    task, worker, told = Task.of(json.loads(text)), get_worker(), 0.0

    def stopped(run_id: str, fraction: float, when: float) -> str:
        nonlocal told
        if time.monotonic() - told > QUIET:
            told = time.monotonic()
            worker.log_event(topic, {"is": "beat", "task": task.id, "run_id": run_id, "fraction": float(fraction), "time": float(when)})
        return stops.get(task.id, "")

    parcel = None if shared else Parcel()
    try:
        return perform(task, runner, stopped, parcel), parcel.files if parcel else {}
    finally:
        stops.pop(task.id, None)


async def stop(task: str, why: str) -> None:
    """On a worker, beside the task: ask it to stop at its next beat. (Not waited for, which Dask allows only where it is a coroutine.)"""
    stops[task] = why
