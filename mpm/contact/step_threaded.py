"""The mechanical step where something is near, of a scene in slabs: integrate/step_threaded.py with the contacts of step.py between scatter and gather.

What a contact needs of the particles near it goes by slabs too, even ones before odd ones, and its weights go by parts of the contacts: any number of
threads gives the same bits. So do the impulses (solve_threaded.py). Which pieces are near is one thread's.
"""

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.contact.skin import new_skin
from mpm.contact.solve import pose
from mpm.contact.solve_threaded import PART, press_in_slabs
from mpm.contact.step import after_contacts, before_contacts, finish, seek
from mpm.contact.weights import fall_short, mark, new_weights, shares, unmark
from mpm.integrate.step_parts import method_of, scratch
from mpm.integrate.step_threaded import steps_in_slabs, wave
from mpm.jit import kernel
from mpm.state import PAD


@kernel
def new_scratch(method, bodies, grids):
    """A chunk for passes over the nodes of the first field."""
    return scratch(method, bodies, grids.nodes[0])


def advance_touching_slabs(scene, touching, grids, pace, reports) -> bool:
    """As step.advance_touching. Whether a chunk was late (integrate/step_threaded.py)."""
    method, bodies, skin = method_of(scene), scene.for_motion, new_skin(directions(scene.space), touching.first)
    chunk = new_scratch(method, bodies, grids)

    def between(step, now, _, slabs, crew):
        before_contacts(method, bodies, chunk, touching, grids, (step, now), scene.gravity, pace)
        contacts, count = seek(scene.space, bodies, touching, skin)
        if count > 0:
            nodes = grids.nodes[:, now]
            weights = weigh_in_slabs(scene, touching, skin, (contacts, count), nodes, slabs, crew)
            problem = pose(scene.space, contacts, count, weights, touching.fields, nodes, touching.tools, touching.number)
            press_in_slabs(scene.space, problem, pace.ahead, pace.sound, touching, slabs, crew)
            finish(method, touching, skin, grids, now, pace, problem)
        after_contacts(method, bodies, chunk, touching, grids, now, pace.dt, slabs.reports[-1])

    return steps_in_slabs(scene, method, grids, touching.fields, between, (pace.dt, pace.kick, pace.steps, pace.begun), True, reports)


def apart(scene, walls, slabs) -> bool:
    """Whether no two slabs of a kind act on one node: none has strays, and only the first two and the last two reach what stands for ghosts of a mirror."""
    axis, reach, mirrored = slabs.axis, scene.order.reach, (walls[:, slabs.axis] < CONTACT).any(axis=0)
    low, high = 2 * PAD, extents(scene.space)[axis] - 1 - 2 * PAD
    return not (slabs.strays.any() or (mirrored[0] and (reach[2:, 0] <= low).any()) or (mirrored[1] and (reach[:-2, 1] > high).any()))


def weigh_in_slabs(scene, touching, skin, near, nodes, slabs, crew):
    """weights.weigh, by threads; where slabs are not `apart`, by one, in the same order."""
    (contacts, count), space, gradient, number = near, scene.space, scene.gradient, touching.number
    weights, order = new_weights(space, count), wave(slabs.starts.shape[1] - 1)
    parts = 2 * np.arange(-(-count // PART))  # even: they wait for nobody
    for b, body in enumerate(scene.for_motion):
        f = touching.fields[b]
        box, short = mark(space, b, touching.walls[f], contacts, count, number)

        def add(which, f=f, b=b, body=body, box=box, short=short):
            for s in which:
                some = int(slabs.starts[b, s]), int(slabs.starts[b, s + 1])
                fall_short(space, gradient, body.particles, b, touching.walls[f], skin, box, number, short, some)

        def share(which, f=f, b=b, short=short):
            for part in which // 2:
                some = int(part) * PART, min(count, (int(part) + 1) * PART)
                shares(space, gradient, b, touching.walls[f], contacts, some, nodes[f], number, short, weights)

        if len(short[0]) > 0:
            if apart(scene, touching.walls, slabs):
                crew.work(order, add)
            else:
                add(order)
        crew.work(parts, share)
        unmark(contacts, b, count, number, weights)
    return weights
