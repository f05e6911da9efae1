"""Which pieces are near what: the contacts of one step, with their gaps.

wall      every piece of a body that the wall is no mirror for, and every particle without a piece, which stands half its width before its middle:
          it never acts unless surface has been torn open
body B    over the faces t of B within REACH that look at piece s (n_t . n_s < FACING, corners CORNER), weights q_t = (1 - r/REACH)^2 S_t:
          n = sum q n_t, normalised;  g = n . (x_s - sum q x_t/sum q);  the point of B is x_s - g n, on the particle of the nearest t;
          none where that lies beside t, past the edge of B
"""

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.contact.found import BODY, CORNER, FACING, REACH, around, new_contacts, put
from mpm.contact.skin import POINT
from mpm.contact.tools import find_tools
from mpm.jit import kernel, role
from mpm.state import PAD, NoExchange, Surface


@kernel
def find_all(space, bodies, skin, stops, pairs, tools, room, within):
    """(contacts, how many). stops (B, 3, 2), pairs (B, B): friction, negative where nothing is met; room (1,): how many to make room for, remembered."""
    D = directions(space)
    while True:
        found = new_contacts(room[0], D)
        count = find_walls(space, skin, stops, found, within)
        b = 0
        for body in literal_unroll(bodies):
            count = find_lone(body.surface, space, body, b, stops, found, count)
            b += 1
        if pairs.max() >= 0.0:
            count = find_pairs(space, skin, pairs, found, count, within)
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
    for p in range(x.shape[0]):
        if surface.row[p] >= 0:
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


@kernel
def find_pairs(space, skin, pairs, found, count, within):
    """Pieces before faces of other bodies, from number `count` on; how many then."""
    D, h, B = directions(space), space.h, pairs.shape[0]
    reach = REACH * h
    low, high = np.full((B, D), 1e300), np.full((B, D), -1e300)
    for s in range(len(skin.area)):
        for a in range(D):
            low[skin.body[s], a], high[skin.body[s], a] = min(low[skin.body[s], a], skin.x[s, a]), max(high[skin.body[s], a], skin.x[s, a])
    near, number = np.empty(len(skin.area), np.int64), 0  # pieces that reach into the box of another body
    least, most = np.full(D, 1e300), np.full(D, -1e300)
    for s in range(len(skin.area)):
        b = skin.body[s]
        for other in range(B):
            inside = pairs[b, other] >= 0.0 and skin.area[s] > 0.0
            for a in range(D):
                inside = inside and low[other, a] - reach <= skin.x[s, a] <= high[other, a] + reach
            if inside:
                near[number] = s
                number += 1
                for a in range(D):
                    least[a], most[a] = min(least[a], skin.x[s, a]), max(most[a], skin.x[s, a])
                break
    if number == 0:
        return count
    size, total = np.ones(3, np.int64), 1
    for a in range(D):
        size[a] = int((most[a] - least[a]) / reach) + 1
        total *= size[a]
    head, after, cell = np.full(total, -1), np.full(number, -1), np.zeros(3, np.int64)
    for k in range(number):
        home_of(skin.x[near[k]], least, reach, size, cell)
        at = (cell[0] * size[1] + cell[1]) * size[2] + cell[2]
        after[k], head[at] = head[at], k
    normal, middle, point = np.empty(D), np.empty(D), np.empty(D)
    for k in range(number):
        s = near[k]
        b, corner = skin.body[s], skin.area[s] <= 2 * POINT * h ** (D - 1)
        home_of(skin.x[s], least, reach, size, cell)
        for other in range(B):
            if pairs[b, other] < 0.0:
                continue
            weight, nearest, t = 0.0, 1e300, -1
            normal[:], middle[:] = 0.0, 0.0
            for i in range(max(cell[0] - 1, 0), min(cell[0] + 2, size[0])):
                for j in range(max(cell[1] - 1, 0), min(cell[1] + 2, size[1])):
                    for m in range(max(cell[2] - 1, 0), min(cell[2] + 2, size[2])):
                        e = head[(i * size[1] + j) * size[2] + m]
                        while e >= 0:
                            c = near[e]
                            e = after[e]
                            if skin.body[c] != other or skin.area[c] <= 2 * POINT * h ** (D - 1):
                                continue
                            square, cosine = 0.0, 0.0
                            for a in range(D):
                                square += (skin.x[c, a] - skin.x[s, a]) ** 2
                                cosine += skin.normal[c, a] * skin.normal[s, a]
                            if square >= reach * reach or cosine >= (CORNER if corner else FACING):
                                continue
                            q = (1.0 - square**0.5 / reach) ** 2 * skin.area[c]
                            weight += q
                            for a in range(D):
                                normal[a] += q * skin.normal[c, a]
                                middle[a] += q * skin.x[c, a]
                            if square < nearest:
                                nearest, t = square, c
            if t < 0:
                continue
            length, gap = 0.0, 0.0
            for a in range(D):
                length += normal[a] ** 2
            for a in range(D):
                normal[a] /= length**0.5
                gap += normal[a] * (skin.x[s, a] - middle[a] / weight)
            along, beside = 0.0, 0.0
            for a in range(D):
                point[a] = skin.x[s, a] - gap * normal[a]
                along += (point[a] - skin.x[t, a]) * skin.normal[t, a]
            for a in range(D):
                beside += (point[a] - skin.x[t, a] - along * skin.normal[t, a]) ** 2
            wide = 0.55 * skin.area[t] / around(space, skin.x[t, 0]) if D == 2 else 0.78 * skin.area[t] ** 0.5
            if gap >= within * h or (D > 1 and beside > wide * wide):
                continue
            if count < len(found.gap):
                put(found, count, s, BODY + other, gap, pairs[b, other], (b, skin.owner[s]), (skin.home[s], skin.x[s]), not corner)
                found.normal[count], found.home[count, 1], found.point[count, 1] = normal, skin.home[t], point
                found.body[count, 1], found.owner[count, 1], found.balanced[count, 1] = other, skin.owner[t], not corner
            count += 1
    return count


@kernel(inline=True)
def home_of(x, least, reach, size, cell):
    """The cell of a list of cells that a place lies in."""
    for a in range(len(x)):
        cell[a] = min(max(int((x[a] - least[a]) / reach), 0), size[a] - 1)
