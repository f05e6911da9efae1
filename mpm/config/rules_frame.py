"""Rules of `method.frame: total`: what it does not do yet, or does in its own way, is told where it stands."""

from collections.abc import Callable, Iterator
from typing import Any

from mpm.config.boundary import spell
from mpm.config.explain import Finding
from mpm.config.partial import Unknown
from mpm.config.rules_scene import moves

OWN = "leave it out: velocities and temperatures stay on the nodes; or method.frame: updated"
UPDATED = "method.frame: updated"


def known(question: Callable[..., Any], *given: Any) -> bool:
    """The answer, and no where it is not known."""
    try:
        return bool(question(*given))
    except Unknown:
        return False


def named(experiment: Any, which: str) -> Any:
    """The experiment with its frame named."""
    return experiment.model_copy(update={"method": experiment.method.model_copy(update={"frame": which})})


def hindered(experiment: Any) -> str:
    """Why the total frame cannot take an experiment; empty where it can."""
    one = named(experiment, "total")
    found = [*frame(one), *(wrong for side, wall in one.walls.items() for wrong in frame_wall(one, side, wall))]
    found += [wrong for name, material in one.materials.items() for wrong in frame_material(one, name, material)]
    if found:
        return found[0].message
    if one.tools:
        return "the total frame knows no tools yet"
    return "what flows in is known in the updated frame only" if any(body.inflow is not None for body in one.bodies.values()) else ""


def frame(experiment: Any) -> Iterator[Finding]:
    """What the total frame does not do yet, of the whole experiment."""
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
    if known(lambda: method.temperature.kind != "apic"):
        yield Finding(("method", "temperature"), "the total frame transfers nothing", OWN, on_key=True)
    if known(lambda: method.heat.kind not in ("auto", "implicit")):
        yield Finding(("method", "heat"), "heat in the total frame steps implicitly", ["auto", "implicit", UPDATED], on_key=True)
    if known(lambda: method.bounds.kind == "repair"):
        yield Finding(("method", "bounds"), "the total frame cannot keep temperatures within bounds yet", ["no `bounds`", UPDATED], on_key=True)
    if known(lambda: method.fracture != "warn"):
        yield Finding(("method", "fracture"), "bodies in the total frame do not come apart", UPDATED, on_key=True)
    if known(lambda: method.particles < 2):
        yield Finding(("method", "particles"), "the total frame needs two points a cell and direction: one does not see bending", "2 or more", given=1)
    if known(lambda: experiment.grid.basis == "linear"):
        yield Finding(("grid", "basis"), "hat functions that a surface cuts have no stable step in the total frame", ["quadratic", "cubic"], given="linear")


def frame_wall(experiment: Any, side: str, item: Any) -> Iterator[Finding]:
    """Of a wall."""
    if experiment.method.frame == "total" and getattr(item, "heat", None) is not None:
        said = "walls exchange no heat in the total frame: what lies on one exchanges through its own surface"
        yield Finding(("walls", side, item.kind, "heat"), said, ["an entry under surfaces", UPDATED], on_key=True)
    if experiment.method.frame == "total" and item.acts == "stick" and spell(item) != (0.0, float("inf")):
        said = "what the total frame holds at a wall it holds from the start to the end"
        yield Finding(("walls", side, item.kind), said, ["no from and no until", UPDATED], on_key=True)
    if experiment.method.frame == "total" and item.acts == "contact":
        yield Finding(("walls", side), "the total frame has no contact yet: it holds what lies on a wall at the start", ["slip", "stick", UPDATED], on_key=True)


def frame_material(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """Of a material."""
    if experiment.method.frame != "total" or item.elastic is None:
        return
    if item.heat is not None and known(lambda: item.heat.alpha.kind != "constant"):
        said = "the total frame has no specific heat that follows temperature yet"
        yield Finding(("materials", name, "heat", "fourier", "alpha"), said, ["a number", UPDATED], on_key=True)
    if item.heating is not None and known(lambda: item.heating.elastic.form == "grid"):
        yield Finding(("materials", name, "heating", "elastic", "form"), "the total frame heats its particles, along the adiabat", "adiabat", on_key=True)
