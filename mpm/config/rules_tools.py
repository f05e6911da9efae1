"""Rules for tools, and for observables of what bodies meet: shapes and vectors of the grid's dimension, names of their own, physics that they need."""

from collections.abc import Iterator
from typing import Any

from mpm.config.boundary import WALL_SIDES
from mpm.config.explain import Finding
from mpm.config.problems import near
from mpm.config.rules_scene import conducts, heats, hot, moves, plain_names, vector
from mpm.config.shapes_fit import misfits
from mpm.config.tools import SHAPES

RESERVED = ("total", "exchanged", "ledger", "inflow", "exchanging")  # heat_total and area_exchanging are other things


def tool(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """Name, shape and physics of a tool."""
    grid, at = experiment.grid, ("tools", name)
    yield from plain_names(experiment, "tools", [name])
    taken = [*experiment.bodies, *WALL_SIDES[grid.dimension], *RESERVED, *(f"{a}_{b}" for a in experiment.bodies for b in experiment.bodies)]
    if name in taken:
        yield Finding(at, f"the name {name!r} is taken: forces on a tool are told by its name", "a name of its own", on_key=True)
    if grid.dimension == 0 or not moves(experiment):
        yield Finding(at, "no body moves, so there is nothing that a tool could push", "an elastic section in a material", on_key=True)
        return
    for below, said, allowed in misfits(item.shape, grid.dimension, grid.directions, SHAPES):
        yield Finding((*at, "shape", item.shape.kind, *below), said, allowed)
    if experiment.method.frame == "total":
        yield Finding(at, "the total frame knows no tools yet", "method.frame: updated", on_key=True)
    if experiment.time.scale > 1:
        yield Finding(at, "time scaling does not know tools", "time: {scale: 1}", on_key=True)
    if item.heat is not None and not heats(experiment):
        yield Finding((*at, "heat"), "no body has heat, so nothing can be exchanged", "a heat section in the material of a body", on_key=True)
    elif item.heat is not None and item.heat.beta != 0.0:
        for material in sorted({body.material for body in experiment.bodies.values()}):
            if experiment.materials[material].heat is not None and not conducts(experiment, material):
                said = f"{material!r} conducts no heat (kappa = 0), and so passes nothing on that it takes in from a tool"
                yield Finding((*at, "heat", "beta"), said, "a kappa above 0, or no `heat` of the tool", on_key=True)


def motion(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """Vectors have the grid's directions; nothing leaves the axis of a round scene."""
    at, dimension, move = ("tools", name, "motion"), experiment.grid.dimension, item.motion
    wrong: list[Finding] = []
    for key in ("velocity", "force"):
        wrong += vector(experiment, (*at, key), getattr(move, key), f"the {key}")
    for index, x in enumerate(move.path.displacement if move.path is not None else ()):
        wrong += vector(experiment, (*at, "path", "displacement", index), x, "a displacement")
    yield from wrong
    if dimension == "axisymmetric" and not wrong:
        radial: list[tuple[tuple, Any]] = [((key, 0), getattr(move, key)) for key in ("velocity", "force") if getattr(move, key) is not None]
        radial += [(("path", "displacement", k, 0), x) for k, x in enumerate(move.path.displacement if move.path is not None else ())]
        for below, x in radial:
            if x[0] != 0:
                yield Finding((*at, *below), "a tool in an axisymmetric scene keeps its distance from the axis", "0", given=x[0])
    spin = move.spin
    if spin is not None and dimension not in (2, 3):
        yield Finding((*at, "spin"), f"there is no rotation in dimension {dimension}", "dimension 2 or 3", on_key=True)
    elif spin is not None and (isinstance(spin, tuple) != (dimension == 3) or (isinstance(spin, tuple) and len(spin) != 3)):
        yield Finding((*at, "spin"), f"the spin needs {'one number' if dimension == 2 else 'three numbers'} in dimension {dimension}")


def met(experiment: Any, index: int, name: str, *_: Any) -> Iterator[Finding]:
    """An observable of a wall, a tool or a pair: that there is such a thing."""
    from mpm.records.variables import BITES
    from mpm.records.variables import met as taken_apart

    found = taken_apart(name)
    if found is None:
        return
    what, of = found[:2]
    bodies = list(experiment.bodies)
    pairs = {f"{a}_{b}": (a, b) for k, a in enumerate(bodies) for b in bodies[k + 1 :]}
    everything = [*WALL_SIDES[experiment.grid.dimension], *experiment.tools, *pairs]
    known = [*(name for _, name in hot(experiment)), *pairs] if what == "heat" else list(experiment.tools) if what in ("travel", *BITES) else everything
    cold = [one for one in pairs.get(of, ()) if what == "heat" and experiment.materials[experiment.bodies[one].material].heat is None]
    if cold:
        said = f"{cold[0]} has no heat, so none passes between the two"
        yield Finding(("output", "observables", index), said, f"a heat section in materials.{experiment.bodies[cold[0]].material}", given=name)
    if of in known:
        return
    said = f"there is no {'tool' if what in ('travel', *BITES) else 'wall, tool or pair of bodies'} {of!r}"
    if what == "heat" and of in everything:
        said = f"{of} has no `heat`, so it passes none"
    yield Finding(("output", "observables", index), said, known or "two bodies", near(of, known), given=name)
