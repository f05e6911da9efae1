"""Flight: velocity to round-off, displacement g t dt/2 too far, exactly."""

import numpy as np
import pytest

from mpm.verification import exact_solution, free_fall

STEPS = (0.08, 0.04, 0.02)


def test_the_error_is_half_a_step_of_speed(core, points):
    runs = points("free_fall", "time.step", STEPS)
    for run, step in zip(runs, STEPS, strict=True):
        assert run.finals["error_velocity"] < 1e-14
        assert run.series["error_displacement_l2"] == pytest.approx(2 * run.times * step / 2, rel=1e-10, abs=1e-13)
        assert np.abs(run.series["J_max"] - 1).max() < 1e-12
    assert core.order([run.finals["error_displacement"] for run in runs]) > free_fall.ORDER


def test_another_scene_is_refused(shipped):
    with pytest.raises(ValueError, match="gravity"):
        exact_solution(shipped("free_fall", {"gravity": None}))
