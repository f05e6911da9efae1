"""R1 to R3: kill -9 and a failing disk, at every call that changes a file and at random moments (kills.py says how)."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_runner as fake
import numpy as np
import pytest
from scenes import config, go, many

from mpm.sweep.compare import compare
from mpm.sweep.verify import files, wrong

HERE = Path(__file__).parent
PARENT = """
import sys
sys.path[:0] = {paths!r}
from pathlib import Path
from scenes import go
from mpm.sweep import background_collect
if {beside!r}:  # datasets all the time, in a process of their own
    background_collect.SMALL, background_collect.EVERY, background_collect.SHARE = 0, 0.0, 0
print(go({config!r}, Path({out!r}), jobs=2).exit_code)
"""


def campaign(*arguments):
    done = subprocess.run([sys.executable, str(HERE / "kills.py"), *map(str, arguments)], capture_output=True, text=True, timeout=3600, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


def test_kills_and_a_failing_disk(tmp_path):
    killed = campaign("kill", tmp_path / "a", 4, 25)
    assert killed["calls"] >= 10 and not killed["wrong"], killed
    failed = campaign("disk", tmp_path / "b", 10)
    assert failed["points"] == 10 and not failed["wrong"], failed


@pytest.mark.slow
def test_kills_at_length(tmp_path, table):
    found = campaign("kill", tmp_path, 1000, 1)
    said = f"{found['calls']} kills before, amid and after every write, fsync and rename, {found['moments']} at random moments: {found['wrongs']} wrong"
    table("kill -9 of a sweep: points lost, partial files, another sweep.nc", said)
    assert not found["wrong"], found


@pytest.mark.slow
def test_a_failing_disk_at_length(tmp_path, table):
    found = campaign("disk", tmp_path, 200)
    table("ENOSPC, EIO, EROFS, EDQUOT, EFBIG at 200 calls: path told, nothing lost, goes on", f"{found['points']} points, {found['wrongs']} wrong")
    assert not found["wrong"], found


@pytest.mark.parametrize("who, times", [("parent", 1), pytest.param("all", 1, marks=pytest.mark.wide), pytest.param("both", 50, marks=pytest.mark.slow)])
def test_kills_of_a_sweep_with_workers(tmp_path, table, who, times):
    rng, bad = np.random.default_rng(5), []
    data = many(400)
    go(data, tmp_path / "whole")
    for turn in range(times):
        out = tmp_path / f"out{turn}"
        code = PARENT.format(paths=[str(HERE), str(HERE.parent / "fakes"), *sys.path], config=data, out=str(out), beside=who == "parent" or turn % 4 > 1)
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        end = time.monotonic() + 30
        while not list(out.glob("points/*/*.nc")) and time.monotonic() < end:
            time.sleep(0.01)
        time.sleep(float(rng.uniform(0, 0.3)))
        everyone = who == "all" or (who == "both" and turn % 2)
        (os.killpg if everyone else os.kill)(process.pid, signal.SIGKILL)
        process.wait()
        time.sleep(0.5)
        bad += [str(path) for kind, path in files(out) if wrong(kind, path)[1]]
        bad += [f"exit code {code}" for code in [go(data, out).exit_code] if code] + compare(tmp_path / "whole", out)
    if times > 1:
        table(f"kill -9 of the parent, or of all, of a sweep with two workers, {times} times", f"{len(bad)} wrong")
    assert not bad


@pytest.mark.slow
def test_workers_killed_at_length(tmp_path, marks, table):
    """200 points kill their worker once each, one kills it every time."""
    once = [round(fake.DIES_ONCE + 0.001 * k, 3) for k in range(200)]
    result = go(config([*once, fake.DIES, 0.5]), tmp_path / "out", jobs=2)
    said = f"{result.counts['ok']} ok, {result.counts['killed']} killed, exit code {result.exit_code}"
    table("kill -9 of a worker, 200 times; a point that kills its worker each time", said)
    assert result.counts["ok"] == 201 and result.counts["killed"] == 1 and result.exit_code == 3
