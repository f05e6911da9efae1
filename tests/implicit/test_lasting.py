"""Implicit steps in the total frame: weights of the reference shape, no remapping."""

from pathlib import Path

import pytest

import mpm
from mpm.benchmarks.implicit import stack
from mpm.runner import run_point

COLUMN = Path(__file__).parents[2] / "configs" / "studies" / "viscous_column.yaml"
VERIFICATION = Path(__file__).parents[2] / "configs" / "verification"
STACK = 0.03685021840933645  # m, mean height of the stack of material points that the column is
REST = {"time.end": "1e5", "output.every": "1e5", "method.mechanics": "implicit", "method.frame": "total"}


@pytest.mark.plain
def test_flow_is_that_of_a_stack_of_points():
    """What flow leaves is kept on particles: mean height of a viscous column after 20 s, 3.1e-5 off with cells of 10 mm (updated frame 2.7e-4)."""
    run = run_point(mpm.load(COLUMN, {"method.frame": "total", "output.every": "20", "grid.cell": "10 mm"}))
    assert run.outcome.ok and abs(run.finals["position_mean_x"] / STACK - 1) < 6e-5


@pytest.mark.slow
def test_the_stack_of_points_is_as_high_as_is_said():
    assert stack(mpm.load(COLUMN)) == pytest.approx(STACK, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("nu", "locking", "most"), [(0.3, None, (2e-4, 2.5e-5, 3e-6)), (0.499, {"fbar": {}}, (2e-3, 9e-5, 1.9e-5))])
def test_a_heated_ring(nu, locking, most):
    """Timoshenko's thick cylinder, heat and motion, in one step to rest: 9.7e-5, 1.2e-5, 1.5e-6, order 3, and nearly incompressible 1.0e-3, 5.8e-5, 9.5e-6."""
    for cell, bound in zip((0.1, 0.05, 0.025), most, strict=True):
        changes = {"grid.cell": str(cell), "materials.steel.elastic.hencky.nu": str(nu), "method.locking": locking, "time.step": "1e5", "loads": []}
        run = run_point(mpm.load(VERIFICATION / "thermal_cylinder_total.yaml", REST | changes))
        assert run.outcome.ok and run.facts["failed"] == 0 and run.finals["error_displacement"] < bound


@pytest.mark.slow
def test_a_cantilever_that_bends_far():
    """At rest, half its length down: the displacement of finite elements, as by explicit steps (1.0e-3, 4.1e-4 with 2 and 4 cells over the thickness)."""
    for cell, most in ((0.05, 1.3e-3), (0.025, 6e-4)):
        changes = {"grid.cell": str(cell), "loads": [], "time.end": "100", "output.every": "100"}
        run = run_point(mpm.load(VERIFICATION / "cantilever_far_total.yaml", REST | changes))
        assert run.outcome.ok and run.finals["error_displacement"] < most


@pytest.mark.slow
def test_a_pipe_under_a_pressure_that_follows_its_bore():
    """A quarter wider inside, at rest: the displacement of the exact solution, as by explicit steps (1.53e-3, 1.89e-4 at cells of 0.2, 0.1)."""
    for cell, most in ((0.2, 2e-3), (0.1, 3e-4)):
        run = run_point(mpm.load(VERIFICATION / "pressed_cylinder_total.yaml", {"method.mechanics": "implicit", "grid.cell": str(cell), "output.every": "40"}))
        assert run.outcome.ok and run.finals["error_displacement"] < most
