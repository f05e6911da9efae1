"""The mechanical step where something is near, of a scene in slabs: integrate/step_threaded.py with the contacts of step.py between scatter and gather.

What a contact needs of the particles near it goes by slabs too, even ones before odd ones, and its weights go by parts of the contacts: any number of
threads gives the same bits. So do the impulses (solve_threaded.py). Which pieces are near is one thread's.
"""

import numpy as np

from mpm.boundary import CONTACT, extents
from mpm.contact.skin import lay_skins
from mpm.contact.solve import pose
from mpm.contact.solve_threaded import PART, press_in_slabs
from mpm.contact.step import after_contacts, before_contacts, finish, seek
from mpm.contact.sums import fall_short, forget, hold_good, lean_all, make_room, pieces_within, recall
from mpm.contact.weights import seats, shares
from mpm.integrate.step_parts import method_of, scratch
from mpm.integrate.step_threaded import steps_in_slabs, wave
from mpm.integrate.strain import SPEED
from mpm.jit import kernel
from mpm.state import PAD


@kernel
def new_scratch(method, bodies, grids):
    """A chunk for passes over the nodes of the first field."""
    return scratch(method, bodies, grids.nodes[0])


def advance_touching_slabs(scene, met, grids, pace, reports) -> bool:
    """As step.advance_touching, for a meeting. Whether a chunk was late (integrate/step_threaded.py)."""
    method, bodies, touching, skin = method_of(scene), scene.for_motion, met.touching, met.skin
    chunk = new_scratch(method, bodies, grids)

    def between(step, now, _, slabs, crew):
        before_contacts(method, bodies, chunk, touching, grids, (step, now), scene.gravity, pace)
        sums = met.sums
        contacts, count = seek(scene.space, bodies, touching, skin, sums, pace.dt * float(slabs.reports[..., SPEED].max()) ** 0.5)
        if count > 0:
            nodes = grids.nodes[:, now]
            if not hold_good(scene.space, touching.walls, touching.fields, sums, contacts, count, touching.number):
                met.sums = sums = make_room(scene.space, touching.walls, touching.fields, sums, contacts, count, touching.number)
                add_up_in_slabs(scene, touching, skin, sums, slabs, crew)
            problem = pose(scene.space, touching.walls, touching.fields, contacts, count, nodes, touching.tools, touching.number)
            weigh_in_slabs(scene, touching, skin, sums, problem, crew)
            press_in_slabs(scene.space, problem, pace.ahead, pace.sound, touching, slabs, crew)
            finish(method, touching, skin, sums, grids, now, pace, problem)
        after_contacts(method, bodies, chunk, touching, grids, now, pace.dt, slabs.reports[-1])

    return steps_in_slabs(scene, method, grids, touching.fields, between, (pace.dt, pace.kick, pace.steps, pace.begun), True, reports)


def apart(scene, walls, slabs) -> bool:
    """Whether no two slabs of a kind act on one node: none has strays, and only the first two and the last two reach what stands for ghosts of a mirror."""
    axis, reach, mirrored = slabs.axis, scene.order.reach, (walls[:, slabs.axis] < CONTACT).any(axis=0)
    low, high = 2 * PAD, extents(scene.space)[axis] - 1 - 2 * PAD
    return not (slabs.strays.any() or (mirrored[0] and (reach[2:, 0] <= low).any()) or (mirrored[1] and (reach[:-2, 1] > high).any()))


def add_up_in_slabs(scene, touching, skin, sums, slabs, crew) -> None:
    """sums.add_up, by threads; where slabs are not `apart`, by one, in the same order."""
    space, number, order = scene.space, touching.number, wave(slabs.starts.shape[1] - 1)
    pieces = pieces_within(space, skin, sums)
    lay_skins(space, scene.for_motion, skin, *pieces)
    for b, body in enumerate(scene.for_motion):
        walls = touching.walls[touching.fields[b]]

        def add(which, walls=walls, b=b, body=body):
            for s in which:
                part = int(slabs.starts[b, s]), int(slabs.starts[b, s + 1])
                fall_short(space, scene.gradient, body.particles, b, walls, skin, pieces, sums, number, part)

        if sums.first[b] < sums.first[b + 1]:
            recall(sums, b, number)
            if apart(scene, touching.walls, slabs):
                crew.work(order, add)
            else:
                add(order)
            forget(sums, b, number)
    lean_all(space, sums)


def weigh_in_slabs(scene, touching, skin, sums, problem, crew) -> None:
    """weights.weigh, by threads."""
    space, count = scene.space, len(problem.impulse)
    parts = 2 * np.arange(-(-count // PART))  # even: they wait for nobody
    for b, f in enumerate(touching.fields):
        seat = seats(sums, b, f, problem, touching.number)

        def share(which, f=f, b=b, seat=seat):
            for part in which // 2:
                some = int(part) * PART, min(count, (int(part) + 1) * PART)
                shares(space, scene.gradient, b, touching.walls[f], skin, sums, seat, problem, some)

        crew.work(parts, share)
