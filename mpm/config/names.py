"""Names: from what a user writes, `kappa`, `κ`, `surfaces.top.convection.beta`, to the one path in this file that answers to it."""

import re
from collections import defaultdict
from typing import Any

from mpm.config.base import Kind, Model
from mpm.config.experiment import Experiment
from mpm.config.laws import Constant
from mpm.config.parameters import slot_of
from mpm.config.problems import near
from mpm.config.schema_paths import Path, Slot, leaves, places

GREEK = {"κ": "kappa", "β": "beta", "α": "alpha", "η": "eta"}
NOT_VARIED = ("title", "sweep", "smoke", "chart", "stability", "fit", "formulas")
ROOT = Slot(Experiment)


def dots(name: str) -> str:
    """`upper[0]` as `upper.0`."""
    return re.sub(r"\[(\d+)\]", r".\1", name)


class UnknownName(ValueError):
    """No path, or more than one, answers to a name."""

    def __init__(self, message: str, allowed: Any = "", suggestion: str = ""):
        super().__init__(message)
        self.message, self.allowed, self.suggestion = message, allowed, suggestion


class Names:
    """The paths of one experiment that can be set or swept, found by their whole name or by any tail that only one of them has."""

    def __init__(self, experiment: Any):
        self.experiment = experiment
        self.slots: dict[Path, Slot] = {}
        self.spoken: dict[Path, str] = {}
        self.tails: dict[tuple[str, ...], dict[Path, None]] = defaultdict(dict)
        surfaces = experiment.surfaces if isinstance(experiment.surfaces, tuple) else ()
        declared = experiment.parameters if isinstance(experiment.parameters, dict) else {}
        self.declared: dict[str, Path] = {name: ("parameters", name, "value") for name in declared}
        differences = self.differences() if declared else set()
        for name, path in self.declared.items():
            self.slots[path], self.spoken[path] = slot_of(name, declared[name], name in differences), f"parameters.{name}"
            self.tails[(name,)][path] = self.tails[("parameters", name)][path] = None
        models = [(index, surface) for index, surface in enumerate(surfaces) if isinstance(surface, Model)]
        called = {index: named for index, surface in models if isinstance(named := getattr(surface, "name", None), str)}
        for path, slot in leaves(ROOT, experiment):
            if path[0] in (*NOT_VARIED, "parameters"):
                continue
            self.slots[path] = slot
            forms = [tuple(map(str, path))]
            if path[0] == "surfaces" and path[1:2] and path[1] in called:
                forms.append(("surfaces", called[path[1]], *map(str, path[2:])))
            self.spoken[path] = ".".join(forms[-1])
            for form in forms:
                for start in range(len(form)):
                    self.tails[form[start:]][path] = None

    def differences(self) -> set[str]:
        """Named parameters that stand alone where a difference of temperatures does."""
        formulas = self.experiment.formulas if isinstance(self.experiment.formulas, dict) else {}
        slots = ((text, ROOT.walk(tuple(int(word) if word.isdigit() else word for word in path.split(".")))) for path, text in formulas.items())
        return {text for text, slot in slots if slot is not None and slot.quantity is not None and slot.quantity.difference and slot.quantity.unit == "K"}

    def resolve(self, name: str) -> tuple[Path, Slot]:
        """The path and slot that a name stands for; UnknownName lists what would do."""
        parts = tuple(GREEK.get(part, part) for part in dots(name).split("."))
        if parts[-1] in self.declared and parts in ((parts[-1],), ("parameters", parts[-1])):  # what the file declares comes first
            return (path := self.declared[parts[-1]]), self.slots[path]
        found = list(self.tails.get(parts, ()))
        whole = [path for path in found if self.spoken[path] == ".".join(parts) or tuple(map(str, path)) == parts]
        if whole:
            return whole[0], self.slots[whole[0]]
        if section := self.section(parts):
            return section
        if len(found) == 1:
            return found[0], self.slots[found[0]]
        if found:
            raise UnknownName(f"{name!r} could be any of {len(found)} parameters", [self.spoken[path] for path in found])
        wholes = [*self.spoken.values()]
        single = [tail[0] for tail, paths in self.tails.items() if len(tail) == 1 and len(paths) == 1 and not tail[0].isdigit()]
        elsewhere = [place for place in places(ROOT, parts[0]) if place.split(".")[0] not in NOT_VARIED] if len(parts) == 1 else []
        if elsewhere:
            raise UnknownName(f"nothing in this file is called {name!r}; it would be {' or '.join(elsewhere[:3])}", single)
        pool = wholes if len(parts) > 1 else single
        raise UnknownName(f"nothing in this file is called {name[:80]!r}", pool if len(parts) == 1 else self.around(parts), near(".".join(parts), pool))

    def section(self, parts: tuple[str, ...]) -> tuple[Path, Slot] | None:
        """A whole section that is there: `materials.dough.elastic.hencky`."""
        if parts[0] in NOT_VARIED:
            return None
        slot, value, path = ROOT, self.experiment, []
        for index, part in enumerate(parts):
            if part == "constant" and isinstance(value, Constant) and index == len(parts) - 1:
                break  # kappa.constant is kappa
            key: Any = int(part) if part.isdigit() and isinstance(value, tuple) and int(part) < len(value) else part
            under, value = slot.step(key), below(value, key)
            if under is None or value is None:
                return None
            slot = under
            path.append(key)
        return tuple(path), slot

    def around(self, parts: tuple[str, ...]) -> list[str]:
        """Paths that begin like a wrong one, as far as it is right."""
        for length in range(len(parts) - 1, 0, -1):
            start = ".".join(parts[:length]) + "."
            if close := [name for name in self.spoken.values() if name.startswith(start)]:
                return close
        return list(dict.fromkeys(str(path[0]) for path in self.slots))

    def target(self, name: str) -> Path:
        """The path that an override sets; unlike a swept one it may be absent so far, as long as the models have a place for it."""
        try:
            return self.resolve(name)[0]
        except UnknownName as unknown:
            parts = dots(name).split(".")
            if parts[0] not in Experiment.model_fields:
                raise
            slot, value, path = ROOT, self.experiment, []
            for index, part in enumerate(parts):
                key = self.entry(part, value)
                under = slot.step(key)
                new = isinstance(value, dict) and key not in value and index < len(parts) - 1 and parts[0] not in NOT_VARIED
                if under is None or new or (isinstance(value, tuple) and not isinstance(key, int)):
                    words = list(value) if isinstance(value, dict) else slot.keys
                    said = f"{'.'.join(parts[:index])!r} has no {part[:60]!r}" if index else str(unknown)
                    raise UnknownName(said, words or unknown.allowed, near(part, words)) from None
                path.append(key)
                slot, value = under, below(value, key)
            return tuple(path)

    @staticmethod
    def entry(part: str, value: Any) -> str | int:
        """A key, or the index of an entry of a list by its number or its name."""
        if not isinstance(value, tuple):
            return part
        if part.isdigit() and int(part) < len(value):
            return int(part)
        return next((index for index, item in enumerate(value) if isinstance(item, Model) and getattr(item, "name", None) == part), part)


def below(value: Any, key: str | int) -> Any:
    """What lies under a key of a validated model, or None."""
    if isinstance(value, Kind) and key == value.kind:
        return Unwrapped(value)
    if isinstance(value, Unwrapped):
        value = value.kind
    if isinstance(value, Model):
        return getattr(value, str(key), None)
    if isinstance(value, dict):
        return value.get(key)
    return value[key] if isinstance(value, tuple) and isinstance(key, int) and key < len(value) else None


class Unwrapped:
    """A kind whose name has been stepped over."""

    def __init__(self, kind: Kind):
        self.kind = kind
