"""Latched expansion in a moving body: it swells with the temperature, sets, and does not shrink as it cools."""

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.state import Expansion

pytestmark = pytest.mark.plain

LATCHED = {"latched": {"gamma": 0.02, "reference": 400.0, "set": 410.0}}
REVERSIBLE = {"modulus": {"gamma": 0.02, "reference": 400.0}}
SWOLLEN = np.exp(0.02 * 10 / 7.0)  # uniaxial: ln J = gamma (set - reference)/(lam + 2 mu)


def play(core, expansion, start, outside):
    """(scene, run, mean of J after half the time) of a free bar of temperature `start` in air of temperature `outside`."""
    data = core.config(1, time={"end": 8.0}, surfaces=[{"of": "body", "convection": {"beta": 20.0, "outside": outside}}])
    data["bodies"]["body"]["temperature"] = start
    data["materials"]["solid"] |= {"expansion": expansion, "heating": None, "heat": {"fourier": {"kappa": 2.0, "alpha": 1.5}}}
    scene, run = core.play(mpm.load(data))
    assert run.outcome.ok
    return scene, run, float(np.mean(run.series["volume_total"][run.times > 4.0]) / run.series["volume_total"][0])


def test_swells_no_further_than_it_sets(core):
    scene, run, J = play(core, LATCHED, 395.0, 430.0)
    assert run.series["temperature_min"][-1] > 425 and J == pytest.approx(SWOLLEN, rel=2e-3)
    assert np.all(scene.bodies[0].expansion.most + scene.bodies[0].thermal.zero == 410.0)


def test_does_not_deflate_as_it_cools(core):
    _, run, J = play(core, LATCHED, 430.0, 380.0)
    assert run.series["temperature_max"][-1] < 382 and J == pytest.approx(SWOLLEN, rel=2e-3)
    assert play(core, REVERSIBLE, 430.0, 380.0)[2] < 0.98


def test_nothing_is_stored_otherwise(core):
    scene, _ = core.play(core.experiment(1))
    assert type(scene.bodies[0].expansion) is Expansion and all(np.ndim(field) == 0 for field in scene.bodies[0].expansion)


@pytest.mark.parametrize("strength", [{"coefficient": 1e-3}, {"gamma": 13.0}, {"c": 13.0 / 3.0}])
def test_three_ways_to_say_how_strongly(core, strength):
    from mpm.scene.build import build

    data = core.config(1)
    data["materials"]["solid"] |= {"expansion": {"latched": strength | {"set": 410.0}}, "heating": None}
    assert build(mpm.load(data)).bodies[0].expansion.gamma == pytest.approx(13.0 if "coefficient" not in strength else 13e-3, rel=1e-14)


@pytest.mark.parametrize(
    ("expansion", "heating", "message"),
    [
        ({"set": 410}, None, "exactly one strength is needed, found none"),
        ({"set": 410, "c": 1, "gamma": 1}, None, "found gamma c"),
        ({"gamma": 1}, None, "missing"),
        ({"set": 410, "gamma": 1}, {"elastic": {}}, "not reversible"),
    ],
)
def test_refusals(core, expansion, heating, message):
    data = core.config(1)
    data["materials"]["solid"] |= {"expansion": {"latched": expansion}, "heating": heating}
    with pytest.raises(ConfigError, match=message):
        mpm.load(data)
