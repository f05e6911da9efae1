"""What `mpm plan` says a point costs: more for more, and what it costs within a factor of two."""

import math

import pytest

import mpm
from mpm.benchmarks.costs import CONFIGS, SCENES, measure
from mpm.contact.outlook import fall, near_shares
from mpm.costs import estimate
from mpm.scene.build import build


def seconds(name, changes):
    return estimate(mpm.load(CONFIGS / f"{name}.yaml", changes))["seconds"]


def test_more_costs_more():
    coarse, fine, finer = (seconds("verification/hencky_bar", {"grid.cell": 2.0**-n}) for n in (4, 8, 9))
    assert 1 < fine / coarse and 2.5 < finer / fine < 4  # four times the work where a run is more than what happens once, and once an output
    assert seconds("verification/hencky_bar", {"output.every": 0.01}) > seconds("verification/hencky_bar", {})
    assert seconds("scenes/slump", {"materials.dough.flow.ellipse.map": "clipped"}) > seconds("scenes/slump", {})


@pytest.mark.parametrize(
    ("gap", "speed", "pull", "time"), [(1, 0, 2, 1), (1, 2, 0, 0.5), (1, -1, 2, (1 + 5**0.5) / 2), (0.4, 1, -1, 1 - 0.2**0.5), (0.6, 1, -1, math.inf),
                                       (1, -1, 0, math.inf), (0, -1, 0, 0)]
)  # fmt: skip
def test_when_a_gap_is_closed(gap, speed, pull, time):
    assert fall(gap, speed, pull) == pytest.approx(time, rel=1e-12)


def near_share(scene, *told, settles):
    return max((part for part, _ in near_shares(scene, *told, settles)), default=0.0)


def test_contact_costs_from_when_something_is_near():
    """The cube falls on to its floor and then meets it; in slump.yaml nothing falls towards a side."""
    cube = build(mpm.load(CONFIGS / "scenes" / "cube.yaml"))
    assert 0.75 < near_share(cube, 0.3, 11.6, settles=True) < 1 - 0.04 / 0.3  # 0.1 m at 1.5 m/s and faster, less half a cell of skin
    assert 2 * 0.3 / 10 < 0.3 * near_share(cube, 0.3, 15.8, settles=False) < 3 * 0.3 / 10  # in touch for 2 L/c, c that of a bar
    assert near_share(cube, 0.04, 11.6, settles=True) == 0
    assert near_share(build(mpm.load(CONFIGS / "scenes" / "slump.yaml")), 5.0, 2.0, settles=True) == 0
    flies = seconds("scenes/cube", {"walls": {}, "gravity": [0, 0, 0], "bodies.cube.velocity": [0, 0, 0.1]})
    assert 1.1 * flies < seconds("scenes/cube", {}) < 1.6 * flies  # run in turn with one that lies still, it took 1.16 of it


@pytest.mark.parametrize("name", ["cube", "slump", "loaf_oven_spring", "chocolate_pour", "dough_creep"])
def test_few_particles_have_the_limits_of_all(name, monkeypatch):
    """What is said of a large scene is seen on a part of its particles: the limits are the same, and the counts nearly."""
    experiment = mpm.load(CONFIGS / "scenes" / f"{name}.yaml")
    every = estimate(experiment)
    monkeypatch.setattr("mpm.costs.LOOKED", 60)
    few = estimate(experiment)
    assert few["limits"] == pytest.approx(every["limits"], rel=1e-9) and few["binds"] == every["binds"] and few["steps"] == every["steps"]
    assert few["particles"] == pytest.approx(every["particles"], rel=0.05) and few["memory_bytes"] == every["memory_bytes"]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "changes"), SCENES)
def test_within_a_factor_of_two(name, changes):
    """By processor time, which a busy machine stretches by a third or so."""
    line = measure(name, changes)
    assert 0.5 <= line.ratio <= 2.0, line.text()
