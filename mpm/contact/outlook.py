"""How much of a run has something near, from its start alone: for what a run will cost (mpm.costs).

near_from   the first time at which a body may be near a wall, a body or a tool: what its speed at the start and gravity along that way close the gap in
Fails when  bodies bounce off (near for less), spread or are pushed towards what they would not fall to (near for more)
"""

import math

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.contact.meeting import box, skin_depth
from mpm.contact.spots import seen
from mpm.state import PAD


def fall(gap: float, speed: float, pull: float) -> float:
    """When speed t + pull t^2/2 = gap first holds [s]; inf where it never does."""
    if gap <= 0:
        return 0.0
    root = speed**2 + 2 * pull * gap
    return math.inf if root < 0 or (pull <= 0 and speed <= 0) else 2 * gap / (speed + math.sqrt(root)) if speed + math.sqrt(root) > 0 else math.inf


def near_from(scene) -> float:
    """[s], of the scene's clock; inf where nothing may ever be near by itself."""
    met = scene.meeting
    if met is None:
        return math.inf
    h, D, found = met.space.h, directions(met.space), [math.inf]
    ways = [(*box(body.particles.x), body.particles.v.mean(axis=0)) for body in met.bodies]
    for b, (low, high, v) in enumerate(ways):
        held = (met.walls[b, :D] < CONTACT).any(axis=1)  # it stands on a mirror: weight brings it nowhere along that axis
        pull = np.where(held, 0.0, scene.gravity)
        for axis, side in np.argwhere(met.stops[b, :D] >= 0):
            gap = (extents(met.space)[axis] - 1 - 2 * PAD) * h - high[axis] if side else low[axis]
            toward = 1.0 if side else -1.0
            found.append(fall(gap - skin_depth(met.bodies[b], h), toward * v[axis], toward * pull[axis]))
        for c in range(b):
            if met.pairs[b, c] >= 0:
                gaps = np.maximum(low - ways[c][1], ways[c][0] - high)
                axis = int(np.argmax(gaps))
                toward = 1.0 if low[axis] > ways[c][1][axis] - h else -1.0  # in which c comes to b
                found.append(fall(gaps[axis] - seen(met.space) * h, toward * (ways[c][2][axis] - v[axis]), abs(scene.gravity[axis])))
        for t in range(len(met.tool_names)):
            found.append(
                fall(
                    met.drive.gap(t, 0.0, low, high) - skin_depth(met.bodies[b], h), met.pace(0.0, 1e9) + float(np.linalg.norm(v)), float(np.linalg.norm(pull))
                )
            )
    return min(found)
