"""R7: Ctrl-C, SIGTERM and SIGHUP leave in two seconds, a second signal at once; nothing outlives a killed parent; on own workers and on Dask's."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_runner as fake
import pytest
from scenes import config

from mpm.sweep.api import tree_of
from mpm.sweep.folder import signals

HERE = Path(__file__).parent
PARENT = """
import sys
sys.path[:0] = {paths!r}
from pathlib import Path
from mpm.config import load
from mpm.sweep.api import execute
from mpm.sweep.engine import Options
sys.exit(execute(load({config!r}), Path({out!r}), Options(jobs=2, runner="fake_runner", scheduler={scheduler!r})).exit_code)
"""
WAYS = {
    "SIGINT": ([signal.SIGINT], 130),
    "SIGTERM": ([signal.SIGTERM], 143),
    "SIGHUP": ([signal.SIGHUP], 143),
    "SIGINT twice": ([signal.SIGINT, signal.SIGINT], 130),
    "SIGKILL": ([signal.SIGKILL], -9),
}
POINTS = [fake.SLOW, fake.HANGS, 0.2]  # one that stops when it is asked, one that never does, and one that has to wait


def started(out, marks, scheduler):
    """A sweep in a process of its own, once both workers have a point; and its workers."""
    before = len(marks())
    code = PARENT.format(paths=[str(HERE), str(HERE.parent / "fakes"), *sys.path], config=config(POINTS), out=str(out), scheduler=scheduler)
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 60
    while len(rows := [row for row in marks()[before:] if row[0] == "run"]) < 2 and time.monotonic() < end:
        time.sleep(0.02)
    assert len(rows) == 2, process.poll()
    return process, {int(row[-1]) for row in rows}


def gone(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def leaving(out, marks, scheduler, way):
    """Seconds from the last signal until the sweep has ended, and until its last worker has."""
    blows, code = WAYS[way]
    process, workers = started(out, marks, scheduler)
    for number, blow in enumerate(blows):
        time.sleep(0.1 * number)
        process.send_signal(blow)
    began = time.monotonic()
    _, said = process.communicate(timeout=60)
    ended = time.monotonic() - began
    while not all(map(gone, workers)) and time.monotonic() - began < 30:
        time.sleep(0.01)
    assert process.returncode == code, said[-1500:]
    return ended, time.monotonic() - began


def looked(out, way):
    """What the sweep left: nothing counts as killed, and the point that stopped can go on. A second signal leaves no time for a dataset."""
    if len(WAYS[way][0]) == 1 and way != "SIGKILL":
        assert tree_of(out / "sweep.nc").status.values.tolist() == [6, 6, 6] and len(list((out / "checkpoints").iterdir())) == 1


@pytest.mark.parametrize(
    "scheduler, way",
    [
        (None, "SIGTERM"),
        pytest.param(None, "SIGHUP", marks=pytest.mark.wide),
        pytest.param(None, "SIGINT twice", marks=pytest.mark.wide),
        (None, "SIGKILL"),
        ("local", "SIGINT"),
    ],
)
def test_signals_stop_in_time_and_leave_no_orphan(tmp_path, marks, scheduler, way):
    ended, alone = leaving(tmp_path / "out", marks, scheduler, way)
    looked(tmp_path / "out", way)
    assert ended < 2 and alone < 2


def test_a_signal_that_is_ignored_stays_so():
    """As under nohup."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with signals(pytest.fail):
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.slow
@pytest.mark.parametrize("scheduler", [None, "local"])
def test_signals_at_length(tmp_path, marks, table, scheduler):
    times = {way: [] for way in WAYS}
    for turn in range(int(os.environ.get("MPM_SIGNALS", "10"))):
        for way in WAYS:
            out = tmp_path / f"{turn} {way}"
            times[way].append(leaving(out, marks, scheduler, way))
            looked(out, way)
    said = "; ".join(f"{way} {max(ended for ended, _ in rows):.2f} s" for way, rows in times.items() if way != "SIGKILL")
    orphans = max(alone for _, alone in times["SIGKILL"])
    who = "Dask" if scheduler else "own workers"
    table(f"signals, {len(times['SIGINT'])} times each, {who}: slowest end", f"{said}; after SIGKILL 0 orphans after {orphans:.2f} s")
    assert all(one < 2 for rows in times.values() for pair in rows for one in pair)
