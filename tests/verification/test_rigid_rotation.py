"""A quarter turn in flight: position and strain within the load of rotation, at any cell; angular velocity steady."""

import numpy as np
import pytest

from mpm.verification import exact_solution, rigid_rotation

LOAD = rigid_rotation.LOAD * 0.01**2 * 0.97**2  # R0 Omega^2 R^2/(lam + 2 mu) of the config


@pytest.mark.wide
def test_within_the_load_of_rotation(points):
    for run in points("rigid_rotation", "grid.cell", (0.5, 0.25)):
        assert np.max(run.series["error_displacement_max"]) < LOAD
        assert np.max(run.series["strain_max"]) < LOAD
        assert np.ptp(run.series["momentum_x"]) < 1e-12 * run.series["momentum_x"][0]
        assert run.finals["error_displacement"] < 1e-4


def test_solution_turns_about_the_moving_centre(shipped):
    motion = exact_solution(shipped("rigid_rotation"))
    from mpm.scene.build import build

    build(shipped("rigid_rotation"), motion)
    centre = np.array([[2.4, 2.6]])
    assert motion.fields["displacement"](centre, 50.0) == pytest.approx(np.array([[0.3, 0.15]]), abs=1e-3)
    edge = centre + np.array([0.5, 0.0])
    quarter = edge + motion.fields["displacement"](edge, np.pi / 2 / 0.01)
    assert quarter - centre - np.array([0.006, 0.003]) * np.pi / 2 / 0.01 == pytest.approx(np.array([[0.0, 0.5]]), abs=1e-3)


def test_another_scene_is_refused(shipped):
    with pytest.raises(ValueError, match="angular_velocity"):
        exact_solution(shipped("rigid_rotation", {"bodies.disc.angular_velocity": None}))
