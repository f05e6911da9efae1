"""A sweep of implicit runs has the same bits in one process, in two, and over Dask; and explicit runs know nothing of implicit mechanics."""

import subprocess
import sys

import pytest

from mpm.config import load
from mpm.sweep.api import execute
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options

COLUMN = {
    "grid": {"dimension": 1, "size": [1.5], "cell": 0.125},
    "bodies": {"column": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "soft"}},
    "materials": {"soft": {"density": 1e3, "elastic": {"hencky": {"lam": 0, "mu": 5e4}}}},
    "gravity": [-9.81],
    "method": {"mechanics": "implicit"},
    "time": {"end": 1},
    "output": {"every": 0.5},
    "sweep": {"axes": {"gravity.0": [-3.0, -6.0, -9.81], "method.frame": ["updated", "total"]}},
}


@pytest.mark.slow
def test_one_process_two_and_dask(tmp_path):
    for name, options in (("one", {"jobs": 1}), ("two", {"jobs": 2}), ("dask", {"jobs": 2, "scheduler": "local"})):
        result = execute(load(COLUMN), tmp_path / name, Options(**options), None)
        assert result.counts["ok"] == 6
    assert compare(tmp_path / "one", tmp_path / "two") == [] and compare(tmp_path / "one", tmp_path / "dask") == []


@pytest.mark.plain
def test_explicit_runs_load_nothing_of_it():
    code = f"""
import sys
from mpm.config import load
from mpm.runner import run_point
from mpm.simulation import simulate
made = {COLUMN | {"method": {}, "time": {"end": 0.01}, "output": {"every": 0.01}, "sweep": None}!r}
assert run_point(load({{key: value for key, value in made.items() if value}})).outcome.ok
sys.exit(any(name.startswith("mpm.implicit") for name in sys.modules))
"""
    assert subprocess.run([sys.executable, "-c", code], env={"NUMBA_DISABLE_JIT": "1"}, check=False).returncode == 0
