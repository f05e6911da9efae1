"""Cautions: what is valid in a config and yet seldom meant. Told once, by whoever runs it."""

from collections.abc import Iterator
from typing import Any

from mpm.config.names import ROOT, Names, UnknownName
from mpm.config.nodes import Node
from mpm.config.quantities import Quantity
from mpm.config.schema_paths import Path, leaves

COLD = 223.15  # K, -50 °C: below it a number without a unit was rather meant in degrees Celsius
MOST_TOLD = 5


def cautions(experiment: Any) -> list[str]:
    """Temperatures that are numbers without a unit, and colder than the applications of this code: 20 is 20 K. Snapshots that no picture can show.

    Empty where nothing is known of the config's text.
    """
    root: Node | None = experiment._tree
    if root is None:
        return []
    found = []
    for path, quantity in temperatures(experiment):
        for node in numbers(root, path):
            if quantity.unit == "K" and not quantity.difference and 0 < node.value < COLD:
                place, value = ".".join(map(str, path)), f"{node.value:g}"
                said = f"{value} without a unit is {value} K, {node.value - 273.15:.4g} °C; say '{value} degC' or '{value} K'"
                found.append(str(node.origin.problem(node.line, node.column, place, said)))
    rest = len(found) - MOST_TOLD
    return found[:MOST_TOLD] + ([f"and {rest} more temperatures without a unit"] if rest > 0 else []) + undrawn(experiment, root)


def undrawn(experiment: Any, root: Node) -> list[str]:
    """Snapshots of particles without their positions."""
    shots = experiment.output.snapshots
    node: Node | None = root
    if shots is None or not shots.particles or "position" in shots.particles:
        return []
    for key in ("output", "snapshots", "particles"):
        node = node.child(key) if node is not None else None
    said = "without position the snapshots cannot be drawn, made a movie of or exported; add position"
    return [str(node.origin.problem(node.line, node.column, "output.snapshots.particles", said))] if node is not None else []


def temperatures(experiment: Any) -> Iterator[tuple[Path, Quantity]]:
    """Paths of the config that hold a quantity: in its sections, and in what its sweep and its fit vary."""
    for path, slot in leaves(ROOT, experiment):
        if slot.quantity is not None and path[0] not in ("sweep", "fit"):
            yield path, slot.quantity
    meant = spoken(experiment)
    yield from ((("parameters", name, "value"), quantity) for name, quantity in meant.items())
    if not (places := [*varied(experiment)]):
        return
    names = Names(experiment)
    for path, name in places:
        try:
            quantity = meant.get(name) or names.resolve(name)[1].quantity
        except UnknownName:
            continue  # told when the sweep or the fit is planned
        if quantity is not None:
            yield path, quantity


def spoken(experiment: Any) -> dict[str, Quantity]:
    """What named parameters without a unit are taken for where they stand alone: `temperature: =start`."""
    found = {}
    for path, slot in leaves(ROOT, experiment):
        name = experiment.formulas.get(".".join(map(str, path)), "")
        if slot.quantity is not None and name in experiment.parameters and not experiment.parameters[name].unit:
            found[name] = slot.quantity
    return found


def varied(experiment: Any) -> Iterator[tuple[Path, str]]:
    """Where each parameter's values stand, of a sweep and of a fit."""
    if (fit := experiment.fit) is not None:
        yield from ((("fit", "parameters", name), name) for name in fit.parameters)
    if (sweep := experiment.sweep) is None:
        return
    yield from ((("sweep", "axes", name), name) for name in sweep.axes)
    for form in ("zip", "points"):
        yield from (((("sweep", form, index, name)), name) for index, entry in enumerate(getattr(sweep, form)) for name in entry)
    if sweep.sample is not None:
        yield from ((("sweep", "sample", sweep.sample.kind, "ranges", name), name) for name in sweep.sample.ranges)


def numbers(root: Node, path: Path) -> Iterator[Node]:
    """The plain numbers at a path: one, those of a list, or the ends of a range."""
    node: Node | None = root
    for key in path:
        node = node.child(key) if node is not None else None
    if node is None:
        return
    if isinstance(node.value, dict):
        for word in ("linear", "log"):
            if (ends := node.child(word)) is not None and isinstance(ends.value, list):
                yield from (end for end in ends.value[:2] if plain(end))
    elif isinstance(node.value, list):
        yield from (item for item in node.value if plain(item))
    elif plain(node):
        yield node


def plain(node: Node) -> bool:
    """Whether a node is a number without a unit."""
    return isinstance(node.value, int | float) and not isinstance(node.value, bool)
