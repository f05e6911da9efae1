"""The impulses of a step of a scene in slabs, by threads: the same bits for any number of them.

A contact belongs to the slab of its particle. The nodes that a slab may touch are those of integrate/step_threaded.py, so even slabs never meet, and an odd
one waits for the two beside it: each takes TURNS sweeps over its own contacts, and those that reach farther, or push a tool that forces move, come after all,
by one thread. It ends where a first sweep of every slab changes no speed by more than CLOSE of the largest: as solve.press, in another order.
"""

import numpy as np

from mpm.boundary import directions, extents
from mpm.contact.solve import CLOSE, FAINT, SWEEPS, begin, one, ready
from mpm.contact.spots import seen
from mpm.contact.weights import WIDE
from mpm.integrate.step_threaded import wave
from mpm.jit import kernel

PART = 256  # contacts that are weighed by one thread
TURNS = 4


@kernel
def homes(space, problem, starts, windows, inverse):
    """The slab of each contact (C,): M for those that come after all; -1 for those too far off. starts (B, M + 1); windows: axis, low (M,), high (M,)."""
    (axis, low, high), contacts, shape, M = windows, problem.contacts, extents(space), starts.shape[1] - 1
    stride = shape[1] * shape[2] if axis == 0 else shape[2] if axis == 1 else 1
    step = seen(space) ** (directions(space) - 1 - axis)  # between the nodes of a contact along the axis
    found = np.full(len(inverse), -1)
    for i in range(len(inverse)):
        if inverse[i] == 0.0:
            continue
        s, owner, first = 0, contacts.owner[i, 0], starts[contacts.body[i, 0]]
        while s < M - 1 and owner >= first[s + 1]:
            s += 1
        inside = contacts.free[i] < 0
        for k in range(2):
            if contacts.body[i, k] >= 0:
                for m in range(seen(space)):
                    n = problem.place[problem.at[i, k, m * step]] // stride % shape[axis]
                    inside = inside and low[s] <= n < high[s]
        found[i] = s if inside else M
    return found


@kernel
def start(space, problem, members, first, which):
    """The impulses of the step before, of the contacts of the slabs `which`: members[first[s]] and so on."""
    u = np.zeros(WIDE)
    for s in which:
        for i in members[first[s] : first[s + 1]]:
            begin(problem, i, directions(space), u)


@kernel
def relax(space, problem, members, first, which, limits, inverse, most):
    """TURNS sweeps over the contacts of the slabs `which`; most[:, s]: of the first, the largest change of a speed and speed. limits: dt, speed of sound."""
    D, u, (dt, sound) = directions(space), np.zeros(WIDE), limits
    for s in which:
        low, high = first[s], first[s + 1]
        for turn in range(TURNS):
            worst, largest = 0.0, FAINT / CLOSE * sound
            for k in range(high - low):
                changed, given = one(problem, members[low + k if turn % 2 == 0 else high - 1 - k], D, dt, sound, inverse, u)
                worst, largest = max(worst, changed), max(largest, given)
            if turn == 0:
                most[0, s], most[1, s] = worst, largest
            if worst <= CLOSE * largest:
                break


def press_in_slabs(space, problem, ahead, sound, touching, slabs, crew) -> None:
    """As solve.press."""
    count, starts, M = len(problem.impulse), slabs.starts, slabs.starts.shape[1] - 1
    inverse, most, order, last = np.zeros(count), np.zeros((2, M + 1)), wave(M), np.array([M])
    warm, rows, limits = touching.warm, touching.rows, (ahead, sound)

    def prepare(which):
        for part in which // 2:
            ready(space, problem, (int(part) * PART, min(count, (int(part) + 1) * PART)), ahead, warm, rows, inverse)

    crew.work(2 * np.arange(-(-count // PART)), prepare)
    home = homes(space, problem, starts, (slabs.axis, slabs.low, slabs.high), inverse)
    members = np.argsort(home, kind="stable")
    first = np.searchsorted(home[members], np.arange(M + 2))
    alone = first[M] < first[M + 1]
    crew.work(order, lambda which: start(space, problem, members, first, which))
    if alone:
        start(space, problem, members, first, last)
    for _ in range(SWEEPS // TURNS):
        crew.work(order, lambda which: relax(space, problem, members, first, which, limits, inverse, most))
        if alone:
            relax(space, problem, members, first, last, limits, inverse, most)
        if most[0].max() <= CLOSE * most[1].max():
            break
