"""The mechanical step of a large scene in slabs, by threads: the same bits for any number of them.

The nodes are cut across one axis into slabs, each wider than a stencil reaches; the particles of a slab lie together (sorting.py). What a slab scatters
reaches into the slabs beside it and no farther, so even slabs never meet, and an odd one waits for the two beside it: every node adds up the even slab, then
the odd one, each in the order of its particles, whichever thread does what and when. Gathers only read. Reports are put together in the order of the slabs.

Particles drift between sorts. A slab may touch nodes up to half way to where the next slab but one reached in the step before; a chunk that would touch more is
kept in its particles, and scattered after all slabs, by one thread: `late`. So no drift is too fast to be right; a block with late chunks is sorted anew.
Nodal passes of schemes that want them (XPIC, F-bar, heating on the grid) are one thread's. Contacts: contact/step_threaded.py; heat: heat_threaded.py.
"""

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numba import literal_unroll

from mpm.basis import stencil
from mpm.boundary import extents
from mpm.boundary.blocks import thin
from mpm.boundary.walls import empty
from mpm.integrate.active_nodes import SLACK, reaches, touch
from mpm.integrate.dither import dither
from mpm.integrate.explicit import clean, on_nodes, step_chunk
from mpm.integrate.step_parts import Grids, Moment, field_buffers, scratch
from mpm.integrate.strain import CODE, DISSIPATED, HEATED, PARTICLE, RATE, SOURCED, SPEED, STEP, STRAIN, SWELL, SWELLED, WORKED
from mpm.jit import kernel
from mpm.lanes import EIGHT, least, load8, maximum, minimum, most
from mpm.transfer import CHUNK, deliver, spread

STILL, LATE = 0, 1


class Slabs(NamedTuple):
    """What the threads share. M slabs, B bodies, F velocity fields."""

    axis: int
    fields: np.ndarray  # (B,) field of each body
    starts: np.ndarray  # (B, M + 1) first particle of each slab
    low: np.ndarray  # (M,) nodes that a slab may touch: low <= node < high along the axis
    high: np.ndarray  # (M,)
    late: np.ndarray  # (B, N) whether the chunk that begins at a particle is to be scattered after all slabs
    strays: np.ndarray  # (M,) how many such chunks a slab has
    boxes: np.ndarray  # (M + 1, F, 3, 2) nodes touched; the last: by late chunks
    reports: np.ndarray  # (M + 1, B, REPORT)


@kernel
def pass_slabs(method, bodies, slabs, which, grids, moment, late):
    """Gather from buffer `now`, respond, and scatter on to the other, for the slabs `which`, one after another; of `late` chunks what is left of it."""
    chunk = scratch(method, bodies, grids.nodes[0])
    for s in which:
        if not late:
            for f in range(slabs.boxes.shape[1]):
                empty(extents(method.space), slabs.boxes[s, f])
            slabs.strays[s] = 0
        b = 0
        for body in literal_unroll(bodies):
            pass_part(method, body, chunk, slabs, s, b, field_buffers(grids, slabs.fields[b]), moment, late)
            b += 1


@kernel
def pass_part(method, body, chunk, slabs, s, b, buffers, moment, after):
    """One body's part of a slab, on the nodes of its field."""
    row = slabs.strays.shape[0] if after else s
    space, now, report, box = method.space, moment.now, slabs.reports[row, b], slabs.boxes[row, slabs.fields[b]]
    here, push, there, pushed = buffers.nodes[now], buffers.force[now], buffers.nodes[1 - now], buffers.force[1 - now]
    x, late, begin, end = body.particles.x, slabs.late[b], slabs.starts[b, s], slabs.starts[b, s + 1]
    part = Moment(now, moment.dt, moment.step, moment.begun, moment.opening or after, moment.last, moment.sparse)
    reach, shake = reaches(space, 0 if moment.last else end - begin), dither(space, x, moment.begun + moment.step)
    for first in range(begin, end, CHUNK):
        if after and late[first] == STILL:
            continue
        count = min(CHUNK, end - first)
        if not step_chunk(method, body, chunk, (here, push), part, first, count, shake, report):
            return
        if moment.last:
            continue
        if after or within(space, chunk, slabs.axis, count, slabs.low[s], slabs.high[s]):
            late[first] = STILL
            spread(method.scheme, space, method.gradient, x, first, chunk, count, there, pushed, reach[(first - begin) // CHUNK])
        else:
            deliver(body.particles, first, chunk, count)
            late[first] = LATE
            slabs.strays[s] += 1
    touch(space, x, begin, end, reach, box, buffers.blocks[1 - now], moment.sparse)


@kernel
def within(space, chunk, axis, count, low, high):
    """Whether the particles of a chunk touch nodes low <= node < high only."""
    row = axis * chunk.place.shape[1]
    leftmost = rightmost = load8(chunk.place, row)
    for p in range(EIGHT, count, EIGHT):
        here = load8(chunk.place, row + p)
        leftmost, rightmost = minimum(here, leftmost), maximum(here, rightmost)
    inverse = 1.0 / space.h
    first = stencil(space.basis, least(leftmost) * inverse - SLACK)[0]
    last, w, _, _, _ = stencil(space.basis, most(rightmost) * inverse + SLACK)
    return low <= first and last + len(w) <= high


@kernel
def nodal_phase(method, bodies, buffers, now, sparse, walls, gravity, times, reports):
    """What is done to the nodes between scatter and gather."""
    on_nodes(method, bodies, scratch(method, bodies, buffers.nodes), buffers, now, sparse, walls, gravity, times, reports)


def advance_slabs(scene, method, buffers, dt, kick, steps, begun, reports) -> bool:
    """`steps` steps of `dt`, as explicit.advance, of a scene whose particles lie in slabs (scene.order). Whether a chunk was late."""

    def between(step, now, sparse, slabs, crew):
        gravity = scene.gravity[step % len(scene.gravity)]
        nodal_phase(method, scene.for_motion, buffers, now, sparse, scene.walls, gravity, (dt, kick if step == 0 else dt), slabs.reports[-1])

    grids = Grids(*(array[None] for array in buffers))
    return steps_in_slabs(scene, method, grids, np.zeros(len(reports), np.int64), between, (dt, kick, steps, begun), False, reports)


def steps_in_slabs(scene, method, grids, fields, between, pace, marked, reports) -> bool:
    """Steps of slabs on the nodes of several fields: (dt, kick, steps, begun) = pace. Whether a chunk was late.

    between(step, now, sparse, slabs, crew): what is done to the nodes between scatter and gather; marked: it wants to know which were touched.
    """
    bodies, shape, starts, axis, (dt, kick, steps, begun) = scene.for_motion, extents(scene.space), scene.order.starts, scene.order.axis, pace
    M, F, boxes = starts.shape[1] - 1, len(grids.nodes), grids.boxes
    largest = max(len(body.particles.m) for body in bodies)
    slabs = Slabs(
        axis, fields, starts, np.zeros(M, np.int64), np.zeros(M, np.int64), np.zeros((len(bodies), largest), np.uint8), np.zeros(M, np.int64),
        np.zeros((M + 1, F, 3, 2), np.int64), np.repeat(reports[None], M + 1, axis=0),
    )  # fmt: skip
    reach = scene.order.reach
    order, strayed, sparse = wave(M), False, True
    for box in boxes.reshape(-1, 3, 2):
        empty(shape, box)
    with Crew(min(scene.threads, M)) as crew:
        for step in range(-1, steps):
            opening, last, now = step < 0, step == steps - 1, max(step, -1) % 2
            if not opening:
                between(step, now, sparse, slabs, crew)
            share_out(reach, slabs)
            moment = Moment(now, kick if opening else dt, step, begun, opening, last, sparse)
            crew.work(order, lambda which, m=moment: pass_slabs(method, bodies, slabs, which, grids, m, False))
            for box in slabs.boxes[M]:
                empty(shape, box)
            if slabs.strays.any() and not (slabs.reports[..., CODE] != 0).any():
                strayed = True
                pass_slabs(method, bodies, slabs, np.flatnonzero(slabs.strays), grids, moment, True)
            if (slabs.reports[..., CODE] != 0).any():
                break
            for f in range(F if not opening else 0):
                clean(method, field_buffers(grids, f), now)
            if not last:
                boxes[:, 1 - now, :, 0], boxes[:, 1 - now, :, 1] = slabs.boxes[..., 0].min(axis=0), slabs.boxes[..., 1].max(axis=0)
                used = np.stack([slabs.boxes[:M, :, axis, 0].min(axis=1), slabs.boxes[:M, :, axis, 1].max(axis=1)], axis=1)
                reach[used[:, 1] > used[:, 0]] = used[used[:, 1] > used[:, 0]]
            if opening:
                sparse = marked or bool(thin(shape, boxes[0, 1 - now], grids.blocks[0, 1 - now]))
    for b, report in enumerate(reports):
        together(report, slabs.reports[:, b])
    return strayed


def share_out(reach: np.ndarray, slabs: Slabs) -> None:
    """What each slab may touch: half way to the reach of the next slab but one."""
    between = np.maximum.accumulate((reach[:-2, 1] + reach[2:, 0]) // 2)  # rising: the next slab but two is out of reach too
    slabs.low[:2], slabs.high[-2:] = -(10**9), 10**9
    slabs.low[2:], slabs.high[:-2] = between, between


def together(report: np.ndarray, found: np.ndarray) -> None:
    """The report of a body from those of the slabs (M + 1, REPORT), in their order; the first failure."""
    failed = np.flatnonzero(found[:, CODE])
    if len(failed):
        report[[CODE, PARTICLE, STEP]] = found[failed[0]][[CODE, PARTICLE, STEP]]
    for place in (SPEED, RATE, SWELL):
        report[place] = found[:, place].max()
    report[STRAIN] = found[:, STRAIN].min()
    for place in (HEATED, DISSIPATED, WORKED, SWELLED, SOURCED):
        report[place] = sum(found[:, place].tolist())


def wave(M: int) -> np.ndarray:
    """Slabs in an order in which an odd one comes soon after the two beside it: 0 2 1 4 3 ..."""
    return np.array(sorted(range(M), key=lambda s: s + 1.5 * (s % 2)))


class Crew:
    """Threads that work on slabs together."""

    def __init__(self, threads: int):
        self.threads = threads
        self.pool = ThreadPoolExecutor(threads - 1) if threads > 1 else None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.pool is not None:
            self.pool.shutdown()

    def work(self, order: np.ndarray, call) -> None:
        """call(array of slabs) for all of them, an odd one after the two beside it; alone in that order, in company as soon as they may."""
        if self.pool is None:
            call(order)
            return
        todo, done, changed = order.tolist(), set(), threading.Condition()

        def ready(s: int) -> bool:
            return s % 2 == 0 or {t for t in (s - 1, s + 1) if t < len(order)} <= done

        def take() -> int | None:
            with changed:
                while todo:
                    s = next((s for s in todo if ready(s)), None)
                    if s is not None:
                        todo.remove(s)
                        return s
                    changed.wait()
            return None

        def run() -> None:
            while (s := take()) is not None:
                try:
                    call(np.array([s]))
                except BaseException:
                    with changed:
                        todo.clear()
                        changed.notify_all()
                    raise
                with changed:
                    done.add(s)
                    changed.notify_all()

        company = [self.pool.submit(run) for _ in range(self.threads - 1)]
        run()
        for one in company:
            one.result()
