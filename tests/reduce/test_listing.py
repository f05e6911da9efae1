"""What `mpm plan` says of smaller models, with and without pilots."""

import mpm
from mpm.reduce.listing import listing, models_in_words
from mpm.runner import run_named


def test_errors_and_savings_without_a_run(scenes):
    found = listing(mpm.load(scenes.gentle(2)))
    (lumped,) = (one for one in found["models"] if one["name"] == "lumped")
    assert lumped["error"] < 0.01 and lumped["saving"] > 1 and lumped["pilot"] is None and found["auto"] is None
    assert any("times as fast" in line and "lumped" in line for line in models_in_words(found))


def test_motion_first_then_what_is_left(scenes):
    config = scenes.elastic()
    config["surfaces"] = [{"of": "b", "convection": {"beta": 0.2, "outside": 400}}]
    found = listing(mpm.load(config))
    errors = {one["name"]: one["error"] for one in found["models"]}
    assert 0 < errors["rigid"] < errors["rigid + lumped"] < 0.01
    assert next(one["saving"] for one in found["models"] if one["name"] == "rigid") > 10


def test_a_pilot_measures_what_the_estimate_guesses(scenes):
    found = listing(mpm.load(scenes.gentle(2)), 0.01, run_named)
    (lumped,) = (one for one in found["models"] if one["name"] == "lumped")
    assert 0 < lumped["pilot"] < lumped["error"]
    assert found["auto"]["name"] == "lumped" and "model: auto would take lumped" in models_in_words(found)[-1]


def test_nothing_smaller_is_said(scenes):
    assert "smaller   none" in models_in_words(listing(mpm.load(scenes.gentle(1) | {"exact": {"robin_slab": {}}})))[0]
