"""Bodies that stand still beside others that move: their nodes keep no speed and give way to nothing, so what meets them meets an obstacle of their own shape.

v_i = 0,   m_i = inf        on the nodes of a held body's field, before contacts are solved; no impulse moves them (solve.py), and W stays w~ (weights.py)

Their particles carry heat and a surface, and never move. Something is near in every step of such a scene: the nodes of a single field know no held body.
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.blocks import BLOCK, span
from mpm.jit import kernel, role
from mpm.transfer import wants_change


class NotHeld(NamedTuple):
    """Every body moves."""


class Held(NamedTuple):
    """Some do not."""

    fields: np.ndarray  # (F,) whether the bodies of a field stand still


@role
def hold(held, method, grids, now, mass):
    """Let the nodes of held fields, of buffer `now`, keep no speed; their mass: infinite while contacts are solved, any other for the gather."""
    raise TypeError(f"no held fields of {type(held).__name__}")


@hold.register(NotHeld)
def hold_not_held(held, method, grids, now, mass):
    return None


@hold.register(Held)
def hold_held(held, method, grids, now, mass):
    for f in range(len(held.fields)):
        if held.fields[f]:
            still(method, grids.nodes[f, now], grids.force[f, now], grids.boxes[f, now], mass)


@kernel
def still(method, nodes, force, box, mass):
    """No speed, and this mass [kg], on the nodes of a box (3, 2)."""
    D, (begin, end) = directions(method.space), span(extents(method.space), box)
    for n in range(BLOCK * begin, min(BLOCK * end, nodes.shape[0])):
        if nodes[n, D] > 0.0:
            nodes[n, D] = mass
        for c in range(D):
            nodes[n, c] = 0.0
            if wants_change(method.scheme):
                force[n, c] = 0.0
