import signal
import socket
import sys
import time
from pathlib import Path

import fake_runner as fake
import pytest
from dask_cluster import After, Dask

from mpm.config import load
from mpm.records.provenance import source_hash
from mpm.sweep import cluster, local
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


def test_a_local_worker_that_stands_still_is_replaced_and_told(monkeypatch):
    monkeypatch.setattr(local, "STALL", 1.0)
    ours = local.Local(cluster.loaded(), 1)
    try:
        (first,) = ours.children
        first.send_signal(signal.SIGSTOP)
        end = time.monotonic() + 30
        while not ours.notes and time.monotonic() < end:
            time.sleep(0.1)
            ours.grow(1)
        assert ours.notes == ["a Dask worker did nothing for 1 s; it is replaced"]
        assert first.poll() == -signal.SIGKILL and [child.poll() for child in ours.children] == [None] and ours.children[0] is not first
    finally:
        ours.close()


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


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "mute", "", "nonsense", "http://127.0.0.1:8786", "tcp://127.0.0.1:port"])
def test_an_address_where_no_scheduler_answers_is_refused_soon(config, tmp_path, monkeypatch, address):
    monkeypatch.setattr(cluster, "ANSWER", 0.3)
    with socket.create_server(("127.0.0.1", 0)) as mute:  # takes connections, and never says a word
        address = f"tcp://127.0.0.1:{mute.getsockname()[1]}" if address == "mute" else address
        began = time.monotonic()
        with pytest.raises(Refused, match=rf"^no Dask scheduler answers at {address or 'an empty address'} .*--scheduler takes") as refused:
            go(config(TINY[:3]), tmp_path / "out", address)
        assert time.monotonic() - began < 20 and "\n" not in str(refused.value)


def test_no_dask_is_told(config, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(Refused, match=r"pip install 'mpm\[cluster\]'"):
        go(config(TINY[:3]), tmp_path / "out", "local")
