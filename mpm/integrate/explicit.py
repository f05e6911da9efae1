"""The mechanical step, chunk by chunk: leapfrog, velocities in the middle of steps, positions at their ends (docs/physics.md 4; contact/insync.py).

open      particles, if they are sound -> nodes
each step nodes: v = p/m + dt g, walls (XPIC: its extra transfers)
          each chunk: gather v, L -> carry (APIC, FLIP, XPIC) -> F-bar -> move -> respond (strain, flow, stress) -> scatter on to the other nodes
          clear these nodes, swap
A chunk of particles stays in the first-level cache from gather to scatter.
"""

import numpy as np
from numba import literal_unroll

from mpm.basis import room
from mpm.boundary import directions, extents
from mpm.boundary.blocks import BLOCK, forget, mark_box, run, span, thin, wipe
from mpm.boundary.walls import empty, fold, impose, unfold
from mpm.integrate.active_nodes import reaches, touch
from mpm.integrate.dither import dither
from mpm.integrate.fbar import average_all, relax
from mpm.integrate.grid_heating import compress_all
from mpm.integrate.nozzle import act
from mpm.integrate.particle_update import respond
from mpm.integrate.state_check import sound
from mpm.integrate.step_parts import Moment, scratch
from mpm.integrate.strain import CODE, PARTICLE, SPEED, STEP
from mpm.integrate.xpic import sharpen
from mpm.jit import kernel
from mpm.lanes import EIGHT, below, fetch_ahead, fma, four, least, load4, load8, maximum, most, peek, poke, splat4, splat8, store
from mpm.outcome import LEFT_GRID, NON_FINITE, UNSOUND
from mpm.state import PAD
from mpm.transfer import CHUNK, carry, collect, fetch, lay_down, pick_up, spread, wants_change


@kernel
def advance(method, bodies, buffers, walls, gravity, dt, kick, steps, begun, reports):
    """`steps` steps of `dt` of all bodies on one grid, after `begun` steps of the run. kick: how long the impulse of the first acts (contact/insync.py).

    walls (3, 2) kinds, gravity (1 or steps, D) [m/s2], reports (bodies, REPORT): see particle_update.py. Returns early where a particle fails.
    """
    shape, chunk, sparse = extents(method.space), scratch(method, bodies, buffers.nodes), True
    empty(shape, buffers.boxes[0])
    empty(shape, buffers.boxes[1])
    for step in range(-1, steps):
        opening, last, now = step < 0, step == steps - 1, step % 2  # variables all: Numba compiles a callee once for every literal argument
        if not opening:
            on_nodes(method, bodies, chunk, buffers, now, sparse, walls, gravity[step % len(gravity)], (dt, kick if step == 0 else dt), reports)
        moment = Moment(now, kick if opening else dt, step, begun, opening, last, sparse)
        if not pass_all(method, bodies, chunk, buffers, moment, reports):
            return
        if opening:
            sparse = thin(shape, buffers.boxes[1 - now], buffers.blocks[1 - now])
        else:
            clean(method, buffers, now)


@kernel(inline=True)
def clean(method, buffers, now):
    """Zero the nodes that were used, for the scatter after next; empty their box and take their marks away."""
    shape, box, blocks = extents(method.space), buffers.boxes[now], buffers.blocks[now]
    if wants_change(method.scheme):
        wipe(buffers.force[now], shape, box, blocks)
    wipe(buffers.nodes[now], shape, box, blocks)
    forget(shape, box, blocks)
    empty(shape, box)


@kernel(inline=True)
def on_nodes(method, bodies, chunk, buffers, now, sparse, walls, gravity, times, reports):
    """What is done to the nodes of buffer `now` between scatter and gather; times: dt, and for how long the impulse acts."""
    dt, kick = times
    space, gradient, nodes, box = method.space, method.gradient, buffers.nodes[now], buffers.boxes[now]
    if not sparse:
        mark_box(buffers.blocks[now], directions(space), extents(space), box)
    update(method, buffers, now, walls, gravity, kick)
    sharpen(method.scheme, method, bodies, chunk, buffers, now, walls)
    average_all(space, gradient, bodies, chunk, nodes, box, walls, dt)
    compress_all(space, gradient, bodies, chunk, nodes, box, walls, dt, reports)


@kernel(inline=True)
def pass_all(method, bodies, chunk, buffers, moment, reports):
    """Gather from buffer `now` (unless it is the opening of a run), respond, and scatter on to the other (unless it is the last step).

    False where a particle fails.
    """
    ok, b = True, 0
    for body in literal_unroll(bodies):  # bodies of several types: Numba unrolls a loop without exits only
        ok = ok and pass_body(method, body, chunk, buffers, moment, reports[b])
        b += 1
    return ok


@kernel(arrays=True)
def pass_body(method, body, chunk, buffers, moment, report):
    """One body's part of `pass_all`. The opening is here for the compiler's sake: the response and the scatter are compiled once."""
    space, x, now, last = method.space, body.particles.x, moment.now, moment.last
    here, push, there, pushed = buffers.nodes[now], buffers.force[now], buffers.nodes[1 - now], buffers.force[1 - now]
    reach, shake = reaches(space, 0 if last else x.shape[0]), dither(space, x, moment.begun + moment.step)
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        if not step_chunk(method, body, chunk, (here, push), moment, first, count, shake, report):
            return False
        if not last:
            spread(method.scheme, space, method.gradient, x, first, chunk, count, there, pushed, reach[first // CHUNK])
    touch(space, x, 0, x.shape[0], reach, buffers.boxes[1 - now], buffers.blocks[1 - now], moment.sparse)
    return True


@kernel(inline=True)
def state_ahead(particles, first, count):
    """The chunk's strains, volumes and masses are on their way while it gathers."""
    B, line = particles.B, 64 // particles.B.itemsize
    for at in range(first * B.shape[1], (first + count) * B.shape[1], line):
        fetch_ahead(B, at)
    for at in range(first, first + count, line):
        fetch_ahead(particles.J, at)
        fetch_ahead(particles.m, at)
        fetch_ahead(particles.V0, at)


@kernel(inline=True)
def step_chunk(method, body, chunk, source, moment, first, count, shake, report):
    """`count` particles from `first` on, from gather to what is to be scattered; source: nodes and forces. The opening only reads. False where one fails."""
    space, gradient, x, opening, dt = method.space, method.gradient, body.particles.x, moment.opening, moment.dt
    past = 0.0 if opening else dt
    if opening and not sound(space, body, first, count):
        report[CODE], report[PARTICLE] = UNSOUND, first
        return False
    lay_down(space, x, first, count, chunk)
    state_ahead(body.particles, first, count)
    if opening:
        fetch(body.particles, first, chunk, count)
    else:
        collect(method.scheme, space, gradient, x, first, chunk, count, source[0], source[1])
        carry(method.scheme, body.particles, first, chunk, count, moment.last)
        relax(body.locking, space, x, first, chunk, count, dt)
        move(space, x, chunk, first, count, dt, shake, report)
    if report[CODE] == 0.0:
        respond(space, gradient, body, chunk, first, count, past, dt, report)
    if report[CODE] != 0.0:
        report[STEP] = max(moment.step, 0)
        return False
    act(body.source, body, chunk, first, count, past, dt, report)
    return True


@kernel(arrays=True)
def update(method, buffers, now, walls, gravity, dt):
    """Nodes of buffer `now`: fold at walls, v_i = p_i/m_i, v_i+ = v_i + dt (f_i/m_i + g), walls, unfold.

    Where the change is wanted, force becomes v_i+ - v_i: nothing in the components that a wall holds (a STOP is for other schemes alone).
    """
    scheme, shape, D = method.scheme, extents(method.space), directions(method.space)
    nodes, force, box, blocks = buffers.nodes[now], buffers.force[now], buffers.boxes[now], buffers.blocks[now]
    folded = box.copy()
    if wants_change(scheme):
        fold(force, D, shape, folded, walls, blocks)
    fold(nodes, D, shape, box, walls, blocks)
    words, (begin, end), total = blocks.view(np.uint64), span(shape, box), nodes.shape[0]
    if D > 1:
        to_velocity(scheme, nodes, force, D, blocks, words, begin, end, gravity, dt)
    else:
        at = begin
        while at < end:
            first, at = run(blocks, words, at, end)
            for n in range(BLOCK * first, min(BLOCK * at, total)):
                m = nodes[n, 1]
                inverse, push = (1.0 / m, dt * gravity[0]) if m > 0.0 else (0.0, 0.0)
                if wants_change(scheme):
                    push += force[n, 0] * inverse
                    force[n, 0] = push
                nodes[n, 0] = nodes[n, 0] * inverse + push
    impose(nodes, D, shape, box, walls)
    if wants_change(scheme):
        impose(force, D, shape, box, walls)
        unfold(force, D, shape, box, walls, blocks)
    unfold(nodes, D, shape, box, walls, blocks)


@kernel(inline=True)
def to_velocity(scheme, nodes, force, D, blocks, words, begin, end, gravity, dt):
    """[p m] becomes [p/m + dt (f/m + g), m], a node at once, and f, where it is apart, dt (f/m + g); a node without mass is nothing."""
    real = nodes.dtype.type
    nought, one = real(0), real(1)
    if D == 2:
        moves, keeps = four(one, one, nought, nought), four(nought, nought, one, nought)
        push = four(real(dt * gravity[0]), real(dt * gravity[1]), nought, nought)
    else:
        moves, keeps = four(one, one, one, nought), four(nought, nought, nought, one)
        push = four(real(dt * gravity[0]), real(dt * gravity[1]), real(dt * gravity[D - 1]), nought)
    at = begin
    while at < end:
        first, at = run(blocks, words, at, end)
        for n in range(BLOCK * first, min(BLOCK * at, nodes.shape[0])):
            m = peek(nodes, 4 * n + D)
            if m > nought:
                inverse, change = splat4(one / m), push
                if wants_change(scheme):
                    change = fma(load4(force, 4 * n), inverse, push)
                    store(force, 4 * n, change)
                store(nodes, 4 * n, fma(load4(nodes, 4 * n), fma(inverse, moves, keeps), change))
            elif wants_change(scheme):
                store(force, 4 * n, splat4(nought))


@kernel(inline=True)
def move(space, x, chunk, first, count, dt, shake, report):
    """x += dt sum w v_i+ (and `shake`: dither.py), also in chunk.place. A particle whose stencil would leave the nodes ends the run; a NaN is no position."""
    shape, inside, D, n, real = extents(space), room(space.basis), directions(space), CHUNK, x.dtype.type
    place, step, speed, good, even = chunk.place, splat8(real(dt)), splat8(real(0)), splat8(real(1)), splat8(real(shake))
    for p in range(count, (count + EIGHT - 1) // EIGHT * EIGHT):
        for c in range(D):
            poke(chunk.v, c * n + p, 0.0)
    for p in range(0, count, EIGHT):
        square = splat8(real(0))
        for c in range(D):
            # Node i of an array lies at (i - PAD) h.
            low, high = splat8(real((inside - PAD) * space.h)), splat8(real((shape[c] - 1 - PAD - inside) * space.h))
            v = load8(chunk.v, c * n + p)
            here = load8(place, c * n + p) + fma(step, v, even)
            store(place, c * n + p, here)
            square = fma(v, v, square)
            good = good * below(low, here) * below(here, high)
        speed = maximum(square, speed)
    report[SPEED] = max(report[SPEED], most(speed))
    pick_up(x, first, count, place)
    if least(good) < 1.0:
        for p in range(count):
            for c in range(D):
                here = x[first + p, c]
                if not (inside - PAD) * space.h < here < (shape[c] - 1 - PAD - inside) * space.h and report[CODE] == 0.0:
                    report[CODE], report[PARTICLE] = NON_FINITE if np.isnan(here) else LEFT_GRID, first + p
