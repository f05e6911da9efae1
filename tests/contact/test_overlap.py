"""What overlaps a little at the start parts without an energy that the guards would stop; what comes within another is warned of."""

import copy

import numpy as np
import pytest
from contact_scenes import pressed

TOUCHING = {
    "grid": {"dimension": 1, "size": [1.5], "cell": 0.0625},
    "bodies": {"a": {"shape": {"box": {"lower": [0.11], "upper": [0.61]}}, "material": "m"},
               "b": {"shape": {"box": {"lower": [0.61], "upper": [1.11]}}, "material": "m"}},
    "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.0}}}},
    "time": {"end": 1.0}, "output": {"every": 0.1, "observables": ["position.max_x.a", "position.min_x.b"]},
}  # fmt: skip


def test_a_small_overlap_parts(plain):
    """As meshes of round bodies leave it: 0.04 and 1e-6 cells, of bodies at rest. It ended as growth of energy."""
    scenes = [copy.deepcopy(TOUCHING) for _ in range(2)]
    for scene, deep in zip(scenes, (0.04, 1e-6), strict=True):
        scene["bodies"]["b"]["shape"]["box"]["lower"] = [0.61 - deep * 0.0625]
    for run in plain(scenes):
        s = run["series"]
        assert run["kind"] == "completed" and not run["facts"]["warnings"]
        assert s["position_max_x_a"][-1] <= s["position_min_x_b"][-1] and s["velocity_max"].max() < 0.02
        assert s["energy_total"].max() < 1.5 * run["facts"]["parted"]


def test_a_tool_that_comes_within_a_body_is_warned_of(plain):
    """It is pushed out, and in the end bears what the bar does."""
    scene = pressed(1, 0.3)
    low = scene["tools"]["press"]["shape"]["box"]["lower"][-1]
    scene["tools"]["press"] |= {"from": 2.0, "motion": {}}
    scene["tools"]["press"]["shape"]["box"]["lower"] = [low - 0.05]
    (run,) = plain([scene])
    (said,) = [text for text in run["facts"]["warnings"] if text.startswith("overlap: ")]
    assert run["kind"] == "completed" and said.startswith("overlap: bar and press overlapped by 0.4 cells")
    assert -run["series"]["force_press_x"][-1] == pytest.approx(-np.log(0.95) / 0.95, rel=0.01)


def test_the_area_of_the_first_record(plain):
    """It is that of the whole interval, of which the first impulse acts for half a step less."""
    scene = copy.deepcopy(TOUCHING) | {"gravity": [-0.01], "walls": {"left": "contact"}, "output": {"every": 0.1}}
    for name, low in (("a", 0.0), ("b", 0.5)):
        scene["bodies"][name]["shape"]["box"] = {"lower": [low], "upper": [low + 0.5]}
    (run,) = plain([scene])
    assert np.all(np.abs(run["series"]["area_left"][1:] - 1.0) < 1e-12) and np.all(np.abs(run["series"]["area_a_b"][1:] - 1.0) < 1e-12)
