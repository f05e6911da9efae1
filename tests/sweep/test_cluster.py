import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import fake_runner as fake
import pytest

from mpm.config import load
from mpm.records.provenance import source_hash
from mpm.sweep import cluster
from mpm.sweep.api import execute, tree_of
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.executors import BrokenWorkers
from mpm.sweep.report import Reporter
from mpm.sweep.store import Refused

ROOT = Path(__file__).parents[2]
TINY = [round(0.01 * k, 2) for k in range(1, 61)]


def go(config, out, address, reporter=None, **more):
    return execute(load(config), out, Options(jobs=2, runner="fake_runner", scheduler=address, **more), reporter)


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
        self.address = __import__("json").loads(target.read_text())["address"]
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


@pytest.fixture
def dask(tmp_path):
    (tmp_path / "dask").mkdir()
    made = Dask(tmp_path / "dask")
    yield made
    made.close()


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


def test_local_gives_the_same_dataset_and_listens_on_loopback_alone(config, tmp_path, marks):
    listening = []

    def look():
        rows = [row.split() for row in Path("/proc/net/tcp").read_text().splitlines()[1:]]
        inodes = {Path(link).stat().st_ino for link in Path("/proc/self/fd").iterdir() if link.exists()}
        listening.extend(row[1] for row in rows if row[3] == "0A" and int(row[9]) in inodes)

    points = config([*TINY, fake.RAISES, fake.DIVERGES])
    result = go(points, tmp_path / "dask", "local", After(3, look))
    assert result.exit_code == 3 and result.ran == 62 and len([row for row in marks() if row[0] == "run"]) == 62
    execute(load(points), tmp_path / "own", Options(jobs=1, runner="fake_runner"))
    assert compare(tmp_path / "dask", tmp_path / "own") == []
    assert all(address.startswith("0100007F:") for address in listening) and not any(address.endswith(":2253") for address in listening)
    assert go(points, tmp_path / "dask", "local").ran == 0


@pytest.mark.slow
@pytest.mark.parametrize("shared", [False, True])
def test_a_killed_worker_and_a_restarted_scheduler_cost_what_was_in_flight(config, tmp_path, marks, dask, shared):
    scheduler = dask.scheduler()
    workers = [dask.worker(), dask.worker()]
    points = config([*TINY, *(fake.BRIEF + k for k in range(8))])  # the last take a second each
    execute(load(points), tmp_path / "own", Options(jobs=1, runner="fake_runner"))
    before = len(marks())
    told = After(62, lambda: kill(workers[0]))
    real, timer = told.finished, threading.Timer(2.5, lambda: (dask.scheduler(), dask.worker()))

    def finished(label, line, again):
        real(label, line, again)
        if told.count == -3:
            kill(scheduler)
            kill(workers[1])
            timer.start()

    told.finished = finished
    result = go(points, tmp_path / "dask", dask.address, told, shared=shared)
    timer.join()
    assert result.exit_code == 0 and result.counts["ok"] == 68
    assert any("does not answer" in note for note in told.notes)
    assert len([row for row in marks()[before:] if row[0] == "run"]) <= 68 + 4
    assert compare(tmp_path / "dask", tmp_path / "own") == []


@pytest.mark.slow
def test_a_point_that_kills_its_worker_pays_alone_and_a_hanging_one_is_ended(config, tmp_path, marks, dask):
    dask.scheduler()
    dask.worker(), dask.worker()
    result = go(config([fake.DIES, fake.HANGS, *TINY[:5]]), tmp_path / "out", dask.address, retries=0, timeout=3.0)
    found = tree_of(tmp_path / "out" / "sweep.nc")
    assert result.exit_code == 3 and found.status.sel(kappa=fake.DIES) == 3 and found.status.sel(kappa=fake.HANGS) == 2
    assert result.counts["ok"] == 5 and "is gone" in found.error.sel(kappa=fake.DIES).item()


@pytest.mark.slow
def test_workers_of_other_source_are_refused(config, tmp_path, dask, monkeypatch):
    dask.scheduler()
    dask.worker()
    monkeypatch.setattr(cluster, "source_hash", lambda: "0" * 16)
    with pytest.raises(BrokenWorkers, match=f"other source .{source_hash()}, here 0000"):
        go(config(TINY[:3]), tmp_path / "out", dask.address)


def test_no_scheduler_and_no_dask_are_told(config, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "ANSWER", 0.3)
    with pytest.raises(BrokenWorkers, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        go(config(TINY[:3]), tmp_path / "out", "tcp://127.0.0.1:9")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(Refused, match=r"pip install 'mpm\[cluster\]'"):
        go(config(TINY[:3]), tmp_path / "out", "local")
