"""A whole scene in the total frame: what the run (mpm.simulation) asks for. Bodies share no nodes, so each goes alone."""

from dataclasses import replace

from mpm.boundary import directions
from mpm.integrate.timestep import WAVE, Limits, limits
from mpm.total.reference import show
from mpm.total.step import advance_total


def show_all(scene) -> None:
    """Particles as records want them: in the original order, and in the total frame with what the nodes carry."""
    scene.order.restore()
    for body, reference in zip(scene.bodies, scene.references, strict=False):
        show(scene.space, body.particles, reference)


def advance_references(scene, clock, buffers, dt: float, steps: int) -> None:
    """One block of `steps` steps of dt, without buffers; clock.reports tells of it."""
    clock.reset()
    for body, reference, report in zip(scene.bodies, scene.references, clock.reports, strict=True):
        advance_total(scene.space, body, reference, scene.gravity, dt, steps, report)


def present_limits(scene, clock) -> Limits:
    """Limits of the present state. In the total frame the elastic wave alone limits the mechanical step, and that may be longer."""
    found = limits(scene.space, directions(scene.space), scene.bodies, clock.reports)
    if not scene.references:
        return found
    longer = min(reference.courant for reference in scene.references) / WAVE
    return replace(found, mechanical={"elastic wave": longer * found.mechanical["elastic wave"]})
