"""Cut quadrature and cut cells against areas in closed form, and against the divergence theorem."""

import numpy as np
import pytest

from mpm.scene import Ball, Box, Cylinder, Polygon, Ring, cells, cut_quadrature

STAR = ((-1.0, -1.0), (1.1, -0.8), (0.2, 0.1), (0.9, 1.2), (-1.2, 1.0))
PLANE = {
    "disc": (Ball((0.03, 0.07), 1.0), np.pi, 2 * np.pi),
    "ring": (Ring((0.03, 0.07), 0.4, 1.0), np.pi * 0.84, 2 * np.pi * 1.4),
    "box": (Box((-0.5, -0.7), (0.8, 0.9)), 1.3 * 1.6, 5.8),
    "turned box": (Box((-0.5, -0.7), (0.8, 0.9), 0.3), 1.3 * 1.6, 5.8),
    "polygon": (Polygon(STAR), 3.43, sum(np.hypot(*np.subtract(STAR[k], STAR[k - 1])) for k in range(5))),
    "polygon the other way": (Polygon(STAR[::-1]), 3.43, sum(np.hypot(*np.subtract(STAR[k], STAR[k - 1])) for k in range(5))),
}
SOLID = {
    "ball": (Ball((0.03, 0.07, 0.11), 1.0), 4 / 3 * np.pi, 4 * np.pi, 2e-6),
    "cylinder": (Cylinder(0.9, 1.1, (0.02, 0.01, -0.5)), np.pi * 0.81 * 1.1, 2 * np.pi * 0.9 * 2.0, 1e-12),
    "block": (Box((-0.5, -0.7, -0.3), (0.8, 0.9, 1.0), 0.2), 1.3 * 1.6 * 1.3, 2 * (1.3 * 1.6 + 1.3 * 1.3 + 1.6 * 1.3), 1e-12),
}


def grid(dimension, n, shift=0.013):
    return [np.linspace(-1.5, 1.5, n + 1) + shift * k for k in range(dimension)]


@pytest.mark.parametrize("name", PLANE)
@pytest.mark.parametrize("n", [3, 7, 16])
def test_plane_shapes_are_exact(name, n):
    shape, area, rim = PLANE[name]
    q, s = cut_quadrature(shape, grid(2, n), 4)
    assert q.w.sum() == pytest.approx(area, rel=1e-10)
    assert s.w.sum() == pytest.approx(rim, rel=1e-13)
    np.testing.assert_allclose(np.linalg.norm(s.normal, axis=1), 1, rtol=1e-13)
    for a, b in [(0, 0), (4, 4), (2, 3), (0, 4)]:  # div (x^(a+1) y^b, 0) = (a+1) x^a y^b
        inside = (a + 1) * (q.w * q.x[:, 0] ** a * q.x[:, 1] ** b).sum()
        assert inside == pytest.approx((s.w * s.normal[:, 0] * s.x[:, 0] ** (a + 1) * s.x[:, 1] ** b).sum(), abs=1e-9)


@pytest.mark.parametrize("name", SOLID)
def test_solids_are_exact(name):
    shape, volume, area, tolerance = SOLID[name]
    q, s = cut_quadrature(shape, grid(3, 7), 4)
    assert q.w.sum() == pytest.approx(volume, rel=tolerance)
    assert s.w.sum() == pytest.approx(area, rel=tolerance)
    for k in range(3):
        assert (s.w * s.normal[:, k] * s.x[:, k]).sum() == pytest.approx(volume, rel=tolerance)


def test_points_lie_in_their_cells():
    shape, edges = Ball((0.03, 0.07), 1.0), grid(2, 7)
    q, s = cut_quadrature(shape, edges, 4)
    for points in (q, s):
        i = np.unravel_index(points.cell, (7, 7))
        for k in range(2):
            assert np.all(points.x[:, k] >= edges[k][i[k]] - 1e-12)
            assert np.all(points.x[:, k] <= edges[k][i[k] + 1] + 1e-12)


@pytest.mark.parametrize("shift", [0.0, 1e-14, 1e-9, 0.3])
def test_a_box_along_grid_lines_is_seen_once(shift):
    edges = [np.arange(-0.2, 1.3, 0.1)] * 2
    q, s = cut_quadrature(Box((0.0 + shift, 0.1), (0.8 + shift, 0.7)), edges, 4)
    assert q.w.sum() == pytest.approx(0.48, rel=1e-9)
    assert s.w.sum() == pytest.approx(2.8, rel=1e-12)
    assert np.all(q.w > 0) or shift == 1e-9  # there a sliver of a cell may have weights of both signs


def test_interval():
    q, s = cut_quadrature(Box((0.13,), (0.87,)), [np.linspace(0, 1, 9)], 4)
    assert q.w.sum() == pytest.approx(0.74, rel=1e-15)
    assert (q.w * q.x[:, 0] ** 5).sum() == pytest.approx((0.87**6 - 0.13**6) / 6, rel=1e-13)
    np.testing.assert_array_equal(s.x[:, 0], [0.13, 0.87])
    np.testing.assert_array_equal(s.normal[:, 0], [-1, 1])
    assert list(s.cell) == [1, 6]


@pytest.mark.parametrize("name", [*PLANE, *SOLID])
def test_particles_keep_volume_surface_and_first_moments(name):
    shape, volume, area = (PLANE | SOLID)[name][:3]
    edges = grid(shape.dimension, 11)
    c = cells(shape, edges)
    assert c.volume.sum() == pytest.approx(volume, rel=3e-6)
    assert c.area.sum() == pytest.approx(area, rel=3e-6)
    q, _ = cut_quadrature(shape, edges, 4)
    np.testing.assert_allclose(c.volume @ c.centroid, q.w @ q.x, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(c.normal, axis=1), 1, rtol=1e-12)
    assert np.all(c.volume > 0.0099 * np.prod([np.diff(e)[0] for e in edges]))
    assert np.all(c.owner < len(c.volume))


@pytest.mark.parametrize("radial", [False, True])
@pytest.mark.parametrize("name", [*PLANE, *SOLID])
def test_sums_are_those_of_the_quadrature(name, radial):
    body = (PLANE | SOLID)[name][0]
    if radial and body.dimension == 3:
        pytest.skip("per radian in the plane only")
    edges = grid(body.dimension, 9)
    held, (volume, surface) = body.contents(edges, radial), cut_quadrature(body, edges, 2)
    w, s = (q.w * q.x[:, 0] if radial else q.w for q in (volume, surface))
    expected = np.zeros((9**body.dimension, 2 + body.dimension))
    np.add.at(expected, volume.cell, np.column_stack([volume.w, w, w[:, None] * volume.x]))
    found = np.zeros_like(expected)
    found[held.cell] = np.column_stack([held.size, held.volume, held.moment])
    np.testing.assert_allclose(found, expected, atol=1e-14)
    expected, found = np.zeros((2, 9**body.dimension, 1 + 2 * body.dimension))
    np.add.at(expected, surface.cell, np.column_stack([s, s[:, None] * surface.x, s[:, None] * surface.normal]))
    np.add.at(found, held.home, np.column_stack([held.area, held.point, held.normal]))
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_a_corner_keeps_its_two_sides_apart():
    c = cells(Box((0.1, 0.1), (0.9, 0.9)), [np.linspace(0, 1, 5)] * 2)
    corner = np.flatnonzero(c.cell == 0)[0]
    pieces = np.flatnonzero(c.owner == corner)
    assert sorted(map(tuple, np.round(c.normal[pieces], 12))) == [(-1, 0), (0, -1)]
    np.testing.assert_allclose(c.area[pieces], 0.15)


def test_slivers_give_their_surface_to_a_neighbour():
    c = cells(Box((0.0, 0.0), (1.001, 1.0)), [np.arange(0, 1.5, 0.25)] * 2)
    assert len(c.volume) == 16
    assert c.volume.sum() == pytest.approx(1.001, rel=1e-14)
    assert c.area.sum() == pytest.approx(4.002, rel=1e-14)


def test_radial_weights():
    edges = [np.linspace(0, 1.2, 13), np.linspace(-1.2, 1.2, 25)]
    sphere = cells(Ball((0.0, 0.0), 1.0), edges, radial=True)
    assert sphere.volume.sum() == pytest.approx(2 / 3, rel=1e-10)  # per radian
    assert sphere.area.sum() == pytest.approx(2, rel=1e-10)
    loaf = cells(Cylinder(0.036, 0.035, (0.0, 0.004)), [np.arange(45) * 1e-3] * 2, radial=True)
    assert len(loaf.volume) == 36 * 35
    assert loaf.volume.sum() == pytest.approx(0.036**2 * 0.035 / 2, rel=1e-14)
    assert loaf.area.sum() == pytest.approx(0.036 * 0.035 + 0.036**2, rel=1e-14)  # none on the axis
