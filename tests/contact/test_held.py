"""A body without `elastic` stands still beside others that move: they land on it, rub on it and exchange heat with it."""

import numpy as np
import pytest
from contact_scenes import block, conducting, dropped, up

import mpm
from mpm.scene.build import SceneError, build

pytestmark = pytest.mark.plain
H = 0.125
STONE = {"density": 3.0, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}


def run_of(data):
    run = mpm.run_point(mpm.load(data))
    assert run.outcome.ok, run.outcome
    return run.series | {"time": run.times}


def on_stone(dimension, gap, **more):
    """A block that falls on to a stone of two cells, off the grid's lines."""
    scene, axis = dropped(dimension, gap, 0.3, cells=2, **more), up(dimension)
    low = 0.4 * H
    scene["bodies"]["block"]["shape"] = block(dimension, 2.3 * H, 2 * H, low + (2 + gap) * H, 2 * H)
    scene["bodies"]["stone"] = {"shape": block(dimension, 1.5 * H, 4 * H, low, 2 * H), "material": "stone"}
    scene["materials"]["stone"] = STONE
    scene["walls"] = {}
    scene["output"]["observables"] = ["mass.total.block", *(f"{what}_{axis}{of}" for what, of in (
        ("position.min", ".block"), ("position.max", ".stone"), ("force.block_stone", "")))]  # fmt: skip
    scene["output"]["observables"] += [f"momentum.{axis}.{name}" for name in ("block", "stone")] + ["momentum.x.block"] * (dimension != 1)
    return scene


def test_a_block_lands_on_a_body_that_stands():
    """Free until then; at rest its face is the stone's, to 0.01 cells, and bears its weight; the stone has not moved by a bit."""
    s = run_of(on_stone(1, 0.7, end=3.0, E=30.0))
    assert np.all(s["position_max_x_stone"] == s["position_max_x_stone"][0]) and np.all(s["momentum_x_stone"] == 0.0)
    free = s["position_min_x_block"] > 2.5 * H
    assert free.sum() > 2 and np.abs(s["force_block_stone_x"][free]).max() == 0.0
    assert s["position_min_x_block"][-1] == pytest.approx(2.4 * H, abs=0.01 * H)
    assert s["force_block_stone_x"][-1] == pytest.approx(s["mass_total_block"][0], rel=1e-3)


@pytest.mark.slow
def test_it_rubs():
    """Down a stone of 25 degrees with g (sin - mu cos), to 0.5 %, once it bears: let go at once, friction is late by 2 ms."""
    s, c, mu = np.sin(np.radians(25)), np.cos(np.radians(25)), 0.2
    scene = on_stone(2, 0.0, end=0.12, E=100.0, drag=0.0, gravity=[s, -c])
    scene["contacts"] = [{"between": ["block", "stone"], "friction": mu}]
    found = run_of(scene)
    down = (found["momentum_x_block"] + mu * found["momentum_y_block"]) / found["mass_total_block"][0]
    assert (down[14:] - down[8]) / (found["time"][14:] - found["time"][8]) == pytest.approx(s - mu * c, rel=0.005)


def series(x, t):
    k = np.arange(1, 400, 2)
    return 350 + np.sum(200 / (np.pi * k) * np.sin(k * np.pi / 2) * np.cos(k * np.pi * x) * np.exp(-((k * np.pi) ** 2) * t))


def test_heat_between_one_that_stands_and_one_that_moves():
    """Two slabs of one conductivity are one bar to heat: order 1.8, and what one loses the other takes in to 1e-12."""
    errors = []
    for n in (8, 16):
        scene = conducting(1, n)
        scene["materials"]["stone"] = {name: law for name, law in scene["materials"]["m"].items() if name != "elastic"}
        scene["bodies"]["hot"]["material"] = "stone"
        scene["output"] |= {"probes": {"hot": [0.25], "cold": [0.75]}, "observables": ["heat.total", "heat.hot_cold"]}
        s = run_of(scene)
        errors.append(max(abs(s["temperature_hot"][-1] - series(0.25, 0.05)), abs(s["temperature_cold"][-1] - series(0.75, 0.05))))
        assert np.abs(s["heat_total"]).max() < 1e-12 * 25 and s["heat_hot_cold"][-1] < -5
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[1] < 5e-3 * 50


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"contacts": [{"between": ["block", "stone"], "welded": {}}]}, "contacts.0.welded: stone has no `elastic`"),
        ({"method": {"transfer": {"xpic": {"order": 2}}}}, "method.transfer: xpic"),
        ({"method": {"locking": "fbar"}}, "method.locking"),
        ({"method": {"frame": "total"}}, "method.frame"),
        ({"method": {"mechanics": "implicit"}}, "method.mechanics"),
        (
            {"tools": {"press": {"shape": {"box": {"lower": [0.0, 0.6], "upper": [0.75, 0.75]}}, "motion": {"velocity": [0, -1]}}}},
            "tools.press.motion: at 0.325 s",
        ),
    ],
)
def test_what_it_cannot_be_beside_is_refused(change, said):
    with pytest.raises((SceneError, mpm.ConfigError), match=said):
        build(mpm.load(on_stone(2, 0.0, end=0.1) | {"time": {"end": 0.5}} | change))
