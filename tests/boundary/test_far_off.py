"""Blocks of nodes: a body far off, with an empty box between, changes no bit of another."""

import numpy as np
import pytest

from mpm.boundary import extents
from mpm.boundary.blocks import new_blocks, thin
from mpm.boundary.walls import empty
from mpm.simulation import Clock, advance_block, work_arrays

pytestmark = pytest.mark.plain


@pytest.mark.parametrize(("D", "transfer"), [(1, {"xpic": {"order": 3}}), (1, {"flip": {}}), (2, {"apic": {}})], ids=["xpic", "flip", "apic"])
def test_a_body_far_off_changes_no_bit(core, marked, D, transfer):
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
