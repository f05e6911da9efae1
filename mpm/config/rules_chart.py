"""Rules of `chart:`: what it compares is recorded, spelled as under `output`, and known before anything runs."""

from collections.abc import Iterator
from typing import Any

from mpm.config.explain import Finding
from mpm.config.partial import MISSING
from mpm.config.problems import near
from mpm.config.rules_output import known, observable
from mpm.config.rules_scene import heats, moves


def chart(experiment: Any) -> Iterator[Finding]:
    """What a chart compares is there, and its reference is one of its methods."""
    if experiment.chart is None or experiment.chart is MISSING:
        return
    yield from compared(experiment)
    yield from errors(experiment)
    wanted = experiment.chart
    if wanted.methods and wanted.reference is not None and wanted.reference not in wanted.methods:
        found = near(wanted.reference, wanted.methods)
        yield Finding(("chart", "reference"), "the chart has no such method", list(wanted.methods), found, given=wanted.reference)


def compared(experiment: Any) -> Iterator[Finding]:
    """`chart.observables`."""
    output, wanted = experiment.output, experiment.chart
    units: dict[str, str] = {}  # the first name of each
    if experiment.exact is None and not (wanted.observables or output.observables or output.probes):
        said = "nothing can be compared: there is no exact solution, and nothing is observed"
        yield Finding(("chart",), said, ["exact", "chart.observables", "observables or probes under output"], on_key=True)
    for index, name in enumerate(wanted.observables):
        path, dotted = ("chart", "observables", index), spelled(experiment, name)
        if dotted.removeprefix("temperature.") in output.probes and known(heats, experiment):
            units.setdefault("K", name)
            continue
        wrong = list(observable(experiment, index, dotted, known(heats, experiment), known(moves, experiment), path))
        if not wrong and recorded_if_listed(dotted) and dotted not in output.observables:
            wrong = [Finding(path, "it is not recorded", f"the same under output.observables: [{dotted}]", given=name)]
        yield from wrong
        if not wrong and (unit := unit_of(dotted)) != "s":
            units.setdefault(unit, name)
    if wanted.scale is not None and len(units) > 1:
        said = f"one number cannot be 100 % of {' and of '.join(f'{name} [{unit}]' for unit, name in units.items())}"
        yield Finding(("chart", "scale"), said, "no `scale`: each is measured by how much it changes", given=wanted.scale)


def errors(experiment: Any) -> Iterator[Finding]:
    """`chart.error`."""
    from mpm.records.variables import VARIABLES

    there = [name for name in VARIABLES if name.startswith("error_")]
    for index, name in enumerate(experiment.chart.error):
        path = ("chart", "error", index)
        if name not in there:
            yield Finding(path, "unknown error", there, near(name, there), given=name)
        elif experiment.exact is None:
            yield Finding(path, "there is no exact solution to err from", "exact, or chart.observables in place of chart.error", given=name)
        elif experiment.chart.scale is None and VARIABLES[name].units not in ("1", "K"):
            allowed = f"chart.scale [{VARIABLES[name].units}], or {name.rpartition('_')[0]}, which is relative"
            yield Finding(path, f"an error in {VARIABLES[name].units} needs what counts as 100 % of it", allowed, given=name)


def spelled(experiment: Any, name: str) -> str:
    """The observable of a name as `output` spells it: of `temperature_mean` too, as the dataset has it."""
    from mpm.records.variables import OBSERVABLES, dataset_name

    listed = (*OBSERVABLES, *experiment.output.observables, *(f"temperature.{probe}" for probe in experiment.output.probes))
    return name if name in listed else next((one for one in listed if dataset_name(one) == name), name)


def recorded_if_listed(name: str) -> bool:
    """Whether a run records it only where `output.observables` lists it."""
    from mpm.records.variables import OBSERVABLES

    return name not in OBSERVABLES


def unit_of(name: str) -> str:
    """The unit of an observable."""
    from mpm.records.variables import dataset_name, describe

    return describe(dataset_name(name)).units
