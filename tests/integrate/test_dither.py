"""What is added to steps in float32, so that rounding favours no side."""

import math

import numpy as np
import pytest

from mpm.integrate.dither import dither
from mpm.state import Plane

SPACE = Plane(0.01, 105, 40)  # 1 m: units in the last place of 2^-24 m at most


def moved(x, increment, steps, d):
    """x after that many steps of x + (increment + d(k)), every sum rounded to float32."""
    for k in range(steps):
        x = x + np.float32(increment + np.float32(d(k)))
    return x.astype(float)


@pytest.mark.parametrize("steps", [100, 1000, 10_000])
def test_errors_of_rounding_grow_like_a_logarithm(steps):
    """Steps of 0 to 3 units from places on the whole grid: within 2 + 2 ln n units of the exact sum; without it half a unit of the place a step."""
    rng, unit = np.random.default_rng(steps), 2.0**-24
    x = rng.uniform(0.01, 1.0, 500).astype(np.float32)
    increment = np.float32(unit) * rng.uniform(-3.0, 3.0, 500).astype(np.float32)
    exact = x + steps * increment.astype(float)
    error = moved(x, increment, steps, lambda k: dither(SPACE, x, k)) - exact
    plain = moved(x, increment, steps, lambda k: 0.0) - exact
    assert np.abs(error).max() < (2.0 + 2.0 * math.log(steps)) * unit
    assert np.abs(plain).max() > 0.45 * steps * unit


def test_what_it_is():
    """Evenly over one unit in the last place of the largest position; nothing in float64; the same in plain Python."""
    single, double = np.zeros((1, 2), np.float32), np.zeros((1, 2))
    found = np.array([dither(SPACE, single, k) for k in range(1000)]) * 2.0**24
    assert np.abs(found).max() <= 0.5 and abs(found.mean()) < 2e-3
    assert np.histogram(found, 10, (-0.5, 0.5))[0].tolist() == pytest.approx([100] * 10, abs=3)
    assert all(dither(SPACE, double, k) == 0.0 for k in range(5))
    assert [dither.py_func(SPACE, single, k) for k in range(5)] == [dither(SPACE, single, k) for k in range(5)]
    assert dither(Plane(0.0101, 105, 40), single, 7) == dither(Plane(0.02, 105, 40), single, 7) == 2 * dither(SPACE, single, 7)
