"""Flight: velocity and displacement to round-off, in any step, where steps change too."""

import numpy as np
import pytest

from mpm.verification import exact_solution

pytestmark = pytest.mark.plain

STEPS = (0.08, 0.04, 0.02)


def test_velocity_and_displacement_are_exact(points):
    for run in points("free_fall", "time.step", STEPS):
        assert run.finals["error_velocity"] < 1e-14 and run.finals["error_displacement"] < 1e-13
        assert np.abs(run.series["J_max"] - 1).max() < 1e-12


def test_steps_that_change_do_not_matter(points):
    """The last interval of 0.1 s is cut into three steps of 0.033 s, those before into ten of 0.04 s."""
    for run in points("free_fall", "time.end", (1.3,)):
        assert run.times[-1] == pytest.approx(1.3) and run.finals["error_velocity"] < 1e-14 and run.finals["error_displacement"] < 1e-13


def test_another_scene_is_refused(shipped):
    with pytest.raises(ValueError, match="gravity"):
        exact_solution(shipped("free_fall", {"gravity": None}))
