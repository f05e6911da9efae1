"""Every operation on lanes: compiled equals plain Python, in both precisions, NaN included."""

import numpy as np
import pytest

from mpm.jit import kernel
from mpm.lanes import (
    absolute,
    below,
    choose,
    expm1,
    exponential,
    fetch_ahead,
    floor,
    fma,
    four,
    high,
    item,
    join,
    least,
    like,
    load4,
    load8,
    load_row,
    log1p,
    logarithm,
    low,
    maximum,
    minimum,
    most,
    peek,
    poke,
    precision,
    put,
    splat4,
    splat8,
    sqrt,
    store,
    thirds,
    three,
    transposed,
)


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
    store(out, 116, sqrt(absolute(x)))
    store(out, 124, choose(below(x, y), x, like(x, 2.5)))
    store(out, 132, 2.0 * x + 1.0 - (3.0 - y) / 4.0)
    store(out, 140, put(x, 3, number) * precision(x))
    one = a[5]
    out[148], out[149], out[150] = choose(below(one, like(one, 0.5)), one, like(one, 3.0)), sqrt(absolute(one)), maximum(one, minimum(one, b[2]))


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("holes", [False, True], ids=["numbers", "NaN"])
def test_compiled_equals_plain(real, holes):
    rng = np.random.default_rng(1)
    a, b = (3 * rng.standard_normal(8)).astype(real), (3 * rng.standard_normal(8)).astype(real)
    if holes:
        a[1], a[4] = np.nan, np.inf
    compiled, plain = np.zeros(151, real), np.zeros(151, real)
    everything(a, b, compiled, real(0.7))
    everything.py_func(a, b, plain, real(0.7))
    assert np.allclose(compiled, plain, rtol=4 * np.finfo(real).eps, atol=4 * np.finfo(real).eps, equal_nan=True)
    assert np.array_equal(compiled[48:72], plain[48:72], equal_nan=True) and compiled[115] == a[2]


@kernel
def rows(a, out, number):
    x = load_row(a, 1)
    fetch_ahead(a, 1)  # says nothing
    left, centre, right = thirds(x)
    store(out, 0, fma(like(x, number), x, three(right, centre, left)) - x * x)
    store(out, 13, centre)


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_rows_touch_twelve_numbers(real):
    """Wherever a row lives, one vector or two, what lies behind it is neither read into it nor written."""
    a = np.array([np.nan, *range(1, 13), np.nan], real)
    compiled, plain = np.full(18, -1, real), np.full(18, -1, real)
    rows(a, compiled, real(0.5))
    rows.py_func(a, plain, real(0.5))
    assert np.array_equal(compiled, plain) and plain[12] == -1 and (plain[13:17] == a[5:9]).all() and plain[17] == -1
    assert (plain[:12] == 0.5 * a[1:13] + a[[9, 10, 11, 12, 5, 6, 7, 8, 1, 2, 3, 4]] - a[1:13] ** 2).all()


@kernel
def turned(a, out):
    n = 4
    for lanes in transposed(load4(a, 0), load4(a, 4), load4(a, 8), load4(a, 12)):
        store(out, n - 4, lanes)
        n += 4
    for lanes in transposed(load8(a, 0), load8(a, 8), load8(a, 16), load8(a, 24)):
        store(out, n - 4, lanes)
        n += 8


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_fours_and_eights_transposed(real):
    a = np.arange(32, dtype=real)
    compiled, plain = np.zeros(48, real), np.zeros(48, real)
    turned(a, compiled)
    turned.py_func(a, plain)
    halves = [a.reshape(4, 8)[:, half : half + 4].T for half in (0, 4)]
    assert np.array_equal(compiled, plain) and (plain[:16].reshape(4, 4) == a[:16].reshape(4, 4).T).all()
    assert (plain[16:].reshape(4, 2, 4) == np.stack(halves, axis=1)).all()


def test_a_nan_is_below_nothing():
    """Guards multiply what `below` says: a lane that is no number must fail them."""
    nan, one = np.full(8, np.nan), np.ones(8)
    assert not below(nan, one).any() and not below(one, nan).any() and below(0 * one, one).all()


@kernel
def powers(x, out):
    n = x.shape[0]
    for p in range(0, n, 8):
        store(out, p, log1p(load8(x, p)))
        store(out, n + p, expm1(load8(x, p)))
        store(out, 2 * n + p, exponential(load8(x, p)))
        store(out, 3 * n + p, logarithm(absolute(load8(x, p)) + 1e-30))


N = 1 << 18 if hasattr(powers, "signatures") else 1 << 10


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_logarithm_and_exponential_to_two_ulp(real):
    """Over every size of argument, against the library in long double."""
    rng = np.random.default_rng(3)
    small = 10.0 ** rng.uniform(-30, 0, N // 4)
    x = np.concatenate([rng.uniform(-0.99, 3, N // 4), small, -0.999 * small, rng.uniform(-80, 80, N // 8), 10.0 ** rng.uniform(0, 30, N // 8)]).astype(real)
    out = np.zeros((4, N), real)
    powers(x, out)
    wide, unit = x.astype(np.longdouble), np.finfo(real).eps
    inside, moderate = x > -1, np.abs(x) < 80
    for found, function, where in ((out[0], np.log1p, inside), (out[1], np.expm1, moderate), (out[2], np.exp, moderate)):
        expected = function(wide[where])
        assert np.max(np.abs(found[where] - expected) / np.abs(expected)) < 2 * unit
    positive = (np.abs(x) + real(1e-30)).astype(np.longdouble)
    away = np.abs(positive - 1) > 1e-3  # from its root, where it is log1p's task
    assert np.max((np.abs(out[3] - np.log(positive)) / np.abs(np.log(positive)))[away]) < 2 * unit
    plain = np.zeros((4, 8), real)
    powers.py_func(x[:8], plain)
    assert np.allclose(plain, out[:, :8], rtol=4 * unit)


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_powers_at_their_ends(real):
    x = np.array([np.nan, -1e4, 1e4, 0.0, -0.0, 1e-38, -80.0, np.inf], real)
    out = np.zeros((4, 8), real)
    powers(x, out)
    assert np.isnan(out[:, 0]).all() and out[1, 1] == -1 and 0 < out[2, 1] < 1e-30 and out[2, 2] > 1e30
    assert (out[:2, 3:5] == 0).all() and (out[2, 3:5] == 1).all() and (out[:2, 5] == x[5]).all()
