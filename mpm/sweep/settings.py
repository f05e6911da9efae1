"""Settings: the points of a chart (config.chart) as cases of an ordinary sweep along one dimension, `setting`.

A setting is the config with a method's parameters set and one place along a path of refinement. Unlike an axis it may set what the base config does not
have (a moving body's `elastic` beside a rigid one, another dimension), so each is loaded whole, as `--set` would.

Coordinates    method, path (labels), place (0 the coarsest), and every parameter that any setting sets, as it stands in each (a label where it is no number)
"""

from typing import Any

import numpy as np

from mpm.config import load
from mpm.config.experiment import Experiment
from mpm.config.explain import Finding
from mpm.config.names import Names
from mpm.config.nodes import Origin, wrap
from mpm.config.problems import ConfigError
from mpm.config.vary import RESERVED, label
from mpm.records.variables import VARIABLES, of_probe
from mpm.sweep.case_list import Alone, Case, Cases, Coordinate, Dimension
from mpm.sweep.cases import stop

OWN = ("method", "path", "place")


def plan(experiment: Experiment, max_runs: int = 10_000) -> Cases:
    """The settings of an experiment that has a chart; ConfigError where one is wrong or they are too many."""
    root = experiment._tree or wrap(experiment.resolved(), Origin("<experiment>"), [])
    rows = settings(experiment, root)
    if len(rows) > max_runs:
        stop(root, [Finding(("chart",), f"the chart has {len(rows)} settings, and the limit is {max_runs}", f"fewer, or --max-runs {len(rows)}", on_key=True)])
    if not rows:
        stop(root, [Finding(("chart",), "there is nothing to draw", "methods, each with something to refine", on_key=True)])
    base, cases, wrong = experiment.template(), [], []
    for flat, (method, path, place, values) in enumerate(rows):
        try:
            point = load(base, values)
        except ConfigError as error:
            where = ("chart", "methods", method)
            for one in error.problems:
                said = f"{path} {place}: {one.path}: {one.message}" + (f" ({one.given})" if one.given else "")
                wrong.append(Finding(where, said, str(one.allowed or ""), on_key=True))
            continue
        point._source, point._path, point._tree = experiment._source, experiment._path, None
        cases.append(Case(Alone(point, (flat,), {"method": method, "path": path} | values), flat, point.run_id))
    stop(root, wrong)
    return Cases((Dimension("setting", len(rows), coordinates(rows, cases)),), cases, np.zeros(len(rows), dtype=bool))


def settings(experiment: Experiment, root: Any) -> list[tuple[str, str, int, dict[str, Any]]]:
    """(method, path, place along it, {parameter: value}) of every setting."""
    rows: list[tuple[str, str, int, dict[str, Any]]] = []
    if (chart := experiment.chart) is None:
        return rows
    for method, line in chart.methods.items():
        paths = chart.refine if line.refine is None else line.refine
        for path, refined in paths.items():
            lengths = {len(values) for values in refined.values()}
            if len(lengths) > 1:
                said = f"{path}: the lists that move together have {' and '.join(map(str, sorted(lengths)))} entries"
                stop(root, [Finding(("chart",), said, "lists of one length", on_key=True)])
            for place in range(max(lengths, default=0)):
                rows.append((method, path, place, line.set | {name: values[place] for name, values in refined.items()}))
        if not paths:
            rows.append((method, "", 0, dict(line.set)))
    return rows


def coordinates(rows: list, cases: list[Case]) -> list[Coordinate]:
    """What varies, as it stands in each setting."""
    own = [np.array([row[k] for row in rows], dtype=float if k == 2 else object) for k in range(3)]
    said = ("method", "path of refinement", "place along the path, 0 the coarsest")
    found = [Coordinate(name, values, "1", words, "") for name, values, words in zip(OWN, own, said, strict=True)]
    names = list(dict.fromkeys(name for row in rows for name in row[3]))
    for name in names:
        column, slot, spoken = [], None, name
        for case in cases:
            value, here, known = standing(case.experiment, name)
            column.append(value)
            slot, spoken = (here, known) if here is not None else (slot, spoken)
        numbers = all(isinstance(value, float | int) and not isinstance(value, bool) for value in column)
        values = np.array(column, dtype=float) if numbers else np.array([value if isinstance(value, str) else label(value) for value in column], dtype=object)
        units = slot.quantity.units if numbers and slot is not None and slot.quantity else "1"
        taken = {variable for probe in cases[0].experiment.output.probes for variable in of_probe(probe)}
        found.append(Coordinate(short(spoken, [other for other in names if other != name], taken), values, units, slot.description if slot else spoken, spoken))
    return found


def standing(experiment: Experiment, name: str) -> tuple[Any, Any, str]:
    """(value, slot, path in words) of a parameter in one setting; `none` where it does not exist there."""
    names = Names(experiment)
    try:
        path = names.target(name)
    except ValueError:
        return "none", None, name
    value: Any = experiment.resolved()
    for key in path:
        if isinstance(value, list):
            value = value[key] if isinstance(key, int) and key < len(value) else None
        else:
            value = value.get(key) if isinstance(value, dict) else None
    slot = names.slots.get(path)
    return ("none" if value is None else value), slot, names.spoken.get(path) or ".".join(map(str, path))


def short(spoken: str, others: list[str], results: set[str]) -> str:
    """A name for the dataset: the last word of the path, and more of it where that is taken."""
    words = spoken.split(".")
    taken = {other.rsplit(".", 1)[-1] for other in others} | results
    for length in range(1, len(words) + 1):
        name = "_".join(words[-length:])
        if name.isidentifier() and name not in VARIABLES and name not in taken and name not in {*OWN, "setting", *RESERVED}:
            return name
    return "set_" + "_".join(words)
