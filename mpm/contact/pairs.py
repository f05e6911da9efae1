"""Bodies that may meet, and the contacts of a piece with the faces of another body.

Over the faces t of B within REACH that look at piece s (n_t . n_s < FACING, corners CORNER), weights q_t = (1 - r/REACH)^2 S_t:
n = sum q n_t, normalised;  g = sum q (n + n_t)/2 . (x_s - x_t)/sum q;  the point of B is x_s - g n, on the particle of the nearest t;
none where that lies beside t, past the edge of B. A chord of a circle, or of a sphere, is at right angles to the mean of the normals at its ends: with n alone
round faces stood off, and hollow ones overlapped, by (h/2)^2/(2 R) and more.
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.contact.found import BODY, CORNER, FACING, REACH, around, others, put
from mpm.contact.skin import POINT
from mpm.jit import kernel, role


class Pairs(NamedTuple):
    """Several bodies."""

    mu: np.ndarray  # (B, B) friction of the bodies that a body meets, negative for others


class NoPairs(NamedTuple):
    """One body."""


@others.register(NoPairs)
def others_no_pairs(which):
    return False


@others.register(Pairs)
def others_pairs(which):
    return True


@role
def find_pairs(pairs, space, skin, found, count, within):
    """Pieces before faces of other bodies, from number `count` on; how many then."""
    raise TypeError(f"no pairs of {type(pairs).__name__}")


@find_pairs.register(NoPairs)
def find_pairs_no_pairs(pairs, space, skin, found, count, within):
    return count


@find_pairs.register(Pairs)
def find_pairs_pairs(pairs, space, skin, found, count, within):
    D, h, mu, B = directions(space), space.h, pairs.mu, len(pairs.mu)
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
            inside = mu[b, other] >= 0.0 and skin.area[s] > 0.0
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
            if mu[b, other] < 0.0:
                continue
            weight, nearest, t, beyond = 0.0, 1e300, -1, 0.0
            for a in range(D):
                normal[a] = middle[a] = 0.0
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
                                beyond += q * skin.normal[c, a] * (skin.x[s, a] - skin.x[c, a])
                            if square < nearest:
                                nearest, t = square, c
            if t < 0:
                continue
            length, gap = 0.0, 0.0
            for a in range(D):
                length += normal[a] ** 2
            for a in range(D):
                normal[a] /= length**0.5
                gap += 0.5 * normal[a] * (skin.x[s, a] - middle[a] / weight)
            gap += 0.5 * beyond / weight
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
                put(found, count, s, BODY + other, gap, mu[b, other], (b, skin.owner[s]), (skin.home[s], skin.x[s]), not corner)
                for a in range(D):  # numpy's own way to fill a row compiles the words of its errors
                    found.normal[count, a], found.home[count, 1, a], found.point[count, 1, a] = normal[a], skin.home[t, a], point[a]
                found.body[count, 1], found.owner[count, 1], found.balanced[count, 1] = other, skin.owner[t], not corner
            count += 1
    return count


@kernel(inline=True)
def home_of(x, least, reach, size, cell):
    """The cell of a list of cells that a place lies in."""
    for a in range(len(x)):
        cell[a] = min(max(int((x[a] - least[a]) / reach), 0), size[a] - 1)
