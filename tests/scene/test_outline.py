"""Extents are those of the material: of every shape at any offset, deformed too; and the mean temperature is one thing in every solver."""

import numpy as np
import pytest

import mpm
from mpm.observe import Recorder
from mpm.scene.build import build
from mpm.scene.shapes import shape
from mpm.simulation import Clock

MM = 1e-3
SHAPES = {
    "interval": (1, {"box": {"lower": [4 * MM], "upper": [8 * MM]}}),
    "square": (2, {"box": {"lower": [4 * MM] * 2, "upper": [8 * MM] * 2}}),
    "turned": (2, {"box": {"lower": [4 * MM, 5 * MM], "upper": [8 * MM, 7.5 * MM], "angle": 0.4}}),
    "disc": (2, {"ball": {"centre": [6 * MM] * 2, "radius": 4 * MM}}),
    "ring": (2, {"ring": {"centre": [6 * MM] * 2, "inner": 2 * MM, "outer": 4 * MM}}),
    "triangle": (2, {"polygon": {"vertices": [[3 * MM, 3 * MM], [9 * MM, 4 * MM], [5 * MM, 9 * MM]]}}),
    "stub": ("axisymmetric", {"cylinder": {"base": [0, 4 * MM], "radius": 4 * MM, "height": 3 * MM}}),
    "ball on the axis": ("axisymmetric", {"ball": {"centre": [0, 6 * MM], "radius": 4 * MM}}),
    "cube": (3, {"box": {"lower": [4 * MM] * 3, "upper": [8 * MM] * 3}}),
    "ball": (3, {"ball": {"centre": [6 * MM] * 3, "radius": 4 * MM}}),
    "cylinder": (3, {"cylinder": {"base": [6 * MM, 6 * MM, 4 * MM], "radius": 4 * MM, "height": 3 * MM}}),
}
H = 1 * MM
TURN = np.array([[0.6, -0.9, 0.2], [0.8, 0.7, -0.3], [0.1, 0.2, 1.4]])
STRETCH = np.array([[1.3, 0.0], [0.0, 0.8]])  # what an axisymmetric body can do


def scene_of(dimension, body, offset):
    directions = {1: 1, 2: 2, "axisymmetric": 2, 3: 3}[dimension]
    shift = [offset] * directions
    if dimension == "axisymmetric":
        shift[0] = 0.0
    return build(mpm.load({
        "grid": {"dimension": dimension, "size": [13 * MM] * directions, "cell": H},
        "bodies": {"b": {"shape": body, "material": "m"}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}}},
        "time": {"end": 1},
        "method": {"offset": shift},
    })), np.array(shift) * H  # fmt: skip


def recorded(scene):
    """Smallest and largest coordinates as a run records them."""
    series = dict(Recorder(scene).mechanical(scene, Clock(scene)))
    low, high = ([values for name, values in series.items() if name.startswith(f"position_{end}_")] for end in ("min", "max"))
    assert [values for name, values in series.items() if name.startswith("extent_")] == pytest.approx(np.subtract(high, low))
    assert ("radius_max" in series) == ("position_max_r" in series) and series.get("radius_max") == series.get("position_max_r")
    return np.array([low, high])


def dense(body, dimension, shift):
    """Points all over the surface of the shape, without the grid: corners, and circles by the degree."""
    outline = shape(body, dimension).moved(shift)
    (kind, values), turn = next(iter(body.items())), np.radians(np.arange(0, 360, 0.5))
    if kind == "ball" and dimension == 3:
        a, b = (angle.ravel() for angle in np.meshgrid(turn, turn[:361]))
        return np.array(values["centre"]) + shift + values["radius"] * np.stack([np.sin(b) * np.cos(a), np.sin(b) * np.sin(a), np.cos(b)], axis=-1)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    if kind in ("ball", "ring"):
        return np.array(values["centre"]) + shift + values.get("radius", values.get("outer")) * circle
    if kind == "cylinder" and dimension == 3:
        return np.concatenate([np.array(values["base"]) + shift + np.column_stack([values["radius"] * circle, np.full(len(turn), z)])
                               for z in (0.0, values["height"])])  # fmt: skip
    if kind == "polygon" or values.get("angle"):
        return np.array([piece.start for piece in outline.pieces()])
    return np.stack(np.meshgrid(*np.stack(outline.bounds(), axis=1)), axis=-1).reshape(-1, len(outline.bounds()[0]))


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("offset", [0.0, 0.1, 0.25, -0.37, 0.5])
def test_outlines_are_those_of_the_material(name, offset):
    dimension, body = SHAPES[name]
    scene, shift = scene_of(dimension, body, offset)
    points, x = dense(body, dimension, shift), scene.bodies[0].particles.x
    points = points[points[:, 0] >= -1e-12] if dimension == "axisymmetric" else points
    assert recorded(scene) == pytest.approx(np.array([points.min(axis=0), points.max(axis=0)]), abs=1e-4 * H)
    F = STRETCH if dimension == "axisymmetric" else TURN[: x.shape[1], : x.shape[1]]
    x[:] = x @ F.T
    moved = points @ F.T
    assert recorded(scene) == pytest.approx(np.array([moved.min(axis=0), moved.max(axis=0)]), abs=0.02 * H)


def test_nothing_is_claimed_beyond_a_cell_of_a_particle():
    scene, _ = scene_of(*SHAPES["interval"], 0.0)
    x = scene.bodies[0].particles.x
    x[0] -= 100 * H
    (low,), _ = recorded(scene)
    assert x.min() - H * (1 + 1e-9) <= low < x.min()


TWO = {
    "grid": {"dimension": 1, "size": [1], "cell": 0.0625},
    "bodies": {
        "a": {"shape": {"box": {"lower": [0], "upper": [0.5]}}, "temperature": 400, "material": "m"},
        "b": {"shape": {"box": {"lower": [0.5], "upper": [1]}}, "temperature": 300, "material": "n"},
    },
    "materials": {name: {"density": 2, "heat": {"fourier": {"kappa": 0, "alpha": alpha}}} for name, alpha in (("m", 1), ("n", 10))},
    "time": {"end": 0.01},
    "output": {"every": 0.01, "observables": ["temperature.mean"]},
}


@pytest.mark.parametrize("alpha", [10, {"table": {"temperature": [250, 350], "value": [5, 15]}}], ids=["constant", "table"])
def test_the_mean_temperature_is_weighted_with_heat_capacity_in_every_solver(alpha):
    """(400 x 1 + 300 x 10)/11 K, whether the bodies may move or not."""
    data = TWO | {"materials": TWO["materials"] | {"n": {"density": 2, "heat": {"fourier": {"kappa": 0, "alpha": alpha}}}}}
    rigid = mpm.run_point(mpm.load(data))
    assert rigid.series["temperature_mean"] == pytest.approx(3400 / 11, rel=1e-12)
    elastic = {"elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}
    apart = {"contacts": [{"between": ["a", "b"], "conductance": 0}]}
    scene = build(mpm.load(data | apart | {"materials": {name: material | elastic for name, material in data["materials"].items()}}))
    recorder = Recorder(scene)
    recorder.record(scene, Clock(scene))
    assert recorder.series["temperature_mean"][0] == pytest.approx(3400 / 11, rel=1e-12)


def test_outlines_in_the_total_frame():
    body = {"box": {"lower": [4 * MM, 5 * MM], "upper": [8 * MM, 7.5 * MM]}}
    data = {"grid": {"dimension": 2, "size": [13 * MM] * 2, "cell": H}, "bodies": {"b": {"shape": body, "material": "m"}},
            "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}}}, "time": {"end": 1}, "method": {"frame": "total"}}  # fmt: skip
    scene = build(mpm.load(data))
    corners = np.array([[4.0, 5.0], [8.0, 5.0], [8.0, 7.5], [4.0, 7.5]]) * MM
    assert recorded(scene) == pytest.approx(np.array([corners.min(axis=0), corners.max(axis=0)]), abs=1e-6 * H)
    scene.bodies[0].particles.x[:] = scene.bodies[0].particles.x @ TURN[:2, :2].T
    assert recorded(scene) == pytest.approx(np.array([(corners @ TURN[:2, :2].T).min(axis=0), (corners @ TURN[:2, :2].T).max(axis=0)]), abs=1e-6 * H)
