"""A sweep in a process of its own that is stopped, killed or found busy: nothing that finished is lost, and the same command goes on."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_runner as fake
import pytest

from mpm.config import load
from mpm.sweep.api import execute, tree_of
from mpm.sweep.cases import plan
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.store import Refused, Store

ROOT = Path(__file__).parents[2]


def go(config, out, jobs=0):
    return execute(load(config), out, Options(jobs=jobs, runner="fake_runner"))


SCRIPT = """
import sys
from pathlib import Path
sys.path[:0] = [{root!r}, {fakes!r}]
from mpm.config import load
from mpm.sweep.api import execute
from mpm.sweep.engine import Options
print("go", flush=True)
sys.exit(execute(load({config!r}), Path({out!r}), Options(jobs=2, runner="fake_runner")).exit_code)
"""


def start(config, out, marks, **options):
    code = SCRIPT.format(root=str(ROOT), fakes=str(ROOT / "tests" / "fakes"), config=config, out=str(out))
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
    end = time.monotonic() + 20
    while len([row for row in marks() if row[0] == "run"]) < 2 and time.monotonic() < end:
        time.sleep(0.05)
    return process


def gone(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return Path(f"/proc/{pid}/stat").read_text().split()[2] == "Z"


def test_sigterm_to_the_whole_group_leaves_what_ran_pending(config, tmp_path, marks):
    """As a batch system or `timeout` does it: the workers hear it too, and must not count as killed."""
    process = start(config([fake.BRIEF, fake.SLOW]), tmp_path / "out", marks, start_new_session=True)
    os.killpg(process.pid, signal.SIGTERM)
    process.communicate(timeout=20)
    assert process.returncode == 143
    status = tree_of(tmp_path / "out" / "sweep.nc").status.values.tolist()
    assert 3 not in status and 6 in status


def test_ctrl_c_leaves_checkpoints_and_the_same_command_goes_on_from_them(config, tmp_path, marks):
    points, out = config([fake.BRIEF, fake.BRIEF + 1e-9, fake.DIVERGES, 0.5]), tmp_path / "out"
    process = start(points, out, marks)
    time.sleep(0.3)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode == 130 and time.monotonic() - began < 2
    assert tree_of(out / "sweep.nc").status.values.tolist() == [6, 6, 6, 6] and len(list((out / "checkpoints").iterdir())) == 2
    assert go(points, out, jobs=2).counts["ok"] == 3
    begins = [int(row[1]) for row in marks() if row[0] == "from"]
    assert begins[:2] == [0, 0] and min(begins[2:]) > 10 and list((out / "checkpoints").iterdir()) == []
    go(config([fake.BRIEF, fake.BRIEF + 1e-9, fake.DIVERGES, 0.5]), tmp_path / "whole", jobs=2)
    assert compare(tmp_path / "whole", out) == []


def test_killed_again_and_again_loses_nothing_that_finished(config, tmp_path, marks):
    points = config([round(0.01 * k, 2) for k in range(1, 601)])
    go(points, tmp_path / "whole")
    run_ids = [case.run_id for case in plan(load(points)).cases]
    done = 0
    for wait in (0.0, 0.05):
        process = start(points, tmp_path / "out", lambda done=done: marks()[600 + done :])
        time.sleep(wait)
        process.kill()
        process.communicate(timeout=20)
        end = time.monotonic() + 2
        while not all(gone(int(row[-1])) for row in marks()[600:]) and time.monotonic() < end:
            time.sleep(0.02)
        lines, damaged = Store(tmp_path / "out").lines(run_ids)
        assert not damaged and all(line["status"] == 0 for line in lines.values())
        done = len(marks()) - 600
    kept = len(lines)
    assert 0 < kept < 600 and go(points, tmp_path / "out", jobs=2).ran == 600 - kept
    assert compare(tmp_path / "whole", tmp_path / "out") == []


def test_two_sweeps_on_one_folder(config, tmp_path, marks):
    process = start(config([fake.SLOW, fake.HANGS]), tmp_path / "out", marks)
    with pytest.raises(Refused, match=f"in use by process {process.pid} on"):
        go(config([0.2]), tmp_path / "out")
    process.kill()
    process.communicate(timeout=20)
    assert go(config([0.2]), tmp_path / "out").exit_code == 0
