"""Laws over lanes against their scalar forms: return maps over a million states of the stated ranges, laws of temperature, p0 by porosity."""

import numpy as np
import pytest
from states import states

from mpm.jit import kernel
from mpm.lanes import load8, store
from mpm.materials import Bump, Constant, Logistic, Porous, enthalpies, enthalpy, table, temperature_of, temperatures, value, values
from mpm.materials.clipped import clipped_lanes, map_clipped
from mpm.materials.porous import aspect
from mpm.materials.radial import map_radial, radial_lanes
from mpm.materials.roles import aspects


@kernel
def map_lanes(clipped, s, thermal, out):
    """s: rows trace, |dev|, lam, mu, M, p0, eta of a unit step; out: rows trace, share, dissipated, flowed, good."""
    n = s.shape[1]
    for p in range(0, n, 8):
        trace, deviator, lam, mu = load8(s, p), load8(s, n + p), load8(s, 2 * n + p), load8(s, 3 * n + p)
        M, p0, eta, heat = load8(s, 4 * n + p), load8(s, 5 * n + p), load8(s, 6 * n + p), load8(thermal, p)
        if clipped:
            found = clipped_lanes(trace, deviator, lam, mu, M, p0, eta, 1.0, heat)
        else:
            found = radial_lanes(trace, deviator, lam, mu, M, p0, eta, 1.0, heat)
        store(out, p, found[0])
        store(out, n + p, found[1])
        store(out, 2 * n + p, found[2])
        store(out, 3 * n + p, found[3])
        store(out, 4 * n + p, found[4])


@kernel
def map_each(clipped, s, thermal, out):
    """The same states one by one: rows p, q, dissipated, steps."""
    for k in range(s.shape[1]):
        mu, M, p0, eta = float(s[3, k]), float(s[4, k]), float(s[5, k]), float(s[6, k])
        K = float(s[2, k]) + 2.0 / 3.0 * mu
        p, q = float(thermal[k]) - K * float(s[0, k]), np.sqrt(6.0) * mu * float(s[1, k])
        if clipped:
            out[0, k], out[1, k], dp, dq, out[3, k] = map_clipped(p, q, K, mu, M, p0, eta, 1.0)
        else:
            out[0, k], out[1, k], dp, dq, out[3, k] = map_radial(p, q, K, mu, M, p0, eta, 1.0)
        out[2, k] = out[0, k] * dp / K + out[1, k] * dq / (3.0 * mu)


MANY = 1_000_000 if hasattr(map_lanes, "signatures") else 2_000


def extremes():
    """The states of test_extremes.py, as strains of a step of one second."""
    p, q, K, mu, M, p0, eta, dt = states(MANY, seed=3).T
    return np.stack([-p / K, q / (np.sqrt(6.0) * mu), K - 2 * mu / 3, mu, M, p0, eta / dt])


def moderate(n):
    """States in float32's reach."""
    rng = np.random.default_rng(5)
    mu, M = 10.0 ** rng.uniform(3, 7, n), 10.0 ** rng.uniform(1, 4, n)
    p0, eta = 10.0 ** rng.uniform(-1, 1, n), 10.0 ** rng.uniform(-3, 3, n) * mu
    return np.stack([rng.uniform(-0.1, 0.1, n), 10.0 ** rng.uniform(-6, -1, n), 2 * mu, mu, M, p0, eta])


def relative(a, b):
    return np.abs(a - b) / np.maximum(np.abs(b), 1e-300)


@pytest.mark.parametrize("clipped", [False, True], ids=["radial", "clipped"])
@pytest.mark.parametrize("real", [np.float64, np.float32])
def test_return_maps(clipped, real):
    """Without thermal stress p = -K tr eps: both invariants relative to themselves, however far the state was mapped."""
    s = np.ascontiguousarray(extremes() if real is np.float64 else moderate(MANY // 8), real)
    thermal, out, one = np.zeros(s.shape[1], real), np.zeros((5, s.shape[1]), real), np.zeros((4, s.shape[1]))
    map_lanes(clipped, s, thermal, out)
    map_each(clipped, s, thermal, one)
    # radial ends where the next step is below round-off, clipped at 1e-14 (float32 6e-6) of its angle, worth up to thirty times that in p
    few = ((64 if clipped else 16) if real is np.float32 else 2000 if clipped else 64) * np.finfo(real).eps
    flowed = out[3] == 1
    assert (out[4] == 1).all() and 0.2 < flowed.mean() < 0.99
    assert ((one[3] > 0) != flowed).mean() < 1e-3  # round-off on the ellipse itself
    both = flowed & (one[3] > 0)
    out, s, one = out[:, both].astype(float), s[:, both].astype(float), one[:, both]
    K = s[2] + 2 / 3 * s[3]
    a1, a2 = np.abs(K * s[0]) / (s[4] * s[5]), np.sqrt(6) * s[3] * s[1] / s[4]
    near = np.minimum(a1**2 + a2**2 - 1, np.minimum(np.abs(a1 - 1), np.abs(a2 - 1)))
    few = few * (1 + 1 / np.maximum(near, 1e-14))  # how far outside the ellipse and its tips is a difference: its round-off counts where it is small
    assert (relative(-K * out[0], one[0]) < few).all()
    assert (relative(np.sqrt(6) * s[3] * s[1] * out[1], one[1]) < few).all()
    # the work is a small difference near the ellipse: what is taken off counts
    size = one[0] ** 2 / K + one[1] ** 2 / (3 * s[3])
    assert np.all(np.abs(out[2] - one[2]) <= few * (np.abs(one[2]) + size))


@pytest.mark.parametrize("clipped", [False, True], ids=["radial", "clipped"])
def test_elastic_lanes_are_left_alone(clipped):
    """Bit for bit, beside lanes that flow; thermal stress shifts the pressure."""
    s = moderate(4096)
    thermal = np.where(np.arange(4096) % 2, 0.3 * s[4] * s[5], 0.0)
    out, one = np.zeros((5, 4096)), np.zeros((4, 4096))
    map_lanes(clipped, s, thermal, out)
    map_each(clipped, s, thermal, one)
    still = out[3] == 0
    assert 0.05 < still.mean() < 0.95
    assert np.array_equal(still, one[3] == 0)
    assert np.array_equal(out[0, still], s[0, still]) and (out[1, still] == 1).all() and (out[2, still] == 0).all()
    K = s[2] + 2 / 3 * s[3]
    assert np.allclose(thermal - K * out[0], one[0], rtol=1e-12, atol=1e-13 * np.max(K * np.abs(s[0])))


@pytest.mark.parametrize("clipped", [False, True], ids=["radial", "clipped"])
@pytest.mark.parametrize(("row", "wrong"), [(4, 0.0), (4, np.nan), (5, -1.0), (6, -1.0), (6, np.nan)])
def test_a_wrong_law_fails_its_lane_only(clipped, row, wrong):
    s = moderate(8)
    s[row, 3] = wrong
    out = np.zeros((5, 8))
    map_lanes(clipped, s, np.zeros(8), out)
    assert out[4].tolist() == [1, 1, 1, 0, 1, 1, 1, 1]


@kernel
def follow(law, theta, J, out):
    for p in range(0, theta.shape[0], 8):
        store(out, p, values(law, load8(theta, p)))
        store(out, theta.shape[0] + p, aspects(law, load8(theta, p), load8(J, p)))


@kernel
def shape(law, theta, J, out):
    for p in range(0, theta.shape[0], 8):
        store(out, p, aspects(law, load8(theta, p), load8(J, p)))


LAWS = {
    "constant": Constant(3.5),
    "logistic": Logistic(60.0, 6.0, 313.0, 3.0),
    "bump": Bump(2000.0, 4e5, 373.0, 2.0),
    "table": table([280.0, 300.0, 330.0, 400.0], [1.0, 5.0, 2.0, 3.0], "pchip"),
}


@pytest.mark.parametrize("real", [np.float64, np.float32])
@pytest.mark.parametrize("name", LAWS)
def test_laws_of_temperature(name, real):
    theta = np.random.default_rng(7).uniform(250, 450, 4096).astype(real)
    out = np.zeros((2, 4096), real)
    follow(LAWS[name], theta, np.ones(4096, real), out)
    expected = np.array([value(LAWS[name], float(t)) for t in theta])
    few = 16 * np.finfo(real).eps * (1 if real is np.float64 else 40)  # in float32 theta - at is worth 1e-5 K
    assert np.allclose(out[0], expected, rtol=few, atol=few * np.abs(expected).max()) and np.array_equal(out[0], out[1])


@kernel
def ask_eight(law, a, guess, out):
    """Rows value, enthalpy, and the temperature of the enthalpies a."""
    n = len(guess)
    for p in range(0, n, 8):
        store(out, p, values(law, load8(a, p)))
        store(out, n + p, enthalpies(law, load8(a, p)))
        store(out, 2 * n + p, temperatures(law, load8(a, n + p), load8(guess, p)))


@kernel
def ask_each(law, a, guess, out):
    for k in range(len(guess)):
        out[0, k], out[1, k], out[2, k] = value(law, a[0, k]), enthalpy(law, a[0, k]), temperature_of(law, a[1, k], guess[k])


@kernel
def heat_each(law, theta, out):
    for k in range(len(theta)):
        out[k] = enthalpy(law, theta[k])


KNOTS = (290.0, 300.0, 303.0, 340.0, 371.0, 374.0, 420.0)
HEATS = (2100.0, 2100.0, 5200.0, 2600.0, 2500.0, 60000.0, 2200.0)
CAPACITIES = {
    "constant": Constant(2247.0),
    "linear": table(KNOTS, HEATS),
    "pchip": table(KNOTS, HEATS, "pchip"),
    "two points": table(KNOTS[:2], HEATS[1:3]),
    "more than it walks": table(np.linspace(280.0, 420.0, 60), 2000.0 + 500.0 * np.sin(np.arange(60))),
    "bump": Bump(2247.0, 2.46e5, 372.75, 1.5),
    "sharp": Bump(2000.0, 3.3e5, 373.15, 1e-3),
    "dip": Bump(4000.0, -2000.0, 330.0, 2.0),
    "up": Logistic(2000.0, 4000.0, 345.0, 3.0),
    "down": Logistic(4000.0, 1500.0, 345.0, 0.2),
}


@pytest.mark.parametrize("name", CAPACITIES)
def test_heat_and_its_inverse(name):
    """Ordinary temperatures, those at the points of tables and within steps and bumps, and 1e-3 to 1e6 K; guesses near and far."""
    law, rng = CAPACITIES[name], np.random.default_rng(11)
    n = MANY // 8 if MANY > 10_000 else MANY // 40
    special = np.array([*KNOTS, 280.0, 330.0, 345.0, 372.75, 373.15])
    parts = (rng.uniform(250, 450, 4 * n), rng.choice(special, n), rng.choice(special, 2 * n) + rng.normal(size=2 * n) * 1e-3, 10 ** rng.uniform(-3, 6, n))
    theta = np.concatenate(parts)
    guess = theta + rng.normal(size=len(theta)) * 10.0 ** rng.integers(-6, 2, len(theta))
    a, out, one = np.stack([theta, theta]), np.zeros((3, len(theta))), np.zeros((3, len(theta)))
    heat_each(law, theta, a[1])
    ask_eight(law, a, guess, out)
    ask_each(law, a, guess, one)
    few = 4 * np.finfo(float).eps
    assert (relative(out[0], one[0]) <= few).all()
    size = one[0].max() * theta + 4e5  # of the terms: enthalpies are nothing where they begin
    assert (np.abs(out[1] - one[1]) <= few * size).all()
    assert (np.abs(out[2] - one[2]) <= 8 * few * size / one[0].min()).all()  # the terms of a steep cubic are several times its values


@pytest.mark.parametrize("name", CAPACITIES)
def test_a_nan_stays_in_its_lane(name):
    a = np.stack([np.full(8, 350.0), np.full(8, enthalpy(CAPACITIES[name], 350.0))])
    a[:, 3] = np.nan
    out, rest = np.zeros((3, 8)), np.arange(8) != 3
    ask_eight(CAPACITIES[name], a, np.full(8, 349.0), out)
    assert np.isnan(out[:, 3]).all() == (name != "constant") and np.isfinite(out[:, rest]).all()
    assert np.allclose(out[2, rest], 350.0, rtol=1e-14)


@pytest.mark.parametrize("name", CAPACITIES)
def test_heat_in_single_precision(name):
    """The inverse gives the temperature back to what an enthalpy of float32 can say of it."""
    theta = np.random.default_rng(12).uniform(295, 415, 4096).astype(np.float32)
    law, out = CAPACITIES[name], np.zeros((3, 4096), np.float32)
    h = np.array([enthalpy(law, float(t)) for t in theta])
    ask_eight(law, np.ascontiguousarray([theta, h], np.float32), theta + np.float32(0.5), out)
    least = min(value(law, float(t)) for t in np.linspace(295, 415, 4001))
    assert (np.abs(out[1] - h) <= 32 * np.finfo(np.float32).eps * (np.abs(h).max() + 400 * least)).all() or name == "sharp"
    assert (np.abs(out[2] - theta) <= 32 * np.finfo(np.float32).eps * (np.abs(h).max() / least + 400)).all()


def test_aspect_of_pores():
    J, law = np.random.default_rng(8).uniform(0.5, 2.0, 64), Porous(0.6, 2.0)
    out = np.zeros(64)
    shape(law, np.full(64, 300.0), J, out)
    assert np.allclose(out, [aspect(0.6 / j, 2.0) for j in J], rtol=1e-14)
