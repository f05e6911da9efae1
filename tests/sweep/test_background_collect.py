"""The dataset made beside the sweep, and signals that come while it is made or just after."""

import os
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from mpm.config import load
from mpm.sweep import background_collect, collect
from mpm.sweep.api import execute, tree_of
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.report import Reporter

ROOT = Path(__file__).parents[2]


def go(config, out, jobs=0, reporter=None, **more):
    return execute(load(config), out, Options(jobs=jobs, runner="fake_runner", **more), reporter)


@pytest.fixture
def beside(monkeypatch):
    """All datasets are made in a process of their own; those that were started."""
    started = []

    class Seen(background_collect.Beside):
        def __init__(self, out):
            super().__init__(out)
            started.append(self.process)

    monkeypatch.setattr(background_collect, "SMALL", 0)
    monkeypatch.setattr(background_collect, "Beside", Seen)
    return started


def test_a_dataset_made_beside_is_the_same(config, tmp_path, beside, monkeypatch):
    points = config([0.2, 17.0, 0.5], output={"every": 1, "probes": {"centre": [0.01]}, "snapshots": {"every": 2, "grid": ["temperature"]}})
    assert go(points, tmp_path / "beside").collected and len(beside) == 1
    assert not go(points, tmp_path / "beside").collected and len(beside) == 1  # nothing is due, so nothing starts
    monkeypatch.setattr(background_collect, "SMALL", 1e9)
    assert go(points, tmp_path / "here").collected and len(beside) == 1
    assert compare(tmp_path / "beside", tmp_path / "here") == []


def test_datasets_beside_while_points_run(config, tmp_path, beside, monkeypatch):
    monkeypatch.setattr(background_collect, "EVERY", 0.0)
    monkeypatch.setattr(background_collect, "SHARE", 0)
    seen = []

    class Eyes(Reporter):
        def finished(self, label, line, again):
            end = time.monotonic() + 20
            while line["status"] == 0 and not seen and not (tmp_path / "sweep.nc").exists() and len(beside) == 1 and time.monotonic() < end:
                time.sleep(0.01)
            if (tmp_path / "sweep.nc").exists():
                seen.append(tree_of(tmp_path / "sweep.nc").status.values.tolist())

    assert go(config([round(0.2 + 0.1 * k, 1) for k in range(6)]), tmp_path, reporter=Eyes()).exit_code == 0
    assert len(beside) > 1 and seen and 6 in seen[0]
    assert tree_of(tmp_path / "sweep.nc").status.values.tolist() == [0] * 6 and all(process.poll() is not None for process in beside)


def test_a_signal_while_the_last_dataset_is_made_beside(config, tmp_path, beside, monkeypatch):
    monkeypatch.setattr(background_collect, "START", "import time; time.sleep(60)")
    began = []

    def told():
        while not beside:
            time.sleep(0.01)
        (tmp_path / ".sweep.nc.0.tmp").write_text("half")
        began.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=told)
    thread.start()
    result = go(config([0.2, 0.5]), tmp_path)
    thread.join()
    assert result.exit_code == 130 and time.monotonic() - began[0] < 1 and result.hurried and not result.collected
    assert beside[0].poll() is not None and not list(tmp_path.glob(".*.tmp")) and not (tmp_path / "sweep.nc").exists()
    monkeypatch.undo()
    assert go(config([0.2, 0.5]), tmp_path).collected


@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_signals_while_a_small_dataset_is_made(config, tmp_path, monkeypatch, number, code):
    """The first comes when a point is done, the second amid the collect: neither leaves a trace but the exit code."""
    real = collect.assemble

    def told(*given):
        os.kill(os.getpid(), number)
        return real(*given)

    monkeypatch.setattr(collect, "assemble", told)
    before = signal.getsignal(number)

    class Stops(Reporter):
        def finished(self, label, line, again):
            os.kill(os.getpid(), number)

    result = go(config([0.2, 0.5]), tmp_path, reporter=Stops())
    assert result.exit_code == code and result.ran == 1 and result.collected
    assert tree_of(tmp_path / "sweep.nc").status.values.tolist() == [0, 6] and signal.getsignal(number) == before


LATE = """
import atexit, sys, time
sys.path[:0] = {paths!r}
import fake_runner
from mpm.sweep import engine
engine.RUNNER = "fake_runner"
from mpm_cli.main import main
atexit.register(lambda: (print("ending", flush=True), time.sleep(30)))
sys.exit(main(["sweep", {file!r}, "-o", {out!r}, "-j", "1"]))
"""


@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), pytest.param(signal.SIGTERM, 143, marks=pytest.mark.wide)])
def test_a_second_signal_while_the_interpreter_ends(config, tmp_path, marks, number, code):
    import fake_runner as fake
    from ruamel.yaml import YAML

    with (tmp_path / "a.yaml").open("w") as file:
        YAML().dump(config([fake.SLOW, 0.5]), file)
    text = LATE.format(paths=[str(ROOT), str(ROOT / "tests" / "fakes")], file=str(tmp_path / "a.yaml"), out=str(tmp_path / "out"))
    process = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 30
    while not [row for row in marks() if row[0] == "run"] and time.monotonic() < end:
        time.sleep(0.02)
    process.send_signal(number)
    while process.stdout.readline() not in ("ending\n", ""):
        pass
    process.send_signal(number)
    began = time.monotonic()
    _, said = process.communicate(timeout=20)
    assert process.returncode == code and time.monotonic() - began < 1 and "Traceback" not in said, said


def test_a_collecting_process_that_dies_is_told(config, tmp_path, beside, monkeypatch):
    monkeypatch.setattr(background_collect, "START", "import os; os.kill(os.getpid(), 9)")
    result = go(config([0.2, 0.5]), tmp_path)
    assert result.exit_code == 1 and result.counts["ok"] == 2 and not result.collected
    assert "not made: it ended by signal 9 (SIGKILL, perhaps for want of memory)" in result.stopped and f"mpm collect {tmp_path}" in result.stopped
    monkeypatch.undo()
    assert go(config([0.2, 0.5]), tmp_path).exit_code == 0


def test_a_disk_that_fails_the_collecting_process_is_told_with_its_path(config, tmp_path, beside):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    points = config([round(0.01 * k, 2) for k in range(1, 60)])
    resource.setrlimit(resource.RLIMIT_FSIZE, (15_000, before[1]))
    try:
        with pytest.raises(OSError, match="File too large") as error:
            go(points, tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert error.value.filename == str(tmp_path / "sweep.nc")
    again = go(points, tmp_path)
    assert again.ran == 0 and again.exit_code == 0 and again.collected


def test_it_ends_with_its_parent(tmp_path):
    """Its standard input closes when the parent dies, however that was."""
    slow = "import time, mpm.sweep.api as api; api.collect_folder = lambda out: (print('in', flush=True), time.sleep(60))\n"
    slow += "from mpm.sweep.collect_apart import main; main()"
    process = subprocess.Popen([sys.executable, "-c", slow, str(tmp_path)], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "in\n"
    process.stdin.close()
    assert process.wait(5) == 1
    process.stdout.close()


FORKS = """
import os, signal, sys, time
from mpm.sweep.background_collect import NotCollected, forked

def disk_full():
    raise OSError(28, "No space left on device", "sweep.nc")

here = os.getpid()
assert forked(lambda: os.getpid() != here) is True and forked(lambda: False) is False
try:
    forked(disk_full)
except OSError as error:
    assert (error.errno, error.filename) == (28, "sweep.nc")
try:
    forked(lambda: os.kill(os.getpid(), signal.SIGKILL))
except NotCollected as error:
    assert "died" in str(error)
try:
    forked(lambda: 1 / 0)
except ZeroDivisionError:
    pass
try:
    os.waitpid(-1, 0)
except ChildProcessError:
    print("none is left", flush=True)
forked(lambda: (print(os.getpid(), flush=True), time.sleep(60)))
"""


def test_a_dataset_made_by_a_fork():
    """What it says, what it raises, its death; and it ends with its parent, however that ends."""
    parent = subprocess.Popen([sys.executable, "-c", FORKS], stdout=subprocess.PIPE, text=True)
    assert parent.stdout.readline() == "none is left\n"
    child = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    state = Path(f"/proc/{child}/stat")
    gone, end = lambda: not state.exists() or state.read_text().split()[2] == "Z", time.monotonic() + 20
    while not gone() and time.monotonic() < end:
        time.sleep(0.01)
    assert gone()
