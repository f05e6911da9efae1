"""Rules for gravity and loads: directions, what they act on, and what exact solutions know of them."""

from collections.abc import Iterator
from typing import Any

from mpm.config.explain import Finding
from mpm.config.partial import MISSING
from mpm.config.problems import near
from mpm.config.rules_scene import vector
from mpm.config.rules_sides import known_side


def load(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """The body is there and moves, the traction has the grid's directions, the side exists."""
    known, dimension = experiment.bodies, experiment.grid.dimension
    if item.of not in known:
        yield Finding(("loads", index, "of"), "there is no such body", list(known), near(item.of, known), given=item.of)
        return
    name = known[item.of].material
    if dimension == 0:
        yield Finding(("loads", index), "a material point has no surface to load", "loading: [{stress: {zz: ...}}]", on_key=True)
    elif name in experiment.materials and experiment.materials[name].elastic is None:
        yield Finding(("loads", index), f"{name!r} has no elastic law, so the body cannot move", f"an elastic section in materials.{name}", on_key=True)
    elif item.traction is not None:
        for form in ("nominal", "cauchy"):
            yield from vector(experiment, ("loads", index, "traction", form), getattr(item.traction, form), "the traction")
        yield from known_side(experiment, ("loads", index, "side"), item)


def gravity(experiment: Any) -> Iterator[Finding]:
    """One entry a direction; exact solutions of motion know one that stays as it is, and loads that do not end."""
    yield from vector(experiment, ("gravity",), experiment.gravity, "gravity")
    if experiment.grid.dimension == "axisymmetric" and experiment.gravity and experiment.gravity[0] != 0:
        said = "gravity in a round scene points along its axis, and the first number is along r"
        yield Finding(("gravity", 0), said, "0, and the second number along z")
    if experiment.exact is None or experiment.exact.kind == "formulas":
        return
    if any(not isinstance(one, float) for one in experiment.gravity or ()):
        yield Finding(("gravity",), "the exact solution knows gravity that does not change over time only", "a number a direction, or no exact", on_key=True)
    for index, entry in enumerate(experiment.loads):
        for key in ("from", "until"):
            if entry is not MISSING and getattr(entry, key):
                said = "the exact solution knows loads from the start to the end only"
                yield Finding(("loads", index, key), said, "no from and no until, or no exact", on_key=True)
