"""Slow ones of the table: bars at rest and dropped, in plain Python."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

pytestmark = pytest.mark.slow
WEIGHT = 0.09  # rho g H/(lam + 2 mu)


def standing(gap, n=16):
    """A bar of n cells on a wall, or dropped on to it from `gap` cells, under its weight; a drag brings it to rest."""
    return {
        "grid": {"dimension": 1, "size": [2.0], "cell": 1 / n},
        "bodies": {"bar": {"shape": {"box": {"lower": [gap / n], "upper": [gap / n + 1.0]}}, "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}},
        "walls": {"left": "contact"}, "gravity": [-WEIGHT], "loads": [{"of": "bar", "drag": {"rate": 3.0}}],
        "time": {"end": 30.0}, "output": {"every": 3.0},
    }  # fmt: skip


@pytest.mark.parametrize("gap", [0.0, 0.3, 0.77])
def test_a_bar_under_its_weight(plain, gap):
    """ln F/F = -rho g (1 - X)/(lam + 2 mu): the top to 0.5 % of its way down, the strain of the foot to 5 %."""
    X = (np.arange(1000) + 0.5) / 1000
    F = np.array([brentq(lambda f, x=x: math.log(f) / f + WEIGHT * (1 - x), 0.5, 1.0) for x in X])
    (run,) = plain([standing(gap)])
    assert run["kind"] == "completed" and run["series"]["velocity_max"][-1] < 1e-6
    assert run["series"]["position_max_x"][-1] == pytest.approx(F.mean(), abs=0.005 * (1 - F.mean()))
    assert math.log(run["series"]["J_min"][-1]) == pytest.approx(math.log(F[0]), rel=0.05)
