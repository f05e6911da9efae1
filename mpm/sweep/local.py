"""Local: a Dask scheduler in this process and workers on this machine, on 127.0.0.1 alone and without a dashboard.

Workers are fresh interpreters of one thread, as `processes` has them. (Dask's own start of workers runs the user's script again, unless it is guarded.)
They end when their end of a pipe does, so that none outlives this process.
"""

import json
import logging
import os
import subprocess
import sys
import tempfile
import threading
from typing import Any

from mpm import cache
from mpm.sweep.executors import BrokenWorkers
from mpm.sweep.processes import ONE_THREAD, STALL, START_FAILURES
from mpm.sweep.resources import Pulse

START = "import json, sys; sys.path[:] = json.loads(sys.argv[3]); from mpm.sweep.local import main; main()"
QUIET: dict[str, list[str]] = {"distributed.scheduler.http.routes": [], "distributed.worker.http.routes": []}


class Local:
    """The scheduler, and `jobs` workers."""

    def __init__(self, distributed: Any, jobs: int):
        import dask

        self.jobs = jobs
        self.failed = 0
        self.folder = tempfile.TemporaryDirectory(prefix="mpm-dask-")
        with dask.config.set(QUIET):
            self.cluster = distributed.LocalCluster(
                n_workers=0, processes=False, host="127.0.0.1", protocol="tcp", dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL
            )
        self.cluster.scheduler.http_server.stop()  # Dask opens a port for HTTP in any case
        self.address = self.cluster.scheduler_address
        self.children: list[subprocess.Popen] = []
        self.pulses: dict[int, Pulse] = {}
        self.notes: list[str] = []  # to be told
        cache.base()  # one for all workers
        self.grow(jobs)

    def grow(self, wanted: int) -> bool:
        """Start workers up to the number worth having; whether any had ended. One that stands still is replaced (one that works beats now and then)."""
        for child in self.children:
            if child.poll() is None and self.pulses[child.pid].still(STALL):
                child.kill()
                child.wait()
                self.notes.append(f"a Dask worker did nothing for {STALL:.0f} s; it is replaced")
        ended = [child for child in self.children if child.poll() is not None]
        self.failed += sum(child.returncode == 1 for child in ended)
        if self.failed >= START_FAILURES:
            raise BrokenWorkers(f"{START_FAILURES} Dask workers ended by themselves; try `{sys.executable} -c 'import distributed, mpm.sweep.local'`")
        self.children = [child for child in self.children if child.returncode is None]
        while len(self.children) < min(self.jobs, wanted):
            command = [sys.executable, "-P", "-c", START, self.address, self.folder.name, json.dumps(sys.path)]
            self.children.append(subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL, env={**os.environ, **ONE_THREAD}))
            self.pulses[self.children[-1].pid] = Pulse(self.children[-1].pid)
        return bool(ended)

    def kill(self, pid: int) -> None:
        """End a worker."""
        for child in self.children:
            if child.pid == pid:
                child.kill()
                child.wait()

    def close(self) -> None:
        """End all."""
        for child in self.children:
            child.kill()
        for child in self.children:
            child.wait()
            if child.stdin is not None:
                child.stdin.close()
        self.cluster.close(timeout=0.8)
        self.folder.cleanup()


def main() -> None:
    """A worker process, started with the scheduler's address and a folder for Dask's scratch as arguments."""
    import asyncio
    import signal

    import dask
    import distributed

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # they reach the whole group; what to do about them is the parent's choice
        signal.signal(number, signal.SIG_IGN)
    logging.getLogger("distributed").setLevel(logging.CRITICAL)

    def watch() -> None:
        sys.stdin.buffer.read()
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()

    async def live() -> None:
        # no memory limit of Dask's: it would spill results to disk; the engine bounds memory
        async with distributed.Worker(sys.argv[1], nthreads=1, host="127.0.0.1", memory_limit=0, local_directory=sys.argv[2]) as worker:
            worker.http_server.stop()
            await worker.finished()

    with dask.config.set(QUIET):
        asyncio.run(live())
    os._exit(0)
