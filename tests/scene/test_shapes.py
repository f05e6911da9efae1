"""Shapes: signed distance, bounds, construction from a config's mapping, sides."""

import numpy as np
import pytest

from mpm.scene import Ball, Box, Cylinder, Polygon, Ring, on_side, shape

MENU = [
    Box((0.1,), (0.7,)),
    Box((0.1, 0.2), (0.7, 0.9)),
    Box((0.1, 0.2), (0.7, 0.9), 0.4),
    Box((0.1, 0.2, 0.3), (0.7, 0.9, 0.8)),
    Ball((0.5,), 0.3),
    Ball((0.5, 0.4), 0.3),
    Ball((0.5, 0.4, 0.6), 0.3),
    Cylinder(0.4, 0.5, (0.0, 0.1)),
    Cylinder(0.4, 0.5, (0.5, 0.5, 0.1)),
    Ring((0.5, 0.5), 0.1, 0.4),
    Polygon(((0.1, 0.1), (0.9, 0.2), (0.5, 0.8))),
]


def grid(dimension):
    """Half steps, so that the axis of (r, z), where the cylinder needs one, is an edge."""
    return [np.linspace(0, 1.5, 7)] * dimension


@pytest.mark.parametrize("body", MENU, ids=repr)
def test_volume_inside_equals_quadrature(body):
    lower, upper = body.bounds()
    d, n = body.dimension, {1: 4000, 2: 400, 3: 80}[body.dimension]
    axes = [lo + (hi - lo) * (np.arange(n) + 0.5) / n for lo, hi in zip(lower, upper, strict=True)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, d)
    counted = body.inside(x).mean() * np.prod(upper - lower)
    exact = body.cut(grid(d))[0].w.sum()
    assert counted == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("body", MENU, ids=repr)
def test_surface_points_are_at_distance_zero_and_normals_point_out(body):
    _, s = body.cut(grid(body.dimension))
    np.testing.assert_allclose(body.distance(s.x), 0, atol=1e-12)
    np.testing.assert_allclose(body.distance(s.x + 1e-6 * s.normal), 1e-6, atol=1e-9)
    np.testing.assert_allclose(body.distance(s.x - 1e-6 * s.normal), -1e-6, atol=1e-9)


@pytest.mark.parametrize("body", MENU, ids=repr)
def test_moved(body):
    shift = np.full(body.dimension, 0.25)
    if isinstance(body, Cylinder) and body.dimension == 2:
        shift[0] = 0  # the axis stays
    x = np.random.default_rng(1).uniform(-1, 2, (50, body.dimension))
    np.testing.assert_allclose(body.moved(shift).distance(x + shift), body.distance(x), atol=1e-14)


def test_from_mapping():
    assert shape({"ball": {"centre": [0.0, 1.0], "radius": 2}}, 2) == Ball((0.0, 1.0), 2.0)
    assert shape({"box": {"lower": [0.0], "upper": [1.0], "angle": 0.0}, "ball": None}, 1) == Box((0.0,), (1.0,))
    assert shape({"cylinder": {"radius": 1, "height": 2, "base": [0, 0]}}, "axisymmetric") == Cylinder(1.0, 2.0, (0.0, 0.0))
    assert shape({"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]]}}, 2) == Polygon(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)))
    with pytest.raises(ValueError, match="a shape is one of box, ball"):
        shape({"blob": {}}, 2)
    with pytest.raises(ValueError, match="2 coordinates"):
        shape({"ball": {"centre": [0.0, 1.0], "radius": 2}}, 3)


def test_sides():
    normal = np.array([[-1.0, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])
    for k, side in enumerate(["left", "right", "front", "back", "bottom", "top"]):
        assert list(np.flatnonzero(on_side(normal, side))) == [k]
    assert list(np.flatnonzero(on_side(normal, "lateral"))) == [0, 1, 2, 3]
    assert on_side(normal, "all").all()
    assert list(on_side(np.array([[0.6, 0.8], [0.8, 0.6]]), "top")) == [True, False]
