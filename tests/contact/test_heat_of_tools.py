"""Heat of each hot wall and tool: what they give adds up to what bodies take in; resistances in series; a lumped body among three."""

import math

import numpy as np
import pytest

import mpm
from mpm import warming
from mpm.integrate import heat_threaded, sorting
from mpm.scene.build import build
from mpm.simulation import simulate

pytestmark = pytest.mark.plain
RAMP = {"table": {"time": [0, 0.04, 0.04, 1], "value": [400, 380, 340, 360]}}
HEATS = ("explicit", "stabilised", {"implicit": {"order": 1}}, {"implicit": {"order": 2}})
SWELLS = {"table": {"temperature": [250, 350, 450], "value": [0.8, 1.0, 1.4]}}


def pressed(kappa=1.0, alpha=1.0, beta=20.0, other=5.0, temperature=RAMP, end=0.1, method=None, E=1.0, **more) -> dict:
    """A bar of half a metre between a hot wall and a hot tool, in eight cells."""
    h = 0.0625
    return {
        "grid": {"dimension": 1, "size": [1.0], "cell": h},
        "bodies": {"bar": {"shape": {"box": {"lower": [0.0], "upper": [0.5]}}, "material": "m", "temperature": 300}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": E, "nu": 0.0}}, "heat": {"fourier": {"kappa": kappa, "alpha": alpha}}}},
        "walls": {"left": {"contact": {"heat": {"beta": beta, "temperature": temperature}}}},
        "tools": {"press": {"shape": {"box": {"lower": [0.5], "upper": [0.75]}}, "heat": {"beta": other, "temperature": 320}}},
        "method": method or {}, "time": {"end": end}, "output": {"every": end / 5},
    } | more  # fmt: skip


def ran(scene, threads=1) -> dict:
    made = build(mpm.load(scene))
    made.threads = threads
    run = simulate(made)
    assert run.outcome.ok, run.outcome
    return run.series


def given(series, *names) -> np.ndarray:
    return sum(series[f"heat_{name}"] for name in names)


@pytest.mark.parametrize(
    ("heat", "alpha"),
    [
        *((heat, 1.0) for heat in HEATS),
        *(pytest.param(heat, SWELLS, marks=() if heat in ("stabilised", HEATS[-1]) else pytest.mark.wide) for heat in HEATS),
    ],
)
def test_walls_and_tools_give_what_a_body_takes(heat, alpha):
    """Over a ramp and a jump of the wall's temperature, to round-off, whatever advances the temperatures."""
    s = ran(pressed(alpha=alpha, method={"heat": heat}))
    assert s["heat_left"][-1] > 1 and s["heat_press"][-1] != 0
    assert given(s, "left", "press") == pytest.approx(s["heat_exchanged"], abs=1e-12 * np.abs(s["heat_exchanged"]).max())


LONG = {"heat": {"implicit": {"order": 2}}, "heat_step": 0.25}


@pytest.mark.parametrize(
    ("kind", "cells", "method", "off"),
    [
        ("contact", 8, LONG, 0.016),
        ("slip", 8, LONG, 0.016),
        pytest.param("contact", 32, LONG, 0.004, marks=pytest.mark.slow),
        pytest.param("contact", 8, {}, 0.0012, marks=pytest.mark.slow),
    ],
)
def test_resistances_in_series(kind, cells, method, off):
    """At the end what comes in goes out: q = (T_1 - T_2)/(1/beta_1 + L/kappa + 1/beta_2). Long heat steps are 1.5 and 0.39 % short, those of its own 0.11 %."""
    scene = pressed(temperature=400.0, end=1.5, method=method)
    scene["grid"]["cell"] = 0.5 / cells
    scene["walls"]["left"] = {kind: scene["walls"]["left"]["contact"]}
    s = ran(scene)
    q = (400 - 320) / (1 / 20 + 0.5 + 1 / 5)
    came, went = ((s[f"heat_{name}"][-1] - s[f"heat_{name}"][-2]) / 0.3 for name in ("left", "press"))
    assert came == pytest.approx(q, rel=off) and went == pytest.approx(-came, rel=1e-4)


def test_a_lumped_body_between_wall_tool_and_air():
    """C dT/dt = sum beta_k (T_k - T) has T = T_e + (T_0 - T_e) exp(-t/tau), and each gives beta_k int (T_k - T) dt; air acts on two sides of a block."""
    scene = pressed(kappa=1e4, beta=2.0, other=5.0, temperature=400.0, end=0.08, method={"heat": "stabilised"})
    h, wide = 0.0625, 0.25
    scene["grid"] = {"dimension": 2, "size": [0.75, 1.0], "cell": h}
    scene["bodies"]["bar"]["shape"]["box"] = {"lower": [0.25, 0.0], "upper": [0.25 + wide, 0.5]}
    scene["tools"]["press"]["shape"]["box"] = {"lower": [0.125, 0.5], "upper": [0.625, 0.75]}
    scene["walls"] = {"bottom": scene["walls"].pop("left")}
    scene["surfaces"] = [{"of": "bar", "convection": {"beta": 1.0, "outside": 200}}]
    scene["method"] = {"heat": {"implicit": {"order": 2}}, "heat_step": 0.008}
    s = ran(scene)
    betas, sizes, outside = np.array([2.0, 5.0, 1.0]), np.array([wide, wide, 2 * 0.5]), np.array([400.0, 320.0, 200.0])
    rates, capacity, t = betas * sizes, wide * 0.5, 0.08
    steady, tau = float(rates @ outside / rates.sum()), capacity / rates.sum()
    integral = steady * t + (300 - steady) * tau * (1 - math.exp(-t / tau))
    wall, press, air = rates * (outside * t - integral)
    assert s["heat_bottom"][-1] == pytest.approx(wall, rel=2e-3)
    assert s["heat_press"][-1] == pytest.approx(press, rel=2e-3)
    assert s["heat_exchanged"][-1] == pytest.approx(wall + press + air, rel=2e-3, abs=2e-3 * abs(wall))


def test_a_lumped_cylinder_between_wall_and_tool():
    """The same of a whole cylinder, not of a radian of it: pi R^2 beta_k int (T_k - T) dt."""
    scene = pressed(kappa=1e4, beta=2.0, other=5.0, temperature=400.0, end=0.04, method={"heat": {"implicit": {"order": 2}}, "heat_step": 0.008})
    scene["grid"] = {"dimension": "axisymmetric", "size": [0.5, 1.0], "cell": 0.125}
    scene["bodies"]["bar"]["shape"] = {"cylinder": {"radius": 0.25, "height": 0.5, "base": [0, 0]}}
    scene["tools"]["press"]["shape"] = {"cylinder": {"radius": 0.375, "height": 0.25, "base": [0, 0.5]}}
    scene["walls"] = {"bottom": scene["walls"].pop("left")}
    s = mpm.run_point(mpm.load(scene)).series
    t, tau, steady = 0.04, 0.5 / 7.0, (2 * 400 + 5 * 320) / 7.0
    integral = steady * t + (300 - steady) * tau * (1 - math.exp(-t / tau))
    face = math.pi * 0.25**2
    assert s["heat_bottom"][-1] == pytest.approx(face * 2 * (400 * t - integral), rel=5e-3)
    assert s["heat_press"][-1] == pytest.approx(face * 5 * (320 * t - integral), rel=5e-3)
    assert given(s, "bottom", "press") == pytest.approx(s["heat_exchanged"], rel=1e-12)


def test_a_tool_that_is_taken_off_within_a_heat_step_gives_for_that_long():
    """It goes at half of the only heat step: the piece sees it for a part of that step, and the air for the rest."""
    method = {"heat": {"implicit": {"order": 2}}, "heat_step": 0.02}
    scene = pressed(kappa=1e4, temperature=400.0, end=0.02, method=method, E=1e4, walls={"left": "contact"}) | {"output": {"every": 0.02}}
    scene["tools"]["press"]["motion"] = {"path": {"time": [0, 0.01, 0.02], "displacement": [[0.0], [0.0], [0.2]]}}
    alone = ran(scene)
    assert alone["heat_press"] == pytest.approx(alone["heat_exchanged"], abs=1e-12)
    air = ran(scene | {"surfaces": [{"of": "bar", "side": "right", "convection": {"beta": 3.0, "outside": 310}}]})
    t, half = 0.02, 0.5

    def warmed(rate, steady):
        """Integral of the temperature of a lumped body of capacity 1/2."""
        return steady * t + (300 - steady) * (1 - math.exp(-2 * rate * t)) / (2 * rate)

    by_tool = half * 5 * (320 * t - warmed(half * 5, 320))
    beside = half * 5 * (320 * t - warmed(half * 8, (5 * 320 + 3 * 310) / 8))
    assert alone["heat_press"][-1] == pytest.approx(by_tool, rel=0.04)  # a gap of 0.05 cells touches yet
    assert air["heat_press"][-1] / alone["heat_press"][-1] == pytest.approx(beside / by_tool, rel=2e-3)
    rest = half * 3 * (310 * t - warmed(half * 8, (5 * 320 + 3 * 310) / 8))
    assert air["heat_exchanged"][-1] - air["heat_press"][-1] == pytest.approx(rest, rel=0.04)


def test_bodies_on_each_other_take_what_wall_and_tool_give():
    """Two bars in touch go through one matrix; the pair's heat is neither's."""
    scene = pressed(beta=math.inf)
    scene["bodies"] = {
        name: {"shape": {"box": {"lower": [low], "upper": [low + 0.25]}}, "material": "m", "temperature": T}
        for name, low, T in (("a", 0.0, 300), ("b", 0.25, 350))
    }
    s = ran(scene)
    assert np.abs(s["heat_a_b"]).max() > 0.1
    assert given(s, "left", "press") == pytest.approx(s["heat_exchanged"], abs=1e-12 * np.abs(s["heat_exchanged"]).max())


def test_implicit_mechanics_keep_the_same_books():
    """The step of order 2 is twice the second less the first, and so are its heats."""
    s = ran(pressed(method={"mechanics": "implicit"}, end=0.04))
    assert s["heat_left"][-1] > 1
    assert given(s, "left", "press") == pytest.approx(s["heat_exchanged"], abs=1e-10)


def test_slabs_add_up(monkeypatch):
    """Threads' shares of a body: the same bits for any number of them."""
    monkeypatch.setattr(sorting, "SHARED", 1)
    monkeypatch.setattr(sorting, "FULL", 1)
    scene = pressed(temperature=400.0, end=0.001, method={"heat": "stabilised", "heat_step": 5e-4})
    scene["grid"] = {"dimension": 2, "size": [3.0, 1.0], "cell": 0.125}
    scene["bodies"]["bar"]["shape"]["box"] = {"lower": [0.25, 0.0], "upper": [1.75, 0.25]}
    scene["tools"]["press"]["shape"]["box"] = {"lower": [0.125, 0.25], "upper": [2.0, 0.625]}
    scene["walls"] = {"bottom": scene["walls"].pop("left")}
    looked = []
    monkeypatch.setattr(warming, "shared", lambda scene, b: looked.append(heat_threaded.shared(scene, b)) or looked[-1])
    one, three = (ran(scene, threads) for threads in (1, 3))
    assert looked and all(looked)
    assert given(one, "bottom", "press") == pytest.approx(one["heat_exchanged"], rel=1e-12) and one["heat_press"][-1] > 0
    assert all(np.array_equal(one[name], three[name]) for name in ("heat_bottom", "heat_press"))


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("heat.plate", "plate has no `heat`, so it passes none"),
        ("heat.right", "right has no `heat`, so it passes none"),
        ("heat.top", "there is no wall, tool or pair of bodies 'top'"),
    ],
)
def test_what_gives_no_heat_cannot_be_asked_for_it(name, said):
    scene = pressed()
    scene["tools"]["plate"] = {"shape": {"box": {"lower": [0.8], "upper": [0.95]}}}
    with pytest.raises(mpm.ConfigError, match=said):
        mpm.load(scene | {"output": {"observables": ["heat.left", "heat.press", name]}})


def test_a_beta_of_nothing_gives_nothing():
    """As one point of a sweep over beta: told, and 0."""
    s = ran(pressed(beta=0.0) | {"output": {"every": 0.05, "observables": ["heat.left", "heat.press"]}})
    assert np.all(s["heat_left"] == 0) and s["heat_press"] == pytest.approx(s["heat_exchanged"], abs=1e-12)


@pytest.mark.parametrize("kind", ["contact", pytest.param("slip", marks=pytest.mark.wide)])
def test_a_beta_of_nothing_insulates_as_nearly_nothing_does(kind):
    """Air cools all sides; what lies on the wall sees none of it, but after `until`."""
    taken = []
    for beta, until in ((0.0, None), (1e-9, None), (0.0, 0.05)):
        scene = pressed(beta=beta, temperature=400.0, end=0.1, surfaces=[{"of": "bar", "convection": {"beta": 5.0, "outside": 250}}]) | {"tools": {}}
        scene["walls"] = {"left": {kind: scene["walls"]["left"]["contact"] | ({"until": until} if until else {})}}
        taken.append(ran(scene)["heat_exchanged"])
    assert taken[0] == pytest.approx(taken[1], abs=1e-6) and taken[0][-1] < -10
    assert taken[2][:3] == pytest.approx(taken[0][:3], rel=0.02) and taken[2][-1] < 1.2 * taken[0][-1]
