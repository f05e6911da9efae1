"""Blocks of nodes that hold material: what is marked, and that nothing else matters."""

import numpy as np
import pytest

from mpm.boundary import directions, extents
from mpm.boundary.blocks import BLOCK, new_blocks, thin
from mpm.boundary.walls import empty
from mpm.integrate.active_nodes import SLACK
from mpm.state import Line, Plane, Volume

SPACES = {1: Line(0.1, 3000), 2: Plane(0.1, 90, 101), 3: Volume(0.1, 41, 38, 43)}


def nodes_of(space, x, slack=0.0):
    """Numbers of the nodes within the quadratic stencils of x (N, D), all of them (N, 3^D) or more with some slack."""
    D, shape = directions(space), extents(space)
    found = np.zeros((len(x), 1), np.int64)
    for a in range(D):
        first = np.floor(x[:, a] / space.h + 0.5 + slack).astype(int) + 1  # PAD - 1
        found = found[:, :, None] * shape[a] + (first[:, None] + np.arange(3))[:, None, :]
        found = found.reshape(len(x), -1)
    return found


@pytest.mark.parametrize("D", SPACES)
def test_what_particles_touch_is_marked(D, marked):
    """A strip along the diagonal, its particles in order and in no order; the end of a row falls within chunks."""
    space, rng = SPACES[D], np.random.default_rng(D)
    length = (min(extents(space)[:D]) - 8) * space.h
    x = np.sort(rng.uniform(0.2, length, 700))[:, None] + rng.uniform(0.0, 0.3, (700, D))
    for order in (np.arange(700), rng.permutation(700)):
        box, blocks = np.zeros((3, 2), np.int64), new_blocks(np.prod(extents(space)))[0]
        empty(extents(space), box)
        marked(space, x[order], box, blocks)
        needed = np.unique(nodes_of(space, x) // BLOCK)
        assert blocks[needed].all() and set(blocks) == {0, 1}
        assert thin(extents(space), box, blocks) == (D > 1)
        if D > 1 and order[0] != 0:  # particle by particle: no more than they may touch
            most = np.union1d(nodes_of(space, x, SLACK) // BLOCK, nodes_of(space, x, -SLACK) // BLOCK)
            ends = np.union1d(needed, most)
            assert blocks.sum() <= len(ends) < 0.5 * len(blocks)
