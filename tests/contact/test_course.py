"""What changes over time beside heat, against closed forms, in plain Python: gravity, loads that begin and end, friction, walls and pairs within a time."""

import copy
import math

import numpy as np
import pytest
from contact_scenes import conducting, pressed

import mpm
from mpm.scene.build import SceneError, build

FRAMES = ("updated", "total")
FREE = {
    "grid": {"dimension": 1, "size": [4.0], "cell": 0.25},
    "bodies": {"bar": {"shape": {"box": {"lower": [2.0], "upper": [3.0]}}, "material": "m"}},
    "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 100.0, "nu": 0.0}}}},
    "time": {"end": 0.5}, "output": {"every": 0.1},
}  # fmt: skip


def over(time, value) -> dict:
    return {"table": {"time": time, "value": value}}


def test_free_fall_under_gravity_that_rises(plain):
    """g = -8 t: v = -4 t^2 to rounding; x = -4 t^3/3 but for g' t dt^2/6 by leapfrog. Its work is what the body gains, of order 2."""
    runs = plain([FREE | {"gravity": [over([0, 0.5], [0, -4.0])], "time": {"end": 0.5, "step": step}, "method": {"frame": frame}}
                  for frame in FRAMES for step in (0.025, 0.0125)])  # fmt: skip
    for number, run in enumerate(runs):
        t, s, dt = run["times"], run["series"], (0.025, 0.0125)[number % 2]
        x = -4 * t**3 / 3 + 8 * t * dt**2 / 6
        assert run["kind"] == "completed" and s["momentum_x"] == pytest.approx(-4 * t**2, abs=1e-14)
        assert s["position_mean_x"] - 2.5 == pytest.approx(x, abs=1e-13)
    for coarse, fine in (runs[:2], runs[2:]):
        off = [abs(run["series"]["work_loads"][-1] - run["series"]["energy_kinetic"][-1]) for run in (coarse, fine)]
        assert off[1] < 0.3 * off[0] and off[1] < 0.01 * 0.5


@pytest.mark.parametrize("method", [{}, {"frame": "total"}, pytest.param({"mechanics": "implicit"}, marks=pytest.mark.wide)])
def test_work_of_gravity_that_grows_on_what_lies(plain, method):
    """A bar that rests and sags as gravity grows stores it all. By momentum alone a quarter was lacking, and in the total frame it was -65 times that."""
    scene = FREE | {"gravity": [over([0, 40.0], [0, -0.05])], "walls": {"left": "stick"}, "time": {"end": 40.0}, "method": method}
    scene["bodies"] = {"bar": scene["bodies"]["bar"] | {"shape": {"box": {"lower": [0.0], "upper": [1.0]}}}}
    (run,) = plain([scene])
    s = run["series"]
    assert run["kind"] == "completed" and s["work_loads"][-1] == pytest.approx(s["energy_elastic"][-1], rel=0.02) and s["energy_elastic"][-1] > 0.0


def test_a_block_of_no_steps_does_no_work():
    """With it a run compiles ahead: it ended there with an error."""
    scene = build(mpm.load(FREE | {"gravity": [over([0, 0.5], [0, -4.0])]}))
    scene.course.lay(scene, 0.0, 0.1, 0, 0.0)
    assert scene.course.work(scene) == 0.0


def test_gravity_that_jumps(plain):
    """Steps end on the jump, which no output time shares: momentum is exact after it."""
    jump = [over([0, 0.23, 0.23, 0.5], [-1, -1, 2, 2])]
    for run in plain([FREE | {"gravity": jump, "method": {"frame": frame}} for frame in FRAMES]):
        t = run["times"]
        assert run["series"]["momentum_x"] == pytest.approx(np.where(t < 0.23, -t, -0.23 + 2 * (t - 0.23)), abs=1e-14)


def test_gravity_that_swings_in_implicit_steps(plain):
    """g = cos(2 pi t): of order 2 in the steps that it takes."""
    swing = {"sine": {"mean": 0.0, "amplitude": 1.0, "period": 1.0, "phase": math.pi / 2}}
    off = []
    for step in (0.05, 0.025):
        (run,) = plain([FREE | {"gravity": [swing], "time": {"end": 0.5, "step": step}, "method": {"mechanics": "implicit"}}])
        exact = (1 - np.cos(2 * np.pi * run["times"])) / (2 * np.pi) ** 2
        off.append(np.abs(run["series"]["position_mean_x"] - 2.5 - exact).max())
    assert off[0] < 2e-3 and off[1] < 0.3 * off[0]


@pytest.mark.parametrize("ramp", [0.0, 0.1])
def test_a_traction_that_begins_and_ends(plain, ramp):
    """Its impulse: force times time, to rounding where it is steady, in both frames, at any time between two outputs; with a ramp by the integral of it."""
    load = {"of": "bar", "side": "right", "traction": {"nominal": [0.3], "ramp": ramp}, "from": 0.07, "until": 0.31}
    for run in plain([FREE | {"loads": [load], "method": {"frame": frame}} for frame in FRAMES]):
        acted = np.clip(run["times"] - 0.07, 0, 0.24)
        s = np.minimum(acted / ramp, 1.0) if ramp else np.ones_like(acted)
        exact = 0.3 * (ramp * (s**3 - s**4 / 2) + acted - np.minimum(acted, ramp))
        assert run["kind"] == "completed" and run["series"]["momentum_x"] == pytest.approx(exact, abs=1e-4 if ramp else 1e-14)


def test_loads_of_several_times_on_one_body(plain):
    """Two tractions and a drag, each within its own time."""
    one = {"of": "bar", "side": "right", "traction": {"nominal": [0.3]}, "from": 0.07, "until": 0.31}
    two = {"of": "bar", "side": "left", "traction": {"nominal": [0.1]}}
    (run,) = plain([FREE | {"loads": [one, two, {"of": "bar", "drag": {"rate": 2.0}, "from": 0.4}]}])
    t, p = run["times"], run["series"]["momentum_x"]
    assert p[t < 0.41] == pytest.approx((0.3 * np.clip(t - 0.07, 0, 0.24) + 0.1 * t)[t < 0.41], abs=1e-14)
    slower = math.exp(-0.2)
    assert p[-1] == pytest.approx(p[-2] * slower + 0.05 * (1 - slower), rel=0.01)  # drag acts on velocities of half a step before
    with pytest.raises(SceneError, match="several from and until"):
        build(mpm.load(FREE | {"loads": [one, two], "method": {"frame": "total"}}))


def slope(**bottom) -> dict:
    """A block that slides down, pulled by half its weight."""
    return {
        "grid": {"dimension": 2, "size": [1.0, 0.5], "cell": 0.125},
        "bodies": {"block": {"shape": {"box": {"lower": [0.25, 0.0], "upper": [0.5, 0.25]}}, "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 100.0, "nu": 0.3}}}},
        "gravity": [0.5, -1.0], "walls": {"bottom": bottom}, "time": {"end": 0.2}, "output": {"every": 0.025},
    }  # fmt: skip


def test_friction_that_jumps(plain):
    """What rubs is mu of what presses, before and after the jump at 0.1 s; and on a wall whose friction begins at 0.05 s and ends at 0.15 s."""
    jumps, within = plain([slope(contact={"friction": over([0, 0.1, 0.1, 1], [0.1, 0.1, 0.3, 0.3])}),
                           slope(contact={"friction": 0.2, "from": 0.05, "until": 0.15})])  # fmt: skip
    for run, exact in ((jumps, [0.1] * 3 + [0.3] * 4), (within, [0.0] + [0.2] * 4 + [0.0] * 2)):
        x, y = (run["series"][f"force_bottom_{axis}"][2:] for axis in "xy")
        assert run["kind"] == "completed" and -x / y == pytest.approx(exact, abs=1e-12)


def test_a_wall_that_lets_go(plain):
    """A mirror that sticks until 0.1 s: nothing slides, then the block goes with 0.5 m/s2."""
    (run,) = plain([slope(stick={"until": 0.1})])
    t, v = run["times"], run["series"]["momentum_x"] / run["series"]["mass_total"][0]
    assert run["kind"] == "completed" and np.diff(v[t > 0.12]) == pytest.approx(0.5 * 0.025, abs=1e-12)
    assert np.diff(v[t > 0.09])[0] == pytest.approx(0.5 * 0.025, rel=0.2)  # the wall goes half a step sooner or later
    held = plain([slope(stick={})])[0]["series"]
    assert np.abs(held["momentum_x"] - run["series"]["momentum_x"])[t < 0.09].max() == 0.0


@pytest.mark.slow
def test_friction_of_a_tool_and_of_a_pair(plain):
    """The belt takes a block along from 0.05 s on; a block on another rubs until 0.1 s."""
    tool = slope(slip={}) | {"gravity": [0.0, -1.0]}
    tool["bodies"]["block"]["shape"]["box"] = {"lower": [0.25, 0.25], "upper": [0.5, 0.5]}
    tool["grid"]["size"] = [1.0, 0.75]
    belt = {"shape": {"box": {"lower": [-3.0, 0.0], "upper": [3.0, 0.25]}}, "motion": {"velocity": [0.5, 0]}}
    tool["tools"] = {"belt": belt | {"friction": over([0, 0.05, 0.05, 1], [0, 0, 0.2, 0.2])}}
    pair = copy.deepcopy(tool)
    del pair["tools"]
    pair["bodies"]["under"] = {"shape": {"box": {"lower": [0.125, 0.0], "upper": [0.625, 0.25]}}, "material": "m"}
    pair["bodies"]["block"]["velocity"] = [0.5, 0.0]
    pair["contacts"] = [{"between": ["block", "under"], "friction": 0.2, "until": 0.1}]
    one, two = plain([tool, pair])
    for run, name, exact in ((one, "belt", [0.0] + [0.2] * 6), (two, "block_under", [-0.2] * 3 + [0.0] * 4)):
        x, y = (run["series"][f"force_{name}_{axis}"][2:] for axis in "xy")
        assert run["kind"] == "completed" and x / y == pytest.approx(exact, abs=0.02 if name != "belt" else 1e-12)


def test_heat_of_a_wall_and_of_a_pair_within_a_time(plain):
    """Nothing passes before and after; while it lasts as much as from the start on, later."""
    scene = conducting(1, 8, conductance=5.0, end=0.06)
    scene["output"]["every"] = 0.01
    later = copy.deepcopy(scene)
    later["contacts"][0] |= {"from": 0.02, "until": 0.04}
    hot = {"heat": {"beta": 20.0, "temperature": 500}}
    wall = scene | {"bodies": {"hot": scene["bodies"]["hot"]}, "contacts": [], "walls": {"left": {"contact": hot}}}
    again = wall | {"walls": {"left": {"contact": hot | {"from": 0.02, "until": 0.04}}}}
    first, then, by_wall, by_wall_later = plain([scene, later, wall, again])
    for early, late, name in ((first, then, "heat_hot_cold"), (by_wall, by_wall_later, "heat_exchanged")):
        a, b = early["series"][name], late["series"][name]
        assert abs(a[2]) > 1 and b[:3] == pytest.approx(0.0, abs=1e-12) and b[4] == pytest.approx(a[2], rel=1e-6) and b[5:] == pytest.approx(b[4], rel=1e-12)


def test_what_cannot_change_is_refused():
    """With words that say what would do."""
    box = pressed(1)
    told = [
        (slope(slip={"until": 0.2}), "a side of the domain stays where it is"),
        (slope(contact={"friction": 0.2, "from": 0.3, "until": 0.2}), "it would end before it begins"),
        (FREE | {"walls": {"left": {"stick": {"until": 0.2}}}, "method": {"frame": "total"}}, "from the start to the end"),
        (FREE | {"gravity": [over([0, 1], [1, 2])], "exact": {"free_fall": {}}}, "gravity that does not change over time only"),
        (box | {"loads": [{"of": "bar", "side": "right", "traction": {"nominal": [1.0]}, "until": -1}]}, "before it begins"),
    ]
    for config, said in told:
        with pytest.raises(mpm.ConfigError, match=said):
            mpm.load(config)


def test_resolved_configs_are_read_back():
    scene = slope(contact={"friction": over([0, 1], [0.1, 0.2]), "until": 3.0}) | {"gravity": [0.0, over([0, 0.1, 0.1, 1], [0, 0, -1, -1])]}
    experiment = mpm.load(scene | {"loads": [{"of": "block", "drag": {"rate": 1.0}, "from": 0.1}]})
    assert mpm.load(experiment.template()) == experiment and mpm.load(experiment.resolved()).run_id == experiment.run_id
    assert mpm.load(scene | {"time": {"end": 0.4, "scale": 2.0}}).moving


def test_a_plan_knows_what_changes():
    """Groups, pairs and smaller models of a scene in which gravity and friction change."""
    from mpm.sweep.plan_report import outlook

    scene = slope(contact={"friction": over([0, 1], [0.1, 0.2])}) | {"gravity": [0.0, over([0, 0.1, 0.1, 1], [0, 0, -1, -1])]}
    found = outlook(mpm.load(scene), None, 1)
    assert "gravity: over time" in found["estimate"]["physics"]["compiled"]
    assert next(group["value"] for group in found["groups"] if group["name"] == "gravity/stiffness") == pytest.approx(0.25 / (100 / (1 - 0.3**2)), rel=0.2)


def test_a_body_force_that_jumps(plain):
    """Of a source from 0.07 to 0.31 s: its impulse to rounding, explicit and implicit; a mass of one."""
    source = {"of": "bar", "force": [0.3], "from": 0.07, "until": 0.31}
    for run in plain([FREE | {"sources": [source]}, FREE | {"sources": [source], "method": {"mechanics": "implicit"}, "time": {"end": 0.5, "step": 0.02}}]):
        assert run["kind"] == "completed"
        assert run["series"]["momentum_x"][-1] == pytest.approx(0.3 * 0.24, abs=1e-13 if run["facts"].get("mechanics") is None else 1e-6)


@pytest.mark.slow
def test_friction_that_jumps_in_implicit_steps(plain):
    """Steps of twice the explicit ones and more end on the jump too: the block comes as far, within 1 %."""
    scene = slope(contact={"friction": over([0, 0.1, 0.1, 1], [0.1, 0.1, 0.3, 0.3])})
    explicit, implicit = plain([scene, scene | {"method": {"mechanics": "implicit"}, "time": {"end": 0.2, "step": 0.01}}])
    ways = [run["series"]["position_mean_x"][-1] - 0.375 for run in (explicit, implicit)]
    assert implicit["kind"] == "completed" and ways[1] == pytest.approx(ways[0], rel=0.01)
