"""Outlines: where figures draw a tool is where the run has it (mpm.scene.tools, mpm.contact.drive), in every dimension; walls lie on the domain's sides."""

import numpy as np
import pytest

import mpm
from mpm.contact.drive import turned
from mpm.plots import outlines
from mpm.scene.tools import drive

MOTIONS = {
    "still": {},
    "velocity": {"velocity": 0.02, "from": 0.2, "until": 0.7},
    "path": {"path": {"time": [0.1, 0.5, 0.9], "displacement": [0.0, 0.01, -0.02]}},
    "spin": {"spin": 2.5, "until": 0.6},
}


def scene(dimension, shape, motion, **tool):
    D = {2: 2, "axisymmetric": 2, 3: 3}[dimension]
    said = dict(motion)
    if "velocity" in said:
        said["velocity"] = [0.0] * (D - 1) + [said["velocity"]]
    if "path" in said:
        said["path"] = {**said["path"], "displacement": [[0.0] * (D - 1) + [one] for one in said["path"]["displacement"]]}
    if "spin" in said and D == 3:
        said["spin"] = [0.3, -1.0, said["spin"]]
    body = {"shape": {"box": {"lower": [0.0] * D, "upper": [0.02] * D}}, "material": "m"}
    return mpm.load({
        "grid": {"dimension": dimension, "size": [0.1] * D, "cell": 0.005},
        "bodies": {"b": body},
        "materials": {"m": {"density": 1000, "elastic": {"hencky": {"E": 1e6, "nu": 0.3}}}},
        "tools": {"t": {"shape": shape, "motion": said, **tool}},
        "walls": {"bottom": "stick"},
        "time": {"end": 1},
    })  # fmt: skip


SHAPES = {
    "box": (2, {"box": {"lower": [0.03, 0.05], "upper": [0.07, 0.06], "angle": 0.4}}),
    "polygon": (2, {"polygon": {"vertices": [[0.03, 0.05], [0.07, 0.05], [0.05, 0.08]]}}),
    "ball": (2, {"ball": {"centre": [0.05, 0.06], "radius": 0.01}}),
    "piston": ("axisymmetric", {"cylinder": {"radius": 0.03, "height": 0.02, "base": [0, 0.05]}}),
    "block": (3, {"box": {"lower": [0.03, 0.03, 0.05], "upper": [0.07, 0.06, 0.06]}}),
    "roll": (3, {"cylinder": {"radius": 0.01, "height": 0.02, "base": [0.05, 0.05, 0.05]}}),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("motion", MOTIONS)
def test_a_tool_is_drawn_where_the_run_has_it(shape, motion):
    dimension, said = SHAPES[shape]
    if motion == "spin" and dimension == "axisymmetric":
        pytest.skip("a round scene does not spin")
    experiment = scene(dimension, said, MOTIONS[motion])
    config, (told,) = experiment.resolved(), drive(experiment).told
    (_, begin, known), *_ = outlines.tools(config, 0.0)
    assert known
    for when in (0.0, 0.15, 0.45, 0.65, 1.0):
        (_, lines, _), *_ = outlines.tools(config, when)
        centre = np.array([np.interp(when, told.times, along) for along in told.path.T])
        first = np.array([along[0] for along in told.path.T])
        turn = turned(told.spin, np.clip(when, *told.turning) - told.turning[0])
        if dimension == "axisymmetric":  # the run's box reaches over the axis; what is drawn is mirrored
            first, centre = np.array([0.015, first[1]]), np.array([0.015, centre[1]])
        for line, before in zip(lines, begin, strict=True):
            assert line == pytest.approx((before - first) @ turn.T + centre, abs=1e-12)


def test_a_tool_comes_and_goes_and_a_pushed_one_is_not_known():
    experiment = scene(2, SHAPES["box"][1], {}, **{"from": 0.2, "until": 0.5})
    assert [len(list(outlines.tools(experiment.resolved(), when))) for when in (0.1, 0.2, 0.4, 0.5)] == [0, 1, 1, 0]
    pushed = scene(2, SHAPES["ball"][1], {"force": [0, -1.0], "mass": 0.1})
    assert [known for _, _, known in outlines.tools(pushed.resolved(), 0.5)] == [False]


NOZZLES = {
    2: ({"box": {"lower": [0.06, 0.03], "upper": [0.1, 0.05]}}, {"velocity": [{"table": {"time": [0, 1], "value": [-0.1, 0]}}, 0]},
        [([0.06, 0.03], [0.1, 0.03]), ([0.06, 0.05], [0.1, 0.05])]),
    "axisymmetric": ({"cylinder": {"radius": 0.01, "height": 0.02, "base": [0, 0.08]}}, {"rate": 1e-6}, [([0.01, 0.08], [0.01, 0.1])]),
}  # fmt: skip


@pytest.mark.parametrize("dimension", NOZZLES)
def test_a_nozzle_is_drawn_open_while_it_flows(dimension):
    """The sides along the flow, by its velocity or its weight; not before and not after."""
    from mpm.scene.inflow import column

    shape, flow, sides = NOZZLES[dimension]
    data = scene(dimension, SHAPES["box" if dimension == 2 else "piston"][1], {}).resolved() | {"tools": {}, "gravity": [0, -9.81]}
    data["bodies"]["s"] = {"shape": shape, "material": "m", "inflow": flow | {"from": 0.2, "until": 0.7}}
    experiment = mpm.load(data)
    assert [len(list(outlines.nozzles(experiment.resolved(), when))) for when in (0.1, 0.2, 0.6, 0.7)] == [0, 1, 1, 0]
    ((name, lines, _),) = outlines.nozzles(experiment.resolved(), 0.5)
    assert name == "s" and np.array(lines) == pytest.approx(np.array(sides), abs=1e-15)
    assert lines[0][:, (found := column(experiment, "s")).axis].tolist().count(found.mouth) == 1


@pytest.mark.parametrize(("dimension", "sides"), [(2, 4), ("axisymmetric", 3), (3, 6)])
def test_walls_lie_on_the_sides_and_named_ones_are_told(dimension, sides):
    shape = next(said for at, said in SHAPES.values() if at == dimension)
    found = list(outlines.walls(scene(dimension, shape, {}).resolved()))
    assert len(found) == sides and any(named for _, named in found)
    for line, named in found:
        on = [axis for axis in range(line.shape[1]) if np.ptp(line[:, axis]) == 0 and line[0, axis] in (0.0, 0.1)]
        assert on
        if named:
            assert np.all(line[:, -1] == 0.0)
