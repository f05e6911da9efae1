"""The return maps over sixteen decades: a million states leave no residual, and a few agree with 60-digit bisection."""

from decimal import Decimal, getcontext

import numpy as np
import pytest
from states import states

from mpm.jit import kernel
from mpm.materials.clipped import MOST_STEPS as MOST_CLIPPED
from mpm.materials.clipped import map_clipped
from mpm.materials.radial import MOST_STEPS as MOST_RADIAL
from mpm.materials.radial import map_radial


@kernel
def map_many(clipped, s, out):
    for k in range(s.shape[0]):
        if clipped:
            out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4] = map_clipped(s[k, 0], s[k, 1], s[k, 2], s[k, 3], s[k, 4], s[k, 5], s[k, 6], s[k, 7])
        else:
            out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4] = map_radial(s[k, 0], s[k, 1], s[k, 2], s[k, 3], s[k, 4], s[k, 5], s[k, 6], s[k, 7])


MANY = 1_000_000 if hasattr(map_many, "signatures") else 3_000  # without JIT, for coverage


def mapped(clipped, s):
    """States that yield, with their results."""
    out = np.empty((len(s), 5))
    map_many(clipped, s, out)
    assert np.isfinite(out).all()
    assert out[:, 4].max() < (MOST_CLIPPED if clipped else MOST_RADIAL)
    yields = (s[:, 0] / (s[:, 5] * s[:, 4])) ** 2 + (s[:, 1] / s[:, 4]) ** 2 > 1
    assert ((out[:, 4] > 0) ^ yields).mean() < 1e-3  # round-off on the ellipse itself
    keep = out[:, 4] > 0
    return s[keep].T.astype(np.longdouble), out[keep].T.astype(np.longdouble)


def check_signs(s, o):
    p_trial, q_trial, p, q, dp, dq = s[0], s[1], *o[:4]
    assert np.all(p * p_trial >= 0)
    assert np.all(q >= 0)
    assert np.all(dp * p_trial >= 0)
    assert np.all(dq >= 0)
    assert np.all(np.abs(p + dp - p_trial) <= 1e-15 * np.abs(p_trial))
    assert np.all(np.abs(q + dq - q_trial) <= 1e-15 * q_trial)


def test_radial_million():
    """p0^2 dp/p = (K/3 mu) dq/q = g, and 1/s - 1 + g/chi = 0."""
    s, o = mapped(False, states(MANY))
    check_signs(s, o)
    _, _, K, mu, M, p0, eta, dt = s
    p, q, dp, dq, _ = o
    g1, g2 = p0**2 * dp / p, K / (3 * mu) * dq / q
    assert (np.abs(g1 - g2) / (g1 + g2)).max() < 1e-14
    assert np.abs(M / np.hypot(p / p0, q) - 1 + g1 * eta / (K * dt)).max() < 1e-13


def test_clipped_million():
    """The tangential balance and the pressure balance, with cos phi from p and dp, so that q is checked at the tip too."""
    s, o = mapped(True, states(MANY, seed=1))
    check_signs(s, o)
    assert np.median(o[4]) <= 6  # Newton, not the bisection that guards it
    p_trial, q_trial, K, mu, M, p0, eta, dt = s
    p, q, z, omega, lag = np.abs(o[0]) / M, o[1] / M, np.abs(o[2]) / M, K / (3 * mu), eta / (K * dt)
    c = 2 * (p / p0) / (1 + np.sqrt(1 + 4 * lag * z * p))
    y, T = 1 + lag * p0 * c * z, q / c
    a, b = omega * o[3] / M, T * p0 * y * z
    assert (np.abs(a - b) / (omega * (q_trial / M + q) + T * p0 * y * (np.abs(p_trial) / M + p))).max() < 1e-11
    assert np.abs(c * c + q * q - 1).max() < 1e-13


def bisect(sign, low, high):
    for _ in range(260):
        middle = (low * high).sqrt() if low > 0 else high * Decimal("1e-30")
        low, high = (middle, high) if sign(middle) > 0 else (low, middle)
    return low


def exact_radial(p_trial, q_trial, K, mu, M, p0, eta, dt):
    a1, a2, k1, k2, lag = abs(p_trial) / (p0 * M), q_trial / M, 1 / p0**2, 3 * mu / K, eta / (K * dt)

    def too_small(g):
        return 1 - g * lag - 1 / ((a1 / (1 + k1 * g)) ** 2 + (a2 / (1 + k2 * g)) ** 2).sqrt()

    g = bisect(too_small, Decimal("1e-60"), 2 * max(a1 / k1, a2 / k2))
    return p_trial / (1 + k1 * g), q_trial / (1 + k2 * g)


def exact_clipped(p_trial, q_trial, K, mu, M, p0, eta, dt):
    P, Q, omega, lag = abs(p_trial) / M, q_trial / M, K / (3 * mu), eta / (K * dt)

    def at(T):
        c = 1 / (1 + T * T).sqrt()
        y = (lag * p0 * P * c + 1) / (lag * p0**2 * c * c + 1)
        return c, y, omega * (Q - T * c) - T * p0 * y * (P - p0 * y * c)

    low = (1 / (P / p0) ** 2 - 1).sqrt() if p0 > P else Decimal("1e-60")
    high = (1 / (1 / Q**2 - 1)).sqrt() if Q < 1 else Decimal("1e60")
    T = bisect(lambda T: at(T)[2], low, high)
    c, y, _ = at(T)
    return (M * p0 * y * c).copy_sign(p_trial), M * T * c


@pytest.mark.parametrize(("clipped", "exact"), [(False, exact_radial), (True, exact_clipped)])
def test_sixty_digits(clipped, exact):
    getcontext().prec = 90
    s, o = mapped(clipped, states(120, seed=4, nearest=-4))
    for row, result in zip(s.T.astype(float), o.T.astype(float), strict=True):
        p, q = exact(*(Decimal(x) for x in row))
        assert abs(Decimal(result[0]) / p - 1) < 1e-11, row
        assert abs(Decimal(result[1]) / q - 1) < 1e-11, row


@pytest.mark.parametrize("small", [1e-2, 1e-5, 1e-9, 1e-13])
@pytest.mark.parametrize(("form", "exact"), [(map_radial, exact_radial), (map_clipped, exact_clipped)])
def test_on_the_axes_small_changes_keep_their_digits(form, exact, small):
    """At q_trial = M with little pressure, and at p_trial = p0 M with little shear, the flow is a difference of nearly equal numbers; dissipation needs it."""
    getcontext().prec = 90
    for axis, row in ((1, [small, 1.0, 3.0, 1.0, 1.0, 0.5, 0.75, 0.5]), (0, [0.5, small, 3.0, 1.0, 1.0, 0.5, 0.75, 0.5])):
        result, true = form(*row), exact(*(Decimal(x) for x in row))
        assert abs(Decimal(result[0]) / true[0] - 1) < 1e-12
        assert abs(Decimal(result[1]) / true[1] - 1) < 1e-12
        assert abs(Decimal(result[2 + axis]) / (Decimal(row[axis]) - true[axis]) - 1) < 1e-11
