"""How much of a run has something near, from its start alone: for what a run will cost (mpm.costs).

Speed at the start and gravity close a gap at t0, with speed v there. What settles (flows, or is dragged) then stays; what is elastic bounces, is near for
    tau = 2 sqrt(D) L/c + 2 margin/v        (a wave through the body and back, slower by about sqrt(D) than that which limits steps; and the way in and out)
and comes back after 2 v/g.
Fails when  bodies spread, or are pushed towards what they would not fall to: near for more than is said
"""

import math

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.contact.course import strongest
from mpm.contact.meeting import box, skin_depth
from mpm.contact.spots import seen
from mpm.state import PAD


def fall(gap: float, speed: float, pull: float) -> float:
    """When speed t + pull t^2/2 = gap first holds [s]; inf where it never does."""
    if gap <= 0:
        return 0.0
    root = speed**2 + 2 * pull * gap
    return 2 * gap / (speed + math.sqrt(root)) if root > 0 and speed + math.sqrt(root) > 0 else math.inf


def encounters(scene):
    """(gap, margin, speed, pull, extent) of what may meet: the gap, within `margin` of which something is near; how it closes; the body's extent that way."""
    met, gravity = scene.meeting, strongest(scene)
    h, D = met.space.h, directions(met.space)
    ways = [(*box(body.particles.x), body.particles.v.mean(axis=0)) for body in met.bodies]
    for b, (low, high, v) in enumerate(ways):
        held = (met.walls[b, :D] < CONTACT).any(axis=1)  # it stands on a mirror: weight brings it nowhere along that axis
        pull, skin = np.where(held, 0.0, gravity), skin_depth(met.bodies[b], h)
        for axis, side in np.argwhere(met.stops[b, :D] >= 0):
            gap, toward = ((extents(met.space)[axis] - 1 - 2 * PAD) * h - high[axis], 1.0) if side else (low[axis], -1.0)
            yield gap, skin, toward * v[axis], toward * pull[axis], high[axis] - low[axis]
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
                )
        for t in range(len(met.tool_names)):
            yield met.drive.gap(t, 0.0, low, high), skin, met.pace(0.0, 1e9), 0.0, math.inf  # a tool stays


def near_share(scene, end: float, sound: float, settles: bool) -> float:
    """Share of a run of `end` [s] in which something is near; `sound` [m/s] is that of the fastest wave."""
    share = 0.0
    for gap, margin, speed, pull, extent in encounters(scene) if scene.meeting is not None else ():
        begins = fall(gap - margin, speed, pull)
        left = end - begins
        if left > 0 and begins > 0 and not settles:
            fast = math.sqrt(speed**2 + 2 * pull * gap)
            each = 2 * math.sqrt(directions(scene.space)) * extent / sound + 2 * margin / fast
            left = min(left, each * (1 + left // (each + 2 * fast / pull))) if pull > 0 else min(left, each)
        share = max(share, left / end)
    return share
