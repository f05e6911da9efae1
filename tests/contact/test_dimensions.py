"""The cases of contact in every dimension; quick ones in plain Python, the others compiled and slow."""

import numpy as np
import pytest
from contact_scenes import DIMENSIONS, bars, block, conducting, count, dropped, floor, grid, pressed, up
from scipy.optimize import brentq

import mpm

H = 0.125


def compiled(config):
    tree = mpm.run(mpm.load(config))
    assert int(tree.ds.status) == 0, str(tree.ds.error.values)
    return {name: values.values for name, values in tree["series"].ds.items()} | {"time": tree["series"].time.values}


def turn(dimension) -> float:
    return 2 * np.pi if dimension == "axisymmetric" else 1.0


@pytest.fixture(scope="module")
def falling(plain):
    """A block of one cell that falls from 0.7 cells and bounces."""
    return lambda dimension: plain([dropped(dimension, 0.7, 0.2, cells=1, E=10.0, drag=0.0, end=0.54)])[0]


@pytest.mark.parametrize("dimension", [1, "axisymmetric", pytest.param(3, marks=pytest.mark.wide)])
def test_it_falls_freely_until_its_face_lands(falling, dimension):
    """Untouched before; then the force that is recorded is what turns it back, and its face stays before the wall."""
    run = falling(dimension)
    t, s = run["times"], run["series"]
    p, m = s[f"momentum_{up(dimension)}"], s["mass_total"][0]
    free = 0.5 * t**2 < 0.69 * H
    assert run["kind"] == "completed" and free.sum() > 10
    assert np.abs(p[free] / m + t[free]).max() < 1e-10
    assert p[~free].max() > 0 and s[f"position_min_{up(dimension)}"].min() > -0.01 * H
    force = s[f"force_{floor(dimension)}_{up(dimension)}"]
    impulse = np.cumsum(force[1:]) * (t[1] - t[0])
    assert np.abs(force[free][:-1]).max() == 0.0
    assert impulse[-1] / m == pytest.approx(p[-1] / m + t[-1], abs=0.01)


SETTLED = [(one, gap) for one in DIMENSIONS for gap in (0.0, 0.3, 0.6, 1.0, 2.0)]


@pytest.mark.slow
@pytest.mark.parametrize(("dimension", "gap"), SETTLED)
def test_a_dropped_block_comes_to_rest_with_its_face_on_the_floor(dimension, gap):
    """From five heights, as many places beside the grid's lines: the face to 0.01 cells, the force to a thousandth of the weight."""
    s = compiled(dropped(dimension, gap, 0.37 * gap, end=6.0))
    assert abs(s[f"position_min_{up(dimension)}"][-1]) < 0.01 * H
    assert s[f"force_{floor(dimension)}_{up(dimension)}"][-1] == pytest.approx(s["mass_total"][-1], rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("offset", [0.0, 0.3])
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_a_bar_that_is_pressed(dimension, offset):
    """P = E ln F/F by tool and floor, to 0.5 %; the strain of the particles at the ends to 5 %."""
    s = compiled(pressed(dimension, offset))
    area = s["volume_total"][0]  # a metre long
    for name in ("press", "anvil" if offset else floor(dimension)):
        sign = -1.0 if name == "press" else 1.0
        assert sign * s[f"force_{name}_{up(dimension)}"][-1] / area == pytest.approx(-np.log(0.9) / 0.9, rel=0.005)
        assert s[f"area_{name}"][-1] == pytest.approx(area, rel=1e-3)
    strains = np.log([s["J_min"][-1], s["J_max"][-1]]) / np.log(0.9)
    assert strains == pytest.approx(1.0, abs=0.1 if (dimension, offset) == ("axisymmetric", 0.3) else 0.05)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_two_equal_bars_exchange_their_speed(dimension):
    """The impulse between them is that of the first, but for what a surface of 16 cells takes; momentum to rounding."""
    s = compiled(bars(dimension))
    p, force = s[f"momentum_{up(dimension)}"], s[f"force_a_b_{up(dimension)}"]
    assert np.abs(p / p[0] - 1).max() < 1e-12
    assert 0.96 < -np.sum(force) * 0.1 / p[0] < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_a_bar_of_twice_the_impedance(dimension):
    """The stress at the face is rho c V Z2/(Z1 + Z2) = 2/3 rho c V while both waves are on their way."""
    s = compiled(bars(dimension, speed=1e-4, ratio=2.0, gap=0.0, end=1.6, every=0.4))
    area = s["volume_total"][0] / 2
    force = -s[f"force_a_b_{up(dimension)}"][1:4] / area / 1e-4
    assert force[1:] == pytest.approx(2 / 3, rel=0.005)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_a_stack_of_three(dimension):
    """Each bears what lies on it."""
    scene = dropped(dimension, 0.0, drag=20.0, E=200.0, end=2.0)
    wide = (2 if dimension != "axisymmetric" else 4) * H
    scene["bodies"] = {name: {"shape": block(dimension, 2 * H, wide, 2 * H * k, 2 * H), "material": "m"} for k, name in enumerate("abc")}
    scene["grid"], scene["loads"] = grid(dimension, H, 6 * H, 8 * H), [{"of": name, "drag": {"rate": 20.0}} for name in "abc"]
    s = compiled(scene)
    weight, axis = s["mass_total"][0] / 3, up(dimension)
    found = s[f"force_{floor(dimension)}_{axis}"][-1], -s[f"force_a_b_{axis}"][-1], -s[f"force_b_c_{axis}"][-1]
    assert np.array(found) / weight == pytest.approx([3, 2, 1], rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.2, 0.7])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_block_on_an_incline(dimension, mu):
    """Down the slope, whichever way that is in the plane, with g (sin - mu cos), or not at all."""
    s, c = np.sin(np.radians(30)), np.cos(np.radians(30))
    way = np.array([1.0]) if dimension == 2 else np.array([0.6, 0.8])
    scene = dropped(dimension, 0.0, 0.3, drag=0.0, E=400.0, end=0.8, gravity=[*(s * way), -c], walls={"bottom": {"contact": {"friction": mu}}})
    scene["grid"]["size"] = [1.5] * (dimension - 1) + [0.75]
    found = compiled(scene)
    p, m, t = np.stack([found[f"momentum_{a}"] for a in "xyz"[:dimension]]), found["mass_total"][0], found["time"]
    down = way @ p[:-1]
    if mu == 0.7:
        assert abs(down[-1]) < 0.01 * m * s * t[-1]
    else:
        assert (down + mu * p[-1])[-5:] / m / t[-5:] == pytest.approx(s - mu * c, rel=0.005)
        assert p[:-1, -1] / down[-1] == pytest.approx(way, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
def test_a_ball_on_the_floor(dimension):
    """It falls from a tenth of a cell and settles: the floor bears its weight, at its lowest place, to 0.05 cells (chords of its surface)."""
    scene = dropped(dimension, 0.0, cells=6, E=100.0, end=3.0)
    middle = [0.0, 3.1 * H] if dimension == "axisymmetric" else [5 * H] * (dimension - 1) + [3.1 * H]
    scene["bodies"]["block"]["shape"] = {"ball": {"centre": middle, "radius": 3 * H}}
    s = compiled(scene)
    assert s[f"force_bottom_{up(dimension)}"][-1] == pytest.approx(s["mass_total"][0], rel=2e-3)
    assert abs(s[f"position_min_{up(dimension)}"][-1]) < 0.05 * H


@pytest.mark.slow
def test_a_ball_that_rolls_down():
    """5/7 g sin to 3 %, its radius 8 cells, 2/7 of tan less than the friction. Gravity sets in slowly: let go at once, it sways on its contact by a tenth."""
    scene = dropped(3, 0.0, drag=0.0, E=400.0, end=2.4, walls={"bottom": {"contact": {"friction": 0.5}}})
    scene["gravity"] = [{"table": {"time": [0, 0.8], "value": [0, g]}} if g else 0.0 for g in (0.3, 0.0, -0.9539392)]
    scene["grid"] = {"dimension": 3, "size": [2.0, 1.25, 1.25], "cell": 1 / 16}
    scene["bodies"]["block"]["shape"] = {"ball": {"centre": [0.625, 0.625, 0.5], "radius": 0.5}}
    scene["method"] = {"transfer": "affine_flip"}
    s = compiled(scene)
    way = s["position_mean_x"][-1] - s["position_mean_x"][0]
    assert way == pytest.approx(5 / 7 * 0.3 * (2.4**3 - 1.6**3) / (6 * 0.8), rel=0.03)
    assert abs(s["momentum_y"][-1]) < 1e-3 * s["momentum_x"][-1]


def series(x, t):
    """A bar of one metre, insulated, at 400 K to its middle and 300 K from there on."""
    k = np.arange(1, 400, 2)
    return 350 + np.sum(200 / (np.pi * k) * np.sin(k * np.pi / 2) * np.cos(k * np.pi * x) * np.exp(-((k * np.pi) ** 2) * t))


def resisted(t):
    """The same at a quarter with h_c = 5 between the halves: each meets the middle temperature through 2 h_c."""
    k = [brentq(lambda m: m * np.sin(m) - 5 * np.cos(m), i * np.pi + 1e-9, i * np.pi + np.pi / 2) for i in range(50)]
    return 350 + 50 * sum(4 * np.sin(m) / (2 * m + np.sin(2 * m)) * np.cos(0.5 * m) * np.exp(-m * m * 4 * t) for m in k)


@pytest.mark.slow
@pytest.mark.parametrize("conductance", [None, 5.0])
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_heat_between_blocks(dimension, conductance):
    """Two blocks at 400 and 300 K: order 1.8, what one loses the other takes in to 1e-12."""
    exact = series(0.25, 0.05) if conductance is None else resisted(0.05)
    errors = []
    for n in (8, 16):
        scene = conducting(dimension, n, conductance)
        middle = [0.0] if dimension == "axisymmetric" else [3 / n] * (count(dimension) - 1)
        scene["output"]["probes"] = {"hot": [*middle, 0.25]}
        s = compiled(scene)
        errors.append(abs(s["temperature_hot"][-1] - exact))
        taken = s["heat_hot_cold"][-1]
        assert abs(s["heat_total"]).max() < 1e-12 * abs(taken) and taken < -0.1 * 50 * s["volume_total"][0]
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[1] < 5e-3 * 50
