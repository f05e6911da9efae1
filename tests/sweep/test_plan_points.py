"""What `mpm plan` tells of all points of a sweep: which bodies can meet in which, by what friction, what they cost, which are refused."""

import numpy as np
import pytest

import mpm
from mpm.sweep.plan_points import KNOWN
from mpm.sweep.plan_report import in_words, outlook


def two(**more):
    """A block on a floor and one far above, that hang in the air."""
    return {
        "grid": {"dimension": 2, "size": [4.0, 4.0], "cell": 0.125},
        "bodies": {"a": {"shape": {"box": {"lower": [1, 0.2], "upper": [2, 1.2]}}, "material": "m"},
                   "b": {"shape": {"box": {"lower": [1, 3.0], "upper": [2, 3.5]}}, "material": "m", "velocity": [0, 0]}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.0}}}},
        "walls": {"bottom": "contact"}, "time": {"end": 1.0}, "output": {"every": 0.25},
    } | more  # fmt: skip


def plan(tmp_path, config):
    """The plan, and in words."""
    found = outlook(mpm.load(config), tmp_path, 1)
    return found, in_words(found)


def test_a_body_that_only_some_points_bring_near(tmp_path):
    """The first point lets it hang; it was all that was told, and all points cost as it."""
    found, said = plan(tmp_path, two(sweep={"axes": {"bodies.b.velocity.1": [0.0, -0.05, -2.0, -4.0]}}))
    assert "contact: a and b slide (not named) (in 2 of 4 points)" in found["estimate"]["physics"]["compiled"]
    assert "contact of a and b, which nothing brings together (in 2 of 4 points)" in found["estimate"]["physics"]["absent"]
    over = found["over_points"]
    assert over["points"] == 4 and over["most"] > 1.3 * over["least"] and over["least"] < over["seconds"] < over["most"]
    assert found["seconds"] == pytest.approx(4 * over["seconds"]) and f"{over['least']:.2g} to {over['most']:.2g} s a point" in said
    one, _ = plan(tmp_path, two())
    assert "contact of a and b, which nothing brings together" in one["estimate"]["physics"]["absent"] and not one["over_points"]


def test_what_never_meets_is_what_a_run_compiles_nothing_of():
    """As mpm.scene.build has it: for speeds on either side of what brings them together."""
    from mpm.scene.build import build

    for speed in (0.0, -0.2, -0.3, -1.0):
        config = two()
        config["bodies"]["b"]["velocity"] = [0.0, speed]
        experiment = mpm.load(config)
        never = any("nothing brings together" in text for text in mpm.runner.physics(experiment)["absent"])
        assert never == bool((build(experiment).meeting.pairs < 0).all())


def test_friction_and_tools_that_are_swept(tmp_path):
    """Numbers by their ends, shapes each."""
    near = two(contacts=[{"between": ["a", "b"], "friction": 0.1}], gravity=[0.0, -1.0])
    near["time"]["end"] = 4.0
    _, said = plan(tmp_path, near | {"sweep": {"axes": {"contacts.0.friction": [0.1, 0.5, 0.3]}}})
    assert "contact: a and b rub (0.1 to 0.5)," in said
    tool = two(tools={"t": {"shape": {"box": {"lower": [2.5, 1], "upper": [3.5, 2]}}, "motion": {"velocity": [-0.1, 0]}}})
    ball = {"ball": {"centre": [3.0, 1.5], "radius": 0.5}}
    found, _ = plan(tmp_path, tool | {"sweep": {"axes": {"tools.t.shape": [tool["tools"]["t"]["shape"], ball]}}})
    assert {f"tool: t, {kind}, moves by velocity (in 1 of 2 points)" for kind in ("box", "ball")} <= set(found["estimate"]["physics"]["compiled"])


def test_a_point_that_is_refused_is_told(tmp_path):
    """Where bodies would lie within each other; the others are told as ever."""
    found, said = plan(tmp_path, two(sweep={"axes": {"bodies.b.shape.box.lower.1": [3.0, 0.9]}}))
    assert "refused   " in said and "overlap at the start" in said and found["over_points"]["points"] == 1


def test_many_points_are_looked_at_evenly(tmp_path):
    """Of more than KNOWN points so many, the last among them."""
    speeds = [*np.linspace(0.0, -0.1, 2 * KNOWN).tolist(), -4.0]
    found, _ = plan(tmp_path, two(sweep={"axes": {"bodies.b.velocity.1": speeds}}))
    assert f"contact: a and b slide (not named) (in 1 of {KNOWN} points)" in found["estimate"]["physics"]["compiled"]
