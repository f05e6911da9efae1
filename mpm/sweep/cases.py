"""Cases: from an experiment with a sweep to its points, each a checked experiment with an id that depends on its content alone.

The product is counted as an integer before anything is built. A point is the resolved config with a few values exchanged, validated whole.
Cost of 10 000 points, measured on a busy two-core machine: 1.0 s (kappa x beta of the loaf), 2.6 s (five knobs of the slump).
"""

import json
import math
from array import array
from collections.abc import Iterator
from typing import Any

import numpy as np
from pydantic import ValidationError

from mpm.config.checks import check, unread
from mpm.config.condition import ConditionError
from mpm.config.experiment import Experiment
from mpm.config.explain import Finding, findings, problem
from mpm.config.names import ROOT, Names
from mpm.config.nodes import Node, Origin, wrap
from mpm.config.problems import ConfigError
from mpm.config.schema_paths import Path
from mpm.config.variation import Group, Parameter, Variation, at_path, digits, label, rounded
from mpm.config.vary import Vary
from mpm.sweep.case_list import Alone, Case, CaseList, Cases, Coordinate, Dimension
from mpm.sweep.ranges import columns, replaced

MOST_RUNS = 10_000_000  # whatever --max-runs says: planning as many takes ten minutes, and their ids 240 MB
NOT_OF_A_POINT = ("sweep", "smoke", "chart", "stability", "fit")
MOST_TOLD = 10  # wrong points told one by one


def plan(experiment: Experiment, max_runs: int = 10_000) -> Cases:
    """The points of an experiment; ConfigError if there are more than `max_runs` or if any is wrong."""
    if experiment.sweep is None:
        return Cases(cases=(Case(Alone(experiment), 0, experiment.run_id),))
    root = experiment._tree or wrap(experiment.resolved(), Origin("<experiment>"), [])
    names = Names(experiment)
    vary = Vary(experiment.sweep, names)
    variation = vary.read()
    stop(root, vary.found)
    if variation.size > min(max_runs, MOST_RUNS):
        sizes = " x ".join(str(group.size) for group in variation.groups)
        said = f"the sweep has {sizes + ' = ' if len(variation.groups) > 1 else ''}{variation.size} points, and the limit is {min(max_runs, MOST_RUNS)}"
        more = f", or --max-runs {variation.size}" if variation.size <= MOST_RUNS else ""
        stop(root, [Finding(("sweep",), said, f"fewer points{more}", on_key=True)])
    return Points(experiment, variation, root).build()


def stop(root: Node, found: list[Finding]) -> None:
    """Raise what was found, if anything."""
    told = [one for finding in found if (one := problem(root, finding)) is not None]
    if told:
        raise ConfigError(told)


class Points:
    """The points of one variation."""

    def __init__(self, experiment: Experiment, variation: Variation, root: Node):
        self.whole, self.variation, self.root = experiment, variation, root
        self.groups, self.shape = [group.parameters for group in variation.groups], tuple(group.size for group in variation.groups)
        paths = [parameter.path for parameter in variation.parameters()]
        touched = {path[0] for path in paths} | ({"output"} if "time" in {path[0] for path in paths} else set())  # output.every may follow time.end
        kept = [name for name in Experiment.model_fields if name not in touched]
        self.template = {**experiment.template(), **{name: getattr(experiment, name) for name in kept if name not in NOT_OF_A_POINT}}
        self.known = {name: experiment.key_line(name) for name in kept}
        numbers = all(isinstance(value, int | float) for parameter in variation.parameters() for value in parameter.values)
        self.checked = numbers and all(unread(parameter.path, parameter.slot) for parameter in variation.parameters())
        self.columns = {id(parameter): column for group in variation.groups for parameter, column in zip(group.parameters, columns(group), strict=True)}
        self.base = experiment.resolved()
        self.found: list[Finding] = []
        self.known_places: dict[int, int] = {}

    def build(self) -> Cases:
        """Check every point, drop those that the condition drops."""
        dims = tuple(self.dimension(group) for group in self.variation.groups)
        skipped = np.zeros(self.shape, dtype=bool)
        flats, ids = array("q"), bytearray()
        for flat in range(math.prod(self.shape)):
            pairs = self.pairs(flat)
            if pairs is None or self.dropped(pairs):
                skipped[self.index(flat)] = True
            elif point := self.point(pairs):
                flats.append(flat)
                ids += point.identify(self.known).encode("ascii")
            if len(self.found) >= MOST_TOLD:
                break
        stop(self.root, self.found)
        if not flats:
            stop(self.root, [Finding(("sweep", "where"), "the condition drops every point", "a condition that some points meet")])
        listed = CaseList(self, np.frombuffer(flats, np.int64), np.frombuffer(ids, f"S{len(ids) // len(flats)}"))
        return Cases(dims, listed, skipped, tuple(self.derived()))

    def index(self, flat: int) -> tuple[int, ...]:
        """Place in the dimensions; the last one runs fastest."""
        index = []
        for size in reversed(self.shape):
            flat, place = divmod(flat, size)
            index.append(place)
        return tuple(reversed(index))

    def varied(self, flat: int) -> list[tuple[Parameter, Any]]:
        """Each parameter of the groups with its value at a point."""
        return [(parameter, self.columns[id(parameter)][place]) for group, place in zip(self.groups, self.index(flat), strict=True) for parameter in group]

    def pairs(self, flat: int) -> list[tuple[Parameter, Any]] | None:
        """Also those that follow by a formula, in the order of the file, so that one may use another above it; None where a formula fails."""
        pairs = self.varied(flat)
        for one in self.variation.derived:
            given = self.named(one.names, pairs)
            try:
                value = one.formula(given)
            except ConditionError as error:
                self.found.append(Finding(("sweep", "derive", one.parameter.name), str(error), "", given=values_in_words(given)))
                return None
            pairs.append((one.parameter, int(value) if one.parameter.slot.quantity is None and float(value).is_integer() else value))
        return pairs

    def named(self, names: dict[str, Path], pairs: list[tuple[Parameter, Any]]) -> dict[str, Any]:
        """Values of the names of a formula at a point."""
        varied = {parameter.path: value for parameter, value in pairs}
        found = {}
        for name, path in names.items():
            above = next((path[:length] for length in range(len(path), 0, -1) if path[:length] in varied), ())  # a list varies with its entries
            value = at_path(varied[above], path[len(above) :]) if above else at_path(self.base, path)
            found[name] = float(value) if isinstance(value, float | int) else math.inf if value == ".inf" else label(value)
        return found

    def values(self, flat: int) -> dict[str, Any]:
        """See `Case`."""
        return {parameter.spoken: value for parameter, value in self.varied(flat)}

    def words(self, flat: int) -> dict[str, str]:
        """See `Case`."""
        return {parameter.short: rounded(v, self.places(parameter)) if isinstance(v, float) else label(v) for parameter, v in self.varied(flat)}

    def places(self, parameter: Parameter) -> int:
        """How many digits tell the values of a parameter apart."""
        if id(parameter) not in self.known_places:
            self.known_places[id(parameter)] = digits(value for value in self.columns[id(parameter)] if isinstance(value, float))
        return self.known_places[id(parameter)]

    def experiment(self, flat: int) -> Experiment:
        """See `Case`."""
        pairs = self.pairs(flat)
        assert pairs is not None, "a point that was checked"
        return Experiment.model_validate(self.data(pairs))._placed(self.whole)

    def dropped(self, pairs: list[tuple[Parameter, Any]]) -> bool:
        """Whether the condition drops a point."""
        condition = self.variation.condition
        if condition is None:
            return False
        values = self.named(self.variation.names, pairs)
        try:
            return not condition(values)
        except ConditionError as error:
            self.found.append(Finding(("sweep", "where"), str(error), "", given=values_in_words(values)))
            return True

    def data(self, pairs: list[tuple[Parameter, Any]]) -> Any:
        """A point as plain data."""
        data = self.template
        for parameter, value in pairs:
            data = replaced(data, parameter.path, value)
        return data

    def point(self, pairs: list[tuple[Parameter, Any]]) -> Experiment | None:
        """A point as a checked experiment; None if it is wrong."""
        try:
            point = Experiment.model_validate(self.data(pairs))
        except ValidationError as error:
            self.blame(findings(error, ROOT), pairs)
            return None
        if wrong := [] if self.checked else check(point):
            self.blame(wrong, pairs)
            return None
        return point

    def derived(self) -> Iterator[tuple[tuple[str, ...], Coordinate]]:
        """The dimensions and values of what follows by a formula: over the groups that it depends on."""
        depends: dict[Path, set[int]] = {parameter.path: {k} for k, group in enumerate(self.groups) for parameter in group}
        for at, one in enumerate(self.variation.derived):
            above = {path[:length] for path in one.names.values() for length in range(1, len(path) + 1)}
            here = sorted(set().union(*(depends.get(path, set()) for path in above)))
            depends[one.parameter.path] = set(here)
            shape = tuple(self.shape[k] for k in here)
            values = np.empty(shape)
            for place in np.ndindex(shape):
                flat = int(np.ravel_multi_index([place[here.index(k)] if k in here else 0 for k in range(len(self.shape))], self.shape)) if self.shape else 0
                pairs = self.pairs(flat)
                values[place] = np.nan if pairs is None else float(pairs[len(pairs) - len(self.variation.derived) + at][1])
            slot = one.parameter.slot
            units = slot.quantity.units if slot.quantity else "1"
            names = tuple(self.name(self.variation.groups[k]) for k in here)
            yield names, Coordinate(one.parameter.short, values, units, slot.description or one.parameter.short, one.parameter.spoken)

    def blame(self, wrong: list[Finding], pairs: list[tuple[Parameter, Any]]) -> None:
        """Tell what is wrong with a point where the sweep sets it."""
        said = ", ".join(f"{parameter.short} = {label(value)}" for parameter, value in pairs)
        for one in wrong:
            cause = next(
                (parameter for parameter, _ in pairs if one.path[: len(parameter.path)] == parameter.path or parameter.path[: len(one.path)] == one.path), None
            )
            where: Path = cause.where if cause else ("sweep",)
            finding = Finding(where, f"the point {said} is wrong: {'.'.join(map(str, one.path))}: {one.message}", one.allowed, one.suggestion, on_key=True)
            if finding not in self.found:
                self.found.append(finding)

    def dimension(self, group: Group) -> Dimension:
        """The dimension of a group with its coordinates."""
        return Dimension(self.name(group), group.size, [self.coordinate(parameter) for parameter in group.parameters])

    @staticmethod
    def name(group: Group) -> str:
        """The name of a group's dimension."""
        return {"sample": "sample", "points": "point"}.get(group.form, group.parameters[0].short)

    def coordinate(self, parameter: Parameter) -> Coordinate:
        """Values along the dimension: floats where all are numbers, else labels."""
        raw: list[Any] = [float("inf") if value == ".inf" else value for value in self.columns[id(parameter)]]
        raw, alone = ([value[0] for value in raw], True) if all(isinstance(value, list) and len(value) == 1 for value in raw) else (raw, False)
        numbers = all(isinstance(value, float | int) and not isinstance(value, bool) for value in raw)
        quantity = parameter.slot.under(0).quantity if alone else parameter.slot.quantity  # a place in 1-D is a number
        values = np.array(raw, dtype=float) if numbers else np.array(labels(raw), dtype=object)
        units = quantity.units if quantity and numbers else "1" if numbers else ""
        return Coordinate(parameter.short, values, units, parameter.slot.description or parameter.short, parameter.spoken)


def labels(values: list[Any]) -> list[str]:
    """A label a value; JSON where two of different values would be the same."""
    short, whole = [label(value) for value in values], [json.dumps(value, sort_keys=True, ensure_ascii=False) for value in values]
    return short if len(set(short)) == len(set(whole)) else whole


def values_in_words(values: dict[str, Any]) -> str:
    """`kappa = 0.3, beta = 5`."""
    return ", ".join(f"{key} = {label(value)}" for key, value in values.items())
