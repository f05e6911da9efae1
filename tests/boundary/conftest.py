"""What a scatter marks, for the tests of blocks."""

import numpy as np
import pytest

from mpm.boundary import directions
from mpm.integrate.active_nodes import reaches, touch
from mpm.transfer import CHUNK


@pytest.fixture
def marked():
    """marked(space, x, box, blocks): mark as a scatter of x does, boxes of chunks, then `touch`."""

    def mark(space, x, box, blocks):
        reach = reaches(space, len(x))
        for k in range(len(reach)):
            for a in range(directions(space)):
                first = np.floor(x[k * CHUNK : (k + 1) * CHUNK, a] / space.h + 0.5).astype(int) + 1
                reach[k, a] = first.min(), first.max() + 3
        touch(space, x, 0, len(x), reach, box, blocks, True)

    return mark
