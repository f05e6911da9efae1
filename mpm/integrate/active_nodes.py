"""What particles mark of the nodes they touch (mpm.boundary.blocks), chunk by chunk, after all of them are scattered."""

import numpy as np

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.boundary.blocks import mark_box, marks_of
from mpm.boundary.walls import empty
from mpm.jit import kernel
from mpm.transfer import CHUNK

SLACK = 1e-3  # cells: positions are rounded otherwise in lanes
MANY = 8  # marks a particle: about what it costs to mark particle by particle


@kernel
def reaches(space, count):
    """Boxes of nodes (chunks, 3, 2) of `count` particles, for the scatter of each chunk to grow."""
    found = np.empty(((count + CHUNK - 1) // CHUNK, 3, 2), np.int64)
    for k in range(found.shape[0]):
        empty(extents(space), found[k])
    return found


@kernel
def touch(space, x, begin, end, reach, box, blocks, sparse):
    """Grow `box` (3, 2) by what the chunks of the particles from `begin` to `end` reached, and where the scene is `sparse` mark it.

    The box of a chunk where that is small; where it is not, because particles are out of order or a plane of cells ends in the chunk, particle by particle.
    Every chunk has a box, sparse or not: to choose one for each scatter cost 3 to 5 % of a step (`mpm bench --n 64 --np 100000 --dtype f64`).
    """
    shape, D, inverse, one = extents(space), directions(space), 1.0 / space.h, np.empty((3, 2), np.int64)
    for k in range(reach.shape[0]):
        if reach[k, 0, 0] >= reach[k, 0, 1]:
            continue  # not scattered
        for a in range(3):
            box[a, 0], box[a, 1] = min(box[a, 0], reach[k, a, 0]), max(box[a, 1], reach[k, a, 1])
        if not sparse:
            continue
        first = begin + k * CHUNK
        count = min(CHUNK, end - first)
        if marks_of(D, shape, reach[k]) <= MANY * count:
            mark_box(blocks, D, shape, reach[k])
            continue
        for p in range(first, first + count):
            for a in range(D):
                low, w, _, _, _ = stencil(space.basis, x[p, a] * inverse - SLACK)
                one[a, 0], one[a, 1] = low, stencil(space.basis, x[p, a] * inverse + SLACK)[0] + len(w)
            mark_box(blocks, D, shape, one)
