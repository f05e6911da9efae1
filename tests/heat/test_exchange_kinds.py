"""Flux, fixed temperature, radiation, temperatures over time, hot walls: rigid and moving bodies against exact results and each other."""

import math

import pytest

import mpm
from mpm.heat.exchange import STEFAN_BOLTZMANN
from mpm.heat.programmes import Sine, at, bounds, longest
from mpm.materials import table

OVEN = {"table": {"time": [0, 0.2, 0.5], "value": [300, 500, 400]}}
UNCOUPLED = {"expansion": {"modulus": {"gamma": 0.0, "reference": 350.0}}, "heating": {"elastic": {}}}  # of zero: the steps that other tests compile too
SINE = {"sine": {"mean": 350, "amplitude": 40, "period": 0.4}}


def bar(surfaces, elastic=True, end=0.5, start=350.0, kappa=1.0, **method):
    """One metre in eight cells; without `elastic` a rigid body."""
    solid = {"density": 2.0, "heat": {"fourier": {"kappa": kappa, "alpha": 1.5}}}
    if elastic:
        solid |= {"elastic": {"hencky": {"lam": 0.03, "mu": 0.02}}} | UNCOUPLED
    return mpm.load(
        {
            "grid": {"dimension": 1, "size": [1.5], "cell": 0.125},
            "bodies": {"bar": {"shape": {"box": {"lower": [0.3], "upper": [1.3]}}, "temperature": start, "material": "solid"}},
            "materials": {"solid": solid},
            "surfaces": [{"of": "bar"} | surface for surface in surfaces],
            "time": {"end": end},
            "output": {"every": end},
            "method": method,
        }
    )


def ended(experiment, ledger=1e-12):
    run = mpm.run_point(experiment)
    assert run.outcome.ok
    assert abs(run.finals["heat_ledger"]) <= ledger * abs(run.finals["heat_exchanged"])
    return run.finals


METHODS = {
    "moving, explicit": {"heat": "explicit"},
    "moving, implicit": {"heat": {"implicit": {"order": 2}}},
    "rigid, implicit": {"elastic": False, "rigid": "implicit"},
    "rigid, explicit": {"elastic": False, "rigid": "explicit"},
}
NAMES = [pytest.param(name, marks=pytest.mark.wide) if name == "moving, implicit" else name for name in METHODS]


@pytest.mark.parametrize("name", NAMES)
def test_flux_is_what_comes_in(name):
    """3 W/m2 at one end and -1 at the other for 0.5 s: exactly 1 J/m2 more, and in the end a parabola."""
    found = ended(bar([{"side": "left", "flux": {"q": 3.0}}, {"side": "right", "flux": {"q": -1.0}}], **METHODS[name]))
    assert found["heat_exchanged"] == pytest.approx(1.0, rel=1e-11)
    assert found["temperature_mean"] == pytest.approx(350 + 1 / 3, rel=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_radiation_cools_a_lumped_body(name):
    """Bi of 0.02: c dT/dt = -2 sigma e (T^4 - Ts^4), integrated by itself."""
    T, capacity, dt = 1000.0, 3.0, 1e-4
    for _ in range(5000):
        T -= dt / capacity * 2 * STEFAN_BOLTZMANN * 0.004 * (T**4 - 300.0**4)
    found = ended(bar([{"radiation": {"emissivity": 0.004, "surroundings": 300}}], start=1000.0, kappa=20.0, **METHODS[name]))
    assert 1000 - found["temperature_mean"] == pytest.approx(1000 - T, rel=0.02) and T < 950


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("programme", [OVEN, SINE], ids=["oven", "sine"])
def test_surroundings_over_time(name, programme):
    """A bar that conducts well follows c dT/dt = 2 b (out(t) - T), with the resistance L/(6 kappa) of its inside in b."""
    from mpm.scene.exchange import programme as made

    experiment = bar([{"convection": {"beta": 2.0, "outside": programme}}], kappa=20.0, **METHODS[name])
    outside, T, dt, b = made(experiment.surfaces[0].convection.outside), 350.0, 1e-4, 1 / (1 / 2 + 1 / 120)
    for k in range(5000):
        T += dt / 3.0 * 2 * b * (at(outside, (k + 0.5) * dt) - T)
    assert ended(experiment)["temperature_mean"] == pytest.approx(T, abs=0.3)


def test_radiation_never_overshoots():
    """A cold body in a furnace, one implicit step of many times its response."""
    experiment = bar([{"radiation": {"emissivity": 1.0, "surroundings": 2000}}], start=300.0, end=100.0, heat={"implicit": {}}, heat_step=100.0)
    run = mpm.run_point(mpm.load(experiment.resolved() | {"time": {"end": 100.0, "step": 0.5}}))
    assert run.outcome.ok and 300 < run.finals["temperature_min"] <= run.finals["temperature_max"] < 2000


def test_several_kinds_on_one_surface_add():
    one = {"side": "left", "flux": {"q": 3.0}, "convection": {"beta": 2.0, "outside": 400}, "radiation": {"emissivity": 0.5, "surroundings": 600}}
    apart = [{"side": "left", key: one[key]} for key in ("flux", "convection", "radiation")]
    for method in (METHODS["moving, explicit"], METHODS["rigid, implicit"]):
        together, sum_of_parts = ended(bar([one], **method)), ended(bar(apart, **method))
        assert together["temperature_mean"] == pytest.approx(sum_of_parts["temperature_mean"], rel=1e-12)


def test_moving_and_rigid_agree():
    surfaces = [{"side": "left", "fixed": {"temperature": 300}}, {"side": "right", "radiation": {"emissivity": 0.8, "surroundings": OVEN}}]
    found = [ended(bar(surfaces, **METHODS[name]))["temperature_mean"] for name in ("moving, implicit", "rigid, implicit")]
    assert found[0] == pytest.approx(found[1], abs=0.5)


def test_two_radiations_at_one_place_are_refused():
    twice = [{"radiation": {"emissivity": 0.5, "surroundings": 600}}] * 2
    with pytest.raises(mpm.ConfigError, match="'bar' has a radiation there already"):
        bar(twice)


def test_no_conduction_no_exchange():
    with pytest.raises(mpm.ConfigError, match="conducts no heat"):
        bar([{"convection": {"beta": 1, "outside": 300}}], kappa=0.0)


def test_programmes():
    ramp, wave = table([0, 10, 12], [300, 400, 350]), Sine(300.0, 50.0, 8.0, math.pi / 2)
    assert [at(ramp, t) for t in (-1, 5, 20)] == [300, 350, 350] and bounds(ramp) == (300, 400) and longest(ramp) == 0.5
    assert at(wave, 0.0) == 350 and at(wave, 2.0) == pytest.approx(300) and bounds(wave) == (250, 350) and longest(wave) == 0.5
    assert at(3.0, 7.0) == 3.0 and bounds(3.0) == (3.0, 3.0) and longest(3.0) == math.inf
