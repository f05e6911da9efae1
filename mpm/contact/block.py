"""The arrays that a run works on, and one block of its steps by whichever kernel it needs: slabs, one thread, or with contacts."""

import math
from typing import NamedTuple

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.blocks import new_blocks
from mpm.contact.step import Pace
from mpm.integrate.explicit import advance
from mpm.integrate.heat_chebyshev import ROWS as STABILISED_ROWS
from mpm.integrate.heat_step import ROWS as EXPLICIT_ROWS
from mpm.integrate.step_parts import Buffers, method_of
from mpm.integrate.step_threaded import advance_slabs
from mpm.integrate.strain import PARTICLE, SPEED
from mpm.integrate.timestep import WAVE, mechanical_limits
from mpm.lanes import aligned
from mpm.outcome import COMPLETED, Outcome, outcome
from mpm.state import Thermal
from mpm.transfer import columns, wants_change

AHEAD = 1.5  # of what the fastest particle and gravity let a particle move in a block
FEWEST = 4  # steps of a block that is cut short so that nothing comes near in it


class Work(NamedTuple):
    """What a run works on beside its state; all zero between blocks."""

    buffers: Buffers
    rows: np.ndarray  # (rows, n) scalars of the nodes, for heat steps; of no nodes without heat


def work_arrays(scene) -> Work:
    """The arrays of a scene."""
    n, D = math.prod(extents(scene.space)), directions(scene.space)
    dtype = scene.bodies[0].particles.x.dtype
    nodes = aligned((2, n, columns(D)), dtype)
    force = aligned((2, n if wants_change(scene.scheme) else 0, columns(D)), dtype)
    warm = any(isinstance(body.thermal, Thermal) for body in scene.bodies)
    rows = EXPLICIT_ROWS if scene.heat.kind == "explicit" else STABILISED_ROWS
    return Work(Buffers(nodes, force, np.zeros((2, 3, 2), np.int64), new_blocks(n)), np.zeros((rows, n if warm else 0)))


def reach(scene, clock, span: float) -> float:
    """How far a particle or a tool may move within `span` [m]."""
    speed, g = math.sqrt(max(clock.reports[:, SPEED].tolist())), heaviest(scene)
    return AHEAD * max(speed + g * span, scene.meeting.pace(clock.time, span)) * span


def heaviest(scene) -> float:
    """No gravity of the run is larger [m/s2]."""
    return scene.course.heaviest if scene.course is not None and scene.course.gravity else math.hypot(*scene.gravity[0].tolist())


def clear(scene, clock, dt: float, steps: int) -> int:
    """How many of `steps` steps of dt to take at once: fewer where that surely brings nothing near, so that contacts are computed, and compiled, only then."""
    met, fewer = scene.meeting, steps // 2
    if met is None or met.stands or not met.near(reach(scene, clock, dt * steps), clock.time):
        return steps
    while fewer >= FEWEST and met.left < reach(scene, clock, dt * fewer):
        fewer //= 2
    return fewer if fewer >= FEWEST else steps


def advance_block(scene, clock, work: Work, dt: float, steps: int) -> Outcome:
    """One block of `steps` steps of dt; clock.reports tells of it. Not ok where a meeting was not foreseen."""
    met = scene.meeting
    clock.touching = met is not None and met.near(reach(scene, clock, dt * steps), clock.time)
    if clock.touching and met.unforeseen is not None:
        return outcome(met.unforeseen[0], time=clock.time * scene.scale, step=clock.steps, detail=f"({scene.names[met.unforeseen[1]]})")
    scene.order.refresh()
    kick, before, clock.lag = clock.lag + 0.5 * dt, clock.lag, 0.5 * dt
    if scene.course is not None:
        scene.course.lay(scene, clock.time, dt, steps, before / kick)
    if scene.inflow is not None:
        scene.inflow.lay(clock.time, dt * steps)
    astray = push(scene, clock, work, float(dt), float(kick), steps, float(dt), clock.reports)
    if met is not None and (scene.inflow is not None or not clock.touching):
        met.forget()
    if met is not None and met.drive is not None and not clock.touching:
        met.drive.drift(clock.time, dt, kick, steps)
    if scene.course is not None:
        clock.worked += scene.course.work(scene)
    travel = math.sqrt(max(clock.reports[:, SPEED].tolist())) * dt * steps
    scene.order.passed(travel, steps, astray)
    if met is not None:
        met.left -= max(travel, met.pace(clock.time, dt * steps) * dt * steps)
    return outcome(COMPLETED)


def push(scene, clock, work: Work, dt: float, kick: float, steps: int, ahead: float, reports) -> bool:
    """`steps` steps of dt, whose first impulse acts for `kick` and whose contacts are such that nothing overlaps `ahead` later. Whether a chunk was late."""
    wave = mechanical_limits(scene.space, directions(scene.space), scene.bodies, clock.reports)["elastic wave"] if clock.touching else 0.0
    reports[:] = 0.0
    reports[:, PARTICLE] = -1
    if clock.touching:
        pace = Pace(dt, kick, ahead, steps, clock.steps, WAVE * scene.space.h / wave)
        return scene.meeting.advance(scene, work.buffers, pace, clock.time, reports)
    if scene.order.sliced:
        return advance_slabs(scene, method_of(scene), work.buffers, dt, kick, steps, clock.steps, reports)
    advance(method_of(scene), scene.for_motion, work.buffers, scene.walls, scene.gravity, dt, kick, steps, clock.steps, reports)
    return False
