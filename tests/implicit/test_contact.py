"""Friction and tools by implicit steps: a block on an incline that slides and one that sticks, a plate that presses a bar."""

import math

import numpy as np
import pytest

import mpm
from mpm.runner import run_point


def block(friction, end):
    """A block of elastic material on a floor of 30 degrees; the floor lies along the grid."""
    return mpm.load(
        {
            "grid": {"dimension": 2, "size": [2, 0.75], "cell": 0.125},
            "bodies": {"block": {"shape": {"box": {"lower": [0.3, 0], "upper": [0.55, 0.25]}}, "material": "stiff"}},
            "materials": {"stiff": {"density": 1, "elastic": {"hencky": {"E": 400, "nu": 0.3}}}},
            "walls": {"bottom": {"contact": {"friction": friction}}},
            "gravity": [0.5, -math.sqrt(0.75)], "method": {"mechanics": "implicit"}, "time": {"end": end},
            "output": {"every": 0.1, "observables": ["force.bottom_x", "force.bottom_y"]},
        }
    )  # fmt: skip


@pytest.mark.slow
def test_a_block_slides_at_coulombs_rate():
    """(sin 30 - 0.2 cos 30) t^2/2 within 0.5 %, pulled at by friction times its weight, which takes friction times weight times way."""
    run, weight = run_point(block(0.2, 1.5)), math.sqrt(0.75) / 16
    way = run.series["position_mean_x"][-1] - run.series["position_mean_x"][0]
    assert run.outcome.ok and run.facts["shifts"] == 0
    assert way == pytest.approx(0.5 * (0.5 - 0.2 * math.sqrt(0.75)) * 1.5**2, rel=5e-3)
    assert run.series["force_bottom_x"][-1] == pytest.approx(-0.2 * run.series["force_bottom_y"][-1], rel=1e-3)
    assert run.series["force_bottom_y"][-1] == pytest.approx(weight, rel=0.02)
    assert run.series["dissipation_friction"][-1] == pytest.approx(0.2 * weight * way, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.7, math.inf])
def test_a_block_that_sticks_stays(friction):
    """tan 30 < 0.7: once its springs have come to rest it does not creep, for any number of steps."""
    x = run_point(block(friction, 4.0)).series["position_mean_x"]
    assert abs(x[-1] - x[20]) < 1e-6 and x[-1] - x[0] < 5e-4


@pytest.mark.slow
def test_a_plate_presses_a_bar():
    """A bar against a wall pressed by a tenth: the force is that of Hencky's law, (lam + 2 mu) ln(stretch)/stretch, and its work (0.39 and 0.36 % less,
    of which 0.34 are the depth of contact: a penalty gives way by a hundredth of a cell)."""
    E, nu, cut = 1e4, 0.3, 0.1
    run = run_point(
        mpm.load(
            {
                "grid": {"dimension": 1, "size": [1.5], "cell": 0.025},
                "bodies": {"bar": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "soft"}},
                "materials": {"soft": {"density": 1, "elastic": {"hencky": {"E": E, "nu": nu}}}},
                "tools": {"plate": {"shape": {"box": {"lower": [1.0], "upper": [1.2]}}, "motion": {"velocity": [-cut / 10], "until": 10}}},
                "method": {"mechanics": "implicit"}, "time": {"end": 20},
                "output": {"every": 2, "observables": ["force.plate_x", "travel.plate_x"]},
            }
        )
    )  # fmt: skip
    M = E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
    assert run.outcome.ok and run.finals["kinetic_over_work"] < 1e-3 and run.series["travel_plate_x"][-1] == pytest.approx(-cut)
    assert run.series["force_plate_x"][-1] == pytest.approx(M * math.log(1 - cut) / (1 - cut), rel=5e-3)
    assert run.series["work_loads"][-1] == pytest.approx(0.5 * M * math.log(1 - cut) ** 2, rel=5e-3)
    assert np.ptp(run.series["force_plate_x"][-4:]) < 1e-3 * abs(run.series["force_plate_x"][-1])
