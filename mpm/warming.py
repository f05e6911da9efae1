"""One heat step of all bodies of a scene, in the updated frame or the total one; what sets follows it."""

import math

import numpy as np

from mpm.diagnostics import warm_energy
from mpm.heat.setting import set_bodies
from mpm.integrate.bounds import bounds_of, keep_between, needs_slopes
from mpm.integrate.fracture_surface import tear_open
from mpm.integrate.heat_chebyshev import heat_chebyshev, stages
from mpm.integrate.heat_implicit import heat_implicit
from mpm.integrate.heat_step import ROWS as EXPLICIT_ROWS
from mpm.integrate.heat_step import Back, heat_step
from mpm.integrate.heat_threaded import heat_in_slabs, shared
from mpm.integrate.timestep import SUBSTEPS, Limits
from mpm.integrate.xpic import correct, lost_to_grid
from mpm.outcome import COMPLETED, HEAT_SOLVER, Outcome, outcome
from mpm.state import Thermal
from mpm.total.drive import present_limits, warm_references

MANY = 5  # stages of a stabilised heat step that cost about as much as an implicit one


def warm_bodies(scene, clock, work, begun: float, dt: float, now: Limits) -> Outcome:
    """One heat step from `begun` on of every body that has heat, and what sets by it."""
    held = warm_energy(scene.space, scene.bodies)
    result = conduct(scene, clock, work, begun, dt, now)
    if result.ok:
        set_bodies(scene.bodies, dt)
        clock.softened += warm_energy(scene.space, scene.bodies) - held
    return result


def conduct(scene, clock, work, begun: float, dt: float, now: Limits) -> Outcome:
    """The heat step: explicit in as many sub-steps or stages as the limits ask for, or implicit."""
    around = [(b, body, one) for b, (body, one) in enumerate(zip(scene.bodies, scene.surroundings, strict=True)) if one is not None]
    if (not now.heat and not around) or scene.references:  # without conduction a given flux still heats
        return warm_references(scene, clock, dt) if now.heat or around else outcome(COMPLETED)
    tear_open(scene)
    if scene.order.sliced:
        scene.order.refresh()
    met = scene.meeting
    for b, body, one in around:
        one.write(scene.space, body, begun, dt, met.covered(b, dt) if met is not None else None)
    if not all(one.steady for *_, one in around):
        now = present_limits(scene, clock)
    kind, stable = scene.heat.kind, now.substep() * scene.safety
    ratio = dt / stable * (1 - 1e-9)
    substeps = stages(dt, stable) if kind != "explicit" else 1 if ratio <= 1 else math.ceil(ratio / SUBSTEPS)
    implicit = kind == "implicit" or (kind == "auto" and substeps > MANY)
    clock.heated = (dt / substeps, now.substep(), "heat" if len(now.heat) != 1 else next(iter(now.heat))) if kind == "explicit" else None
    kinds = [scene.walls] * len(scene.bodies) if met is None else met.walls
    trio = zip(scene.bodies, scene.surroundings, kinds, strict=True)
    mirrors = np.stack([walls if one is None else one.mirrors(scene.space, body, walls) for body, one, walls in trio])
    before = [(lost_to_grid(scene, body, work.rows, walls), bounds_of(body, seen) if scene.repair and isinstance(body.thermal, Thermal) else None)
              for body, walls, seen in zip(scene.bodies, mirrors, clock.seen, strict=True)]  # fmt: skip
    joined = ()
    if met is not None and (links := met.heat_links(mirrors, dt)) is not None:
        joined, (gained, _, count) = met.conduct(scene, mirrors, links, dt)
        if count < 0:
            return outcome(HEAT_SOLVER, time=clock.time * scene.scale, step=clock.steps)
        clock.exchanged, clock.iterations, implicit = clock.exchanged + gained, clock.iterations + count, True
    for b, (body, walls, (lost, between)) in enumerate(zip(scene.bodies, mirrors, before, strict=True)):
        back = Back(scene.blend, 1.0 if needs_slopes(scene, body, between is not None) else scene.affine)
        if b in joined:
            gained, between = 0.0, between and tuple(pick(before[c][1][k] for c in joined) for k, pick in enumerate((min, max)))
        elif implicit:
            gained, count = heat_implicit(scene.space, scene.for_heat[b], work.rows, walls, dt, scene.heat.order, scene.heat.tolerance, back)
            if count < 0:
                return outcome(HEAT_SOLVER, time=clock.time * scene.scale, step=clock.steps)
            clock.iterations += count
        elif shared(scene, b):
            gained = heat_in_slabs(scene, b, work.rows, walls, dt, substeps, back)
        elif kind != "explicit":
            gained = heat_chebyshev(scene.space, scene.for_heat[b], work.rows, walls, dt, substeps, back)
        else:
            gained = heat_step(scene.space, scene.for_heat[b], work.rows[:EXPLICIT_ROWS], walls, dt, substeps, back)
        clock.exchanged += gained
        if lost is not None:
            correct(body.thermal, *lost)
        if between is not None:
            moved, left = keep_between(scene.space, body, work.rows, walls, *between)
            clock.repaired, clock.unrepaired = clock.repaired + moved, clock.unrepaired + left
    clock.given = sum((one.given(body.surface, len(scene.hot)) for _, body, one in around), clock.given)
    if met is not None:
        met.warmed()
    clock.heat_steps += 1
    if implicit:
        clock.implicit += 1
    elif substeps > (1 if kind == "explicit" else 2):
        binding = min(now.heat, key=now.heat.get)
        clock.bound[f"{binding} (heat sub-steps)"] = clock.bound.get(f"{binding} (heat sub-steps)", 0) + substeps
    return outcome(COMPLETED)
