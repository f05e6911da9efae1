"""Checks across sections: names exist, vectors have the grid's dimension, physics has what it needs.

Each rule sees one item and yields findings. A rule that meets a value that is MISSING (already reported) is given up alone.
To add a rule: write it, list it in `RULES` with the items it is for.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mpm.config.boundary import EXCHANGES, SURFACE_SIDES, WALL_SIDES
from mpm.config.explain import Finding
from mpm.config.loose import MISSING, Unknown
from mpm.config.problems import MOST_FINDINGS, near
from mpm.config.shapes_fit import misfits, outside
from mpm.config.slots import Path, Slot

MOST_CELLS = 10**9
MOST_SAMPLES = 10**6

Rule = Callable[..., Iterable[Finding]]


def check(experiment: Any) -> list[Finding]:
    """Everything that is wrong across sections of an experiment, whole or loose."""
    found: list[Finding] = []
    for rule, items in RULES:
        try:
            listed = list(items(experiment))
        except Unknown:
            continue
        for item in listed:
            if len(found) > MOST_FINDINGS:
                return found
            try:
                found += list(rule(experiment, *item))
            except Unknown:
                continue
    return found


def unread(path: Path, slot: Slot) -> bool:
    """Whether no rule reads the value of a path, so that changing it cannot break one: numbers and laws of materials and surfaces."""
    return path[0] in ("materials", "surfaces") and slot.quantity is not None


def once(experiment: Any) -> Iterator[tuple]:
    yield ()


def each(section: str) -> Callable[[Any], Iterator[tuple]]:
    """Items of a mapping or list: (key, item)."""

    def items(experiment: Any) -> Iterator[tuple]:
        content = getattr(experiment, section)
        yield from enumerate(content) if isinstance(content, tuple) else list(content.items())

    return items


def vector(experiment: Any, path: Path, value: Any, what: str) -> Iterator[Finding]:
    """One number a direction."""
    wanted = experiment.grid.directions
    if value is not None and len(value) != wanted:
        said = f"{what} needs {wanted} number{'s' * (wanted != 1)} in dimension {experiment.grid.dimension}, found {len(value)}"
        yield Finding(path, said, "one number a direction", given=list(value))


def plain_names(experiment: Any, section: str, names: Iterable[str]) -> Iterator[Finding]:
    """Names become variables and paths."""
    for name in names:
        if not name.isidentifier() or not name.isascii():
            yield Finding(
                (*section.split("."), name), f"{name[:60]!r} is not a plain name", "letters, digits and underscores, not beginning with a digit", on_key=True
            )


def names(experiment: Any) -> Iterator[Finding]:
    for section, content in (("bodies", experiment.bodies), ("materials", experiment.materials)):
        yield from plain_names(experiment, section, content)


def grid(experiment: Any) -> Iterator[Finding]:
    size, cell = experiment.grid.size, experiment.grid.cell
    yield from vector(experiment, ("grid", "size"), size, "the size")
    for index, length in enumerate(size):
        if cell > length * (1 + 1e-9):
            yield Finding(("grid", "cell"), f"the cell is larger than the domain in direction {index}", f"at most {length:g} [m]", given=cell)
    cells = math.prod(math.ceil(length / cell) for length in size) if cell > 0 and all(length / cell < MOST_CELLS for length in size) else MOST_CELLS + 1
    if cells > MOST_CELLS:
        yield Finding(("grid", "cell"), "the grid would have more than a billion cells", "a larger cell or a smaller size", given=cell)


def body(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    known = experiment.materials
    if item.material not in known:
        yield Finding(("bodies", name, "material"), "there is no such material", list(known), near(item.material, known), given=item.material)


def body_shape(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    at = ("bodies", name, "shape", item.shape.kind)
    wrong = [Finding((*at, *below), message, allowed) for below, message, allowed in misfits(item.shape, experiment.grid.dimension, experiment.grid.directions)]
    yield from wrong
    if not wrong and len(experiment.grid.size) == experiment.grid.directions and (said := outside(item.shape, experiment.grid.dimension, experiment.grid.size)):
        yield Finding(("bodies", name, "shape"), said, "a shape inside [0, size]", on_key=True)


def body_motion(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    dimension = experiment.grid.dimension
    if item.velocity is not None:
        yield from vector(experiment, ("bodies", name, "velocity"), item.velocity, "the velocity")
    spin, at = item.angular_velocity, ("bodies", name, "angular_velocity")
    if spin is not None:
        if dimension not in (2, 3):
            yield Finding(at, f"there is no rotation in dimension {dimension}", "dimension 2 or 3", on_key=True)
        elif isinstance(spin, tuple) != (dimension == 3) or (isinstance(spin, tuple) and len(spin) != 3):
            yield Finding(at, f"the angular velocity needs {'one number' if dimension == 2 else 'three numbers'} in dimension {dimension}")
    for key in ("velocity", "angular_velocity"):
        if getattr(item, key) is not None and item.material in experiment.materials and experiment.materials[item.material].elastic is None:
            yield Finding(
                ("bodies", name, key),
                f"{item.material!r} has no elastic law, so the body cannot move",
                f"an elastic section in materials.{item.material}",
                on_key=True,
            )


def material(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    needs = (
        ("flow", ("elastic",)),
        ("expansion", ("elastic", "heat")),
        ("heating", ("elastic", "heat")),
    )
    for section, wanted in needs:
        absent = [key for key in wanted if getattr(item, key) is None]
        if getattr(item, section) is not None and absent:
            yield Finding(
                ("materials", name, section),
                f"{section} needs {' and '.join(wanted)}, and there is no {' and no '.join(absent)}",
                f"materials.{name}.{absent[0]}",
                on_key=True,
            )
    if item.heating is not None:
        for part, section in (("elastic", "expansion"), ("dissipation", "flow")):
            if getattr(item.heating, part) is not None and getattr(item, section) is None:
                yield Finding(("materials", name, "heating", part), f"{part} heating needs {section}", f"materials.{name}.{section}", on_key=True)


def anything(experiment: Any) -> Iterator[Finding]:
    used = [experiment.materials[item.material] for item in experiment.bodies.values() if item.material in experiment.materials]
    if used and all(item.elastic is None and item.heat is None for item in used):
        yield Finding(("materials",), "no body has any physics, so there is nothing to compute", "an elastic or a heat section", on_key=True)


def surface(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    known = experiment.bodies
    if item.of not in known:
        yield Finding(("surfaces", index, "of"), "there is no such body", list(known), near(item.of, known), given=item.of)
        return
    name = experiment.bodies[item.of].material
    if name in experiment.materials and experiment.materials[name].heat is None:
        for key in EXCHANGES:
            if getattr(item, key) is not None:
                yield Finding(
                    ("surfaces", index, key), f"{name!r} has no heat law, so nothing can be exchanged", f"a heat section in materials.{name}", on_key=True
                )


def surface_side(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    sides = SURFACE_SIDES[experiment.grid.dimension]
    if item.side not in sides:
        yield Finding(
            ("surfaces", index, "side"), f"there is no such side in dimension {experiment.grid.dimension}", list(sides), near(item.side, sides), given=item.side
        )


def surface_names(experiment: Any) -> Iterator[Finding]:
    seen: dict[str, int] = {}
    for index, item in enumerate(experiment.surfaces):
        if item is not MISSING and item.name is not None and seen.setdefault(item.name, index) != index:
            yield Finding(("surfaces", index, "name"), "two surfaces have the same name", "a name of its own", given=item.name)


def moves(experiment: Any) -> bool:
    """Whether any body is elastic; a section that is there but wrong counts."""
    return any(experiment.materials[item.material].elastic is not None for item in experiment.bodies.values() if item.material in experiment.materials)


def heats(experiment: Any) -> bool:
    """Whether any body has heat."""
    return any(experiment.materials[item.material].heat is not None for item in experiment.bodies.values() if item.material in experiment.materials)


def walls(experiment: Any, side: str, item: Any) -> Iterator[Finding]:
    sides = WALL_SIDES[experiment.grid.dimension]
    if side not in sides:
        yield Finding(("walls", side), f"there is no such wall in dimension {experiment.grid.dimension}", list(sides), near(side, sides), on_key=True)


def mechanics(experiment: Any) -> Iterator[Finding]:
    if (experiment.walls or experiment.gravity is not None) and not moves(experiment):
        for key in ("walls", "gravity"):
            if getattr(experiment, key):
                yield Finding((key,), f"no body is elastic, so {key} would do nothing", "an elastic section in the material of a body", on_key=True)


def gravity(experiment: Any) -> Iterator[Finding]:
    yield from vector(experiment, ("gravity",), experiment.gravity, "gravity")


def clock(experiment: Any) -> Iterator[Finding]:
    every, end = experiment.output.every, experiment.time.end
    if every is not None and end / every > MOST_SAMPLES:
        yield Finding(("output", "every"), f"the series would have {end / every:.3g} samples", f"at least {end / MOST_SAMPLES:g} [s]", given=every)
    shots = experiment.output.snapshots
    if shots is not None and end / shots.every > MOST_SAMPLES:
        yield Finding(
            ("output", "snapshots", "every"), f"there would be {end / shots.every:.3g} snapshots", f"at least {end / MOST_SAMPLES:g} [s]", given=shots.every
        )


def probe(experiment: Any, name: str, point: Any) -> Iterator[Finding]:
    path = ("output", "probes", name)
    yield from plain_names(experiment, "output.probes", [name])
    wrong = list(vector(experiment, path, point, "a probe"))
    yield from wrong
    for index, (x, length) in enumerate(zip(point, experiment.grid.size, strict=False) if not wrong else ()):
        if not 0 <= x <= length:
            yield Finding((*path, index), "the probe lies outside the domain", f"0 to {length:g} [m]", given=x)


def probes(experiment: Any) -> Iterator[tuple]:
    yield from list(experiment.output.probes.items())


def observables(experiment: Any) -> Iterator[tuple]:
    physics = (known(heats, experiment), known(moves, experiment))
    yield from ((index, name, *physics) for index, name in enumerate(experiment.output.observables))


def known(question: Callable[[Any], bool], experiment: Any) -> bool:
    """The answer, and yes where it is not known."""
    try:
        return question(experiment)
    except Unknown:
        return True


def observable(experiment: Any, index: int, name: str, hot: bool, moving: bool) -> Iterator[Finding]:
    from mpm.records.variables import OBSERVABLES, fits, observable_exists, threshold

    path = ("output", "observables", index)
    if not observable_exists(name):
        dimension = experiment.grid.dimension
        allowed = [word for word in OBSERVABLES if dimension is MISSING or fits(word, dimension)] + [
            "time_to.<probe>.<value>_degC",
            "time_to.<probe>.<value>_K",
        ]
        yield Finding(path, "unknown observable", allowed, near(name, OBSERVABLES), given=name)
        return
    found = threshold(name)
    if found is not None:
        known = experiment.output.probes
        if found.probe not in known:
            yield Finding(path, f"there is no probe {found.probe!r}", list(known) or "a probe under output.probes", near(found.probe, known), given=name)
    elif not fits(name, experiment.grid.dimension):
        yield Finding(
            path,
            f"there is no such direction in dimension {experiment.grid.dimension}",
            [word for word in OBSERVABLES if fits(word, experiment.grid.dimension)],
            given=name,
        )
    family = name.split(".", maxsplit=1)[0]
    if family in ("temperature", "heat", "time_to") and not hot:
        yield Finding(path, "no body has heat", "a heat section in the material of a body", given=name)
    if family in ("momentum", "energy", "dissipation", "position", "extent", "velocity", "J", "pressure", "strain") and not moving:
        yield Finding(path, "no body is elastic, so nothing moves", "an elastic section in the material of a body", given=name)


def snapshots(experiment: Any) -> Iterator[Finding]:
    from mpm.records.variables import FIELDS_GRID, FIELDS_PARTICLES

    shots = experiment.output.snapshots
    for key, allowed in (("grid", FIELDS_GRID), ("particles", FIELDS_PARTICLES)) if shots is not None else ():
        for index, name in enumerate(getattr(shots, key)):
            if name not in allowed:
                yield Finding(("output", "snapshots", key, index), "unknown field", list(allowed), near(name, allowed), given=name)


def method(experiment: Any) -> Iterator[Finding]:
    if experiment.method.offset:
        yield from vector(experiment, ("method", "offset"), experiment.method.offset, "the offset")


def exact(experiment: Any) -> Iterator[Finding]:
    solution = experiment.exact
    if solution is None:
        return
    known = list(experiment.bodies)
    path = ("exact", solution.kind, "body")
    if solution.body is None and len(known) > 1:
        yield Finding(path, "there are several bodies; say which one", known)
    elif solution.body is not None and solution.body not in known:
        yield Finding(path, "there is no such body", known, near(solution.body, known), given=solution.body)


RULES: list[tuple[Rule, Callable[[Any], Iterator[tuple]]]] = [
    (names, once), (grid, once), (body, each("bodies")), (body_shape, each("bodies")), (body_motion, each("bodies")), (material, each("materials")),
    (anything, once), (surface, each("surfaces")), (surface_side, each("surfaces")), (surface_names, once), (walls, each("walls")), (mechanics, once),
    (gravity, once), (clock, once), (probe, probes), (observable, observables), (snapshots, once), (method, once), (exact, once),
]  # fmt: skip
