"""Friction and tools by implicit steps: a block on an incline that slides and one that sticks, a plate that presses a bar."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import mpm
from mpm.implicit.contact import STIFFNESS
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


def weight_on_a_bar(**changes):
    """A plate of 0.05 that a force of 0.05 pushes on to a bar of lam + 2 mu = 1, foot on a wall."""
    return mpm.load(
        {
            "grid": {"dimension": 1, "size": [2.0], "cell": 0.125},
            "bodies": {"bar": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "soft"}},
            "materials": {"soft": {"density": 1, "elastic": {"hencky": {"lam": 0.3, "mu": 0.35}}}},
            "tools": {"plate": {"shape": {"box": {"lower": [1.0], "upper": [1.5]}}, "motion": {"force": [-0.05], "mass": 0.05}}},
            "walls": {"left": "stick"}, "method": {"mechanics": "implicit"}, "time": {"end": 1e5, "step": 1e4}, "output": {"every": 1e5},
        },
        changes,
    )  # fmt: skip


@pytest.mark.plain
def test_a_weight_comes_to_rest_on_a_bar():
    """ln(stretch) = -0.05 stretch, and the penalty's depth on top (5.1e-5, 1.4e-5, 9e-6 off); the bar bears all of the force."""
    stretch = brentq(lambda one: np.log(one) + 0.05 * one, 0.3, 1.0)
    for n, most in ((4, 1e-4), (8, 3e-5), (16, 2e-5)):
        run = run_point(weight_on_a_bar(**{"grid.cell": str(1 / n)}))
        assert run.outcome.ok
        assert run.finals["travel_plate_x"] == pytest.approx(stretch - 1 - 0.05 / (STIFFNESS * n), abs=most)
        assert run.finals["force_plate_x"] == pytest.approx(-0.05, rel=1e-6)


@pytest.mark.plain
def test_a_tool_falls_free():
    """Half of acceleration times time squared, to round-off, and nothing of it in the bar that it has not reached."""
    run = run_point(weight_on_a_bar(**{"tools.plate.motion.force": [-2e-3], "tools.plate.shape.box": {"lower": [1.2], "upper": [1.6]},
                                       "time": {"end": 2, "step": 0.5}, "output.every": 2}))  # fmt: skip
    assert run.outcome.ok and run.finals["travel_plate_x"] == pytest.approx(-0.5 * 0.04 * 4, rel=1e-10)
    assert run.finals["force_plate_x"] == 0 and run.finals["position_mean_x"] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.slow
def test_a_weight_sinks_into_dough_as_by_explicit_steps():
    """A plate on a disc of viscous dough for a second: travel and width within 1 %."""

    def pressed(mechanics):
        return run_point(mpm.load({
            "grid": {"dimension": "axisymmetric", "size": [0.03, 0.024], "cell": 2e-3},
            "bodies": {"disc": {"shape": {"cylinder": {"radius": 0.015, "height": 0.012, "base": [0, 0]}}, "material": "dough"}},
            "materials": {"dough": {"density": 1000, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}, "flow": {"ellipse": {"M": 60, "p0": 8, "eta": 500}}}},
            "tools": {"plate": {"shape": {"cylinder": {"radius": 0.025, "height": 0.006, "base": [0, 0.012]}}, "friction": 0.3,
                                "motion": {"force": [0, -0.02], "mass": 0.01}}},
            "walls": {"bottom": {"contact": {"friction": 0.3}}}, "gravity": [0, -9.81],
            "method": {"mechanics": mechanics}, "time": {"end": 1}, "output": {"every": 1},
        }))  # fmt: skip

    one, two = pressed("implicit"), pressed("explicit")
    assert one.outcome.ok and two.outcome.ok
    for name in ("travel_plate_z", "position_max_r"):
        assert one.finals[name] == pytest.approx(two.finals[name], rel=1e-2), name
