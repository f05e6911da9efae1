"""What the particles near a contact put on the nodes that it acts on: r and T of weights.py, kept from step to step while little moves.

Nothing near moves by more than LAG of a cell before they are made anew, or are wanted on another node: W is late by that, and in its correction alone. It stays
linear-exact, and what it gives to one body it takes from the other. A run that goes on has those that it was cut with (meeting.py).
"""

import math
from typing import NamedTuple

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.contact.found import BODY, CLEAR, STRAY
from mpm.contact.skin import hoop, lay_skins
from mpm.contact.spots import WIDE, along, gradients, lanes_of, level, new_lines, new_places, new_slopes, new_spots, places, products, slopes, spans, turns
from mpm.jit import kernel
from mpm.lanes import fma, item, load4, splat4, store
from mpm.state import PAD

LAG = 0.01  # cells


class Sums(NamedTuple):
    """K nodes, of one body after another."""

    place: np.ndarray  # (B * nodes,) which; K are used
    first: np.ndarray  # (B + 1,) first of each body
    box: np.ndarray  # (B, 2, D) the particles that touch them lie within [m]
    moved: np.ndarray  # (1,) how far any of them may have moved since [m]
    lack: np.ndarray  # (K, WIDE) r
    diagonal: np.ndarray  # (K, WIDE) T_cc
    beside: np.ndarray  # (K, WIDE) T_yz, T_xz, T_xy; of no nodes where walls alone are met
    lean: np.ndarray  # (K, WIDE) r_c/T_cc; 0 where there is no face


def new_sums(space, B):
    """None yet."""
    D, n = directions(space), math.prod(extents(space))
    none = np.zeros((0, WIDE))
    return Sums(np.empty(B * n, np.int64), np.zeros(B + 1, np.int64), np.zeros((B, 2, D)), np.full(1, np.inf), none, none, none, none)


def kept(sums):
    """What of the sums outlasts a run that is cut: plain arrays."""
    return {**sums._asdict(), "place": sums.place[: sums.first[-1]]}


def taken_up(sums, found):
    """The sums that were `kept`; sums: any of the scene."""
    sums.place[: len(found["place"])] = found["place"]
    return Sums(**{name: np.array(value) for name, value in found.items()} | {"place": sums.place})


@kernel
def recall(sums, b, number):
    """Number the nodes of body b."""
    for k in range(sums.first[b], sums.first[b + 1]):
        number[sums.place[k]] = k


@kernel
def forget(sums, b, number):
    """Take the numbers away."""
    for k in range(sums.first[b], sums.first[b + 1]):
        number[sums.place[k]] = -1


@kernel
def hold_good(space, walls, fields, sums, contacts, count, number):
    """Whether the sums are there for every balanced contact, and not too old."""
    if not sums.moved[0] <= LAG * space.h or (len(sums.beside) == 0 and slanted(contacts, count)):
        return False
    shape, place, fine = extents(space), new_places(space), True
    n0, n1, n2 = spans(space)
    for b in range(len(fields)):
        recall(sums, b, number)
        for i in range(count):
            for k in range(2):
                if not fine or contacts.body[i, k] != b or not contacts.balanced[i, k]:
                    continue
                places(space, walls[fields[b]], contacts.home[i, k], place)
                for j0 in range(n0):
                    for j1 in range(n1):
                        for j2 in range(n2):
                            fine = fine and number[(place[0, j0] * shape[1] + place[1, j1]) * shape[2] + place[2, j2]] >= 0
        forget(sums, b, number)
    return fine


@kernel
def make_room(space, walls, fields, sums, contacts, count, number):
    """Sums of the nodes on which bodies are balanced now; all zero."""
    for b in range(len(fields)):
        sums.first[b + 1] = mark(space, b, walls[fields[b]], sums, contacts, count, number)
        forget(sums, b, number)
    K = sums.first[-1]
    beside = np.zeros((K if slanted(contacts, count) else 0, WIDE))
    return Sums(sums.place, sums.first, sums.box, np.zeros(1), np.zeros((K, WIDE)), np.zeros((K, WIDE)), beside, np.zeros((K, WIDE)))


@kernel(inline=True)
def slanted(contacts, count):
    """Whether anything but walls is met: normals of those are directions."""
    for i in range(count):
        if contacts.against[i] >= BODY:
            return True
    return False


@kernel
def mark(space, b, walls, sums, contacts, count, number):
    """Number the nodes where body b is balanced, from sums.first[b] on, and keep them; how many then. The box (low, high) of what touches them."""
    D, shape, place, marked = directions(space), extents(space), new_places(space), sums.first[b]
    low, high = np.full(directions(space), 1e300), np.full(directions(space), -1e300)
    n0, n1, n2 = spans(space)
    for i in range(count):
        for k in range(2):
            if contacts.body[i, k] != b or not contacts.balanced[i, k]:
                continue
            places(space, walls, contacts.home[i, k], place)
            for j0 in range(n0):
                for j1 in range(n1):
                    for j2 in range(n2):
                        n = (place[0, j0] * shape[1] + place[1, j1]) * shape[2] + place[2, j2]
                        if number[n] < 0:
                            number[n], sums.place[marked] = marked, n
                            marked += 1
            for a in range(D):
                for j in range(n0):
                    low[a], high[a] = min(low[a], place[a, j]), max(high[a], place[a, j])
    for a in range(D):  # from nodes to places, and half of what a particle sees on either side
        sums.box[b, 0, a], sums.box[b, 1, a] = (low[a] - PAD - 0.5 * n0 - CLEAR) * space.h, (high[a] - PAD + 0.5 * n0 + CLEAR) * space.h
    return marked


@kernel
def add_up(space, gradient, bodies, walls, fields, skin, sums, number):
    """All of the sums, from all of the particles and pieces."""
    pieces = pieces_within(space, skin, sums)
    lay_skins(space, bodies, skin, *pieces)
    b = 0
    for body in literal_unroll(bodies):
        if sums.first[b] < sums.first[b + 1]:
            recall(sums, b, number)
            fall_short(space, gradient, body.particles, b, walls[fields[b]], skin, pieces, sums, number, (0, body.particles.x.shape[0]))
            forget(sums, b, number)
        b += 1
    lean_all(space, sums)


@kernel
def pieces_within(space, skin, sums):
    """The pieces whose particles may lie in the boxes of the sums, by where they were last laid: they have moved by less than STRAY since. (which, first)."""
    some, starts, margin = np.empty(len(skin.area), np.int64), np.zeros(len(skin.first), np.int64), STRAY * space.h
    for b in range(len(starts) - 1):
        found, lead = starts[b], thinnest(sums.box[b])
        low, high = sums.box[b, 0, lead] - margin, sums.box[b, 1, lead] + margin
        if sums.first[b] < sums.first[b + 1]:
            for s in range(skin.first[b], skin.first[b + 1]):
                some[found] = s
                found += low <= skin.home[s, lead] <= high
        starts[b + 1] = found
    return some, starts


@kernel(inline=True)
def thinnest(box):
    """The direction in which a box (2, D) is thinnest."""
    lead = 0
    for a in range(1, box.shape[1]):
        if box[1, a] - box[0, a] < box[1, lead] - box[0, lead]:
            lead = a
    return lead


@kernel
def lean_all(space, sums):
    """r_c/T_cc."""
    least = 1e-12 * space.h ** (directions(space) - 1)
    for k in range(len(sums.lean)):
        for c in range(directions(space)):
            if sums.diagonal[k, c] > least:
                sums.lean[k, c] = sums.lack[k, c] / sums.diagonal[k, c]


@kernel
def fall_short(space, gradient, particles, b, walls, skin, pieces, sums, number, some):
    """r and T of the marked nodes, from the particles some[0] <= p < some[1] of body b within the box of its sums, and from their pieces."""
    room = new_spots(space), new_lines(space), new_slopes(space)
    from_particles(space, gradient, particles, b, walls, sums, number, some, room, np.empty(directions(space)))
    from_pieces(space, gradient, b, walls, skin, pieces, sums, number, some, room)


@kernel(inline=True)
def from_particles(space, gradient, particles, b, walls, sums, number, some, room, home):
    """V G of the particles, and along r of an axisymmetric body V w/r."""
    (spots, lines, _), D, shape, lack, lead = room, directions(space), extents(space), sums.lack, thinnest(sums.box[b])
    low, high, place, (n0, n1, n2) = sums.box[b, 0], sums.box[b, 1], spots[1], spans(space)
    least, most = low[lead], high[lead]
    for p in range(some[0], some[1]):
        if not least <= particles.x[p, lead] <= most:
            continue
        inside = True
        for a in range(D):
            home[a] = particles.x[p, a]
            inside = inside and low[a] <= home[a] <= high[a]
        if not inside:
            continue
        mirrored = along(space, walls, home, spots)
        gradients(space, gradient, spots, lines)
        if hoop(space):
            for i in range(n0):
                lines[0, i, 0] += spots[0][0, 0, i] / home[0]
        if mirrored:
            turns(space, walls, spots, lines)
        V = splat4(np.float64(particles.V0[p]) * np.float64(particles.J[p]))
        for i in range(n0):
            one = V * load4(lines, WIDE * i)
            for j in range(n1):
                both, row = one * load4(lines, WIDE * (n0 + j)), (place[0, i] * shape[1] + place[1, j]) * shape[2]
                for k in range(n2):
                    n = number[np.uint64(row + place[2, k])]
                    if n >= 0:
                        store(lack, WIDE * n, fma(both, load4(lines, WIDE * (2 * n0 + k)), load4(lack, WIDE * n)))


@kernel(inline=True)
def from_pieces(space, gradient, b, walls, skin, pieces, sums, number, some, room):
    """S n w~ and S w n n^T of the pieces."""
    (spots, signs, slope), D, shape, lack, (which, first) = room, directions(space), extents(space), sums.lack, pieces
    low, high, place, (n0, n1, n2) = sums.box[b, 0], sums.box[b, 1], spots[1], spans(space)
    for at in range(first[b], first[b + 1]):
        s = which[at]
        inside = skin.area[s] > 0.0 and some[0] <= skin.owner[s] < some[1]
        for a in range(D):
            inside = inside and low[a] <= skin.home[s, a] <= high[a]
        if not inside:
            continue
        mirrored = along(space, walls, skin.home[s], spots)
        slopes(space, gradient, spots, slope)
        if mirrored:
            level(space, signs)
            turns(space, walls, spots, signs)
        way, pressed = lanes_of(D, skin.x[s]) - lanes_of(D, skin.home[s]), splat4(skin.area[s]) * lanes_of(D, skin.normal[s])
        square, crossed, pairs = pressed * lanes_of(D, skin.normal[s]), splat4(skin.area[s]) * products(lanes_of(D, skin.normal[s])), len(sums.beside) > 0
        ahead0, ahead1, ahead2 = item(way, 0), item(way, 1), item(way, 2)
        for i in range(n0):
            for j in range(n1):
                row, both = (place[0, i] * shape[1] + place[1, j]) * shape[2], slope[0, 0, i] * slope[0, 1, j]
                rest = both + ahead0 * slope[1, 0, i] * slope[0, 1, j] + ahead1 * slope[0, 0, i] * slope[1, 1, j]
                for k in range(n2):
                    n = number[np.uint64(row + place[2, k])]
                    if n < 0:
                        continue
                    weight, push = rest * slope[0, 2, k] + ahead2 * both * slope[1, 2, k], pressed
                    if mirrored:
                        push = pressed * load4(signs, WIDE * i) * load4(signs, WIDE * (n0 + j)) * load4(signs, WIDE * (2 * n0 + k))
                    store(lack, WIDE * n, fma(splat4(-weight), push, load4(lack, WIDE * n)))
                    w = splat4(both * slope[0, 2, k])
                    store(sums.diagonal, WIDE * n, fma(w, square, load4(sums.diagonal, WIDE * n)))
                    if pairs:
                        store(sums.beside, WIDE * n, fma(w, crossed, load4(sums.beside, WIDE * n)))
