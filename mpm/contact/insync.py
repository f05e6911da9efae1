"""Velocities at the time of the positions (docs/physics.md 4).

Leapfrog   v(t + dt/2) = v(t - dt'/2) + a(t) (dt' + dt)/2,   x(t + dt) = x(t) + dt v(t + dt/2),   dt' the step before, none at the start
Particles carry the velocities of the middle of the step behind them: `lag` = dt'/2 is how far those lie back. The impulse of a step acts for lag + dt/2, so the
first one for half of itself, and a step may follow a longer or a shorter one at no loss of order. What is recorded is
    v(t) = v(t - lag) + (v of a step with an impulse over `lag`) - (v of a step with none),
both steps of the method itself, which move nothing, so that walls and contacts act as they do and what the transfer smooths cancels. The slopes C alike.
The run goes on from what it was: a record changes no bit of it. Cost: two steps a record.
Error      order 2 where cell and step are refined together (tests/contact/test_insync.py); at a fixed cell, what the lumped mass smooths of an impulse
           leaves order 1 in dt, with h^2 before it. Without this velocities lag by dt/2, and a start under load misplaces by dt t a/2
Fails when a contact closes or opens within the step: then the velocity of what touches is that of either side of it
"""

from contextlib import contextmanager

from mpm.contact.block import push
from mpm.contact.sums import kept, new_sums, taken_up
from mpm.integrate.strain import CODE
from mpm.memory import arrays

STILL = 1e-9  # of a step: how far the steps go that move nothing


def put_back(now, kept) -> None:
    """Arrays as they were."""
    for path, array in now.items():
        array[...] = kept[path]


@contextmanager
def in_sync(scene, clock, work):
    """Within it, particles carry the velocities of the present. Bodies in the total frame always do."""
    if clock.lag == 0 or scene.references:
        yield
        return
    lagging = [(body.particles.v.copy(), body.particles.C.copy()) for body in scene.bodies]
    if scene.order.sliced:
        scene.order.refresh()
    if scene.course is not None:
        scene.course.lay(scene, clock.time, STILL * clock.lag, 1, 1.0)
    changed = scene.bodies, () if scene.meeting is None else scene.meeting.touching
    now, met = arrays(changed), scene.meeting
    sums = None if met is None else taken_up(new_sums(scene.space, len(scene.bodies)), kept(met.sums))
    before = {path: array.copy() for path, array in now.items()}
    reach, dt, reports = scene.order.reach.copy(), 2 * clock.lag, clock.reports.copy()
    for kick in (0.0, clock.lag):
        reports[:] = 0.0
        push(scene, clock, work, STILL * dt, kick, 1, dt, reports)
        if reports[:, CODE].any():
            raise ArithmeticError("a state that was found sound takes no step")  # no state does that: the guards look at it first
        if kick == 0.0:
            idle = [(body.particles.v.copy(), body.particles.C.copy()) for body in scene.bodies]
            put_back(now, before)
    pushed = [(body.particles.v - v, body.particles.C - C) for body, (v, C) in zip(scene.bodies, idle, strict=True)]
    put_back(now, before)
    if met is not None:
        met.forget()
        met.sums = sums
    del before, idle
    for body, (v, C) in zip(scene.bodies, pushed, strict=True):
        body.particles.v[...] += v
        body.particles.C[...] += C
    if scene.order.sliced:
        scene.order.reach[...] = reach
        scene.order.restore()
    yield
    for body, (v, C) in zip(scene.bodies, lagging, strict=True):
        body.particles.v[...], body.particles.C[...] = v, C
