"""Laws of temperature: values, exact primitives and their inverse, latent heat whole."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from mpm.jit import kernel
from mpm.materials import LAWS, Bump, Constant, Logistic, Table, enthalpy, table, temperature_of, value

POINTS = [290.0, 300.0, 303.0, 340.0, 371.0, 374.0, 420.0]
HEATS = [2100.0, 2100.0, 5200.0, 2600.0, 2500.0, 60000.0, 2200.0]
EXAMPLES = {
    "constant": Constant(2247.0),
    "linear": table(POINTS, HEATS),
    "pchip": table(POINTS, HEATS, "pchip"),
    "bump": Bump(2247.0, 2.46e5, 372.75, 1.5),
    "sharp": Bump(2000.0, 3.3e5, 373.15, 1e-3),
    "dip": Bump(4000.0, -2000.0, 330.0, 2.0),
    "up": Logistic(2000.0, 4000.0, 345.0, 3.0),
    "down": Logistic(4000.0, 1500.0, 345.0, 0.2),
}
every_law = pytest.mark.parametrize("law", EXAMPLES.values(), ids=EXAMPLES)
THETA = np.concatenate([np.linspace(250.0, 480.0, 461), 373.15 + np.linspace(-5e-3, 5e-3, 21)])


@kernel
def value_many(law, theta, out):
    for k in range(len(theta)):
        out[k] = value(law, theta[k])


@kernel
def enthalpy_many(law, theta, out):
    for k in range(len(theta)):
        out[k] = enthalpy(law, theta[k])


@kernel
def inverse_many(law, h, guess, out):
    for k in range(len(h)):
        out[k] = temperature_of(law, h[k], guess[k])


def many(run, law, *arrays):
    out = np.empty_like(arrays[0])
    run(law, *arrays, out)
    return out


def test_every_kind_has_an_example():
    assert {type(law) for law in EXAMPLES.values()} == set(LAWS)


@every_law
def test_enthalpy_is_the_primitive(law):
    edges = np.sort(np.concatenate([np.arange(285.0, 425.0, 4.7), POINTS, 373.15 + 1e-3 * np.arange(-8, 9)]))
    total = sum(quad(lambda x: value(law, x), a, b, epsabs=1e-9, epsrel=1e-12)[0] for a, b in pairwise(edges))
    assert enthalpy(law, edges[-1]) - enthalpy(law, edges[0]) == pytest.approx(total, rel=1e-10)


@every_law
def test_inverse_round_trip_from_any_guess(law):
    h = many(enthalpy_many, law, THETA)
    rng = np.random.default_rng(1)
    for guess in (THETA, THETA + rng.normal(0, 0.1, THETA.shape), np.full_like(THETA, 300.0), np.full_like(THETA, 460.0), rng.permutation(THETA)):
        back = many(inverse_many, law, h, guess)
        assert np.all(np.abs(back - THETA) < 5e-13)
        assert np.all(np.abs(many(enthalpy_many, law, back) - h) <= 4e-16 * np.abs(h) + 1.2e-13 * many(value_many, law, THETA))


@every_law
def test_compiled_equals_plain(law):
    np.testing.assert_allclose(many(value_many, law, THETA), [value(law, x) for x in THETA], rtol=1e-14)
    np.testing.assert_allclose(many(enthalpy_many, law, THETA), [enthalpy(law, x) for x in THETA], rtol=1e-14)


def test_latent_heat_is_whole():
    law = EXAMPLES["sharp"]
    assert enthalpy(law, 374.15) - enthalpy(law, 372.15) - 2 * law.base == pytest.approx(law.heat, rel=1e-13)
    middle = temperature_of(law, enthalpy(law, 373.1) + 0.05 * law.base + law.heat / 2, 300.0)
    assert middle == pytest.approx(373.15, abs=1e-9)
    assert temperature_of(law, enthalpy(law, 373.1) + 0.9 * law.heat, 373.1) < 373.16  # nine tenths of the heat do not jump over it


def test_values_of_the_kinds():
    bump = EXAMPLES["bump"]
    assert value(bump, bump.at) == pytest.approx(bump.base + bump.heat / (1.5 * np.sqrt(2 * np.pi)), rel=1e-15)
    assert value(EXAMPLES["up"], 345.0) == 3000.0
    assert value(EXAMPLES["up"], 345.0 + 9.0) - value(EXAMPLES["up"], 345.0 - 9.0) == pytest.approx(0.905 * 2000, rel=1e-3)
    assert value(EXAMPLES["down"], 1e6) == 1500.0
    assert value(EXAMPLES["down"], -1e6) == 4000.0


@pytest.mark.parametrize("interpolation", ["linear", "pchip"])
def test_tables_go_through_their_points_and_are_flat_outside(interpolation):
    law = table(POINTS, HEATS, interpolation)
    assert [value(law, x) for x in POINTS] == pytest.approx(HEATS, rel=1e-14)
    assert value(law, 100.0) == HEATS[0]
    assert value(law, 1e4) == pytest.approx(HEATS[-1], rel=1e-14)
    inside = np.linspace(POINTS[0], POINTS[-1], 500)
    exact = np.interp(inside, POINTS, HEATS) if interpolation == "linear" else PchipInterpolator(POINTS, HEATS)(inside)
    np.testing.assert_allclose([value(law, x) for x in inside], exact, rtol=1e-12)
    assert isinstance(law, Table)


@pytest.mark.parametrize("seed", range(4))
def test_pchip_slopes_are_those_of_scipy(seed):
    rng = np.random.default_rng(seed)
    x, y = np.cumsum(rng.uniform(0.1, 3, 9)) + 280, np.round(rng.normal(0, 2, 9)) + 10
    inside = np.linspace(x[0], x[-1], 200)
    np.testing.assert_allclose([value(table(x, y, "pchip"), t) for t in inside], PchipInterpolator(x, y)(inside), rtol=1e-12)
    assert value(table(x[:2], y[:2], "pchip"), x[:2].mean()) == pytest.approx(y[:2].mean())


def test_smooth_tables_are_ramps_level_at_their_points():
    law = table([0.0, 2.0, 3.0], [1.0, 5.0, 4.0], "smooth")
    for t, exact in ((0.5, 1 + 4 * (3 / 16 - 2 / 64)), (1.0, 3.0), (2.25, 5 - (3 / 16 - 2 / 64)), (-1.0, 1.0), (9.0, 4.0)):
        assert value(law, t) == pytest.approx(exact, rel=1e-15)
    assert enthalpy(law, 3.0) - enthalpy(law, 0.0) == pytest.approx(2 * 3.0 + 4.5, rel=1e-15)
    for t in (1e-4, 2.0 - 1e-4, 2.0 + 1e-4, 3.0 - 1e-4):
        assert abs(slope_of(law, t)) < 2e-3


def slope_of(law, t):
    return (value(law, t + 1e-6) - value(law, t - 1e-6)) / 2e-6


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (([300.0], [1.0]), "two or more"),
        (([300.0, 310.0], [1.0]), "2 temperatures and 1 values"),
        (([300.0, 300.0], [1.0, 2.0]), "must rise"),
        (([300.0, 310.0], [1.0, np.nan]), "finite"),
        (([300.0, 310.0], [1.0, 2.0], "cubic"), "'linear', 'pchip' and 'smooth'"),
    ],
)
def test_bad_tables(arguments, says):
    with pytest.raises(ValueError, match=says):
        table(*arguments)
