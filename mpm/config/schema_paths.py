"""Slot: what a path in a config may hold, read from the models. One walk serves merging, overrides, short names, sweeps and errors."""

import types
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Union, get_args, get_origin

from mpm.config.base import Kind, Menu, Model
from mpm.config.laws import Constant, Law
from mpm.config.quantities import Auto, Quantity

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Slot:
    """A place for a value: its type without Annotated and None, the annotations found on the way, the field's description, and whether None may stand there."""

    type: Any
    notes: tuple[Any, ...] = ()
    description: str = ""
    optional: bool = False

    @classmethod
    def of(cls, annotation: Any, notes: tuple = (), description: str = "") -> "Slot":
        """Unpack Annotated[...] and Optional[...]."""
        optional = False
        while True:
            if get_origin(annotation) is Annotated:
                annotation, *more = get_args(annotation)
                notes = (*notes, *more)
            elif get_origin(annotation) in (Union, types.UnionType) and type(None) in get_args(annotation):
                optional = True
                left = [item for item in get_args(annotation) if item is not type(None)]
                annotation = left[0] if len(left) == 1 else Union[tuple(left)]  # noqa: UP007
                if len(left) != 1:
                    return cls(annotation, notes, description, optional)
            else:
                return cls(annotation, notes, description, optional)

    def note(self, kind: type) -> Any:
        """The annotation of a class, or None."""
        return next((note for note in self.notes if isinstance(note, kind)), None)

    @property
    def annotated(self) -> Any:
        """The type with its annotations, as pydantic takes it."""
        return Annotated[self.type, *self.notes] if self.notes else self.type

    @property
    def menu(self) -> Menu | None:
        """The menu, where the slot holds a kind."""
        return self.note(Menu)

    @property
    def quantity(self) -> Quantity | None:
        """The unit and bounds, where the slot holds a number or a law."""
        if law := self.note(Law):
            return law.quantity
        auto = self.note(Auto)
        return auto.quantity if auto else self.note(Quantity)

    @property
    def model(self) -> type[Model] | None:
        """The model, where the slot holds one."""
        return self.type if isinstance(self.type, type) and issubclass(self.type, Model) and not self.menu else None

    @property
    def keys(self) -> list[str]:
        """The keys that a mapping here may have, where they are fixed."""
        if self.menu:
            return list(self.menu.kinds)
        return list(self.model.model_fields) if self.model else []

    def step(self, key: str | int) -> "Slot | None":
        """The slot under a key or an index, or None if there can be none."""
        if self.menu:
            kind = self.menu.kinds.get(str(key))
            return Slot(kind) if kind else None
        if self.model:
            if issubclass(self.model, Constant):
                return None
            found = self.model.model_fields.get(str(key))
            return Slot.of(found.annotation, tuple(found.metadata), found.description or "") if found else None
        inner = get_args(self.type)
        if get_origin(self.type) is dict and isinstance(key, str):
            return Slot.of(inner[1], (), self.description)
        if get_origin(self.type) is tuple and isinstance(key, int):
            return Slot.of(inner[0], (), self.description)
        return None

    def under(self, key: str | int) -> "Slot":
        """The slot under a key or an index that the models have; KeyError where there can be none."""
        if (slot := self.step(key)) is None:
            raise KeyError(key)
        return slot

    def walk(self, path: Path) -> "Slot | None":
        """The slot at the end of a path, or None."""
        slot: Slot | None = self
        for key in path:
            slot = slot.step(key) if slot else None
        return slot


def places(slot: Slot, word: str, path: tuple[str, ...] = ()) -> Iterator[str]:
    """Where in any config a field of this name could stand: `materials.<name>.flow.ellipse.eta`."""
    if slot.menu:
        if not slot.note(Law):
            for name, kind in slot.menu.kinds.items():
                yield from places(Slot(kind), word, (*path, name))
    elif slot.model:
        for name in slot.keys:
            if name == word:
                yield ".".join((*path, name))
            yield from places(slot.under(name), word, (*path, name))
    elif get_origin(slot.type) is dict:
        yield from places(slot.under(""), word, (*path, "<name>"))
    elif get_origin(slot.type) is tuple and get_args(slot.type):
        yield from places(slot.under(0), word, (*path, "<n>"))


def leaves(slot: Slot, value: Any, path: Path = ()) -> Iterator[tuple[Path, Slot]]:
    """Every path of a validated model that holds one value: numbers, words, laws (whole, and their entries), kinds."""
    if slot.menu:
        yield path, slot
        if isinstance(value, Kind) and not isinstance(value, Constant):
            yield from leaves(Slot(type(value)), value, (*path, value.kind))
    elif isinstance(value, Model):
        for name in type(value).model_fields:
            yield from leaves(slot.under(name), getattr(value, name), (*path, name))
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from leaves(slot.step(name) or Slot(Any), item, (*path, name))
    elif isinstance(value, tuple):
        if get_origin(slot.type) is tuple:
            if (entry := slot.step(0)) and entry.quantity:
                yield path, slot
            for index, item in enumerate(value):
                yield from leaves(slot.under(index), item, (*path, index))
    elif value is not None or slot.quantity is not None:
        yield path, slot
