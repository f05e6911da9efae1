"""`model: auto`: what it takes, what it refuses, that its errors are predicted from above, and that it is the smaller config bit by bit."""

import json

import numpy as np
import pytest

import mpm
from mpm.reduce.difference import gap
from mpm.reduce.offers import asked, driving


def auto(config, tolerance=0.01):
    return mpm.run_point(mpm.load(config | {"model": {"auto": {"tolerance": tolerance}}}))


def name_of(run):
    return run.facts["model"]["name"]


def why(run, name):
    return " ".join(one["why"] for one in run.facts["model"]["kept"] if one["name"] == name)


def apart(config, run):
    full = mpm.load(config)
    return max(gap(mpm.run_point(full), run, asked(full), driving(full)).values())


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_a_small_biot_number_is_lumped(scenes, dimension):
    run = auto(scenes.gentle(dimension))
    assert name_of(run) == "lumped" and run.finals["model_error"] <= 0.01
    assert dimension == 3 or 0 < apart(scenes.gentle(dimension), run) <= run.finals["model_error"]


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_slab_has_one_direction(scenes, dimension):
    run = auto(scenes.box(dimension))
    assert name_of(run) == "1-D" and run.finals["model_error"] == 0
    assert dimension == 3 or apart(scenes.box(dimension), run) < 1e-9
    assert "estimated error" in why(run, "lumped")


def test_a_reduced_run_is_the_smaller_config_bit_by_bit(scenes):
    run = auto(scenes.box(2))
    slab = scenes.box(1) | {"surfaces": [{"of": "b", "side": "right", "convection": {"beta": 20, "outside": 400}}]}
    hand = mpm.run_point(mpm.load(slab))
    for name in ("temperature_c", "temperature_mean", "temperature_min", "temperature_max"):
        assert np.array_equal(run.series[name], hand.series[name])
    assert np.array_equal(run.series["heat_total"], hand.series["heat_total"] * 0.03) and 0 < run.finals["time_to_c_303_K"] == hand.finals["time_to_c_303_K"]
    point = auto(scenes.gentle(2))
    lumped = {
        "grid": {"dimension": 0},
        "bodies": {"b": {"shape": {"point": {"surface_to_volume": point_ratio(point)}}, "temperature": 300, "material": "m"}},
        "output": scenes.gentle(2)["output"] | {"probes": {"c": []}},
    }
    hand = mpm.run_point(mpm.load(scenes.gentle(2) | lumped))
    assert np.array_equal(point.series["temperature_c"], hand.series["temperature_c"])
    assert point_ratio(point) == pytest.approx(4 / 0.03)


def point_ratio(run):
    return run.facts["model"]["config"]["bodies"]["b"]["shape"]["point"]["surface_to_volume"]


def test_heat_without_motion_is_rigid(scenes):
    run = auto(scenes.elastic())
    assert name_of(run) == "rigid + 1-D" and 0 < run.finals["model_error"] < 0.01
    assert {"elastic", "expansion", "walls", "gravity"} & set(run.facts["model"]["config"]["materials"]["m"]) == set()


def test_motion_that_is_asked_for_stays(scenes):
    config = scenes.elastic()
    config["output"]["observables"] = ["position.max_y"]
    experiment = mpm.load(config | {"model": "auto"})
    from mpm.reduce.choose import Said, judged

    found = judged(experiment, "rigid", 0.01, None)
    assert isinstance(found, Said) and found.why == "motion is asked for"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"output": {"every": 60, "snapshots": {"every": 300, "grid": ["temperature"]}}}, "fields"),
        ({"exact": {"robin_slab": {}}}, "exact"),
        ({"surfaces": [{"of": "b", "fixed": {"temperature": 400}}]}, "held"),
        ({"surfaces": [{"of": "b", "side": "right", "flux": {"q": 1.0}}]}, "nothing is exchanged"),
    ],
)
def test_what_cannot_be_reduced_says_why(scenes, changes, said):
    run = auto(scenes.gentle(1) | changes)
    assert name_of(run) == "full" and run.finals["model_error"] == 0
    assert said in json.dumps(run.facts["model"]["kept"])


def test_a_time_that_depends_on_the_last_percent_is_not_given_away(scenes):
    """The body creeps up to 400 K: an error of half a percent decides when, and whether, 399.9 K is reached."""
    config = scenes.gentle(1)
    config["time"], config["output"] = {"end": 4e6}, {"every": 4e4, "probes": {"c": [0.025]}, "observables": ["time_to.c.399.9_K"]}
    run = auto(config)
    assert name_of(run) == "full" and "time_to_c_399_9_K" in why(run, "lumped")


def test_the_tolerance_decides(scenes):
    assert name_of(auto(scenes.gentle(2), tolerance=1e-3)) != "lumped"
    assert name_of(auto(scenes.gentle(2), tolerance=0.05)) == "lumped"


@pytest.mark.parametrize("beta", [1.0, 10.0])
@pytest.mark.parametrize("end", [100.0, 3000.0])
def test_sides_that_are_left_out_are_estimated_from_above(scenes, beta, end):
    """A plate, hot on top, that also gains something through its sides."""
    config = scenes.box(2)
    config["surfaces"] = [*config["surfaces"], {"of": "b", "side": "left", "convection": {"beta": beta, "outside": 350}}]
    probes = {"c": [0.025, 0.025], "l": [0.012, 0.025]}
    config |= {"time": {"end": end}, "output": {"every": end / 20, "probes": probes, "observables": ["temperature.mean"]}}
    from mpm.reduce.dimension import fewer

    offer = fewer(mpm.load(config), 1.0)
    difference = apart(config, offer.back(mpm.run_point(offer.experiment)))
    assert offer.name == "1-D" and 1e-4 < difference <= offer.error


@pytest.mark.parametrize("sides", ["all", "top"])
@pytest.mark.parametrize("beta", [0.2, 5.0])
@pytest.mark.parametrize("width", [1.0, 6.0])
def test_one_temperature_is_estimated_from_above(scenes, sides, beta, width):
    from mpm.reduce.lumped import lumped

    config = scenes.gentle(2)
    config["grid"] = {"dimension": 2, "size": [0.2, 0.05], "cell": 0.005}
    config["bodies"]["b"]["shape"] = {"box": {"lower": [0.01, 0.01], "upper": [0.01 + width * 0.03, 0.04]}}
    config["surfaces"] = [{"of": "b", "side": sides, "convection": {"beta": beta, "outside": 400}}]
    config["output"]["probes"] = {"c": [0.01, 0.01], "d": [0.01 + width * 0.015, 0.025]}
    offer = lumped(mpm.load(config), 1.0)
    assert 0 < apart(config, offer.back(mpm.run_point(offer.experiment))) <= offer.error


def test_every_point_of_a_sweep_by_its_own_values(scenes, tmp_path):
    config = scenes.gentle(1) | {"model": "auto", "sweep": {"axes": {"beta": [0.2, 200.0]}}}
    tree = mpm.sweep(mpm.load(config), out=tmp_path, jobs=0)
    assert tree.model_name.values.tolist() == ["lumped", "full"]
    assert 0 < float(tree.model_error[0]) <= 0.01 and float(tree.model_error[1]) == 0
    assert "lumped" in tree.attrs["facts"]


def test_the_full_model_is_the_default_and_keeps_its_ids(scenes):
    plain, full, chosen = (mpm.load(scenes.box(1) | more) for more in ({}, {"model": "full"}, {"model": "auto"}))
    assert plain.run_id == full.run_id != chosen.run_id
    assert mpm.load(scenes.box(1) | {"model": {"auto": {"tolerance": "1%"}}}).run_id == chosen.run_id


def test_a_smaller_config_that_no_method_runs_gives_way(scenes):
    """The lumped run is refused: the full model answers, and the dataset says why."""
    from mpm.reduce.choose import smallest
    from mpm.runner import run_named
    from mpm.scene.refusal import SceneError

    def run(experiment):
        if experiment.grid.dimension == 0:
            raise SceneError(("method",), "not today")
        return run_named(experiment)

    done = smallest(mpm.load(scenes.gentle(1) | {"model": "auto"}), run)
    assert done.outcome.ok and name_of(done) == "full" and why(done, "lumped") == "method: not today"


def test_a_run_that_is_stopped_stays_stopped(scenes):
    stopped = mpm.run_point(mpm.load(scenes.box(2) | {"model": "auto"}), beat=lambda fraction, when: True)
    assert stopped.outcome.kind == "budget" and stopped.series == {}
