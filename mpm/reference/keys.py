"""Keys and kinds of configs, from the models: description, unit, what is allowed, default, example."""

import json
import math
from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from mpm.config.base import Kind
from mpm.config.examples import example
from mpm.config.experiment import Experiment, plain
from mpm.config.laws import Constant
from mpm.config.quantities import Auto, Quantity, Whole
from mpm.config.schema_paths import Slot
from mpm.records.variables import FIELDS_GRID, FIELDS_PARTICLES, MET, OBSERVABLES
from mpm.reference.entry import Entry


def entries() -> list[Entry]:
    """Every key and every kind, in the order of the config; each key at the first place where its class stands."""
    return list(walk(Slot(Experiment), (), set()))


FIXED = {  # texts of which only some are allowed
    "output.observables": (
        *OBSERVABLES,
        "time_to.<probe>.95_degC",
        "displacement.<probe>_<axis>",
        "stress.<probe>_<part>",
        *(f"{what}.<wall, tool or pair>" for what in MET),
    ),
    "output.snapshots.grid": FIELDS_GRID,
    "output.snapshots.particles": FIELDS_PARTICLES,
}


def walk(slot: Slot, path: tuple[str, ...], seen: set[Any]) -> Iterator[Entry]:
    """The entries below a place. Laws are described once for each parameter, their keys too, since their units differ."""
    if slot.menu:
        for name, kind in slot.menu.kinds.items():
            if not issubclass(kind, Constant):
                yield of_kind(name, kind, slot.menu.what, path)
                yield from below(kind, (*path, name), seen)
    elif slot.model:
        yield from below(slot.model, path, seen)
    elif get_origin(slot.type) is dict:
        yield from walk(slot.under(""), (*path, "<name>"), seen)
    elif get_origin(slot.type) is tuple and get_args(slot.type):
        yield from walk(slot.under(0), (*path, "<n>"), seen)


def below(model: Any, path: tuple[str, ...], seen: set[Any]) -> Iterator[Entry]:
    """The keys of a model, each followed by what lies below it."""
    again = model in seen
    seen.add(model)
    for name in model.model_fields:
        slot = Slot(model).under(name)
        yield of_key(model, name, slot, (*path, name))
        if not again:
            yield from walk(slot, (*path, name), seen)


def of_kind(name: str, kind: type[Kind], what: str, path: tuple[str, ...]) -> Entry:
    """A kind of a menu."""
    keys = ", ".join(f"{key}{'' if field.is_required() else '?'}" for key, field in kind.model_fields.items())
    said = " ".join((kind.__doc__ or "").split())
    return Entry(
        ".".join((*path, name)), f"{what}, a kind", said, {"keys": keys or "none", "written": f"`{name}`" if kind.bare() else f"`{{{name}: {{...}}}}`"}
    )


def of_key(model: Any, name: str, slot: Slot, path: tuple[str, ...]) -> Entry:
    """A key of a model."""
    bases = tuple(base.__name__ for base in model.__mro__)
    shown = example(model.__name__, name, slot, bases)
    facts = {
        "unit": slot.quantity.units if slot.quantity else "",
        "allowed": ", ".join(FIXED.get(".".join(path), ())) or allowed(slot),
        "default": default(model.model_fields[name]),
        "example": f"`{name}: {flow(shown)}`",
    }
    return Entry(".".join(path), "key of a config", slot.description, facts)


def allowed(slot: Slot) -> str:
    """What may stand here, in words."""
    if slot.quantity is not None:
        kinds = [name for name in slot.menu.kinds if name != "constant"] if slot.menu else []
        found = (["auto"] if slot.note(Auto) else []) + [bounds(slot.quantity)] + ([f"or {', '.join(kinds)}"] if kinds else [])
        return "; ".join(found)
    if slot.menu:
        return ", ".join(slot.menu.kinds)
    if whole := slot.note(Whole):
        return f"a whole number from {whole.least} to {whole.most}"
    if get_origin(slot.type) is Literal:
        return ", ".join(map(str, get_args(slot.type)))
    if slot.model:
        return "a mapping: " + ", ".join(slot.model.model_fields)
    origin = get_origin(slot.type)
    return "a mapping by name" if origin is dict else "a list" if origin is tuple else {bool: "true, false", str: "text"}.get(slot.type, "")


def bounds(quantity: Quantity) -> str:
    """`a number above 0, or .inf`."""
    limits = ((quantity.above, "above"), (quantity.least, "at least"), (quantity.most, "at most"))
    found = " and ".join(f"{word} {limit:g}" for limit, word in limits if math.isfinite(limit))
    return f"a number{f' {found}' if found else ''}{', or .inf' if quantity.infinite else ''}"


def default(field: Any) -> str:
    """The default as a config would write it; nothing where the key is needed."""
    if field.is_required():
        return "required"
    value = plain(field.default, defaults=False)
    if value in (None, [], {}, ""):
        return "absent"
    if isinstance(field.default, Kind) and not value[field.default.kind]:
        return field.default.kind
    return flow(value)


def flow(value: Any) -> str:
    """A value as YAML writes it on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(flow, value)) + "]"
    if isinstance(value, bool) or value is None:
        return json.dumps(value)
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return f'"{text}"' if isinstance(value, str) and any(sign in text for sign in ":#=[]{}*&") else text
