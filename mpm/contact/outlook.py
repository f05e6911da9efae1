"""How much of a run has something near, from its start alone: for what a run will cost (mpm.costs).

Speed at the start and gravity close a gap at t0, with speed v there. What settles (flows, or is dragged) then stays; what is elastic bounces, is near for
    tau = 2 sqrt(D) L/c + 2 margin/v        (a wave through the body and back, slower by about sqrt(D) than that which limits steps; and the way in and out)
and comes back after 2 v/g.
Pieces that meet something are those within NEAR cells of a body's foremost; of two bodies, as many of either as the smaller face has.
Fails when  bodies spread, or are pushed towards what they would not fall to: near for more than is said, and more of them
"""

import math

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.contact.course import strongest
from mpm.contact.found import NEAR
from mpm.contact.meeting import box, skin_depth
from mpm.contact.spots import seen
from mpm.state import PAD, Surface


def fall(gap: float, speed: float, pull: float) -> float:
    """When speed t + pull t^2/2 = gap first holds [s]; inf where it never does."""
    if gap <= 0:
        return 0.0
    root = speed**2 + 2 * pull * gap
    return 2 * gap / (speed + math.sqrt(root)) if root > 0 and speed + math.sqrt(root) > 0 else math.inf


def foremost(body, axis: int, toward: float, h: float) -> int:
    """Pieces of a body within NEAR cells of the one that lies farthest in a direction."""
    if not isinstance(body.surface, Surface) or not len(body.surface.owner):
        return 0
    x = toward * (body.particles.x[body.surface.owner, axis] + body.surface.offset[:, axis])
    return int(np.sum(x > x.max() - NEAR * h))


def encounters(scene):
    """(gap, margin, speed, pull, extent, pieces) of what may meet: the gap, within `margin` of which something is near; how it closes; the body's extent that
    way, and how many pieces then meet something."""
    met, gravity = scene.meeting, strongest(scene)
    h, D = met.space.h, directions(met.space)
    ways = [(*box(body.particles.x), body.particles.v.mean(axis=0)) for body in met.bodies]
    for b, (low, high, v) in enumerate(ways):
        held = (met.walls[b, :D] < CONTACT).any(axis=1) | (met.stands and met.held[b])  # on a mirror, or still: weight brings it nowhere along that axis
        pull, skin = np.where(held, 0.0, gravity), skin_depth(met.bodies[b], h)
        for axis, side in np.argwhere(met.stops[b, :D] >= 0):
            gap, toward = ((extents(met.space)[axis] - 1 - 2 * PAD) * h - high[axis], 1.0) if side else (low[axis], -1.0)
            yield gap, skin, toward * v[axis], toward * pull[axis], high[axis] - low[axis], foremost(met.bodies[b], axis, toward, h)
        for c, (lowest, highest, u) in enumerate(ways[:b]):
            if met.pairs[b, c] >= 0:
                gaps = np.maximum(low - highest, lowest - high)
                axis = int(np.argmax(gaps))
                toward = 1.0 if low[axis] + high[axis] > lowest[axis] + highest[axis] else -1.0
                yield (
                    gaps[axis],
                    seen(met.space) * h,
                    toward * (u[axis] - v[axis]),
                    abs(gravity[axis]),
                    max(high[axis] - low[axis], highest[axis] - lowest[axis]),
                    2 * min(foremost(met.bodies[b], axis, -toward, h), foremost(met.bodies[c], axis, toward, h)),
                )
        for t in range(len(met.tool_names)):
            sides = [foremost(met.bodies[b], axis, toward, h) for axis in range(D) for toward in (-1.0, 1.0)]
            yield met.drive.gap(t, 0.0, low, high), skin, met.pace(0.0, 1e9), 0.0, math.inf, max(sides)  # a tool stays


def near_shares(scene, end: float, sound: float, settles: bool):
    """(share of a run of `end` [s] in which it is near, pieces that meet something then) of what may meet; `sound` [m/s] is that of the fastest wave."""
    for gap, margin, speed, pull, extent, pieces in encounters(scene) if scene.meeting is not None else ():
        begins = fall(gap - margin, speed, pull)
        left = end - begins
        if left > 0 and begins > 0 and not settles:
            fast = math.sqrt(speed**2 + 2 * pull * gap)
            each = 2 * math.sqrt(directions(scene.space)) * extent / sound + 2 * margin / fast
            left = min(left, each * (1 + left // (each + 2 * fast / pull))) if pull > 0 else min(left, each)
        yield max(left, 0.0) / end, pieces
