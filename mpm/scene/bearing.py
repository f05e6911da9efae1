"""What bears a body, from the config alone: sides of the domain that it lies on, sides that hold it, and how far it bends from them."""

import numpy as np

from mpm.scene.conventions import SIDES
from mpm.scene.shapes import shape
from mpm.scene.weight import strongest

FLUSH = 1e-9  # of the domain: what is nearer to a side lies on it


def lying(experiment, lower, upper, axis: int) -> tuple[list[bool], int]:
    """(whether what has these bounds lies on the two sides of the domain along an axis, on how many of them it sticks)."""
    size, sides = experiment.grid.size[axis], SIDES[experiment.grid.dimension][2 * axis : 2 * axis + 2]
    ends = [abs(lower[axis]) <= FLUSH * size, abs(upper[axis] - size) <= FLUSH * size]
    walls = [experiment.walls.get(side) for side in sides]
    return ends, sum(touch and wall is not None and wall.acts == "stick" for touch, wall in zip(ends, walls, strict=True))


def clamped(experiment) -> bool:
    """Whether it is one body, in more than one direction, that sticks to a side of the domain: it may bend."""
    grid = experiment.grid
    if len(experiment.bodies) > 1 or grid.directions < 2:
        return False
    lower, upper = shape(next(iter(experiment.bodies.values())).shape, grid.dimension).bounds()
    return any(lying(experiment, lower, upper, axis)[1] for axis in range(grid.directions))


def bearing(experiment, name: str) -> tuple[str, float]:
    """What bears the weight of a body, and the strain at its clamp over R0 g H/E, H its extent along gravity: by beam theory at small deflection

    3 (L/H)^2 of a cantilever, (L/H)^2/2 of a beam held at both ends, 3 (L/H)^2/4 of a round plate held at its rim, L the extent (radius) across.
    """
    grid, gravity = experiment.grid, strongest(experiment)
    if gravity is None or not any(gravity) or grid.dimension == 0:
        return "", 1.0
    lower, upper = shape(experiment.bodies[name].shape, grid.dimension).bounds()
    down, found = int(np.argmax(np.abs(gravity))), 0.0
    for axis in range(len(grid.size)):
        ends, clamps = lying(experiment, lower, upper, axis)
        if axis == down:
            if ends[1 if gravity[down] > 0 else 0]:
                return "stands", 1.0
            continue
        factor = 0.75 if grid.dimension == "axisymmetric" else {1: 3.0, 2: 0.5}.get(clamps, 0.0)
        slender = factor * ((upper[axis] - max(lower[axis], 0.0)) / (upper[down] - lower[down])) ** 2 if clamps else 0.0
        found = slender if not found else min(found, slender or found)  # the shorter span bears it
    return ("bends", max(1.0, float(found))) if found else ("", 1.0)
