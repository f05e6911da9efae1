"""What cells hold of a shape: against clipped polygons, balls sliced the other way; who takes slivers; memory of a large ball."""

import json
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from mpm.scene import Ball, Box, Polygon, cells
from mpm.scene.contents import nearest

CELL = 0.125
STAR = ((-1.0, -1.0), (1.1, -0.8), (0.2, 0.1), (0.9, 1.2), (-1.2, 1.0))
OFFSETS = [(0.0, 0.0, 0.0), (0.0625, 0.0, 0.03), (0.013, 0.027, 0.041), (1e-9, 1e-3, 0.0625), (-0.05, 0.11, 0.07)]


def lattice(body, edge=CELL):
    """Edges of the cells that hold a body."""
    return [np.arange(np.floor(low / edge), np.ceil(high / edge) + 1) * edge for low, high in zip(*body.bounds(), strict=True)]


def clipped(vertices, lower, upper):
    """Area and first moments of a polygon in a rectangle: cut by one side after another (Sutherland and Hodgman 1974), then summed over triangles."""
    for axis in range(2):
        for sign, bound in ((1, lower[axis]), (-1, upper[axis])):
            kept = []
            for p, q in zip(vertices, [*vertices[1:], *vertices[:1]], strict=True):
                a, b = sign * (p[axis] - bound), sign * (q[axis] - bound)
                kept += [p] if a >= 0 else []
                kept += [p + a / (a - b) * (q - p)] if a * b < 0 else []
            vertices = kept
    if len(vertices) < 3:
        return np.zeros(3)
    p, q = np.array(vertices), np.roll(vertices, -1, axis=0)
    area = (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]) / 2
    return np.abs(area.sum()), *(np.sign(area.sum()) * ((p + q) / 3 * area[:, None]).sum(0))


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("body", [Polygon(STAR), Box((-0.5, -0.7), (0.8, 0.9), 0.3), Box((-0.5, -0.7), (0.8, 0.9), np.pi / 4)], ids=repr)
def test_cells_of_polygons_hold_what_clipping_leaves(body, offset):
    body = body.moved(offset[:2])
    edges, vertices = lattice(body), [np.array(piece.start) for piece in body.pieces()]
    held = body.contents(edges)
    i, j = np.unravel_index(np.arange((len(edges[0]) - 1) * (len(edges[1]) - 1)), [len(e) - 1 for e in edges])
    expected = np.array([clipped(vertices, (edges[0][a], edges[1][b]), (edges[0][a + 1], edges[1][b + 1])) for a, b in zip(i, j, strict=True)])
    found = np.zeros_like(expected)
    found[held.cell] = np.column_stack([held.volume, held.moment])
    np.testing.assert_allclose(found, expected, atol=2e-15 * max(1.0, len(vertices)))


@pytest.mark.parametrize("offset", OFFSETS)
def test_a_prism_holds_its_base_times_its_height(offset):
    box = Box((-0.5, -0.7, -0.3), (0.8, 0.9, 1.0), 0.3).moved(offset)
    edges = lattice(box)
    held, (base, low, high) = box.contents(edges), box.prism()
    flat = base.contents(edges[:2])
    layers = np.clip(high - edges[2][:-1], 0, CELL) - np.clip(low - edges[2][:-1], 0, CELL)
    full = np.flatnonzero(layers > 1e-12)
    np.testing.assert_allclose(held.volume, np.outer(flat.volume, layers[full]).ravel(), atol=1e-16)
    assert held.volume.sum() == pytest.approx(1.3 * 1.6 * 1.3, rel=1e-13)
    np.testing.assert_allclose(held.moment.sum(0) / held.volume.sum(), np.add((0.15, 0.1, 0.35), offset), atol=1e-13)
    assert held.area.sum() == pytest.approx(2 * (1.3 * 1.6 + 1.3 * 1.3 + 1.6 * 1.3), rel=1e-13)
    np.testing.assert_allclose(held.normal.sum(0), 0, atol=1e-13)
    assert (held.normal * held.point / held.area[:, None]).sum() == pytest.approx(3 * 1.3 * 1.6 * 1.3, rel=1e-13)  # flat pieces: n . x of the centroid


@pytest.mark.parametrize("offset", OFFSETS)
def test_a_ball_is_whole_at_any_offset(offset):
    ball = Ball(offset, 0.61)
    held = ball.contents(lattice(ball))
    volume = 4 / 3 * np.pi * 0.61**3
    assert held.volume.sum() == pytest.approx(volume, rel=2e-8)
    assert held.area.sum() == pytest.approx(4 * np.pi * 0.61**2, rel=5e-8)
    np.testing.assert_allclose(held.moment.sum(0) / volume, offset, atol=2e-8)
    assert ((held.point - held.area[:, None] * offset) * held.normal).sum() > 0 and held.volume.min() > 0


def quarter(a, b, r):
    """Area of 0 < y < a, 0 < z < b, y^2 + z^2 < r^2, odd in a and in b."""
    sign, a, b = np.sign(a) * np.sign(b), np.minimum(np.abs(a), r), np.minimum(np.abs(b), r)
    y = np.sqrt(r**2 - b**2)  # where the circle has the height b

    def under(y):
        return (y * np.sqrt(r**2 - y**2) + r**2 * np.arcsin(y / r)) / 2

    return sign * np.where(a <= y, a * b, b * y + under(a) - under(np.minimum(y, a)))


@pytest.mark.parametrize("offset", OFFSETS)
def test_cells_of_a_ball_hold_what_an_integral_over_slices_says(offset):
    """Slices across x, areas in closed form; the quadrature goes along z."""
    ball = Ball(offset, 0.61)
    X, Y, Z = edges = lattice(ball)
    held = ball.contents(edges)
    found = np.zeros([len(e) - 1 for e in edges])
    found.ravel()[held.cell] = held.volume
    g, w = np.polynomial.legendre.leggauss(8)
    for i, (low, high) in enumerate(pairwise(X)):
        ends = np.linspace(low, high, 301)
        x = ((ends[1:] + ends[:-1])[:, None] + np.diff(ends)[:, None] * g).ravel() / 2 - offset[0]
        x, dx = x[np.abs(x) < 0.61], np.tile(w, 300)[np.abs(x) < 0.61] * (high - low) / 600
        areas = quarter((Y - offset[1])[:, None, None], (Z - offset[2])[:, None], np.sqrt(0.61**2 - x**2)) @ dx
        np.testing.assert_allclose(found[i], np.diff(np.diff(areas, axis=0), axis=1), atol=2e-5 * CELL**3)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("body", [Ball((0.0, 0.0, 0.0), 0.61), Box((-0.4, -0.5, -0.45), (0.4, 0.5, 0.45), 0.3)], ids=["ball", "turned box"])
def test_one_point_a_particle_is_of_order_two(body, offset):
    """Second moments by centroids alone miss h^2/12 of each direction, whatever the offset."""
    if isinstance(body, Ball):
        exact = 0.6 * body.radius**2 * 4 / 3 * np.pi * body.radius**3
    else:
        exact = np.prod(2 * np.array(body.upper)) * (np.array(body.upper) ** 2).sum() / 3
    found = [cells(body.moved(offset), lattice(body.moved(offset), edge)) for edge in (CELL, CELL / 2, CELL / 4)]
    errors = [exact - (c.volume * ((c.centroid - offset) ** 2).sum(1)).sum() for c in found]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders, 2, atol=0.35)
    full = (CELL / 4) ** 2 / 4 * found[-1].volume.sum()
    assert 0.7 * full < errors[-1] < 1.02 * full


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("share", [0.5, 0.01])
def test_slivers_go_to_the_nearest_cell(d, share):
    rng = np.random.default_rng(d)
    edges = [np.sort(rng.uniform(size=15)) for _ in range(d)]
    shape, middle = [14] * d, np.stack(np.meshgrid(*[(e[1:] + e[:-1]) / 2 for e in edges], indexing="ij"), axis=-1).reshape(-1, d)
    some = rng.uniform(size=14**d) < share
    some[rng.integers(14**d)] = True
    known, asked = np.flatnonzero(some), np.flatnonzero(~some)
    found = nearest(np.array(np.unravel_index(asked, shape)), middle[asked], known, edges)
    away = ((middle[asked, None] - middle[known]) ** 2).sum(-1)
    np.testing.assert_array_equal(away[np.arange(len(asked)), found], away.min(axis=1))


def test_the_nearest_centroid_is_found():
    rng = np.random.default_rng(7)
    edges = [np.linspace(0, 1, 13)] * 3
    known = np.flatnonzero(rng.uniform(size=12**3) < 0.3)
    low = np.stack([edges[0][i] for i in np.unravel_index(known, [12] * 3)], axis=-1)
    places, x = low + rng.uniform(size=low.shape) / 12, rng.uniform(size=(500, 3))
    found = nearest(np.minimum(np.floor(x * 12).astype(int), 11).T, x, known, edges, places)
    np.testing.assert_array_equal(found, np.argmin(((x[:, None] - places) ** 2).sum(-1), axis=1))


def test_of_equally_near_cells_the_first_takes_a_sliver():
    edges = [np.arange(6.0)] * 2
    known = np.array([7, 11, 13, 17])  # the four neighbours of cell 12
    assert nearest(np.array([[2], [2]]), np.array([[2.5, 2.5]]), known, edges).tolist() == [0]


def test_few_cells_are_asked_whether_they_lie_inside(monkeypatch):
    """As many as the boundary crosses, about; not all."""
    asked = []
    distance = Polygon.distance
    monkeypatch.setattr(Polygon, "distance", lambda self, x: asked.append(len(x)) or distance(self, x))
    c = cells(Polygon(((0.1, 0.1), (0.9, 0.15), (0.55, 0.45), (0.8, 0.9), (0.12, 0.85))), [np.linspace(0, 1, 301)] * 2)
    assert len(c.volume) > 30_000 and sum(asked) < 4_000


ALONE = """
import json, sys
import numpy as np
from mpm.scene import cells, shape
peak = lambda: next(int(line.split()[1]) * 1024 for line in open("/proc/self/status") if line.startswith("VmHWM"))
given, count = json.loads(sys.argv[1])
before = peak()
made = cells(shape(given, 3), [np.arange(count + 1) / count] * 3)
print(json.dumps([len(made.volume), made.volume.sum(), peak() - before, "numba" in sys.modules]))
"""


def alone(given, count):
    """Particles, volume and bytes that a process of its own takes to make them; whether it loaded a compiler."""
    done = subprocess.run([sys.executable, "-c", ALONE, json.dumps([given, count])], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def test_nothing_is_compiled():
    assert not alone({"ball": {"centre": [0.5, 0.5, 0.5], "radius": 0.4}}, 8)[3]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("given", "volume"),
    [
        ({"ball": {"centre": [0.5, 0.5, 0.5], "radius": 0.45}}, 4 / 3 * np.pi * 0.45**3),
        ({"box": {"lower": [0.2, 0.2, 0.1], "upper": [0.8, 0.8, 0.9], "angle": 0.3}}, 0.36 * 0.8),
        ({"cylinder": {"radius": 0.45, "height": 0.8, "base": [0.5, 0.5, 0.1]}}, np.pi * 0.45**2 * 0.8),
    ],
)
def test_a_million_particles_take_no_more_than_their_state(given, volume):
    """Above what the process has: the state of a particle in three dimensions is 24 numbers."""
    particles, found, taken, _ = alone(given, 134)
    print(f"{next(iter(given))} of {particles} particles: {taken / particles:.0f} bytes each")
    assert particles > 6e5 and found == pytest.approx(volume, rel=1e-9) and taken < particles * 24 * 8 * 1.5
