"""Tools: what they push, turn and warm, against exact cases, in plain Python."""

import copy
import math

import numpy as np
import pytest
from contact_scenes import bars, dropped, pressed
from scipy.optimize import brentq

import mpm
from mpm.contact.texture import texture
from mpm.scene.build import SceneError, build


def test_a_bar_between_two_tools(plain):
    """P = E ln F/F to 0.5 %, the strain of every particle to 5 %, wherever the grid's lines are; floor and press to 5e-5."""
    for offset, run in zip((0.0, 0.3), plain([pressed(1, offset) for offset in (0.0, 0.3)]), strict=True):
        s = run["series"]
        push, back = -s["force_press_x"][-1], s["force_anvil_x" if offset else "force_left_x"][-1]
        assert push == pytest.approx(-math.log(0.9) / 0.9, rel=0.005) and back == pytest.approx(push, rel=2e-3)
        assert np.log([s["J_min"][-1], s["J_max"][-1]]) / math.log(0.9) == pytest.approx(1.0, abs=0.05)
        assert s["work_loads"][-1] < 0 or s["work_loads"][-1] == pytest.approx(s["energy_elastic"][-1], rel=0.3)


def test_a_weight_on_a_bar(plain):
    """A tool that a force pushes comes to rest where the bar bears the force: -P = E ln F/F for the length F of the bar, F = 0.9."""
    load = math.log(0.9) / 0.9
    scene = pressed(1, end=60.0)
    scene["tools"]["press"]["motion"] = {"force": [load], "mass": 0.5}
    scene["loads"][0]["drag"]["rate"] = 1.5
    (run,) = plain([scene])
    s = run["series"]
    assert run["kind"] == "completed" and s["velocity_max"][-1] < 1e-3
    assert s["force_press_x"][-1] == pytest.approx(load, rel=5e-3) and s["extent_x"][-1] == pytest.approx(0.9, abs=1e-3)


def test_a_belt_takes_a_block_along(plain):
    """A tool that moves sideways under a block: mu g, until they go alike."""
    scene = dropped(2, 0.0, drag=0.0, end=0.8, cells=1, E=20.0)
    scene["grid"]["size"] = [1.5, 0.75]
    scene["bodies"]["block"]["shape"]["box"] |= {"lower": [0.3, 0.25], "upper": [0.425, 0.375]}
    belt = {"shape": {"box": {"lower": [-3.0, 0.0], "upper": [3.0, 0.25]}}, "motion": {"velocity": [0.1, 0]}, "friction": 0.5}
    scene |= {"tools": {"belt": belt}, "loads": [], "walls": {}}
    (run,) = plain([scene])
    t, v = run["times"], run["series"]["momentum_x"] / run["series"]["mass_total"][0]
    w = run["series"]["momentum_y"] / run["series"]["mass_total"][0]
    sliding = (t > 0.06) & (t < 0.16)
    assert v[sliding] == pytest.approx(0.5 * (t + w)[sliding], rel=0.02)  # mu times the impulse of the normal force
    assert np.mean(v[t > 0.4]) == pytest.approx(0.1, rel=0.03)  # it sways about it


def test_a_hot_tool_is_a_hot_wall(plain):
    """The same bar on a tool that stands at the wall, and on the wall: the same heat."""
    heat = {"beta": 20.0, "temperature": 400}
    scene = bars(1, end=0.05, every=0.01)
    del scene["bodies"]["b"], scene["bodies"]["a"]["velocity"]
    scene["bodies"]["a"] |= {"shape": {"box": {"lower": [0.25], "upper": [1.25]}}, "temperature": 300}
    scene["materials"]["m"]["heat"] = {"fourier": {"kappa": 1.0, "alpha": 1.0}}
    other = copy.deepcopy(scene)
    scene["tools"] = {"pan": {"shape": {"box": {"lower": [0.0], "upper": [0.25]}}, "heat": heat}}
    other["bodies"]["a"]["shape"]["box"] = {"lower": [0.0], "upper": [1.0]}
    other["walls"] = {"left": {"contact": {"heat": heat}}}
    tool, wall = (run["series"]["heat_exchanged"] for run in plain([scene, other]))
    assert wall[-1] > 10 and tool == pytest.approx(wall, rel=1e-6)


@pytest.mark.slow
def test_a_block_that_lands_askew_on_a_hot_tool():
    """At 23 degrees to the grid, from 0.3 and 1 cells above the face: the heat of the slab's series less the fall's share, to 2 %, and none is lost."""
    turn, h, beta, kappa, capacity, end, g, drag = math.radians(23), 0.0625, 20.0, 10.0, 100.0, 0.6, 30.0, 30.0
    along, up = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
    corner = np.array([0.85, 0.6])  # of the tool's upper face, its middle
    roots = [brentq(lambda m: m * math.sin(m) - beta * 0.5 / kappa * math.cos(m), i * math.pi + 1e-9, i * math.pi + math.pi / 2) for i in range(60)]

    def heat(t):
        """Of a slab of 0.5 m that is insulated above, by what it could take in."""
        b = beta * 0.5 / kappa
        return 1 - sum(2 * b * b / (m * m * (m * m + b * b + b)) * math.exp(-m * m * kappa / capacity * t / 0.25) for m in roots)

    scenes = []
    for gap in (0.0, 0.3, 1.0):
        foot = corner + gap * h * up
        vertices = [foot + a * along + b * up for a, b in ((-0.125, 0), (0.125, 0), (0.125, 0.5), (-0.125, 0.5))]
        centre = corner - 0.15 * up
        box = {"lower": [centre[0] - 0.4, centre[1] - 0.15], "upper": [centre[0] + 0.4, centre[1] + 0.15], "angle": turn}
        scene = dropped(2, 0.0, drag=drag, E=1000.0, end=end, gravity=(-g * up).tolist(), walls={})
        scene["grid"] = {"dimension": 2, "size": [1.5, 1.5], "cell": h}
        scene["bodies"]["block"] |= {"shape": {"polygon": {"vertices": [v.tolist() for v in vertices]}}, "temperature": 300}
        scene["materials"]["m"]["heat"] = {"fourier": {"kappa": kappa, "alpha": capacity}}
        scene["tools"] = {"pan": {"shape": {"box": box}, "heat": {"beta": beta, "temperature": 400}}}
        scenes.append(scene)
    runs = [mpm.run_point(mpm.load(scene)) for scene in scenes]
    most = 100 * 0.25 * 0.5 * capacity
    for gap, run in zip((0.0, 0.3, 1.0), runs, strict=True):
        fall = brentq(lambda t, gap=gap: g / drag * t - g / drag**2 * (1 - math.exp(-drag * t)) - gap * h, 0.0, 1.0)
        assert run.outcome.ok and np.abs(run.series["heat_ledger"]).max() < 1e-12 * most
        assert run.series["heat_exchanged"][-1] / runs[0].series["heat_exchanged"][-1] == pytest.approx(heat(end - fall) / heat(end), rel=0.02)
    assert runs[0].series["heat_exchanged"][-1] == pytest.approx(most * heat(end), rel=0.02)


def test_a_path_goes_down_and_up(plain):
    """Two bites: the force is there while the tool is down, and gone when it is up; the tool is where its programme says."""
    scene = pressed(1, end=40.0)
    path = {"time": [0, 10, 20, 30, 40], "displacement": [[0.0], [-0.1], [0.05], [-0.1], [0.05]]}
    scene["tools"]["press"]["motion"] = {"path": path}
    scene["output"]["every"] = 0.5
    (run,) = plain([scene])
    t, force, top = run["times"], run["series"]["force_press_x"], run["series"]["position_max_x"]
    down = (np.abs(t - 10) < 0.3) | (np.abs(t - 30) < 0.3)
    assert run["kind"] == "completed" and -force[down].max() > 0.1 and np.abs(force[np.abs(t - 20) < 1.5]).max() == 0.0
    assert top[np.abs(t - 10) < 0.1] == pytest.approx(0.9, abs=2e-3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"shape": {"box": {"lower": [0.95], "upper": [1.4]}}}, "tools.press.shape: it overlaps bar at the start by 0.4 cells"),
        ({"shape": {"box": {"lower": [1.0], "upper": [1.1]}}}, "tools.press.shape: it is 0.8 cells thick"),
        ({"motion": {"velocity": [-2.0]}}, "over 0.2 of the speed of sound"),
    ],
)
def test_tools_that_no_step_can_follow(change, said):
    scene = pressed(1)
    scene["tools"]["press"] |= change
    with pytest.raises(SceneError, match=said):
        build(mpm.load(scene))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"motion": {"velocity": [1, 0]}}, "the velocity needs 1 number in dimension 1"),
        ({"motion": {"spin": 1.0}}, "there is no rotation in dimension 1"),
        ({"motion": {"force": [-1.0]}}, "a tool with a force needs a mass"),
        ({"motion": {"velocity": [0.1], "force": [1.0], "mass": 1.0}}, "say different things"),
        ({"motion": {"path": {"time": [0, 1], "displacement": [[0.0]]}}}, "2 times but 1 displacements"),
        ({"shape": {"cylinder": {"radius": 1, "height": 1, "base": [0]}}}, "there is no cylinder in dimension 1"),
        ({"heat": {"beta": 5, "temperature": 300}}, "no body has heat"),
    ],
)
def test_tools_are_checked(change, said):
    scene = pressed(1)
    scene["tools"]["press"] |= change
    with pytest.raises(mpm.ConfigError, match=said):
        mpm.load(scene)


def test_observables_of_what_is_met():
    scene = pressed(1)
    scene["output"]["observables"] = ["force.press_x", "area.left", "force.pres_x"]
    with pytest.raises(mpm.ConfigError, match="there is no wall, tool or pair of bodies 'pres'") as found:
        mpm.load(scene)
    assert len(found.value.problems) == 1


def test_texture_of_two_bites(plain):
    """An elastic bar between two bites: the force of the exact law, the second as the first, and its way by the tool's programme."""
    scene = pressed(1, end=40.0)
    path = {"time": [0, 10, 20, 30, 40], "displacement": [[0.0], [-0.1], [0.02], [-0.1], [0.02]]}
    scene["tools"]["press"]["motion"], scene["output"] = {"path": path}, {"every": 0.1}
    scene["output"]["observables"] = ["hardness.press", "cohesiveness.press", "springiness.press", "travel.press_x", "position.max_x.bar"]
    (run,) = plain([scene])
    s, found = run["series"], run["finals"]
    assert run["kind"] == "completed" and s["travel_press_x"] == pytest.approx(np.interp(run["times"], path["time"], np.ravel(path["displacement"])), abs=1e-9)
    assert s["position_max_x_bar"] == pytest.approx(s["position_max_x"], abs=0.0)
    assert found["hardness_press"] == pytest.approx(-math.log(0.9) / 0.9, rel=0.03)  # a mean over an output
    touch = np.argmax((run["times"] > 20) & (-s["force_press_x"] > 0.01 * found["hardness_press"]))
    risen = s["position_max_x"][touch] - 1.0  # it swings, and is met where it is by then
    assert found["springiness_press"] == pytest.approx(1.0 + risen / 0.1, abs=0.02) and found["cohesiveness_press"] == pytest.approx(1.0, abs=0.03)


def test_texture_by_hand():
    """Two triangles, the second half as strong, from where the first left a dent of a fifth; a halt is no second bite; one tells its hardness alone."""
    way = np.concatenate([np.linspace(0, 1, 101), np.linspace(0.99, -0.2, 120), np.linspace(-0.19, 1, 120)])
    force = np.concatenate([np.linspace(0, 1, 101), np.linspace(0.97, 0, 20), np.zeros(100), np.zeros(39), np.linspace(0, 0.5, 81)])
    found = texture(force, way)
    assert found["hardness"] == 1.0 and found["cohesiveness"] == pytest.approx(0.8 * 0.5, rel=0.02) and found["springiness"] == pytest.approx(0.8, rel=0.02)
    halted, stopped = np.insert(way, 50, [way[49]] * 9), np.insert(force, 50, [force[49]] * 9)
    assert texture(stopped, halted) == pytest.approx(found, rel=1e-12)
    once = texture(force[:150], way[:150])
    assert once.pop("hardness") == found["hardness"] and all(np.isnan(value) for value in once.values())
    assert all(np.isnan(value) for value in texture(np.zeros_like(force), way).values())  # it ended the run as failed


def test_a_resolved_config_with_tools_is_read_back():
    """Sweeps and pictures read it: a path, a spin and a force, defaults and all."""
    scene = pressed(1)
    experiment = mpm.load(scene)
    assert mpm.load(experiment.template()) == experiment and mpm.load(experiment.resolved()).run_id == experiment.run_id


def test_what_a_tool_lets_go_meets_the_walls_that_no_one_named(plain):
    """A bar pressed to 0.7 between two tools flies when one is taken away, to a side ten cells off: it ended as `unprepared`."""
    scene = pressed(1, 0.3, F=0.7, n=8, end=14.0)
    scene["tools"]["press"]["until"], scene["loads"], scene["grid"]["size"] = 8.5, [], [2.25]
    scene["output"] |= {"every": 0.25, "observables": ["force.right_x"]}
    (run,) = plain([scene])
    assert run["kind"] == "completed" and run["series"]["position_max_x"].max() <= 2.25 + 0.01 / 8 and run["series"]["force_right_x"].min() < 0.0
