"""Forces, areas and heat that a config asks of walls and pairs that never meet are nothing; those that no run can tell are refused before it begins."""

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.diagnostics import exchanging_area
from mpm.scene.build import build
from mpm.scene.refusal import SceneError

pytestmark = pytest.mark.plain

HEAT, ELASTIC = {"fourier": {"kappa": 1.0, "alpha": 1000.0}}, {"hencky": {"E": 1e4, "nu": 0.0}}
MATERIALS = {"m": {"density": 1000.0, "elastic": ELASTIC, "heat": HEAT}, "dull": {"density": 1000.0, "elastic": ELASTIC}}


def scene(observables, low=12.0, of="m", **more):
    bodies = {"a": (2.0, 6.0, "m"), "b": (low, low + 4.0, of)}
    return mpm.load({
        "grid": {"dimension": 1, "size": [0.02], "cell": 1e-3}, "materials": MATERIALS, "time": {"end": 5e-4},
        "bodies": {name: {"shape": {"box": {"lower": [1e-3 * x], "upper": [1e-3 * y]}}, "material": kind} for name, (x, y, kind) in bodies.items()},
        "output": {"every": 5e-4, "observables": observables}, **more,
    })  # fmt: skip


def test_what_never_meets_does_nothing_to_each_other():
    names = ["force.a_b_x", "area.a_b", "heat.a_b", "force.left_x", "area.right"]
    run = mpm.run_point(scene(names))
    assert run.outcome.ok and all(not run.series[name.replace(".", "_")].any() for name in names)


@pytest.mark.parametrize(("low", "more", "name", "said"), [
    (2.0 + 4.0, {"contacts": [{"between": ["a", "b"], "welded": {}}]}, "force.a_b_x", "a and b are welded"),
    (16.0, {"walls": {"right": "stick"}}, "force.right_x", "right is a mirror to b, which starts at it"),
    (16.0, {}, "area.right", "right is a mirror to b, which starts at it"),
])  # fmt: skip
def test_what_no_run_can_tell_is_refused_at_its_place(low, more, name, said):
    with pytest.raises(SceneError, match=said) as told:
        build(scene(["momentum.x", name], low, **more))
    assert told.value.at == ("output", "observables", 1)


def test_the_total_frame_tells_no_forces_of_walls():
    one = scene(["momentum.x"]).resolved()
    one["bodies"].pop("b")
    one["method"]["frame"], one["output"]["observables"] = "total", ["force.left_x"]
    with pytest.raises(SceneError, match="the total frame holds bodies at its walls"):
        build(mpm.load(one))


def test_heat_of_a_body_without_heat_is_refused():
    with pytest.raises(ConfigError, match="b has no heat, so none passes"):
        scene(["heat.a_b"], of="dull")


def test_heat_of_bodies_apart_that_stand_still_is_nothing():
    found = scene(["heat.a_b"], materials={name: {key: of[key] for key in ("density", "heat")} for name, of in MATERIALS.items() if "heat" in of})
    assert np.all(mpm.run_point(found).series["heat_a_b"] == 0.0)


@pytest.mark.parametrize(("deep", "fine"), [(0.04, True), (0.06, False), (0.08, False)])
def test_a_thin_overlap_is_seen(deep, fine):
    """It was looked for at its two ends, where it is nothing."""
    found = scene(["momentum.x"], 6.0 - deep)
    if fine:
        build(found)
        return
    with pytest.raises(SceneError, match="bodies a and b overlap at the start by"):
        build(found)


def test_a_tool_exchanges_nothing_before_it_touches():
    """In the first record it counted as the upper wall of the last direction, with every face that looks there."""
    one = scene(["area.exchanging"], surfaces=[{"of": "a", "side": "left", "convection": {"beta": 5.0, "outside": 300.0}}]).resolved()
    heat = {"beta": 50.0, "temperature": 400.0}
    one["tools"] = {"pan": {"shape": {"box": {"lower": [8e-3], "upper": [10e-3]}}, "heat": heat}}
    found = build(mpm.load(one))
    assert sum(map(exchanging_area, found.bodies)) == 1.0
