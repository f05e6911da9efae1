"""A sweep of implicit runs has the same bits in one process, in two, and over Dask; and explicit runs know nothing of implicit mechanics."""

import subprocess
import sys
from pathlib import Path

import pytest

from mpm.config import load
from mpm.sweep.api import execute
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options

COLUMN = Path(__file__).parents[2] / "configs" / "verification" / "hydrostatic_column.yaml"
FREE = {"exact": None, "grid.cell": 0.125, "output.every": 0.5, "time.end": 1}
SWEPT = FREE | {"method.mechanics": "implicit", "sweep": {"axes": {"gravity.0": [-0.06, -0.12, -0.2], "method.frame": ["updated", "total"]}}}


@pytest.mark.slow
def test_one_process_two_and_dask(tmp_path):
    for name, options in (("one", {"jobs": 1}), ("two", {"jobs": 2}), ("dask", {"jobs": 2, "scheduler": "local"})):
        result = execute(load(COLUMN, SWEPT), tmp_path / name, Options(**options), None)
        assert result.counts["ok"] == 6
    assert compare(tmp_path / "one", tmp_path / "two") == [] and compare(tmp_path / "one", tmp_path / "dask") == []


@pytest.mark.plain
def test_explicit_runs_load_nothing_of_it():
    code = f"""
import sys
from mpm.config import load
from mpm.runner import run_point
from mpm.simulation import simulate
assert run_point(load({str(COLUMN)!r}, {FREE | {"sweep": None}!r})).outcome.ok
sys.exit(any(name.startswith("mpm.implicit") for name in sys.modules))
"""
    assert subprocess.run([sys.executable, "-c", code], env={"NUMBA_DISABLE_JIT": "1"}, check=False).returncode == 0
