"""A Dask cluster of processes of its own on 127.0.0.1, as a user has one; and a reporter that does something to it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from mpm.sweep.report import Reporter

ROOT = Path(__file__).parents[2]


class Dask:
    """A scheduler and workers of their own, as a user has them on a cluster."""

    def __init__(self, folder):
        self.folder, self.children, self.port = folder, [], 0
        self.environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests" / "fakes")])}

    def start(self, module, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
        log = (self.folder / f"{len(self.children)}.log").open("w")
        child = subprocess.Popen(command, env=self.environment, cwd=self.folder, stdout=log, stderr=log, start_new_session=True)
        self.children.append(child)
        return child

    def scheduler(self):
        target = self.folder / "scheduler.json"
        target.unlink(missing_ok=True)
        child = self.start("dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard", "--scheduler-file", str(target))
        end = time.monotonic() + 30
        while not target.exists() and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(0.1)
        self.address = json.loads(target.read_text())["address"]
        self.port = int(self.address.rpartition(":")[2])
        return child

    def worker(self):
        return self.start("dask_worker", self.address, "--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--local-directory", str(self.folder))

    def close(self):
        for child in self.children:
            kill(child)


def kill(child):
    try:
        os.killpg(child.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    child.wait()


class After(Reporter):
    """Does something once a number of points is done."""

    def __init__(self, count, do):
        self.count, self.do, self.notes = count, do, []

    def finished(self, label, line, again):
        self.count -= 1
        if self.count == 0:
            self.do()

    def note(self, text):
        self.notes.append(text)
