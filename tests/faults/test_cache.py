"""R13: many processes on an empty compile cache at once, and cache files that are cut or wrong: nobody crashes, and all get the same numbers."""

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CODE = "import numpy as np; from mpm.diagnostics import enthalpies; from mpm.materials.laws import Constant; print(enthalpies(Constant(2.0), np.arange(3.0)))"


def start(cache):
    env = {**os.environ, "MPM_CACHE_DIR": str(cache), "NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    return subprocess.Popen([sys.executable, "-c", CODE], cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def outcome(process):
    out, err = process.communicate(timeout=600)
    return process.returncode, out, err[-600:]


def test_cut_and_wrong_cache_files_are_made_anew(tmp_path):
    rng = random.Random(1)
    good = outcome(start(tmp_path))
    assert good[0] == 0 and good[1] == "[0. 2. 4.]\n", good
    made = [path for path in tmp_path.rglob("*") if path.suffix in (".nbi", ".nbc")]
    assert made
    for change in (lambda data: data[: rng.randrange(len(data))], lambda data: b"", lambda data: data[:40] + bytes([data[40] ^ 4]) + data[41:]):
        for path in made:
            path.write_bytes(change(path.read_bytes()))
        assert outcome(start(tmp_path))[:2] == good[:2]
        assert outcome(start(tmp_path))[:2] == good[:2]


@pytest.mark.slow
def test_32_processes_on_an_empty_cache(tmp_path, table):
    bad, rounds = [], int(os.environ.get("MPM_ROUNDS", "20"))
    for turn in range(rounds):
        ended = [outcome(process) for process in [start(tmp_path / str(turn)) for _ in range(32)]]
        bad += [one for one in ended if one[:2] != (0, "[0. 2. 4.]\n")]
    table(f"32 processes at once on a cold cache, {rounds} times", f"{len(bad)} crashes")
    assert not bad
