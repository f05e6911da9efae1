"""Checks across sections, those that the broken configs do not show; and that right scenes pass."""

import numpy as np
import pytest

from mpm.config import ConfigError, load
from mpm.config.shapes_fit import holds

SHAPES = [
    (1, {"box": {"lower": [0], "upper": [1]}}),
    (1, {"ball": {"centre": [0.5], "radius": 0.5}}),
    (2, {"box": {"lower": [0.4, 0.4], "upper": [0.6, 0.6], "angle": "45 deg"}}),
    (2, {"ball": {"centre": [0.5, 0.5], "radius": 0.5}}),
    (2, {"ring": {"centre": [0.5, 0.5], "inner": 0.2, "outer": 0.4}}),
    (2, {"polygon": {"vertices": [[0, 0], [1, 0], [0.5, 1]]}}),
    ("axisymmetric", {"cylinder": {"radius": 1, "height": 1, "base": [0, 0]}}),
    ("axisymmetric", {"ball": {"centre": [0, 0.5], "radius": 0.5}}),
    ("axisymmetric", {"box": {"lower": [0.5, 0], "upper": [1, 1]}}),
    (3, {"cylinder": {"radius": 0.5, "height": 1, "base": [0.5, 0.5, 0]}}),
    (3, {"ball": {"centre": [0.5, 0.5, 0.5], "radius": 0.5}}),
    (3, {"box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}),
]
WRONG = [
    (2, {"box": {"lower": [0, 0], "upper": [1, 1], "angle": 0.1}}, "leaves the domain"),
    (3, {"box": {"lower": [0, 0, 0], "upper": [1, 1, 1], "angle": 0.1}}, "cannot be turned in dimension 3"),
    (3, {"ring": {"centre": [0.5, 0.5, 0.5], "inner": 0.2, "outer": 0.4}}, "there is no ring in dimension 3"),
    (2, {"ring": {"centre": [0.5, 0.5], "inner": 0.4, "outer": 0.4}}, "outer radius must exceed"),
    (2, {"box": {"lower": [0, 0.5], "upper": [1, 0.5]}}, "upper corner must lie above"),
    ("axisymmetric", {"cylinder": {"radius": 1, "height": 1, "base": [0.1, 0]}}, "lies on the axis"),
    (2, {"polygon": {"vertices": [[0, 0], [1, 0]]}}, "at least 3 entries"),
    (2, {"polygon": {"vertices": [[0, 0], [1, 0], [1, 1, 1]]}}, "a point needs 2 numbers"),
    (3, {"cylinder": {"radius": 0.5, "height": 1, "base": [0.4, 0.5, 0]}}, "leaves the domain"),
]


def scene(dimension, shape):
    directions = {1: 1, 2: 2, "axisymmetric": 2, 3: 3}[dimension]
    return {
        "grid": {"dimension": dimension, "size": [1] * directions, "cell": 0.1},
        "bodies": {"a": {"shape": shape, "material": "m"}},
        "materials": {"m": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
        "time": {"end": 1},
    }


@pytest.mark.parametrize(("dimension", "shape"), SHAPES)
def test_shapes_that_fit(dimension, shape):
    assert load(scene(dimension, shape)).bodies["a"].shape.kind in shape


@pytest.mark.parametrize(("dimension", "shape", "message"), WRONG)
def test_shapes_that_do_not(dimension, shape, message):
    with pytest.raises(ConfigError, match=message):
        load(scene(dimension, shape))


@pytest.mark.parametrize(
    ("change", "path", "message"),
    [
        ({"bodies.block.angular_velocity": [1, 2, 3]}, "bodies.block.angular_velocity", "needs one number in dimension 2"),
        ({"grid.dimension": 3}, "grid.size", "the size needs 3 numbers"),
        ({"method.offset": [0.1]}, "method.offset", "the offset needs 2 numbers"),
        ({"output.snapshots": {"every": 1e-9}}, "output.snapshots.every", "there would be 1e+08 snapshots"),
        ({"output.observables": ["momentum.z"]}, "output.observables.0", "there is no such direction in dimension 2"),
        (
            {"surfaces": [{"of": "block", "side": "lateral", "convection": {"beta": 1, "outside": 300}}]},
            "surfaces.0.side",
            "there is no such side in dimension 2",
        ),
        ({"surfaces": [{"of": "block", "name": "a b", "convection": {"beta": 1, "outside": 300}}]}, "surfaces.0.name", "not a plain name"),
        ({"walls": {"outer": "slip"}}, "walls.outer", "there is no such wall in dimension 2"),
    ],
)
def test_findings(block, change, path, message):
    with pytest.raises(ConfigError) as caught:
        load(block, change)
    found = {one.path: one.message for one in caught.value.problems}
    assert message in found[path]


def test_two_surfaces_of_one_name(block):
    block["surfaces"] = [{"of": "block", "name": "skin", "convection": {"beta": 1, "outside": 300}}] * 2
    with pytest.raises(ConfigError, match=r"surfaces.1.name: two surfaces have the same name"):
        load(block)


def test_nothing_to_compute(loaf):
    del loaf["materials"]["dough"]["heat"], loaf["surfaces"]
    loaf["output"] = {}
    with pytest.raises(ConfigError, match="nothing to compute"):
        load(loaf)


def test_angular_velocity_and_velocity(block):
    body = load(block, {"bodies.block.angular_velocity": "10 rpm", "bodies.block.velocity": ["1 cm/s", 0]}).bodies["block"]
    assert body.angular_velocity == pytest.approx(1.0471975511966) and body.velocity == (0.01, 0.0)


def test_exact_needs_a_body_when_there_are_several(loaf):
    loaf["bodies"]["crumb"] = loaf["bodies"]["loaf"]
    loaf["exact"] = "robin_cylinder"
    with pytest.raises(ConfigError, match="several bodies; say which one"):
        load(loaf)
    loaf["exact"] = {"robin_cylinder": {"body": "crumb"}}
    assert load(loaf).exact.body == "crumb"


@pytest.mark.parametrize(("dimension", "shape"), SHAPES)
def test_a_body_holds_the_points_of_its_shape(dimension, shape):
    """Against the signed distance that cuts bodies, on the surface too."""
    from mpm.scene.shapes import shape as outlined

    experiment = load(scene(dimension, shape))
    outline, slack = outlined(experiment.bodies["a"].shape, dimension), 1e-9
    points = np.random.default_rng(0).uniform(-0.1, 1.1, (2000, len(outline.bounds()[0])))
    points = points[np.abs(outline.distance(points)) > 1e-6]
    held = [holds(experiment.bodies["a"].shape, tuple(x), slack) for x in points.tolist()]
    assert held == (outline.distance(points) < 0).tolist() and 0 < sum(held) < len(held)


def test_a_probe_in_no_body_is_refused_with_a_place_at_every_point_of_a_sweep():
    from mpm.sweep.cases import plan

    data = scene(2, {"ring": {"centre": [0.5, 0.5], "inner": 0.2, "outer": 0.4}}) | {"output": {"probes": {"rim": [0.9, 0.5], "hole": [0.5, 0.5]}}}
    with pytest.raises(ConfigError, match=r"output.probes.hole: the probe lies in no body.*a point of a \(0.1 to 0.9 x 0.1 to 0.9 m\)"):
        load(data)
    del data["output"]["probes"]["hole"]
    assert load(data).output.probes["rim"] == (0.9, 0.5)
    with pytest.raises(ConfigError, match=r"output.probes.rim: the probe lies in no body"):
        plan(load(data | {"sweep": {"axes": {"bodies.a.shape.ring.outer": [0.4, 0.35]}}}))
