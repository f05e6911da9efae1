"""Which pieces are near what: the contacts of one step, with their gaps.

wall      every piece of a body that the wall is no mirror for, and every particle without a piece, which stands half its width before its middle:
          it never acts unless surface has been torn open. Level pieces over the same nodes act as one, with the mean of their weights by area and the
          smallest of their gaps: they are more than nodes can tell apart, and each of them held is the same motion
bodies    pairs.py      tools     tools.py
"""

import numpy as np
from numba import literal_unroll

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.contact.found import ALIKE, CLEAR, FACING, FLAT, LEVEL, NEAR, STRAY, around, new_contacts, put, whole
from mpm.contact.pairs import find_pairs
from mpm.contact.skin import POINT
from mpm.contact.tools import find_tools
from mpm.jit import kernel, role
from mpm.state import PAD, NoExchange, Surface


@kernel
def find_all(space, bodies, skin, stops, pairs, tools, room, within, number):
    """(contacts, how many). stops (B, 3, 2): friction, negative where nothing is met; room (1,): how many to make room for, remembered.

    number (nodes,): -1 before and after; of no nodes where every piece is to be a contact of its own.
    """
    D = directions(space)
    while True:
        found = new_contacts(room[0], D, skin.after)
        count = find_walls(space, skin, stops, found, within, number)
        b = 0
        for body in literal_unroll(bodies):
            if skin.lone[b]:
                count = find_lone(body.surface, space, body, b, stops, found, count, 0.0)
            b += 1
        count = find_pairs(pairs, space, skin, found, count, within)
        count = find_tools(tools, space, bodies, skin, found, count, within)
        if count <= room[0]:
            return found, count
        room[0] = count + count // 2


@kernel
def list_near(space, bodies, skin, stops, alone):
    """Which pieces, and whether particles without one, may be near until something has moved by STRAY; where not `alone` all of the pieces."""
    found, b = new_contacts(0, directions(space), skin.after), 0
    list_pieces(space, skin, stops, alone)
    for body in literal_unroll(bodies):
        skin.lone[b] = find_lone(body.surface, space, body, b, stops, found, 0, STRAY) > 0
        b += 1


@kernel
def list_pieces(space, skin, stops, alone):
    """`list_near` of pieces; of its own, as a loop over bodies of several types holds no other loop."""
    skin.left[0] = STRAY * space.h
    for b in range(len(skin.first) - 1):
        skin.starts[b + 1] = skin.starts[b]
        for s in range(skin.first[b], skin.first[b + 1]):
            close = not alone
            for axis in range(directions(space)):
                for side in range(2):
                    close = close or (stops[b, axis, side] >= 0.0 and before(space, axis, side, skin.x[s, axis]) < (NEAR + 2 * STRAY) * space.h)
            if close:
                skin.near[skin.starts[b + 1]] = s
                skin.starts[b + 1] += 1


@kernel(inline=True)
def before(space, stop_axis, side, x):
    """How far a place stands before a wall."""
    return x if side == 0 else (extents(space)[stop_axis] - 1 - 2 * PAD) * space.h - x


@kernel(inline=True)
def find_walls(space, skin, stops, found, within, number):
    """Pieces before walls; how many."""
    D, count, sight = directions(space), 0, min(within * space.h, skin.sight[0])
    for s in skin.near[: skin.starts[-1]]:
        b = skin.body[s]
        if skin.area[s] == 0.0:
            continue
        for axis in range(D):
            for side in range(2):
                if stops[b, axis, side] < 0.0:
                    continue
                gap = before(space, axis, side, skin.x[s, axis])
                if gap >= sight:
                    continue
                out, over = 1.0 if side == 0 else -1.0, -1
                if len(number) > 0 and skin.area[s] > 2 * POINT * space.h ** (D - 1) and skin.normal[s, axis] * out < LEVEL:
                    over = corner_of(space, skin.home[s])
                    i = number[over] if over >= 0 else -1
                    same = i >= 0 and found.against[i] == 2 * axis + side and found.body[i, 0] == b
                    if same and abs(gap - found.gap[i]) <= FLAT * space.h and alike(skin, s, found.piece[i]):
                        skin.after[s], found.mates[i] = found.mates[i], s
                        continue
                if count < len(found.gap):
                    looks = skin.area[s] > 2 * POINT * space.h ** (D - 1) and skin.normal[s, axis] * out < FACING
                    put(found, count, s, 2 * axis + side, gap, stops[b, axis, side], (b, skin.owner[s]), (skin.home[s], skin.x[s]), looks)
                    found.normal[count] = 0.0
                    found.normal[count, axis], found.over[count] = out, over
                    if over >= 0:
                        number[over] = count
                count += 1
    for i in range(min(count, len(found.gap))):
        if found.over[i] >= 0:
            number[found.over[i]] = -1
        if found.mates[i] >= 0:
            meet_as_one(space, skin, found, i)
    return count


@kernel(inline=True)
def alike(skin, s, t):
    """Whether two pieces look the same way: those of a round face do not."""
    cosine = 0.0
    for a in range(skin.normal.shape[1]):
        cosine += skin.normal[s, a] * skin.normal[t, a]
    return cosine > ALIKE


@kernel(inline=True)
def corner_of(space, home):
    """The first of the nodes that a particle at `home` sees; -1 where rounding may tell."""
    n, sure, cells = 0, True, 1.0 / space.h
    for a in range(len(home)):
        first, _, _, _, _ = stencil(space.basis, home[a] * cells - CLEAR)
        last, _, _, _, _ = stencil(space.basis, home[a] * cells + CLEAR)
        n, sure = n * extents(space)[a] + first, sure and first == last
    return n if sure else -1


@kernel(inline=True)
def meet_as_one(space, skin, found, i):
    """The mean place of the pieces that act as contact i with a wall, and the smallest of their gaps."""
    part, s, axis, side = 1.0 / whole(found, skin.area, i), found.mates[i], found.against[i] // 2, found.against[i] % 2
    for a in range(directions(space)):
        found.point[i, 0, a] *= part * skin.area[found.piece[i]]
    while s >= 0:
        found.gap[i] = min(found.gap[i], before(space, axis, side, skin.x[s, axis]))
        for a in range(directions(space)):
            found.point[i, 0, a] += part * skin.area[s] * skin.x[s, a]
        s = found.after[s]


@role
def find_lone(surface, space, body, b, stops, found, count, margin):
    """Particles without pieces before walls, from number `count` on; how many then. With a `margin` [cells] only whether there are any so much
    farther off: one more than `count`."""
    raise TypeError(f"no pieces of {type(surface).__name__}")


@find_lone.register(NoExchange)
def find_lone_no_exchange(surface, space, body, b, stops, found, count, margin):
    return count


@find_lone.register(Surface)
def find_lone_surface(surface, space, body, b, stops, found, count, margin):
    D, x, place = directions(space), body.particles.x, np.empty(directions(space))
    low, high = np.full(D, -1e300), np.full(D, 1e300)  # most particles are within, and no more is asked of them
    for axis in range(D):
        if stops[b, axis, 0] >= 0.0:
            low[axis] = (0.51 + margin) * space.h
        if stops[b, axis, 1] >= 0.0:
            high[axis] = (extents(space)[axis] - 1 - 2 * PAD - 0.51 - margin) * space.h
    for p in range(x.shape[0]):
        within = True
        for axis in range(D):
            within = within and low[axis] < x[p, axis] < high[axis]
        if within or surface.row[p] >= 0:
            continue
        if margin > 0.0:
            return count + 1
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
