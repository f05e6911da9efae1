"""Implicit steps in the total frame: weights of the reference shape, no remapping."""

from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.benchmarks.implicit import stack
from mpm.runner import run_point

COLUMN = Path(__file__).parents[2] / "configs" / "studies" / "viscous_column.yaml"
VERIFICATION = Path(__file__).parents[2] / "configs" / "verification"
REST = {"time.end": "1e5", "output.every": "1e5", "method.mechanics": "implicit", "method.frame": "total"}


@pytest.mark.slow
def test_flow_is_that_of_a_stack_of_points():
    """What flow leaves is kept on particles: mean height of a viscous column after 20 s, with its default steps."""
    right = stack(mpm.load(COLUMN))
    run = run_point(mpm.load(COLUMN, {"method.frame": "total", "output.every": "20"}))
    assert run.outcome.ok and abs(run.finals["position_mean_x"] / right - 1) < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize(("nu", "locking", "most"), [(0.3, None, 2e-3), (0.499, {"fbar": {}}, 4e-3)])
def test_a_heated_ring(nu, locking, most):
    """Timoshenko's thick cylinder, heat and motion, at rest; nearly incompressible too."""
    errors = []
    for cell in (0.1, 0.05, 0.025):
        changes = {"grid.cell": str(cell), "materials.steel.elastic.hencky.nu": str(nu), "method.locking": locking, "time.step": "1e5", "loads": []}
        run = run_point(mpm.load(VERIFICATION / "thermal_cylinder_total.yaml", REST | changes))
        assert run.outcome.ok and run.facts["failed"] == 0
        errors.append(run.finals["error_displacement"])
    assert errors[1] < most and (np.log2(np.array(errors[:-1]) / errors[1:]) > 1.8).all(), errors


@pytest.mark.slow
def test_a_cantilever_that_bends_far():
    """At rest, half its length down: the displacement of finite elements, as by explicit steps (1.0e-3, 4.1e-4 with 2 and 4 cells over the thickness)."""
    for cell, most in ((0.05, 1.3e-3), (0.025, 6e-4)):
        changes = {"grid.cell": str(cell), "loads": [], "time.end": "100", "output.every": "100"}
        run = run_point(mpm.load(VERIFICATION / "cantilever_far_total.yaml", REST | changes))
        assert run.outcome.ok and run.finals["error_displacement"] < most
