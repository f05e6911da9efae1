"""A column of Hencky material (lam = 0) under its own weight, from no stress to equilibrium by implicit steps, against the closed form."""

import numpy as np
import pytest

import mpm
from mpm.runner import run_point

LOAD = 0.29  # rho g H/E


def column(n, **time):
    return mpm.load(
        {
            "grid": {"dimension": 1, "size": [1.5], "cell": 1 / n},
            "bodies": {"column": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "soft"}},
            "materials": {"soft": {"density": 1e3, "elastic": {"hencky": {"lam": 0, "mu": 5e4}}}},
            "gravity": [-LOAD * 1e2],
            "time": {"end": 1e5, "step": 1e5},
            "output": {"every": 1e5},
            "method": {"mechanics": "implicit", "gradient": "bspline"},
        }
        | time
    )


def top_and_middle():
    """Mean position of the material: int x dX of x = int exp(-W)."""
    from scipy.special import lambertw

    X = (np.arange(20000) + 0.5) / 20000
    stretch = np.exp(-lambertw(LOAD * (1 - X)).real)
    return float(np.mean(np.cumsum(stretch) / 20000 - 0.5 * stretch / 20000))


def test_one_step_to_equilibrium():
    """A step over dt alone is of order 2 in the cell (4.8e-3 to 6.5e-5); the pair is nearer everywhere, down to what its one remapping costs (6e-5)."""
    for n, most in ((4, 4.8e-3), (8, 1.1e-3), (16, 2.7e-4), (32, 6.5e-5)):
        run = mpm.run(column(n))
        assert int(run["/"].status) == 0
        assert abs(float(run["/"].position_mean_x) - top_and_middle()) < most


@pytest.mark.plain
@pytest.mark.parametrize("steps", [1, 10])
def test_a_column_in_one_step_or_ten(steps):
    """The closed form with 4, 8, 16 cells: 3.6e-5, 4.6e-6, 5.8e-7, order 3, in ten steps as in one."""
    errors = []
    for n in (4, 8, 16):
        run = run_point(column(n, method={"mechanics": "implicit", "frame": "total"}, time={"end": 1e5, "step": 1e5 / steps}))
        assert run.outcome.ok and run.facts["failed"] == 0
        errors.append(abs(run.finals["position_mean_x"] - top_and_middle()))
    assert errors[0] < 5e-5 and errors[-1] < 1e-6, errors
    assert (np.log2(np.array(errors[:-1]) / errors[1:]) > 2.8).all(), errors


@pytest.mark.plain
def test_a_column_between_two_walls():
    """On a mirror at either end: mean displacement rho g/(12 (lam + 2 mu)), off by 1.0e-3 and 1.3e-4 of it with 8 and 16 cells."""
    for n, most in ((8, 2e-3), (16, 2.6e-4)):
        run = run_point(column(n, grid={"dimension": 1, "size": [1.0], "cell": 1 / n}, gravity=[-0.01], method={"mechanics": "implicit", "frame": "total"}))
        assert run.outcome.ok and 0.5 - run.finals["position_mean_x"] == pytest.approx(1e3 * 0.01 / 12 / 1e5, rel=most)


def test_a_floating_body_does_not_drift():
    """Without a load and with the true inertia, a body that rests stays where it is, however long the step."""
    run = mpm.run(column(16, gravity=[0.0], bodies={"column": {"shape": {"box": {"lower": [0.2], "upper": [1.1]}}, "material": "soft"}},
                         method={"mechanics": "implicit"}))  # fmt: skip
    x = run["series"].position_mean_x.values
    assert abs(x[-1] - x[0]) < 1e-10 / 16


@pytest.mark.plain
def test_what_is_thrown_at_a_wall_stops_there():
    """In a step of 4 s it would fly out of the domain: that one is cut, none passes the wall, and the motion that steps damp is told."""
    run = run_point(column(8, gravity=[0.0], bodies={"column": {"shape": {"box": {"lower": [0.3], "upper": [1.1]}}, "material": "soft", "velocity": [-1.0]}},
                           method={"mechanics": "implicit"}, time={"end": 8, "step": 4}, output={"every": 8}))  # fmt: skip
    assert run.outcome.ok and run.facts["failed"] > 0 and run.finals["position_min_x"] > 0 and run.finals["kinetic_over_work"] < 0.1
    assert any(text.startswith("energy:") for text in run.facts["warnings"])


@pytest.mark.parametrize("end", [1.0])
def test_free_fall(end):
    """The impulse to round-off, v = g t; and what a step of order 1 falls too far, g dt t/2, the extrapolation takes off."""
    run = mpm.run(column(16, gravity=[-0.01], bodies={"column": {"shape": {"box": {"lower": [0.3], "upper": [1.1]}}, "material": "soft"}},
                         method={"mechanics": "implicit"}, time={"end": end, "step": 0.1}, output={"every": 0.1}))  # fmt: skip
    series = run["series"]
    np.testing.assert_allclose(series.momentum_x, -0.01 * series.time * 800, rtol=0, atol=1e-9)
    fallen = series.position_mean_x.values[0] - series.position_mean_x.values[-1]
    assert fallen == pytest.approx(0.5 * 0.01 * end * end, rel=1e-8)
