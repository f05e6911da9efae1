"""Rules of `method.frame: total`: what it does not do yet, or does in its own way, is told where it stands."""

from collections.abc import Iterator
from typing import Any

from mpm.config.explain import Finding
from mpm.config.loose import Unknown
from mpm.config.rules_scene import moves

OWN = "leave it out: velocities stay on the nodes, with the gradient of the basis itself; or method.frame: updated"
UPDATED = "method.frame: updated"


def known(question, *given) -> bool:
    """The answer, and no where it is not known."""
    try:
        return bool(question(*given))
    except Unknown:
        return False


def frame(experiment: Any) -> Iterator[Finding]:
    method = experiment.method
    if method.frame != "total":
        return
    dimension = experiment.grid.dimension
    if dimension == 0 or not moves(experiment):
        yield Finding(("method", "frame"), "no body moves, so there is no frame to choose", "no `frame`, or an elastic section in a material", on_key=True)
        return
    if len(experiment.bodies) > 1:
        yield Finding(("method", "frame"), "one body only: bodies in the total frame would pass through one another", UPDATED, given="total")
    if known(lambda: method.transfer.kind != "apic"):
        yield Finding(("method", "transfer"), "the total frame transfers nothing", OWN, on_key=True)
    if known(lambda: method.locking is not None):
        yield Finding(("method", "locking"), "the total frame has no cure of locking yet", UPDATED, on_key=True)
    if known(lambda: method.fracture != "warn"):
        yield Finding(("method", "fracture"), "bodies in the total frame do not come apart", UPDATED, on_key=True)
    if known(lambda: method.particles < 2):
        yield Finding(("method", "particles"), "the total frame needs two points a cell and direction: one does not see bending", "2 or more", given=1)
    if known(lambda: experiment.grid.basis == "linear"):
        yield Finding(("grid", "basis"), "hat functions that a surface cuts have no stable step in the total frame", ["quadratic", "cubic"], given="linear")


def frame_wall(experiment: Any, side: str, item: Any) -> Iterator[Finding]:
    if experiment.method.frame == "total" and item.kind == "contact":
        yield Finding(("walls", side), "the total frame has no contact yet: it holds what lies on a wall at the start", ["slip", "stick", UPDATED], on_key=True)


def frame_material(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    if experiment.method.frame == "total" and item.heat is not None and item.elastic is not None:
        yield Finding(("materials", name, "heat"), "the total frame has no heat yet", UPDATED, on_key=True)


def frame_exact(experiment: Any) -> Iterator[Finding]:
    if experiment.method.frame == "total" and experiment.exact is not None and experiment.exact.kind == "manufactured":
        yield Finding(("exact", "manufactured"), "the total frame has no sources of force and heat yet", UPDATED, on_key=True)
