import sys
from pathlib import Path

import fake_runner as fake
import pytest
from dask_cluster import After, Dask

from mpm.config import load
from mpm.records.provenance import source_hash
from mpm.sweep import cluster
from mpm.sweep.api import execute, tree_of
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.executors import BrokenWorkers
from mpm.sweep.store import Refused

ROOT = Path(__file__).parents[2]
TINY = [round(0.01 * k, 2) for k in range(1, 61)]


def go(config, out, address, reporter=None, **more):
    return execute(load(config), out, Options(jobs=2, runner="fake_runner", scheduler=address, **more), reporter)


@pytest.fixture
def dask(tmp_path):
    (tmp_path / "dask").mkdir()
    made = Dask(tmp_path / "dask")
    yield made
    made.close()


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
def test_a_point_that_kills_its_worker_pays_alone_and_a_hanging_one_is_ended(config, tmp_path, marks, dask):
    dask.scheduler()
    dask.worker(), dask.worker()
    result = go(config([fake.DIES, fake.HANGS, fake.SLOW, *TINY[:5]]), tmp_path / "out", dask.address, retries=0, timeout=3.0)
    found = tree_of(tmp_path / "out" / "sweep.nc")
    assert result.exit_code == 3 and found.status.sel(kappa=fake.DIES) == 3 and found.status.sel(kappa=fake.HANGS) == 2
    assert found.error.sel(kappa=fake.SLOW).item().startswith("timeout: stopped at t = ")
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
