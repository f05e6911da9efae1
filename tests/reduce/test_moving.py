"""Fewer directions for bodies that move: what is kept bit by bit, and what breaks the symmetry."""

from types import SimpleNamespace

import numpy as np
import pytest

import mpm
from mpm.reduce.choose import judged
from mpm.reduce.difference import gap
from mpm.reduce.moving import touches
from mpm.reduce.offers import Offer, asked, driving
from mpm.runner import run_named


def offered(config, name):
    found = judged(mpm.load(config), name, 0.1, None)
    return getattr(found, "offer", None) or found.why


def test_a_column_is_the_config_of_one_direction(scenes):
    run = mpm.run_point(mpm.load(scenes.column() | {"model": "auto"}))
    assert run.facts["model"]["name"] == "1-D" and run.finals["model_error"] == 0
    hand = scenes.column() | {
        "grid": {"dimension": 1, "size": [1.5], "cell": 0.125},
        "bodies": {"b": {"shape": {"box": {"lower": [0], "upper": [1.0]}}, "material": "m"}},
        "gravity": [-0.05],
        "time": {"end": 2.0, "safety": (1.0 / 1.2) ** 0.5},
        "output": {"every": 0.2},
    }
    run_hand = mpm.run_point(mpm.load(hand))
    assert np.array_equal(run.series["position_max_y"], run_hand.series["position_max_x"])
    assert np.array_equal(run.series["momentum_y"], run_hand.series["momentum_x"] * 0.5)
    assert not {"position_max_x", "extent_x"} & set(run.series)


@pytest.mark.slow
def test_a_column_of_two_directions_is_uniform(scenes):
    experiment = mpm.load(scenes.column())
    offer = offered(scenes.column(), "fewer directions")
    apart = gap(run_named(experiment), offer.back(run_named(offer.experiment)), asked(experiment), driving(experiment))
    assert max(apart.values()) < 1e-12


@pytest.mark.slow
def test_a_bouncing_ball_within_its_estimate(scenes):
    experiment = mpm.load(scenes.ball())
    offer = offered(scenes.ball(), "axisymmetric")
    apart = gap(run_named(experiment), offer.back(run_named(offer.experiment)), asked(experiment), driving(experiment))
    assert 1e-6 < max(apart.values()) < offer.error


def test_a_ball_is_axisymmetric(scenes):
    offer = offered(scenes.ball(), "axisymmetric")
    transits = 0.12 / 0.5 * (1.3461538e5 / 1000) ** 0.5
    assert isinstance(offer, Offer) and offer.experiment.grid.dimension == "axisymmetric" and offer.error == pytest.approx(0.3 / 16 * transits, rel=1e-6)
    assert offer.experiment.bodies["b"].velocity == (0.0, -2.0) and offer.experiment.grid.size == (0.5, 1.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"bodies.b.velocity": [1, 0, 0]}, "pushed or thrown"),
        ({"bodies.b.angular_velocity": [0, 0, 1]}, "spins"),
        ({"bodies.b.shape.ball.centre": [0.3, 0.5, 0.4]}, "walls beside it"),
        ({"output.observables": ["position.max_x"]}, "position_max_x is asked for"),
        ({"output.observables": []}, "everything is asked for"),
    ],
)
def test_what_breaks_the_symmetry_of_a_ball(scenes, change, said):
    config = scenes.ball()
    for path, value in change.items():
        *way, last = path.split(".")
        place = config
        for key in way:
            place = place[key]
        place[last] = value
    assert said in offered(config, "axisymmetric")


@pytest.mark.parametrize("change", [{"walls": {"left": "stick"}}, {"gravity": [0.1, -0.05]}, {"method": {"offset": [0.2, 0]}}])
def test_what_breaks_the_symmetry_of_a_column(scenes, change):
    assert "slip" in offered(scenes.column() | change, "fewer directions")


def test_the_walls_are_looked_at_after_the_run():
    wide = SimpleNamespace(series={"position_max_r": np.array([0.25, 0.41])})
    assert touches(wide, 0.5, 0.05) and not touches(wide, 0.6, 0.05)
