"""Rules of `method.mechanics: implicit`: what it does not do yet is told where it stands."""

from collections.abc import Iterator
from typing import Any

from mpm.config.explain import Finding
from mpm.config.rules_frame import known
from mpm.config.rules_scene import moves

EXPLICIT = "method.mechanics: explicit"


def asked(experiment: Any) -> bool:
    """Whether mechanics is implicit; no where that is not known."""
    return known(lambda: experiment.method.mechanics == "implicit")


def named(experiment: Any, which: str) -> Any:
    """The experiment with its mechanics named."""
    return experiment.model_copy(update={"method": experiment.method.model_copy(update={"mechanics": which})})


def hindered(experiment: Any) -> str:
    """Why implicit mechanics cannot take an experiment, or is not what is wanted of it; empty where it can."""
    one = named(experiment, "implicit")
    found = list(mechanics(one))
    found += [wrong for name, material in one.materials.items() for wrong in mechanics_material(one, name, material)]
    if found:
        return found[0].message
    if experiment.exact is not None or any(body.velocity is not None or body.angular_velocity is not None for body in experiment.bodies.values()):
        return "bodies begin in motion, or an exact solution asks for waves"
    return ""


def mechanics(experiment: Any) -> Iterator[Finding]:
    """What implicit mechanics does not do yet, of the whole experiment."""
    method, grid = experiment.method, experiment.grid
    if not asked(experiment):
        if known(lambda: method.mechanics == "explicit" and method.mechanics_tolerance != type(method).model_fields["mechanics_tolerance"].default):
            yield Finding(("method", "mechanics_tolerance"), "explicit steps have no tolerance", "method.mechanics: implicit", on_key=True)
        return
    at = ("method", "mechanics")
    if grid.dimension == 0 or not moves(experiment):
        yield Finding(at, "no body moves, so there is no mechanics to choose", "no `mechanics`, or an elastic section in a material", on_key=True)
        return
    if len(experiment.bodies) > 1:
        yield Finding(at, "implicit mechanics knows one body only, yet", f"{EXPLICIT}, with a `time.scale` where all is slow", given="implicit")
    if known(lambda: grid.basis != "quadratic"):
        yield Finding(("grid", "basis"), "implicit mechanics is known on quadratic splines only", ["quadratic", EXPLICIT], on_key=True)
    if known(lambda: method.transfer.kind != "apic"):
        yield Finding(("method", "transfer"), "implicit mechanics carries velocities by apic", ["apic", EXPLICIT], on_key=True)
    if known(lambda: method.precision != "float64"):
        yield Finding(("method", "precision"), "implicit mechanics is computed in double precision", ["float64", EXPLICIT], on_key=True)
    if known(lambda: method.fracture == "surface"):
        yield Finding(("method", "fracture"), "implicit mechanics opens no faces", ["warn", "fail", EXPLICIT], on_key=True)
    if known(lambda: experiment.exact is not None and experiment.exact.kind == "manufactured"):
        yield Finding(("exact",), "the sources of a manufactured solution are not known to implicit mechanics", EXPLICIT, on_key=True)


def mechanics_material(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """Of a material."""
    if not asked(experiment) or item.elastic is None:
        return
    if item.flow is not None and known(lambda: item.flow.map != "radial"):
        said = "implicit mechanics knows the radial map only: the clipped one has no tangent yet"
        yield Finding(("materials", name, "flow", item.flow.kind, "map"), said, ["radial", EXPLICIT], on_key=True)
    if item.heating is not None and known(lambda: item.heating.elastic.form == "grid"):
        said = "implicit mechanics heats particles, along the adiabat"
        yield Finding(("materials", name, "heating", "elastic", "form"), said, ["adiabat", EXPLICIT], on_key=True)
