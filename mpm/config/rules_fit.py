"""Rules for named parameters and for what is fitted."""

import keyword
from collections.abc import Iterator
from typing import Any

from mpm.config.condition import FUNCTIONS
from mpm.config.explain import Finding
from mpm.config.rules_scene import plain_names


def parameters(experiment: Any) -> Iterator[Finding]:
    """Their names are words of formulas."""
    yield from plain_names(experiment, "parameters", experiment.parameters)
    for name in experiment.parameters:
        if name in (*FUNCTIONS, "pi") or keyword.iskeyword(name):
            yield Finding(("parameters", name), f"{name!r} means something else in formulas", f"another name, as {name}_0", on_key=True)


def refine(experiment: Any) -> Iterator[Finding]:
    """The observable is recorded, and the level is a value of it."""
    from mpm.config.measured import Unreadable, number
    from mpm.records.variables import dataset_name, describe

    asked = experiment.sweep.refine if experiment.sweep is not None else None
    if asked is None:
        return
    output, name = experiment.output, dataset_name(asked.of)
    known = [*map(dataset_name, output.observables), *(f"temperature_{probe}" for probe in output.probes)]
    if name not in known:
        yield Finding(("sweep", "refine", "of"), "this is not recorded", known or "a probe or an observable under output", given=asked.of)
    elif isinstance(asked.level, str):
        try:
            level = number(asked.level, describe(name, experiment.grid.dimension, output.probes).units, "level", "level")
        except Unreadable as error:
            yield Finding(("sweep", "refine", "level"), error.message, error.allowed)
        else:
            asked.__dict__["level"] = level


def fit(experiment: Any) -> Iterator[Finding]:
    """Parameters have ranges, the curves are there, and their errors can be weighed against one another."""
    from dataclasses import replace

    from mpm.config.fit import ranges
    from mpm.config.measured import target
    from mpm.config.names import Names
    from mpm.config.vary import Vary

    asked, measured = experiment.fit, experiment.output.measured
    if asked is None:
        return
    vary = Vary(ranges(asked), Names(experiment))
    vary.read()
    for one in vary.found:
        yield replace(one, path=("fit", "parameters", *one.path[4:]) if one.path[:4] == ("sweep", "sample", "uniform", "ranges") else ("fit",))
    for index, name in enumerate(asked.data):
        if name not in measured:
            yield Finding(("fit", "data", index), f"there is no measured curve {name!r}", list(measured) or "a curve under output.measured", given=name)
    used = {name: measured[name] for name in asked.data or measured if name in measured}
    if not used and not asked.data:
        yield Finding(("fit",), "there is nothing to fit to", "a curve under output.measured", on_key=True)
    known = [curve.sigma is not None or any(len(row) > 2 for row in curve.samples) or _column(curve) for curve in used.values()]
    units = {found[1] for name, curve in used.items() if (found := target(experiment, name, curve)) is not None}
    if any(known) != all(known):
        yield Finding(("fit",), "some of the curves have a sigma, and some have none", "a sigma for each, or for none of one unit", on_key=True)
    elif len(units) > 1 and not any(known):
        yield Finding(("fit",), f"the curves are in {' and '.join(sorted(units))}, which cannot be weighed together", "a sigma for each", on_key=True)


def _column(curve: Any) -> bool:
    """Whether sigma is a column that is still to be read."""
    return isinstance(curve.sigma, str)
