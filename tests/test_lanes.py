"""Every operation on lanes: compiled equals plain Python, in both precisions, NaN included."""

import numpy as np
import pytest

from mpm.jit import kernel
from mpm.lanes import absolute, below, floor, fma, four, high, item, join, least, load4, load8, low, maximum, minimum, most, peek, poke, splat4, splat8, store


@kernel
def everything(a, b, out, number):
    x, y = load8(a, 0), load8(b, 0)
    store(out, 0, x + y)
    store(out, 8, x - y)
    store(out, 16, x * y)
    store(out, 24, x / y)
    store(out, 32, -x)
    store(out, 40, fma(x, y, x))
    store(out, 48, absolute(x))
    store(out, 56, minimum(x, y))
    store(out, 64, maximum(x, y))
    store(out, 72, floor(x))
    store(out, 80, below(x, y))
    store(out, 88, join(high(x), low(y)))
    store(out, 96, load4(a, 3) + splat4(number))
    store(out, 100, four(a[0], b[1], a[2], number))
    store(out, 104, splat8(number))
    poke(out, 112, peek(a, 5))
    out[113], out[114], out[115] = least(y), most(y), item(x, 2)


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("holes", [False, True], ids=["numbers", "NaN"])
def test_compiled_equals_plain(real, holes):
    rng = np.random.default_rng(1)
    a, b = (3 * rng.standard_normal(8)).astype(real), (3 * rng.standard_normal(8)).astype(real)
    if holes:
        a[1], a[4] = np.nan, np.inf
    compiled, plain = np.zeros(116, real), np.zeros(116, real)
    everything(a, b, compiled, real(0.7))
    everything.py_func(a, b, plain, real(0.7))
    assert np.allclose(compiled, plain, rtol=4 * np.finfo(real).eps, atol=4 * np.finfo(real).eps, equal_nan=True)
    assert np.array_equal(compiled[48:72], plain[48:72], equal_nan=True) and compiled[115] == a[2]


def test_a_nan_is_below_nothing():
    """Guards multiply what `below` says: a lane that is no number must fail them."""
    nan, one = np.full(8, np.nan), np.ones(8)
    assert not below(nan, one).any() and not below(one, nan).any() and below(0 * one, one).all()
