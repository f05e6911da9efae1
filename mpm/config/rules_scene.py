"""Rules for bodies, materials, surfaces, walls and grid: names exist, vectors have the grid's dimension, physics has what it needs."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

from mpm.config.boundary import EXCHANGES, SURFACE_SIDES, WALL_SIDES, spell
from mpm.config.explain import Finding
from mpm.config.partial import MISSING, Unknown
from mpm.config.problems import near
from mpm.config.rules_sides import is_of_shape, known_side
from mpm.config.schema_paths import Path
from mpm.config.shapes_fit import misfits, outside

MOST_CELLS = 10**9
MOST_LETTERS = 100  # of a name: it becomes a variable's, and those of HDF5 end at 64 kB


def vector(experiment: Any, path: Path, value: Any, what: str) -> Iterator[Finding]:
    """One number a direction."""
    wanted = experiment.grid.directions
    if value is not None and len(value) != wanted:
        said = f"{what} needs {wanted} number{'s' * (wanted != 1)} in dimension {experiment.grid.dimension}, found {len(value)}"
        yield Finding(path, said, "one number a direction", given=list(value))


def plain_names(experiment: Any, section: str, names: Iterable[str]) -> Iterator[Finding]:
    """Names become variables and paths."""
    for name in names:
        if len(name) > MOST_LETTERS:
            said = f"the name {name[:20]!r}... has {len(name)} letters"
            yield Finding((*section.split("."), name), said, f"at most {MOST_LETTERS} letters", on_key=True)
        elif not name.isidentifier() or not name.isascii():
            yield Finding(
                (*section.split("."), name), f"{name[:60]!r} is not a plain name", "letters, digits and underscores, not beginning with a digit", on_key=True
            )


def names(experiment: Any) -> Iterator[Finding]:
    for section, content in (("bodies", experiment.bodies), ("materials", experiment.materials)):
        yield from plain_names(experiment, section, content)


def grid(experiment: Any) -> Iterator[Finding]:
    """One length a direction, no cell larger than the domain, and at most a billion cells."""
    size, cell = experiment.grid.size, experiment.grid.cell
    if cell is None or not size:
        return  # rules_point.py says what is missing, and what is not wanted
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
    """A shape suits the dimension and lies in the domain."""
    at = ("bodies", name, "shape", item.shape.kind)
    wrong = [Finding((*at, *below), message, allowed) for below, message, allowed in misfits(item.shape, experiment.grid.dimension, experiment.grid.directions)]
    yield from wrong
    if not wrong and len(experiment.grid.size) == experiment.grid.directions and (said := outside(item.shape, experiment.grid.dimension, experiment.grid.size)):
        yield Finding(("bodies", name, "shape"), said, "a shape inside [0, size]", on_key=True)


def body_motion(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """A velocity has a number a direction, a rotation is in a plane or in space, and what moves is elastic."""
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
    """What each section needs is there, and laws stand together only where that is known."""
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
    if item.elastic is not None and item.elastic.kind == "neo_hookean":
        if item.elastic.E is not None and item.elastic.E.kind != "constant":
            yield Finding(("materials", name, "elastic", "neo_hookean", "E"), "neo_hookean has one E at all temperatures", "a number, or elastic: hencky")
        for section in ("flow", "expansion"):
            if getattr(item, section) is not None:
                yield Finding(("materials", name, section), f"neo_hookean is elastic only: it has no {section}", "elastic: hencky", on_key=True)
    if item.heating is not None and item.heating.elastic is not None and item.expansion is not None and item.expansion.kind == "latched":
        said = "latched expansion is not reversible, so it has no elastic heating"
        yield Finding(("materials", name, "heating", "elastic"), said, "linear, modulus or source", on_key=True)
    compressed = item.heating is not None and item.heating.elastic is not None and item.elastic is not None
    if compressed and item.elastic.E is not None and item.elastic.E.kind != "constant":
        said = "elastic heating is known for constant moduli only: E that follows temperature stores work of its own"
        yield Finding(("materials", name, "heating", "elastic"), said, "a constant E, or no elastic heating", on_key=True)
    if item.heating is not None:
        for part, section in (("elastic", "expansion"), ("dissipation", "flow")):
            if getattr(item.heating, part) is not None and getattr(item, section) is None:
                yield Finding(("materials", name, "heating", part), f"{part} heating needs {section}", f"materials.{name}.{section}", on_key=True)


def anything(experiment: Any) -> Iterator[Finding]:
    """Some body has heat or elasticity."""
    if not moves(experiment) and not heats(experiment):
        yield Finding(("materials",), "no body has any physics, so there is nothing to compute", "an elastic or a heat section", on_key=True)


def surface(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """A surface is of a body that is there, and exchanges heat only where that has some."""
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


def conducts(experiment: Any, name: str) -> bool:
    """Whether a material passes heat inwards: not with kappa = 0. A material point has one temperature, and no kappa."""
    kappa = experiment.materials[name].heat.kappa
    return experiment.grid.dimension == 0 or kappa.kind != "constant" or kappa.value > 0


def surface_conducts(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """What depends on the temperature of the surface needs conduction behind it; a given flux does not."""
    name = experiment.bodies[item.of].material
    if experiment.materials[name].heat is None or conducts(experiment, name):
        return
    acts = {"convection": item.convection and item.convection.beta != 0.0, "fixed": item.fixed}
    acts |= {"radiation": item.radiation and item.radiation.emissivity != 0.0}
    for key, acting in acts.items():
        if acting:
            said = f"{name!r} conducts no heat (kappa = 0): its surface would be as warm as what it meets at once, and pass nothing on"
            yield Finding(("surfaces", index, key), said, "a kappa above 0, or only a flux", on_key=True)


def surface_side(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """There is such a side in the dimension."""
    yield from known_side(experiment, ("surfaces", index, "side"), item)


def covered(side: str, dimension: Any) -> set[str]:
    """The sides that a side's name stands for."""
    every = ({*SURFACE_SIDES[dimension]} - {"all"} - ({"lateral"} if dimension in (3, "axisymmetric") else set())) or {"all"}
    return every if side == "all" else every - {"bottom", "top"} if side == "lateral" else {side}


def shared(one: str, other: str, dimension: Any) -> list[str]:
    """Sides that are in both. A side of the shape itself may lie on any of those that are told by normals."""
    of_shape = [side for side in (one, other) if is_of_shape(side, dimension)]
    if of_shape:
        return of_shape[:1] if one == other or len(of_shape) == 1 else []
    return sorted(covered(one, dimension) & covered(other, dimension))


def surface_twice(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """One exchange of a kind on a side; a fixed temperature is a convection of infinite beta."""
    dimension = experiment.grid.dimension
    for kind in EXCHANGES:
        alike = ("convection", "fixed") if kind in ("convection", "fixed") else (kind,)
        for before in range(index + (kind == "fixed")):
            other = experiment.surfaces[before]
            if other is MISSING or other.of != item.of or getattr(item, kind) is None:
                continue
            same = [name for name in alike if getattr(other, name) is not None and (before < index or name != kind)]
            both = shared(item.side, other.side, dimension)
            (begin, end), (start, stop) = spell(item), spell(other)
            if same and both and max(begin, start) < min(end, stop):
                said = f"{item.of!r} has a {same[0]} there already, from surfaces.{before} (side {other.side})"
                yield Finding(("surfaces", index, kind), said, f"one a side: join the two, or give each its own ({', '.join(both)})", on_key=True)


def surface_names(experiment: Any) -> Iterator[Finding]:
    seen: dict[str, int] = {}
    for index, item in enumerate(experiment.surfaces):
        if item is not MISSING and item.name is not None and seen.setdefault(item.name, index) != index:
            yield Finding(("surfaces", index, "name"), "two surfaces have the same name", "a name of its own", given=item.name)


def contact(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """Two bodies that are there and are not named together elsewhere; of bodies that do not move only heat can be said."""
    known, at = experiment.bodies, ("contacts", index, "between")
    if len(item.between) != 2:
        return  # told where it is read
    for place, name in enumerate(item.between):
        if name not in known:
            yield Finding((*at, place), "there is no such body", list(known), near(name, known), given=name)
            return
    if item.between[0] == item.between[1]:
        yield Finding((*at, 1), "the same body twice: a body does not meet itself", [name for name in known if name != item.between[0]], given=item.between[1])
    elif any(frozenset(other.between) == frozenset(item.between) for other in experiment.contacts[:index] if other is not MISSING):
        yield Finding(at, "this pair is named before", "one entry a pair", on_key=True)
    elif item.conductance and (cold := [name for name in item.between if experiment.materials[known[name].material].heat is None]):
        said = f"{cold[0]} has no heat law, so no heat passes between the two"
        yield Finding(("contacts", index, "conductance"), said, f"a heat section in materials.{known[cold[0]].material}, or no conductance", on_key=True)
    elif moves(experiment):
        for key in ("from", "until"):
            if getattr(item, key) and item.welded is not None:
                said = "what is welded is one body to motion, for ever"
                yield Finding(("contacts", index, key), said, "stick, which may begin and end, or no from and no until", on_key=True)
    else:
        for key in ("friction", "stick", "welded"):
            if getattr(item, key) not in (None, 0.0):
                yield Finding(("contacts", index, key), "no body here has an elastic law, so nothing slides: only heat can pass", "conductance", on_key=True)


def used(experiment: Any) -> list[Any]:
    """Materials of all bodies; Unknown if a body names one that is not there, since then nothing can be said of what the bodies do."""
    if any(item.material not in experiment.materials for item in experiment.bodies.values()):
        raise Unknown
    return [experiment.materials[item.material] for item in experiment.bodies.values()]


def moves(experiment: Any) -> bool:
    """Whether any body is elastic; a section that is there but wrong counts."""
    return any(item.elastic is not None for item in used(experiment))


def heats(experiment: Any) -> bool:
    """Whether any body has heat."""
    return any(item.heat is not None for item in used(experiment))


def hot(experiment: Any) -> list[tuple[str, str]]:
    """(section, name) of the walls and tools that have `heat`."""
    return [(section, name) for section in ("walls", "tools") for name, one in getattr(experiment, section).items() if getattr(one, "heat", None) is not None]


def walls(experiment: Any, side: str, item: Any) -> Iterator[Finding]:
    """There is such a wall in the dimension, and what could take heat from it."""
    sides = WALL_SIDES[experiment.grid.dimension]
    if side not in sides:
        yield Finding(("walls", side), f"there is no such wall in dimension {experiment.grid.dimension}", list(sides), near(side, sides), on_key=True)
    elif spell(item) != (0.0, math.inf) and item.heat is None and item.friction == 0.0:
        said = "a side of the domain stays where it is: without friction and heat it is the same before and after"
        yield Finding(("walls", side, item.kind), said, "heat, or friction of a contact, or no from and no until", on_key=True)
    elif item.heat is not None and not heats(experiment):
        said = "no body has heat, so nothing can be exchanged"
        yield Finding(("walls", side, item.kind, "heat"), said, "a heat section in the material of a body", on_key=True)
    elif item.heat is not None and item.heat.beta != 0.0:
        for name in sorted({body.material for body in experiment.bodies.values()}):
            if experiment.materials[name].heat is not None and not conducts(experiment, name):
                said = f"{name!r} conducts no heat (kappa = 0), so it can take none from the wall"
                yield Finding(("walls", side, item.kind, "heat"), said, f"a kappa above 0 in materials.{name}", on_key=True)


def mechanics(experiment: Any) -> Iterator[Finding]:
    """Walls and gravity have a body to act on."""
    if (experiment.walls or experiment.gravity is not None) and not moves(experiment):
        for key in ("walls", "gravity"):
            if getattr(experiment, key):
                yield Finding((key,), f"no body is elastic, so {key} would do nothing", "an elastic section in the material of a body", on_key=True)


def scaling(experiment: Any) -> Iterator[Finding]:
    """Time scaling trades inertia for speed: without inertia there is nothing to trade, and an exact solution has its own clock."""
    if experiment.time.scale != 1 and (experiment.grid.dimension == 0 or not moves(experiment)):
        yield Finding(("time", "scale"), "nothing here has inertia, so time scaling would do nothing", "no scale", on_key=True)
    elif experiment.time.scale != 1 and experiment.exact is not None:
        yield Finding(("time", "scale"), "an exact solution is not scaled in time", "no scale, or no exact", on_key=True)


def method(experiment: Any) -> Iterator[Finding]:
    if experiment.method.offset:
        yield from vector(experiment, ("method", "offset"), experiment.method.offset, "the offset")
