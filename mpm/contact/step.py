"""The mechanical step where something is near: as integrate/explicit.py, with one velocity field a body or group of welded ones, and the contacts between
the nodes' update and the gather. Everything that goes over particles is the same code.
"""

from typing import NamedTuple

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.boundary.walls import empty, unfold
from mpm.contact.find import NEAR, find_all
from mpm.contact.skin import lay_skins, new_skin
from mpm.contact.solve import press
from mpm.contact.weights import weigh
from mpm.integrate.explicit import clean, pass_body, update
from mpm.integrate.fbar import any_averages, average_all
from mpm.integrate.grid_heating import compress_all
from mpm.integrate.xpic import sharpen
from mpm.jit import kernel
from mpm.transfer import new_chunk, uses_basis_gradient, wants_change

TOUCH = 0.05  # cells: a gap below it touches


class Touching(NamedTuple):
    """Who meets what, and what outlasts a step. B bodies, F fields, P pieces, R obstacles that are met."""

    first: np.ndarray  # (B + 1,) first piece of each body
    fields: np.ndarray  # (B,) velocity field of each body
    walls: np.ndarray  # (F, 3, 2) kinds of walls for each field: mirrors for those that started at them
    stops: np.ndarray  # (B, 3, 2) friction of the walls that a body meets, negative for others
    pairs: np.ndarray  # (B, B) friction of the bodies that a body meets, negative for others
    rows: np.ndarray  # (6 + B,) where an obstacle is kept below
    warm: np.ndarray  # (P, R, D) impulses of the last step [kg m/s]
    touched: np.ndarray  # (P, R) time in touch since the last heat step [s]
    pushed: np.ndarray  # (B, 6 + B, D) impulse on each body since the last record [kg m/s]
    deepest: np.ndarray  # (1,) largest overlap since the last record [m]
    number: np.ndarray  # (nodes,) scratch, -1
    room: np.ndarray  # (1,) contacts to make room for


@kernel
def advance_touching(space, gradient, scheme, bodies, touching, nodes, force, boxes, blocks, gravity, dt, kick, ahead, steps, begun, sound, reports):
    """As explicit.advance with nodes and force (F, 2, n, columns), boxes (F, 2, 3, 2), blocks (F, 2, marks); sound: speed of the fastest wave [m/s].

    ahead [s]: contacts are such that nothing overlaps by then; dt, but where velocities are only looked at (insync.py).
    """
    chunk = new_chunk(gravity.shape[0], nodes[0], uses_basis_gradient(gradient) or any_averages(bodies), wants_change(scheme))
    change, shape, fields = np.zeros_like(chunk.v), extents(space), len(touching.walls)
    skin = new_skin(gravity.shape[0], touching.first)
    for f in range(fields):
        empty(shape, boxes[f, 0])
        empty(shape, boxes[f, 1])
    for step in range(-1, steps):
        opening, last, now = step < 0, step == steps - 1, step % 2
        if not opening:
            for f in range(fields):
                acts = kick if step == 0 else dt
                update(space, scheme, nodes[f, now], force[f, now], boxes[f, now], blocks[f, now], touching.walls[f], gravity, acts)
            here, there, walls = nodes[0], force[0], touching.walls[0]
            if fields == 1:
                sharpen(scheme, space, gradient, bodies, chunk, here[now], there[now], here[1 - now], there[1 - now], boxes[0, now], blocks[0, now], walls)
            meet(space, gradient, scheme, bodies, touching, skin, nodes, force, boxes, blocks, now, ahead, sound)
            if fields == 1:
                average_all(space, gradient, bodies, chunk, here[now], boxes[0, now], walls, dt)
                compress_all(space, gradient, bodies, chunk, here[now], boxes[0, now], walls, dt, reports)
        ok, b, push = True, 0, kick if opening else dt
        for body in literal_unroll(bodies):
            f = touching.fields[b]
            ok = ok and pass_body(space, gradient, scheme, body, chunk, change, nodes[f], force[f], boxes[f], blocks[f], True, now, push, step, begun,
                                  opening, last, reports[b])  # fmt: skip
            b += 1
        if not ok:
            return
        if not opening:
            for f in range(fields):
                clean(space, scheme, nodes[f, now], force[f, now], boxes[f, now], blocks[f, now])


@kernel
def meet(space, gradient, scheme, bodies, touching, skin, nodes, force, boxes, blocks, now, dt, sound):
    """One step's contacts, on the nodes of buffer `now`; and the books of it."""
    lay_skins(space, bodies, skin)
    contacts, count = find_all(space, bodies, skin, touching.stops, touching.pairs, touching.room, NEAR)
    if count == 0:
        touching.warm[:] = 0.0
        return
    at, coef = weigh(space, gradient, bodies, touching.fields, touching.walls, skin, contacts, count, nodes, now, touching.number)
    impulse = press(space, contacts, count, at, coef, touching.fields, nodes, force, now, dt, sound, touching.warm, touching.rows)
    D, shape, pressed = directions(space), extents(space), False
    touching.warm[:] = 0.0
    for i in range(count):
        s, row, along = contacts.piece[i], touching.rows[contacts.against[i]], 0.0
        for c in range(D):
            along += impulse[i, c] * contacts.normal[i, c]
            touching.pushed[contacts.body[i, 0], contacts.against[i], c] += impulse[i, c]
            if contacts.body[i, 1] >= 0:
                touching.pushed[contacts.body[i, 1], 6 + contacts.body[i, 0], c] -= impulse[i, c]
            if s >= 0:
                touching.warm[s, row, c] = impulse[i, c]
        pressed = pressed or along > 0.0
        touching.deepest[0] = max(touching.deepest[0], -contacts.gap[i])
        if contacts.balanced[i, 0] and (along > 0.0 or contacts.gap[i] <= TOUCH * space.h):
            touching.touched[s, row] += dt
    if pressed:
        for f in range(len(touching.walls)):
            unfold(nodes[f, now], D, shape, boxes[f, now], touching.walls[f], blocks[f, now])
            if wants_change(scheme):
                unfold(force[f, now], D, shape, boxes[f, now], touching.walls[f], blocks[f, now])
