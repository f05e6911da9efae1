"""Tools that a force moves, where nothing is near, and for a while: flight by Newton's law to rounding. What a tool pushes meets what lies in its way."""

import numpy as np
import pytest


def weighed(low, thrown=0.0, **motion):
    """A bar of one metre on a wall, or free, and a weight of 1 kg before it."""
    return {
        "grid": {"dimension": 1, "size": [4.0], "cell": 0.125},
        "bodies": {"bar": {"shape": {"box": {"lower": [0.53], "upper": [1.53]}}, "material": "m", "velocity": [thrown]}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.0}}}},
        "tools": {"weight": {"shape": {"box": {"lower": [low], "upper": [low + 0.9]}}, "motion": motion}},
        "time": {"end": 1.5}, "output": {"every": 0.05},
    }  # fmt: skip


@pytest.mark.parametrize("low", [2.9, 1.6])
def test_a_weight_falls(plain, low):
    """From far, where it stood still, and from half a cell: F t^2/(2 M); between `from` and `until`, which no output time shares, and else not."""
    force = {"force": [-0.1], "mass": 1.0}
    free, held = plain([weighed(low, **force), weighed(low, **force, **{"from": 0.212, "until": 0.712})])
    t = free["times"]
    fly = t < np.sqrt(2 * (low - 1.531) / 0.1)
    assert free["series"]["travel_weight_x"][fly] == pytest.approx(-0.05 * t[fly] ** 2, abs=1e-14) and fly.sum() > 20
    moved = np.clip(t - 0.212, 0.0, 0.5)
    assert held["series"]["travel_weight_x"] == pytest.approx(-0.05 * moved**2, abs=1e-14)


def test_a_bar_that_hits_a_free_tool(plain):
    """Momentum of both, also once they are apart: a rigid mass leaves with 1 - exp(-2 Z L/(c M)) of the bar's speed, as its wave is back then."""
    scene = weighed(1.6, 0.01, force=[1e-12], mass=1.0)
    scene["time"]["end"], scene["output"]["every"] = 16.0, 0.5
    (run,) = plain([scene])
    s, t = run["series"], run["times"]
    speed = np.diff(s["travel_weight_x"])[-8:] / np.diff(t)[-8:]
    assert s["momentum_x"][-8:] + speed == pytest.approx(0.01, rel=1e-6)
    assert speed == pytest.approx(0.01 * (1 - np.exp(-2.0)), rel=0.07)


def test_tools_that_forces_drive_together_give_what_they_lose(plain):
    """Weights hit a bar from both sides and bounce. In flight `work_loads` is F s - M v^2/2 of both; it was a third of it, and energy came from nowhere."""
    scene = weighed(0.43, force=[0.1], mass=1.0)
    scene["bodies"]["bar"]["shape"]["box"] = {"lower": [1.53], "upper": [2.53]}
    scene["tools"]["other"] = {"shape": {"box": {"lower": [2.73], "upper": [3.63]}}, "motion": {"force": [-0.1], "mass": 1.0}}
    scene["time"], scene["output"]["every"] = {"end": 7.5, "step": 0.0625}, 0.125
    (run,) = plain([scene])
    s, t = run["series"], run["times"]
    lost = -0.5 * sum(np.gradient(s[f"travel_{name}_x"], t) ** 2 for name in ("weight", "other"))
    lost += 0.1 * (s["travel_weight_x"] - s["travel_other_x"])
    flies = (s["force_weight_x"] == 0.0) & (t > 5.0) & (t < 7.0)
    assert flies.sum() > 8
    assert s["work_loads"][flies] == pytest.approx(lost[flies], rel=1e-10)
    assert s["dissipation_transfer"].min() > -1e-4 * s["work_loads"].max()


def test_a_tool_pushes_a_body_into_another_and_both_against_the_side(plain):
    """Far off at the start, so that nothing else would bring them there: it ended as `unprepared`. Both are pressed to 0.9: P = E ln F/F."""
    bar = lambda low: {"shape": {"box": {"lower": [low], "upper": [low + 0.5]}}, "material": "m"}  # noqa: E731
    scene = weighed(0.1, velocity=[0.2], until=15.5) | {"bodies": {"near": bar(1.0), "far": bar(2.5)}, "time": {"end": 25.0}, "output": {"every": 1.0}}
    scene["loads"] = [{"of": name, "drag": {"rate": 3.0}} for name in scene["bodies"]]
    scene["grid"]["size"] = [5.0]
    (run,) = plain([scene])
    force = -np.log(0.9) / 0.9
    assert run["kind"] == "completed", run
    assert run["series"]["force_weight_x"][-1] == pytest.approx(force, rel=0.01) and run["series"]["force_near_far_x"][-1] == pytest.approx(-force, rel=0.01)
