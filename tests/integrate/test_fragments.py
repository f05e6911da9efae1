"""Pieces of a body: as many as chains of neighbours leave; a body that turns is whole, and a gap of one cell is always seen."""

import time

import numpy as np
import pytest

from mpm.integrate.fragments import STRETCH, pieces, torn
from mpm.scene import Ball, Box, Cylinder, Polygon, Ring
from mpm.scene.shapes import cells

H = 1.0
SHAPES = [
    Box((0.1, 0.3), (6.0, 4.2), 0.3), Ball((0.2, 0.1), 3.1), Ring((0.0, 0.0), 1.2, 3.4), Polygon(((0.0, 0.0), (6.0, 0.4), (2.0, 5.0))),
    Polygon(((0.0, 0.0), (6.0, 0.0), (6.0, 1.3), (1.2, 1.3), (1.2, 5.0), (0.0, 5.0))), Box((0.0, 0.0, 0.0), (5.0, 2.2, 3.1)), Ball((0.1, 0.2, 0.3), 2.7),
    Cylinder(1.6, 4.0, (0.0, 0.0, 0.1)),
]  # fmt: skip


def sampled(shape, particles):
    """Particles of a shape as a body has them (N, D)."""
    edge = H / particles
    edges = [np.arange(np.floor(low / edge), np.ceil(high / edge) + 1) * edge for low, high in zip(*shape.bounds(), strict=True)]
    return cells(shape, edges, radial=False).centroid


def turned(rng, x):
    """Turned at random, strained by a thousandth, moved somewhere."""
    D = x.shape[1]
    turn = np.linalg.qr(rng.normal(size=(D, D)))[0]
    return x @ (turn + 1e-3 * rng.uniform(-1, 1, (D, D))) + rng.uniform(-9, 9, D)


def test_as_many_as_a_graph_has():
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(0)
    for _ in range(60):
        D = int(rng.integers(1, 4))
        x = rng.random((int(rng.integers(1, 300)), D)) * rng.uniform(2, 30) - 3
        tree = cKDTree(x)
        assert pieces(x, H) == connected_components(tree.sparse_distance_matrix(tree, H), directed=False)[0]


@pytest.mark.parametrize("particles", [1, 2, 3])
@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: f"{type(shape).__name__}{len(shape.bounds()[0])}")
def test_a_body_that_turns_is_whole_and_a_gap_is_seen(shape, particles):
    """Over a thousand turns, offsets and shapes in all: never told of a whole body; always where one half stands a cell away from the other."""
    rng, x = np.random.default_rng(particles), sampled(shape, particles)
    one, two = torn(x, H, STRETCH)
    for _ in range(60):
        now = turned(rng, x)
        assert torn(now, H)[0] <= one and torn(now, H)[1] <= two
        way = rng.normal(size=x.shape[1])
        way /= np.linalg.norm(way)
        half = (now - now.mean(axis=0)) @ way > 0
        ends = (now @ way)[~half].max(), (now @ way)[half].min()
        opened = now + np.where(half[:, None], way * (1.06 * H - (ends[1] - ends[0])), 0.0)
        assert torn(opened, H)[0] > one
        assert torn(opened + np.where(half[:, None], way * H, 0.0), H)[1] > two


def test_what_was_apart_at_the_start_is_not_told_of():
    """Two blocks of one body, and a lattice of one particle a cell strained by a hundredth."""
    x = np.stack(np.meshgrid(np.arange(8) * 0.5, np.arange(4) * 0.5), axis=-1).reshape(-1, 2)
    two = np.concatenate([x, x + np.array([9.0, 0.0])])
    assert torn(two, H, STRETCH) == torn(turned(np.random.default_rng(1), two), H) == (2, 2)
    assert torn(2 * x, H, STRETCH)[0] == torn(2.02 * x, H)[0] == 1 < torn(2.2 * x, H)[0]


@pytest.mark.slow
@pytest.mark.parametrize(("D", "side"), [(2, 300), (3, 50)])
def test_cost(D, side):
    x = np.stack(np.meshgrid(*[np.arange(side) * 0.5] * D), axis=-1).reshape(-1, D)
    x, seconds = turned(np.random.default_rng(0), x), []
    for _ in range(5):
        began = time.process_time()
        torn(x, H)
        seconds.append(time.process_time() - began)
    print(f"{D}-D: {1e6 * min(seconds) / len(x):.3f} us a particle")
