"""Rules for sources: the body is there and has the physics, formulas know their names, solvers that do not know a source say so."""

from collections.abc import Iterator
from typing import Any

from mpm.config.condition import Formula
from mpm.config.explain import Finding
from mpm.config.problems import near
from mpm.config.rules_frame import known as truly
from mpm.config.rules_scene import vector
from mpm.config.sources import KINDS, PLACES, ByFormula

EXPLICIT = "method.mechanics: explicit"


def source(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """Body, physics, directions."""
    known, dimension, at = experiment.bodies, experiment.grid.dimension, ("sources", index)
    if item.of not in known:
        yield Finding((*at, "of"), "there is no such body", list(known), near(item.of, known), given=item.of)
        return
    name = known[item.of].material
    if name not in experiment.materials:
        return
    material = experiment.materials[name]
    for key in ("heat", "heat_by_mass"):
        if getattr(item, key) is not None and material.heat is None:
            yield Finding((*at, key), f"{name!r} has no heat law, so nothing can be heated", f"a heat section in materials.{name}", on_key=True)
    if item.force is not None and (dimension == 0 or material.elastic is None):
        said = "a material point has no inertia" if dimension == 0 else f"{name!r} has no elastic law, so the body cannot move"
        yield Finding((*at, "force"), said, f"an elastic section in materials.{name}, in grid.dimension 1 or more", on_key=True)
    elif item.force is not None:
        yield from vector(experiment, (*at, "force"), item.force, "the force")
        if truly(lambda: experiment.method.frame == "total"):
            yield Finding((*at, "force"), "the total frame does not reckon the work of a body force yet", "method.frame: updated", on_key=True)
    for key in ("heat", "heat_by_mass"):
        if getattr(item, key) is not None and truly(lambda: experiment.method.mechanics == "implicit"):
            yield Finding((*at, key), "implicit mechanics knows no heat from within yet", [EXPLICIT, "a force"], on_key=True)
    if experiment.time.scale > 1:
        yield Finding(at, "time scaling does not know sources", "time: {scale: 1}")


def exact(experiment: Any) -> Iterator[Finding]:
    """Formulas of an exact solution know the place at the start and the time."""
    solution = experiment.exact
    if solution is None or solution.kind != "formulas":
        return
    allowed = [*PLACES[experiment.grid.dimension], "t"]
    given = [(("temperature",), solution.temperature)] + [(("displacement", k), one) for k, one in enumerate(solution.displacement or ())]
    for below, one in given:
        for name in [name for name in (Formula(one.text).names if one is not None else ()) if name not in allowed]:
            yield Finding(("exact", "formulas", *below), f"a formula here knows no {name!r}", allowed, given=one.text)


def formula(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """Names of the grid's directions, t and T; what does not move has no T in its sources, a material point only a number."""
    if item.of not in experiment.bodies or experiment.bodies[item.of].material not in experiment.materials:
        return
    places = PLACES[experiment.grid.dimension]
    moves = experiment.materials[experiment.bodies[item.of].material].elastic is not None
    allowed = [*places, "t", *(("T",) if moves else ())]
    given = [((key,), getattr(item, key)) for key in KINDS[:2]] + [(("force", k), one) for k, one in enumerate(item.force or ())]
    for below, one in given:
        if experiment.grid.dimension == 0:
            if one is not None and not isinstance(one, float):
                yield Finding(("sources", index, *below), "a material point has a source that stays the same", "a number")
        elif isinstance(one, ByFormula):
            for name in [name for name in Formula(one.text).names if name not in allowed]:
                said = f"a formula here knows no {name!r}" if name != "T" else "the temperature T is not known to sources of bodies that do not move"
                yield Finding(("sources", index, *below, "formula"), said, allowed if name != "T" else ["x, t", "an elastic section"], given=one.text)
    if experiment.grid.dimension == 0 and (getattr(item, "from") or item.until is not None):
        yield Finding(("sources", index), "a material point has a source that lasts", "no from and no until")
