"""What a piece of surface meets, and numbers over time, by hand: in plain Python, so that a wrong sign is found in a second."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mpm.heat.exchange import STEFAN_BOLTZMANN, meet
from mpm.heat.programmes import SAME, Parts, Sine, at, bounds, during, integral, longest, spell, turns
from mpm.materials import table
from mpm.state import NoExchange, NoRadiation, Radiation, Surface

pytestmark = pytest.mark.plain
ZERO = 290.0


def surface(beta, outside, drift=0.0, flux=0.0, radiation=None):
    """One piece; temperatures [K]."""
    one = SimpleNamespace(beta=np.array([beta]), outside=np.array([outside - ZERO]), drift=np.array([drift]), flux=np.array([flux]))
    rest = dict.fromkeys(("row", "owner", "area", "offset")) | vars(one) | {"radiation": radiation or NoRadiation()}
    return Surface(**{name: rest.get(name) for name in Surface._fields})


def into(piece, T, part=0.0):
    """Heat into the body at a temperature [W/m2]."""
    beta, outside, q = meet(piece, 0, T - ZERO, ZERO, part)
    return beta * (outside - (T - ZERO)) + q


@pytest.mark.parametrize("part", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("T", [250.0, 300.0, 900.0])
@pytest.mark.parametrize("beta", [0.0, 7.0])
def test_convection_radiation_and_flux_add(beta, T, part):
    """beta (outside - T) + sigma e (sky^4 - T^4) + q, each as warm as it is within the heat step."""
    sky = Radiation(np.array([0.8]), np.array([500.0]), np.array([40.0]))
    outside, around = 320.0 + part * 12.0, 500.0 + part * 40.0
    wanted = beta * (outside - T) + 0.8 * STEFAN_BOLTZMANN * (around**4 - T**4) + 3.0
    assert into(surface(beta, 320.0, 12.0, 3.0, sky), T, part) == pytest.approx(wanted, rel=1e-12)
    own = meet(surface(beta, 320.0, 12.0, 3.0, sky), 0, T - ZERO, ZERO, part)[0] - beta
    assert own == pytest.approx(0.8 * STEFAN_BOLTZMANN * (T**2 + around**2) * (T + around), rel=1e-12)


def test_what_does_not_radiate_and_what_meets_nothing():
    assert meet(NoExchange(), 0, 5.0, ZERO, 0.0) == (0.0, 0.0, 0.0)
    assert into(surface(7.0, 320.0), 300.0) == pytest.approx(140.0) and into(surface(0.0, 320.0, 0.0, 3.0), 300.0) == 3.0
    dark = Radiation(np.array([0.0]), np.array([500.0]), np.array([0.0]))
    assert into(surface(0.0, 320.0, 0.0, 3.0, dark), 300.0) == 3.0


def test_a_spell():
    """Nothing before and after it; what jumps already jumps where it did, and at a jump what comes after it holds."""
    short, begun, ended = spell(5.0, 2.0, 6.0), spell(5.0, 2.0), spell(5.0, 0.0, 6.0)
    assert [at(short, t) for t in (0.0, 1.99, 2.0, 4.0, 6.0, 9.0)] == [0.0, 0.0, 5.0, 5.0, 0.0, 0.0]
    assert (turns(short), turns(begun), turns(ended), turns(spell(5.0))) == ((2.0, 6.0), (2.0,), (6.0,), ())
    twice = spell(Parts((3.0, 4.0), (1.0, 2.0, 3.0)), 3.5, 8.0)
    assert [at(twice, t) for t in (0.0, 3.4, 3.5, 4.0, 7.9, 8.0)] == [0.0, 0.0, 2.0, 3.0, 3.0, 0.0]


@pytest.mark.parametrize(("off", "there"), [(0.5, 5.0), (1.5, 0.0)])
def test_what_is_nearer_to_a_jump_than_a_billionth_is_at_it(off, there):
    assert SAME == 1e-9 and during(spell(5.0, 2.0), 2.0 * (1 - off * 1e-9)) == there


def test_bounds_and_steps():
    wave, ramp = Sine(350.0, -40.0, 0.4, 0.1), table([0.0, 1.0, 1.5], [300.0, 500.0, 400.0])
    assert bounds(wave) == (310.0, 390.0) and bounds(ramp) == (300.0, 500.0) and bounds(7.0) == (7.0, 7.0)
    assert bounds(Parts((2.0,), (wave, 600.0))) == (310.0, 600.0)
    assert longest(wave) == 0.025 and longest(ramp) == 0.125 and longest(7.0) == math.inf and longest(Parts((2.0,), (wave, ramp))) == 0.025
    assert at(wave, 0.1) == pytest.approx(350.0 - 40.0 * math.sin(math.pi / 2 + 0.1))


@pytest.mark.parametrize(
    "programme",
    [
        3.0,
        table([1.0, 2.0, 5.0], [2.0, 6.0, -1.0]),
        Sine(4.0, 3.0, 1.7, 0.4),
        Parts((1.5, 4.0), (table([0.0, 9.0], [1.0, 7.0]), 5.0, Sine(1.0, 2.0, 3.0, 0.0))),
    ],
)
@pytest.mark.parametrize(("begin", "end"), [(0.5, 6.0), (2.5, 3.0), (0.0, 1.2)])
def test_integrals_are_sums_over_time(programme, begin, end):
    n = 20_000
    middles = begin + (end - begin) * (np.arange(n) + 0.5) / n
    assert integral(programme, begin, end) == pytest.approx(sum(at(programme, t) for t in middles) * (end - begin) / n, rel=1e-3)
