"""The arrays that a run works on, and one block of its steps by whichever kernel it needs: slabs, one thread, or with contacts."""

import math

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.blocks import new_blocks
from mpm.integrate.explicit import advance
from mpm.integrate.heat_chebyshev import ROWS as STABILISED_ROWS
from mpm.integrate.heat_step import ROWS as EXPLICIT_ROWS
from mpm.integrate.slabs import advance_slabs
from mpm.integrate.strain import SPEED
from mpm.integrate.timestep import WAVE, limits
from mpm.lanes import aligned
from mpm.outcome import COMPLETED, Outcome, outcome
from mpm.state import Thermal
from mpm.transfer import columns, wants_change

AHEAD = 1.5  # of what the fastest particle and gravity let a particle move in a block


def work_arrays(scene):
    """Nodes: two buffers of momentum and mass, two of forces where the transfer wants them, their boxes and blocks, scalars where there is heat."""
    n, D = math.prod(extents(scene.space)), directions(scene.space)
    dtype = scene.bodies[0].particles.x.dtype
    nodes = aligned((2, n, columns(D)), dtype)
    force = aligned((2, n if wants_change(scene.scheme) else 0, columns(D)), dtype)
    warm = any(isinstance(body.thermal, Thermal) for body in scene.bodies)
    rows = EXPLICIT_ROWS if scene.heat.kind == "explicit" else STABILISED_ROWS
    return nodes, force, (np.zeros((2, 3, 2), np.int64), new_blocks(n)), np.zeros((rows, n if warm else 0))


def advance_block(scene, clock, buffers, dt: float, steps: int) -> Outcome:
    """One block of `steps` steps of dt; clock.reports tells of it. Not ok where a meeting was not foreseen."""
    nodes, force, (boxes, blocks), _ = buffers
    speed, g = math.sqrt(max(clock.reports[:, SPEED])), float(np.linalg.norm(scene.gravity))
    met = scene.meeting
    touching = met is not None and met.near(AHEAD * (speed + g * dt * steps) * dt * steps)
    if touching and met.unforeseen is not None:
        return outcome(met.unforeseen[0], time=clock.time * scene.scale, step=clock.steps, detail=f"({scene.names[met.unforeseen[1]]})")
    wave = limits(scene.space, directions(scene.space), scene.bodies, clock.reports).mechanical["elastic wave"] if touching else 0.0
    scene.order.refresh()
    clock.reset()
    astray, begun, reports = False, clock.steps, clock.reports
    if touching:
        met.advance(scene, nodes, force, boxes, blocks, float(dt), steps, begun, WAVE * scene.space.h / wave, reports)
    elif scene.order.sliced:
        astray = advance_slabs(scene, nodes, force, boxes, blocks, float(dt), steps, begun, reports)
    else:
        advance(scene.space, scene.gradient, scene.scheme, scene.bodies, nodes, force, boxes, blocks, scene.walls, scene.gravity, dt, steps, begun, reports)
    travel = math.sqrt(max(reports[:, SPEED])) * dt * steps
    scene.order.passed(travel, steps, astray)
    if met is not None:
        met.left -= travel
    return outcome(COMPLETED)
