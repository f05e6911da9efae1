"""The mechanical step where something is near: as integrate/explicit.py, with one velocity field a body or group of welded ones, and the contacts between
the nodes' update and the gather. Everything that goes over particles is the same code.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.boundary.blocks import mark_box, thin
from mpm.boundary.walls import empty, unfold
from mpm.contact.find import find_all, list_near
from mpm.contact.found import BODY, NEAR, STRAY, others, whole
from mpm.contact.held import hold
from mpm.contact.skin import lay_skins
from mpm.contact.solve import SURE, apart, pose, press, settle, speed_of
from mpm.contact.sums import add_up, hold_good, make_room
from mpm.contact.tools import arm, follow, move_tools, place_tools
from mpm.contact.weights import WIDE, weigh
from mpm.integrate.explicit import clean, pass_body, update
from mpm.integrate.fbar import average_all
from mpm.integrate.grid_heating import compress_all
from mpm.integrate.step_parts import Moment, field_buffers, scratch
from mpm.integrate.strain import SPEED
from mpm.integrate.xpic import sharpen
from mpm.jit import kernel
from mpm.transfer import wants_change

TOUCH = 0.05  # cells: a gap below it touches
SPARE = 0.05  # cells: a gap that is wider than this, SURE, and four times what any particle moves in a step, is not closed by one


class Touching(NamedTuple):
    """Who meets what, and what outlasts a step. B bodies, T tools, F fields, P pieces, R obstacles that are met; K = 6 + B + T."""

    first: np.ndarray  # (B + 1,) first piece of each body
    fields: np.ndarray  # (B,) velocity field of each body
    walls: np.ndarray  # (F, 3, 2) kinds of walls for each field: mirrors for those that started at them
    stops: np.ndarray  # (B, 3, 2) friction of the walls that a body meets, negative for others
    pairs: Any  # Pairs or NoPairs
    tools: Any  # Tools or NoTools
    rows: np.ndarray  # (K,) where an obstacle is kept below
    warm: np.ndarray  # (P, R, D) impulses of the last step [kg m/s]
    touched: np.ndarray  # (P, R) time in touch since the last heat step [s]
    pushed: np.ndarray  # (B, K, D) impulse on each body since the last record [kg m/s]
    turned: np.ndarray  # (B, K, 3) its moment about a tool's centre, or the origin of coordinates [kg m2/s]
    spread: np.ndarray  # (B, K) area in touch times time since the last record [m2 s]
    deepest: np.ndarray  # (B, K) largest overlap since the last record [m]
    worked: np.ndarray  # (1,) work of tools on bodies since the start [J]
    rubbed: np.ndarray  # (1,) work that friction has taken since the start [J]
    parted: np.ndarray  # (1,) work that pushed apart what overlapped since the start [J]
    number: np.ndarray  # (nodes,) scratch, -1
    room: np.ndarray  # (1,) contacts to make room for
    held: Any  # Held or NotHeld


class Pace(NamedTuple):
    """A block of steps."""

    dt: float
    kick: float  # how long the impulse of the first acts [s] (insync.py)
    ahead: float  # contacts are such that nothing overlaps by then; dt, but where velocities are only looked at (insync.py) [s]
    steps: int
    begun: int
    sound: float  # speed of the fastest wave [m/s]


@kernel
def advance_touching(method, bodies, touching, skin, sums, grids, gravity, pace, reports):
    """As explicit.advance with the nodes of every field. The sums of weights.py, as they are then."""
    shape, fields, steps, first = extents(method.space), len(touching.walls), pace.steps, field_buffers(grids, 0)
    chunk = scratch(method, bodies, first.nodes)
    for f in range(fields):
        empty(shape, grids.boxes[f, 0])
        empty(shape, grids.boxes[f, 1])
    sparse = True
    for step in range(-1, steps):
        opening, last, now = step < 0, step == steps - 1, step % 2
        if not opening:
            if not sparse:
                for f in range(fields):
                    mark_box(grids.blocks[f, now], directions(method.space), shape, grids.boxes[f, now])
            before_contacts(method, bodies, chunk, touching, grids, (step, now), gravity, pace)
            sums = meet(method, bodies, touching, skin, sums, grids, now, pace, reports)
            after_contacts(method, bodies, chunk, touching, grids, now, pace.dt, reports)
        moment = Moment(now, pace.kick if opening else pace.dt, step, pace.begun, opening, last, sparse)
        ok, b = True, 0
        for body in literal_unroll(bodies):
            ok = ok and pass_body(method, body, chunk, field_buffers(grids, touching.fields[b]), moment, reports[b])
            b += 1
        if not ok:
            break
        if opening:
            sparse = False
            for f in range(fields):
                sparse = sparse or thin(shape, grids.boxes[f, 1 - now], grids.blocks[f, 1 - now])
        else:
            for f in range(fields):
                clean(method, field_buffers(grids, f), now)
    return sums


@kernel
def before_contacts(method, bodies, chunk, touching, grids, when, gravity, pace):
    """The nodes of every field after step and buffer `when` were scattered, as if nothing touched; where tools stand."""
    step, now = when
    acts = pace.kick if step == 0 else pace.dt
    for f in range(len(touching.walls)):
        update(method, field_buffers(grids, f), now, touching.walls[f], gravity[step % len(gravity)], acts)
    hold(touching.held, method, grids, now, np.inf)
    if len(touching.walls) == 1:
        sharpen(method.scheme, method, bodies, chunk, field_buffers(grids, 0), now, touching.walls[0])
    place_tools(touching.tools, step, pace.ahead, acts)


@kernel
def after_contacts(method, bodies, chunk, touching, grids, now, dt, reports):
    """What is done to nodes whose contacts are solved."""
    move_tools(touching.tools, dt)
    hold(touching.held, method, grids, now, 1.0)
    if len(touching.walls) == 1:
        first, walls = field_buffers(grids, 0), touching.walls[0]
        nodes, box = first.nodes[now], first.boxes[now]
        average_all(method.space, method.gradient, bodies, chunk, nodes, box, walls, dt)
        compress_all(method.space, method.gradient, bodies, chunk, nodes, box, walls, dt, reports)


@kernel
def meet(method, bodies, touching, skin, sums, grids, now, pace, reports):
    """One step's contacts, on the nodes of buffer `now`; and the books of it. The sums of weights.py, as they are then."""
    fastest = 0.0
    for report in reports:
        fastest = max(fastest, report[SPEED])
    space, (contacts, count) = method.space, seek(method.space, bodies, touching, skin, sums, fastest**0.5 * pace.dt)
    if count > 0:
        nodes = grids.nodes[:, now]
        if not hold_good(space, touching.walls, touching.fields, sums, contacts, count, touching.number):
            sums = make_room(space, touching.walls, touching.fields, sums, contacts, count, touching.number)
            add_up(space, method.gradient, bodies, touching.walls, touching.fields, skin, sums, touching.number)
        problem = pose(space, touching.walls, touching.fields, contacts, count, nodes, touching.tools, touching.number)
        weigh(space, method.gradient, touching.walls, touching.fields, skin, sums, problem, touching.number)
        press(space, problem, pace.ahead, pace.sound, touching.warm, touching.rows)
        finish(method, touching, skin, sums, grids, now, pace, problem)
    return sums


@kernel
def seek(space, bodies, touching, skin, sums, travel):
    """(contacts, how many) of the present positions; no particle has moved farther than `travel` [m] since the step before."""
    skin.left[0] -= travel
    skin.sight[0] = (SURE + SPARE) * space.h + 4.0 * travel if travel > 0.0 else NEAR * space.h  # a block begins with what is not known
    if skin.left[0] >= 0.0:
        lay_skins(space, bodies, skin, skin.near, skin.starts)
    else:
        lay_skins(space, bodies, skin, skin.every, skin.first)
        list_near(space, bodies, skin, touching.stops, not (others(touching.pairs) or others(touching.tools)))
    found, count = find_all(space, bodies, skin, touching.stops, touching.pairs, touching.tools, touching.room, NEAR, touching.number)
    if count == 0:
        touching.warm[:], sums.moved[0] = 0.0, np.inf
    return found, count


@kernel
def finish(method, touching, skin, sums, grids, now, pace, problem):
    """Nodes and books after the impulses are found."""
    space, nodes, force = method.space, grids.nodes[:, now], grids.force[:, now]
    D, shape = directions(space), extents(space)
    sums.moved[0] += pace.dt * settle(space, problem, nodes, force)
    if keep_books(space, touching, skin, problem, pace):
        for f in range(len(touching.walls)):
            unfold(nodes[f], D, shape, grids.boxes[f, now], touching.walls[f], grids.blocks[f, now])
            if wants_change(method.scheme):
                unfold(force[f], D, shape, grids.boxes[f, now], touching.walls[f], grids.blocks[f, now])


@kernel
def keep_books(space, touching, skin, problem, pace):
    """Impulses for the next step, and what the records want to know. Whether anything was pressed."""
    D, B, pressed, contacts, impulse = directions(space), len(touching.first) - 1, False, problem.contacts, problem.impulse
    way, moment, goes, slip = np.zeros(3), np.zeros(3), np.zeros(D), np.zeros(WIDE)
    dt = pace.dt
    forget_warm(touching.warm, skin.near[: skin.starts[-1]], skin.left[0] < STRAY * space.h)
    for i in range(len(impulse)):
        s, row, along, size = contacts.piece[i], touching.rows[contacts.against[i]], 0.0, 0.0
        for c in range(D):
            size = max(size, abs(impulse[i, c]))
        if size == 0.0 and contacts.gap[i] > TOUCH * space.h:
            continue
        a, b, to = contacts.body[i, 0], contacts.body[i, 1], contacts.against[i]
        arm(touching.tools, to - BODY - B if to >= BODY + B else -1, contacts.point[i, 0], way)
        cross(way, impulse[i], moment)
        for c in range(D):
            goes[c] = contacts.given[i, c]
        follow(touching.tools, contacts.free[i], goes)
        for c in range(D):
            touching.worked[0] += impulse[i, c] * goes[c]
            along += impulse[i, c] * contacts.normal[i, c]
            touching.pushed[a, to, c] += impulse[i, c]
            if b >= 0:
                touching.pushed[b, BODY + a, c] -= impulse[i, c]
        if contacts.mu[i] > 0.0 and along > 0.0:
            speed_of(problem, i, D, slip)
            for c in range(D):
                touching.rubbed[0] -= (impulse[i, c] - along * contacts.normal[i, c]) * slip[c]
        for c in range(3):
            touching.turned[a, to, c] += moment[c]
            if b >= 0:
                touching.turned[b, BODY + a, c] -= moment[c]
        pressed = pressed or along > 0.0
        touching.parted[0] += along * apart(contacts.gap[i], pace.ahead, pace.sound)
        touching.deepest[a, to] = max(touching.deepest[a, to], -contacts.gap[i])
        total, touches = whole(contacts, skin.area, i) if contacts.mates[i] >= 0 else 0.0, along > 0.0 or contacts.gap[i] <= TOUCH * space.h
        more = contacts.mates[i]
        while s >= 0:
            part = skin.area[s] / total if total > 0.0 else 1.0
            for c in range(D):
                touching.warm[s, row, c] = part * impulse[i, c]
            if contacts.balanced[i, 0] and touches:
                touching.touched[s, row] += dt
                touching.spread[a, to] += skin.area[s] * dt
            s, more = more, contacts.after[more] if more >= 0 else -1
    return pressed


@kernel(inline=True)
def forget_warm(warm, near, listed):
    """No impulses: of the pieces `near` alone where those were `listed` before this step, as no other bore any in the one before."""
    if not listed:
        warm[:] = 0.0
        return
    for s in near:
        for row in range(warm.shape[1]):
            for c in range(warm.shape[2]):
                warm[s, row, c] = 0.0


@kernel(inline=True)
def cross(x, v, out):
    """out (3,) = x cross v, of vectors in a plane or in space."""
    a, b, c = v[0], v[1] if len(v) > 1 else 0.0, v[2] if len(v) > 2 else 0.0
    out[0], out[1], out[2] = x[1] * c - x[2] * b, x[2] * a - x[0] * c, x[0] * b - x[1] * a
