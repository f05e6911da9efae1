"""Implicit steps in three directions: what is the same in fewer directions, and exact cases."""

import math

import numpy as np
import pytest

import mpm
from mpm.runner import run_point

SOFT = {"soft": {"density": 1e3, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}, "flow": {"ellipse": {"M": 60, "p0": 2, "eta": 500}}}}


def slab(dimension, **method):
    """A block that sinks and spreads on its floor between two slip walls; in plane strain there is none of the third direction."""
    flat = dimension == 2
    return mpm.load(
        {
            "grid": {"dimension": dimension, "size": [0.03, 0.016] if flat else [0.03, 0.004, 0.016], "cell": 2e-3},
            "bodies": {"slab": {"shape": {"box": {"lower": [0.004, 0] if flat else [0.004, 0, 0], "upper": [0.018, 0.012] if flat else [0.018, 0.004, 0.012]}},
                                "material": "soft"}},
            "materials": SOFT, "walls": {"bottom": "stick"}, "gravity": [0, -9.81] if flat else [0, 0, -9.81],
            "method": {"mechanics": "implicit", **method}, "time": {"end": 2.0, "step": 0.25}, "output": {"every": 1.0},
        }
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("locking", [None, {"fbar": {}}])
def test_a_slab_between_walls_is_plane_strain(locking):
    """The same numbers as in two directions, to what conjugate gradients leave."""
    plane, space = run_point(slab(2, locking=locking)), run_point(slab(3, locking=locking))
    assert plane.outcome.ok and space.outcome.ok
    for two, three in (("position_mean_x", "position_mean_x"), ("position_mean_y", "position_mean_z"), ("J_min", "J_min"), ("J_max", "J_max")):
        assert space.finals[three] == pytest.approx(plane.finals[two], rel=1e-8)
    assert space.finals["dissipation_total"] == pytest.approx(0.004 * plane.finals["dissipation_total"], rel=1e-7)


@pytest.mark.slow
def test_a_free_body_swells_without_stress():
    """J = exp(3 alpha dTheta), everywhere."""
    run = run_point(
        mpm.load(
            {
                "grid": {"dimension": 3, "size": [0.05] * 3, "cell": 0.005},
                "bodies": {"one": {"shape": {"box": {"lower": [0.012, 0.013, 0.014], "upper": [0.034, 0.033, 0.030]}}, "material": "soft", "temperature": 300}},
                "materials": {"soft": {"density": 1e3, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1e3, "alpha": 1000}},
                                       "expansion": {"linear": {"coefficient": 1e-3, "reference": 300}}}},
                "surfaces": [{"of": "one", "side": "all", "convection": {"beta": 1e3, "outside": 340}}],
                "method": {"mechanics": "implicit"}, "time": {"end": 600}, "output": {"every": 300},
            }
        )
    )  # fmt: skip
    assert run.outcome.ok
    assert run.finals["J_min"] == pytest.approx(math.exp(0.12), rel=1e-3) and run.finals["J_max"] == pytest.approx(math.exp(0.12), rel=1e-3)


@pytest.mark.slow
def test_a_cantilever_sags():
    """Under its own weight by w L^4/(8 E I) and by shear, w L^2/(2 kappa G A), within 3 %: six cells high."""
    L, H, E, nu, g = 0.12, 0.03, 1e6, 0.3, 1.0
    run = run_point(
        mpm.load(
            {
                "grid": {"dimension": 3, "size": [0.14, 0.05, 0.06], "cell": 0.005},
                "bodies": {"beam": {"shape": {"box": {"lower": [0, 0.01, 0.02], "upper": [L, 0.04, 0.05]}}, "material": "rubber"}},
                "materials": {"rubber": {"density": 1e3, "elastic": {"hencky": {"E": E, "nu": nu}}}},
                "walls": {"left": "stick"}, "gravity": [0, 0, -g], "method": {"mechanics": "implicit"},
                "time": {"end": 1e4, "step": 1e4}, "output": {"every": 1e4, "probes": {"tip": [L, 0.025, 0.035]}, "observables": ["displacement.tip_z"]},
            }
        )
    )  # fmt: skip
    w, area = 1e3 * g * H * H, H * H
    sag = w * L**4 / (8 * E * H**4 / 12) + w * L**2 / (2 * (5 / 6) * E / (2 * (1 + nu)) * area)
    assert run.outcome.ok and -run.finals["displacement_tip_z"] == pytest.approx(sag, rel=0.03)


@pytest.mark.slow
def test_a_block_slides_in_space():
    """Coulomb's rate along a diagonal of the floor."""
    pull = np.array([0.3, 0.4]) / 1.0
    run = run_point(
        mpm.load(
            {
                "grid": {"dimension": 3, "size": [1.0, 1.0, 0.375], "cell": 0.125},
                "bodies": {"block": {"shape": {"box": {"lower": [0.2, 0.2, 0], "upper": [0.45, 0.45, 0.25]}}, "material": "stiff"}},
                "materials": {"stiff": {"density": 1, "elastic": {"hencky": {"E": 400, "nu": 0.3}}}},
                "walls": {"bottom": {"contact": {"friction": 0.2}}}, "gravity": [*pull, -math.sqrt(0.75)],
                "method": {"mechanics": "implicit"}, "time": {"end": 1.0}, "output": {"every": 0.25},
            }
        )
    )  # fmt: skip
    way = [run.series[f"position_mean_{axis}"][-1] - run.series[f"position_mean_{axis}"][0] for axis in "xy"]
    assert run.outcome.ok and np.hypot(*way) == pytest.approx(0.5 * (0.5 - 0.2 * math.sqrt(0.75)), rel=0.01)
    assert way[1] / way[0] == pytest.approx(4 / 3, rel=1e-3)
