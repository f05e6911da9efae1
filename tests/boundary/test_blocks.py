"""Blocks of nodes that hold material: what is marked, and that nothing else matters."""

import numpy as np
import pytest

from mpm.boundary import directions, extents
from mpm.boundary.blocks import BLOCK, new_blocks, thin
from mpm.boundary.walls import empty
from mpm.integrate.active_nodes import SLACK, reaches, touch
from mpm.simulation import Clock, advance_block, work_arrays
from mpm.state import Line, Plane, Volume
from mpm.transfer import CHUNK

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


def marked(space, x, box, blocks):
    """Mark as a scatter of x does: boxes of chunks, then `touch`."""
    reach = reaches(space, len(x))
    for k in range(len(reach)):
        for a in range(directions(space)):
            first = np.floor(x[k * CHUNK : (k + 1) * CHUNK, a] / space.h + 0.5).astype(int) + 1
            reach[k, a] = first.min(), first.max() + 3
    touch(space, x, 0, len(x), reach, box, blocks, True)


@pytest.mark.parametrize("D", SPACES)
def test_what_particles_touch_is_marked(D):
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


SHARP = pytest.param(1, {"xpic": {"order": 3}}, marks=pytest.mark.slow)


@pytest.mark.parametrize(("D", "transfer"), [SHARP, (1, {"flip": {}}), (2, {"apic": {}})], ids=["xpic", "flip", "apic"])
def test_a_body_far_off_changes_no_bit(core, D, transfer):
    """A body thrown at the walls of a corner, another beside it or at the far end of the domain; nodes and marks are as clean after as before."""
    from mpm.scene.build import build

    size = 24.0 if D == 1 else 8.0
    found = {}
    for name, lower in (("near", [2.75] + [0.0] * (D - 1)), ("far", [size - 0.75] * D)):
        bodies = {
            "thrown": {"shape": {"box": {"lower": [0.0] * D, "upper": [0.75] * D}}, "velocity": [-0.3] * D, "material": "solid"},
            "other": {"shape": {"box": {"lower": lower, "upper": [a + 0.75 for a in lower]}}, "velocity": [0.1] * D, "material": "solid"},
        }
        material = {"density": 2.0, "elastic": {"neo_hookean": {"E": 5.0, "nu": 0.3}}}
        changes = {"method.transfer": transfer, "gravity": [-0.5] * D, "time.end": 0.1}  # within which they cannot meet: no contact is compiled
        grid = {"dimension": D, "size": [size] * D, "cell": 0.25}
        made = build(core.experiment(D, changes, bodies=bodies, materials={"solid": material}, surfaces=[], grid=grid))
        assert (made.meeting.stops < 0).all() and (made.meeting.pairs < 0).all()
        work = work_arrays(made)
        box, blocks = np.zeros((3, 2), np.int64), new_blocks(np.prod(extents(made.space)))[0]
        empty(extents(made.space), box)
        for body in made.bodies:
            marked(made.space, body.particles.x, box, blocks)
        assert thin(extents(made.space), box, blocks) == (name == "far")
        for _ in range(3):
            advance_block(made, Clock(made), work, 0.01, 20)
        assert not any(np.any(array) for array in (work.buffers.nodes, work.buffers.force, work.buffers.blocks))
        found[name] = made.bodies[0].particles
    for array, other in zip(found["near"], found["far"], strict=True):
        assert np.array_equal(array, other)
    assert np.ptp(found["far"].J) > 1e-3  # the walls were felt
