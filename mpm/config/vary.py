"""From `sweep:` to groups of parameters with checked values. Nothing here grows with the number of points: ranges stay ranges.

A group is a dimension: an axis (one parameter), a zip (several that move together), the sample, the list of points.
"""

import json
import math
from typing import Any

from pydantic import TypeAdapter, ValidationError

from mpm.config.condition import Condition, ConditionError, Formula
from mpm.config.experiment import plain
from mpm.config.explain import Finding, findings, shown
from mpm.config.laws import Law
from mpm.config.names import Names, UnknownName
from mpm.config.problems import MOST_FINDINGS, listed
from mpm.config.quantities import Whole
from mpm.config.schema_paths import Path, Slot
from mpm.config.variation import Derived, Group, Parameter, Variation, at_path, label

MOST_PARAMETERS = 100
RESERVED = {"point", "sample", "obs", "dim", "x", "y", "z", "r", "series", "grid", "particles"}  # dimensions and groups of the dataset


class Vary:
    """Reads one sweep section against the names of its experiment; what is wrong collects in `found`."""

    def __init__(self, sweep: Any, names: Names):
        self.sweep, self.names = sweep, names
        self.found: list[Finding] = []
        self.adapters: dict[Path, TypeAdapter] = {}

    def read(self) -> Variation:
        """The groups and the condition."""
        sweep, groups = self.sweep, []
        if (names := self.count()) > MOST_PARAMETERS:
            self.found.append(Finding(("sweep",), f"{names} names of parameters", f"at most {MOST_PARAMETERS}", on_key=True))
            return Variation([])
        for name, axis in sweep.axes.items():
            groups += self.axis(name, axis)
        for index, together in enumerate(sweep.zip):
            groups += self.zip(index, together)
        if sweep.sample is not None:
            groups += self.sample(sweep.sample)
        if sweep.points:
            groups += self.points(sweep.points)
        variation = Variation(groups)
        variation.derived += self.follow(variation)
        variation.derived += [one for name, text in sweep.derive.items() if (one := self.derive(name, text))]
        variation.derived += self.follow(variation)
        self.conflicts(variation)
        self.shorten(variation)
        if sweep.where is not None:
            self.where(variation, sweep.where)
        if not groups and not variation.derived and not self.found:
            self.found.append(Finding(("sweep",), "nothing varies", ["axes", "zip", "sample", "points", "derive"], on_key=True))
        return variation

    def count(self) -> int:
        """How many different names the sweep uses."""
        sweep = self.sweep
        ranges = sweep.sample.ranges if sweep.sample is not None else {}
        return len({*sweep.axes, *ranges, *sweep.derive, *(name for entry in (*sweep.zip, *sweep.points) for name in entry)})

    def parameter(self, name: str, where: Path) -> Parameter | None:
        """A parameter by its name."""
        try:
            path, slot = self.names.resolve(name)
        except UnknownName as error:
            self.found.append(Finding(where, error.message, error.allowed, error.suggestion, on_key=True))
            return None
        return Parameter(name, path, slot, where, spoken=self.names.spoken.get(path) or shown(path))

    def value(self, parameter: Parameter, value: Any, where: Path) -> Any:
        """A value checked by the parameter's own type, as plain SI data."""
        before = len(self.found)
        if before > MOST_FINDINGS or (value is None and parameter.slot.optional and parameter.slot.menu):  # a kind may be absent: `locking: null`
            return None
        try:
            checked = self.adapter(parameter).validate_python(value)
        except ValidationError as error:
            self.found += findings(error, parameter.slot, where)
        return plain(checked) if len(self.found) == before else None

    def adapter(self, parameter: Parameter) -> TypeAdapter:
        """The validator of a parameter's values, made once."""
        if parameter.path not in self.adapters:
            self.adapters[parameter.path] = adapter(parameter.slot)
        return self.adapters[parameter.path]

    def end(self, parameter: Parameter, value: Any, where: Path, log: bool) -> float:
        """One end of a range, as an SI number."""
        if parameter.slot.quantity is None or (parameter.slot.note(Law) and isinstance(value, dict)):
            self.found.append(Finding(where, f"{parameter.name} is no number with a range", "a list of values"))
            return math.nan
        number = self.value(parameter, value, where)
        if number is None:
            return math.nan
        if not isinstance(number, float) or (log and number <= 0):
            self.found.append(Finding(where, "the end of a range must be a finite number" + (", above 0 on a logarithmic one" if log else ""), "", given=value))
            return math.nan
        return number

    def span(self, parameter: Parameter, ends: tuple, where: Path, log: bool) -> None:
        """Both ends of a range."""
        parameter.log = log
        parameter.low, parameter.high = (self.end(parameter, ends[index], (*where, index), log) for index in range(2))

    def axis(self, name: str, axis: Any) -> list[Group]:
        """The group of one axis; none where it is wrong."""
        where: Path = ("sweep", "axes", name)
        parameter = self.parameter(name, where)
        if parameter is None:
            return []
        if isinstance(axis, dict):
            ((word, (*ends, count)),) = axis.items()
            self.span(parameter, tuple(ends), (*where, word), word == "log")
            if parameter.low == parameter.high and count > 1:
                self.found.append(Finding((*where, word), "the range is a single value", "two different ends"))
            return [Group("axis", [parameter], count, where)]
        self.fill(parameter, axis, where)
        return [Group("axis", [parameter], len(axis), where)]

    def fill(self, parameter: Parameter, values: tuple, where: Path, distinct: bool = True) -> None:
        """A list of values; on an axis of its own each value once."""
        parameter.values = [self.value(parameter, value, (*where, index)) for index, value in enumerate(values)]
        seen: set[str] = set()
        for index, value in enumerate(parameter.values):
            text = json.dumps(value)
            if distinct and (value is not None or values[index] is None) and text in seen:
                self.found.append(Finding((*where, index), "this value is in the list twice", "each value once", given=values[index]))
            seen.add(text)

    def zip(self, index: int, together: dict[str, tuple]) -> list[Group]:
        """The group of parameters that move together; none where they are wrong."""
        where: Path = ("sweep", "zip", index)
        parameters, sizes = [], {name: len(values) for name, values in together.items()}
        if not together:
            self.found.append(Finding(where, "the zip is empty", "parameter: list of values"))
        if len(set(sizes.values())) > 1:
            said = ", ".join(f"{name} {size}" for name, size in sizes.items())
            self.found.append(Finding(where, f"zipped lists must have the same length, found {said}", "lists of one length"))
        for name, values in together.items():
            if parameter := self.parameter(name, (*where, name)):
                self.fill(parameter, values, (*where, name), distinct=False)
                parameters.append(parameter)
        return [Group("zip", parameters, min(sizes.values()), where)] if parameters else []

    def sample(self, sample: Any) -> list[Group]:
        """The group of a sample's parameters; none where they are wrong."""
        where: Path = ("sweep", "sample", sample.kind)
        parameters = []
        for name, span in sample.ranges.items():
            at = (*where, "ranges", name)
            if parameter := self.parameter(name, at):
                log = isinstance(span, dict)
                self.span(parameter, span["log"] if log else span, (*at, "log") if log else at, log)
                if parameter.low >= parameter.high:
                    self.found.append(Finding(at, "the range must rise", "[smallest, largest]"))
                parameters.append(parameter)
        size = sample.count * (len(parameters) + 2 if sample.kind == "saltelli" else 1)
        return [Group("sample", parameters, size, where, sample.kind, sample.seed)] if parameters else []

    def points(self, points: tuple[dict[str, Any], ...]) -> list[Group]:
        """Points that leave a parameter out have it as the config says."""
        parameters: dict[Path, Parameter] = {}
        base = self.names.experiment
        for index, point in enumerate(points):
            if not point:
                self.found.append(Finding(("sweep", "points", index), "the point is empty", "parameter: value"))
            for name, value in point.items():
                where: Path = ("sweep", "points", index, name)
                if parameter := self.parameter(name, where):
                    known = parameters.setdefault(parameter.path, parameter)
                    known.values += [None] * (index - len(known.values))
                    known.values.append(self.value(parameter, value, where))
        for parameter in parameters.values():
            parameter.where = ("sweep", "points")
            parameter.values += [None] * (len(points) - len(parameter.values))
            if None in parameter.values and not self.found:
                default = at_path(plain(base), parameter.path)
                parameter.values = [default if value is None else value for value in parameter.values]
        return [Group("points", list(parameters.values()), len(points), ("sweep", "points"))] if parameters else []

    def conflicts(self, variation: Variation) -> None:
        """No parameter twice, none inside another."""
        seen: list[Parameter] = []
        for parameter in variation.parameters():
            for other in seen:
                length = min(len(parameter.path), len(other.path))
                if parameter.path[:length] == other.path[:length]:
                    said = f"{parameter.spoken} varies already" + (f", as part of {other.spoken}" if parameter.path != other.path else "")
                    self.found.append(Finding(parameter.where, said, "each parameter once", on_key=True))
            seen.append(parameter)

    def shorten(self, variation: Variation) -> None:
        """Names for the dataset: the last word of the path, and more of it where that is taken."""
        from mpm.records.variables import VARIABLES, dataset_name, of_probe

        output = self.names.experiment.output
        results = {variable for probe in output.probes for variable in of_probe(probe)} | {dataset_name(name) for name in output.observables}
        parameters = list(variation.parameters())
        for parameter in parameters:
            words = parameter.spoken.replace("-", "_").split(".")
            for length in range(1, len(words) + 1):
                short = "_".join(words[-length:])
                others = ["_".join(other.spoken.split(".")[-length:]) for other in parameters if other is not parameter]
                if short.isidentifier() and short not in RESERVED and short not in VARIABLES and short not in results and short not in others:
                    break
            parameter.short = short

    def follow(self, variation: Variation) -> list[Derived]:
        """What the config says by formulas over named parameters of which one varies."""
        varied = {parameter.path for parameter in variation.parameters()}
        found: list[Derived] = []
        for spoken, text in self.names.experiment.formulas.items():
            path, slot = self.names.resolve(spoken.removesuffix(".value") if spoken.startswith("parameters.") else spoken)
            formula = Formula(text)
            names = {name: self.names.declared[name] for name in formula.names}
            known = any(one.parameter.path == path for one in variation.derived)
            if not known and varied.intersection(names.values()):
                parameter = Parameter(spoken, path, slot, path, spoken=self.names.spoken.get(path) or shown(path))
                found.append(Derived(parameter, formula, names))
                varied.add(path)
        return found

    def derive(self, name: str, text: str) -> Derived | None:
        """A parameter by its formula."""
        where: Path = ("sweep", "derive", name)
        parameter, formula = self.parameter(name, where), self.formula(Formula, text, where)
        if parameter is None or formula is None:
            return None
        if parameter.slot.quantity is None and not parameter.slot.note(Whole):
            self.found.append(Finding(where, f"{name} is no number", "a parameter that is one", on_key=True))
            return None
        return Derived(parameter, formula, self.paths(formula, where))

    def where(self, variation: Variation, text: str) -> None:
        """The condition that points must meet, and what its names stand for."""
        where: Path = ("sweep", "where")
        if condition := self.formula(Condition, text, where):
            variation.condition, variation.names = condition, self.paths(condition, where)

    def formula(self, kind: type[Formula], text: str, where: Path) -> Any:
        """A formula or a condition, or what is wrong with it."""
        try:
            return kind(text)
        except ConditionError as error:
            self.found.append(Finding(where, str(error), kind.allowed, given=text))
            return None

    def paths(self, formula: Formula, where: Path) -> dict[str, Path]:
        """What the names of a formula stand for."""
        found = {}
        for name in formula.names:
            try:
                found[name] = self.names.resolve(name)[0]
            except UnknownName as error:
                self.found.append(Finding(where, error.message, listed(error.allowed), error.suggestion))
        return found


def adapter(slot: Slot) -> TypeAdapter:
    """The validator of one slot."""
    return TypeAdapter(slot.annotated)


__all__ = ["RESERVED", "Derived", "Group", "Parameter", "Variation", "Vary", "at_path", "label"]
