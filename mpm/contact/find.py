"""Which pieces are near what: the contacts of one step, with their gaps.

wall      every piece of a body that the wall is no mirror for, and every particle without a piece, which stands half its width before its middle:
          it never acts unless surface has been torn open
bodies    pairs.py      tools     tools.py
"""

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.contact.found import FACING, around, new_contacts, put
from mpm.contact.pairs import find_pairs
from mpm.contact.skin import POINT
from mpm.contact.tools import find_tools
from mpm.jit import kernel, role
from mpm.state import PAD, NoExchange, Surface


@kernel
def find_all(space, bodies, skin, stops, pairs, tools, room, within):
    """(contacts, how many). stops (B, 3, 2): friction, negative where nothing is met; room (1,): how many to make room for, remembered."""
    D = directions(space)
    while True:
        found = new_contacts(room[0], D)
        count = find_walls(space, skin, stops, found, within)
        b = 0
        for body in literal_unroll(bodies):
            count = find_lone(body.surface, space, body, b, stops, found, count)
            b += 1
        count = find_pairs(pairs, space, skin, found, count, within)
        count = find_tools(tools, space, bodies, skin, found, count, within)
        if count <= room[0]:
            return found, count
        room[0] = count + count // 2


@kernel(inline=True)
def before(space, stop_axis, side, x):
    """How far a place stands before a wall."""
    return x if side == 0 else (extents(space)[stop_axis] - 1 - 2 * PAD) * space.h - x


@kernel
def find_walls(space, skin, stops, found, within):
    """Pieces before walls; how many."""
    D, count = directions(space), 0
    for s in range(len(skin.area)):
        b = skin.body[s]
        if skin.area[s] == 0.0:
            continue
        for axis in range(D):
            for side in range(2):
                if stops[b, axis, side] < 0.0:
                    continue
                gap = before(space, axis, side, skin.x[s, axis])
                if gap >= within * space.h:
                    continue
                if count < len(found.gap):
                    out = 1.0 if side == 0 else -1.0
                    looks = skin.area[s] > 2 * POINT * space.h ** (D - 1) and skin.normal[s, axis] * out < FACING
                    put(found, count, s, 2 * axis + side, gap, stops[b, axis, side], (b, skin.owner[s]), (skin.home[s], skin.x[s]), looks)
                    found.normal[count] = 0.0
                    found.normal[count, axis] = out
                count += 1
    return count


@role
def find_lone(surface, space, body, b, stops, found, count):
    """Particles without pieces before walls, from number `count` on; how many then."""
    raise TypeError(f"no pieces of {type(surface).__name__}")


@find_lone.register(NoExchange)
def find_lone_no_exchange(surface, space, body, b, stops, found, count):
    return count


@find_lone.register(Surface)
def find_lone_surface(surface, space, body, b, stops, found, count):
    D, x, place = directions(space), body.particles.x, np.empty(directions(space))
    low, high = np.full(D, -1e300), np.full(D, 1e300)  # most particles are within, and no more is asked of them
    for axis in range(D):
        if stops[b, axis, 0] >= 0.0:
            low[axis] = 0.51 * space.h
        if stops[b, axis, 1] >= 0.0:
            high[axis] = (extents(space)[axis] - 1 - 2 * PAD - 0.51) * space.h
    for p in range(x.shape[0]):
        within = True
        for axis in range(D):
            within = within and low[axis] < x[p, axis] < high[axis]
        if within or surface.row[p] >= 0:
            continue
        for axis in range(D):
            for side in range(2):
                if stops[b, axis, side] < 0.0:
                    continue
                far = before(space, axis, side, x[p, axis])
                if far >= 0.5 * space.h:
                    continue
                gap = far - 0.5 * (body.particles.V0[p] * body.particles.J[p] / around(space, x[p, 0])) ** (1.0 / D)
                if gap >= 0.1 * space.h:
                    continue
                if count < len(found.gap):
                    for a in range(D):
                        place[a] = x[p, a]
                    put(found, count, -1, 2 * axis + side, gap, stops[b, axis, side], (b, p), (place, place), 0)
                    found.normal[count] = 0.0
                    found.normal[count, axis] = 1.0 if side == 0 else -1.0
                count += 1
    return count
