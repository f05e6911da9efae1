"""A whole scene in the total frame: what the run (mpm.simulation) asks for. Bodies share no nodes, so each goes alone."""

from dataclasses import replace

from mpm.boundary import directions
from mpm.diagnostics import nodal
from mpm.integrate.timestep import WAVE, Limits, limits, mechanical_limits
from mpm.outcome import COMPLETED, HEAT_SOLVER, Outcome, outcome
from mpm.state import Average, Thermal
from mpm.total.heat import begin_heat, warm
from mpm.total.inertia import impel
from mpm.total.reference import project, show
from mpm.total.step import advance_total

PACE = 4.0  # times the updated frame's: here nothing damps by the step. manufactured_1d, cell 1/32: error of temperature 1.68e-4 at one, 1.72e-4 at four


def begin(space, body, reference) -> None:
    """Nodes from what the particles of a body are given at the start."""
    project(space, reference, body.particles)
    if len(reference.p):
        impel(reference)
    if isinstance(body.locking, Average):
        nodal(space, reference.X.astype(float), body.particles.V0.astype(float), body.locking.volume)
        for ghost, image, lean in zip(reference.ghost, reference.image, reference.lean, strict=True):
            body.locking.volume[image] += body.locking.volume[ghost] if lean == 0.0 else 0.0
    if isinstance(body.thermal, Thermal):
        begin_heat(space, reference.X.astype(float), body.particles.m.astype(float), body.thermal, reference.warmth)


def warm_references(scene, clock, dt: float) -> Outcome:
    """One heat step of every body that has heat."""
    for body, reference, around in zip(scene.bodies, scene.references, scene.surroundings, strict=True):
        if not isinstance(body.thermal, Thermal):
            continue
        if around is not None:
            around.write(scene.space, body, clock.time, dt)
        gained, count = warm(scene.space, body, reference, dt, scene.heat.tolerance)
        if count < 0:
            return outcome(HEAT_SOLVER, time=clock.time * scene.scale, step=clock.steps)
        clock.exchanged, clock.iterations = clock.exchanged + gained, clock.iterations + count
    clock.heat_steps, clock.implicit = clock.heat_steps + 1, clock.implicit + 1
    return outcome(COMPLETED)


def show_all(scene) -> None:
    """Particles as records want them: in the original order, and in the total frame with what the nodes carry."""
    scene.order.restore()
    for body, reference in zip(scene.bodies, scene.references, strict=False):
        show(scene.space, body.particles, reference)


def advance_references(scene, clock, work, dt: float, steps: int) -> None:
    """One block of `steps` steps of dt, without `work`; clock.reports tells of it."""
    clock.reset()
    if scene.course is not None:
        scene.course.lay(scene, clock.time, dt, steps, 0.0)
    for body, reference, report in zip(scene.bodies, scene.references, clock.reports, strict=True):
        advance_total(scene.space, body, reference, scene.gravity, dt, steps, report)
    if scene.course is not None:
        clock.worked += scene.course.work(scene)


def present_steps(scene, clock) -> dict[str, float]:
    """Limits of the mechanical step in the present state, by name [s]. In the total frame the elastic wave alone limits it, and it may be longer."""
    found = mechanical_limits(scene.space, directions(scene.space), scene.bodies, clock.reports)
    if not scene.references:
        return found
    return {"elastic wave": min(reference.courant for reference in scene.references) / WAVE * found["elastic wave"]}


def present_limits(scene, clock) -> Limits:
    """Limits of the present state; in the total frame heat steps may be longer too."""
    found = limits(scene.space, directions(scene.space), scene.bodies, clock.reports)
    return replace(found, mechanical=present_steps(scene, clock), pace=PACE * found.pace) if scene.references else found
