"""R11, R12: the same command again, an added value, an edited parameter, other source; a folder in use, and a lock whose owner died."""

import os
import signal
import subprocess
import sys

import pytest
from scenes import config, go

from mpm.sweep.compare import compare
from mpm.sweep.lock import Refused
from mpm.sweep.report import Reporter

HOLD = """
import os, sys, time
sys.path[:0] = {paths!r}
from pathlib import Path
from mpm.records import netcdf
from mpm.sweep.lock import Lock
Lock(Path({out!r})).__enter__()
(Path({out!r}) / ".half.nc.0.tmp").write_bytes(b"half")
print("held", flush=True)
time.sleep(60)
"""


class Ears(Reporter):
    def __init__(self):
        self.told = []

    def note(self, text):
        self.told.append(text)


def test_what_runs_again(tmp_path, marks, monkeypatch, table):
    out = tmp_path / "out"
    assert go(config([0.2, 0.5]), out).ran == 2
    again, added = go(config([0.2, 0.5]), out).ran, go(config([0.2, 0.5, 0.8]), out).ran
    edited = config([0.2, 0.5, 0.8], time={"end": 8})
    with pytest.raises(Refused, match=r"time.end: 10.0 -> 8.0"):
        go(edited, out)
    affected = go(edited, out, rerun="stale").ran
    back = go(config([0.2, 0.5, 0.8]), out, rerun="stale").ran  # the points of before are there still
    monkeypatch.setattr("mpm.sweep.queue.source_hash", lambda: "other")
    kept, stale = go(config([0.2, 0.5, 0.8]), out).ran, go(config([0.2, 0.5, 0.8]), out, rerun="stale").ran
    table("same command again; added axis value; edited parameter", f"{again} points; {added} of 3; {affected} of 3, refused by key without --rerun stale")
    assert (again, added, affected, back, kept, stale) == (0, 1, 3, 0, 0, 3)


def test_a_folder_in_use_and_a_lock_whose_owner_died(tmp_path, table):
    out, ears = tmp_path / "out", Ears()
    go(config([0.2]), out)
    holder = subprocess.Popen([sys.executable, "-c", HOLD.format(paths=sys.path, out=str(out))], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(Refused, match=f"in use by process {holder.pid} on "):
        go(config([0.2, 0.5]), out)
    os.kill(holder.pid, signal.SIGKILL)
    holder.wait()
    assert go(config([0.2, 0.5]), out, reporter=ears).ran == 1
    assert len(ears.told) == 1 and f"process {holder.pid} on " in ears.told[0] and "1 half-written files are removed" in ears.told[0]
    assert not list(out.rglob(".*.tmp"))
    table("two sweeps on one folder; a lock whose owner died", "refused, naming the process; cleared and told")
    go(config([0.2, 0.5]), tmp_path / "whole")
    assert compare(tmp_path / "whole", out) == []
