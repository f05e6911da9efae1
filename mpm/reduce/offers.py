"""What a smaller model offers, what a config asks for, and how the results of the smaller model go back under the names of the larger one."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.config.boundary import EXCHANGES
from mpm.records.variables import is_total, single
from mpm.scene.scales import Scales, scales, span

HEAT = ("temperature", "heat", "time_to")


@dataclass(frozen=True)
class Offer:
    """A smaller model of an experiment.

    error    its own estimate of what it changes in what is asked for; None where it has none
    factor   by which sums over the body (heat, mass, energy) are multiplied on the way back: a depth from per metre
    places   series of the larger model that symmetry gives: name -> function of the smaller one's series
    doubt    looks at the smaller model's run: a sentence why it cannot stand, or nothing
    """

    name: str
    dropped: str
    experiment: Any
    error: float | None
    factor: float = 1.0
    places: dict[str, Callable] = field(default_factory=dict)
    lost: frozenset[str] = frozenset()
    doubt: Callable[[Any], str] = lambda run: ""

    def back(self, run: Any) -> Any:
        """The run under the names and in the sums of the larger model."""
        sums = {name: values * self.factor if is_total(name) else values for name, values in run.series.items()}
        series = {name: values for name, values in sums.items() if name not in self.lost} | {name: made(sums) for name, made in self.places.items()}
        run.finals = {name: value for name, value in run.finals.items() if name not in run.series}
        run.series = series
        run.finals |= {name: float(values[-1]) for name, values in series.items()}
        return run


@dataclass(frozen=True)
class Asked:
    """What a config asks for, by dataset name; everything where it names nothing."""

    names: tuple[str, ...]
    probes: bool
    fields: bool
    everything: bool

    @property
    def heat_only(self) -> bool:
        """Whether nothing of motion is asked for."""
        return not self.everything and all(name.startswith(HEAT) for name in self.names)

    @property
    def motion_only(self) -> bool:
        """Whether nothing of heat is asked for."""
        return not self.everything and not any(name.startswith(HEAT) for name in self.names)

    @property
    def means_only(self) -> bool:
        """Whether of heat only means and sums are asked for: no place, no extreme."""
        return self.heat_only and not self.probes and not {"temperature_min", "temperature_max"} & set(self.names)


def asked(experiment: Any) -> Asked:
    """Observables and probes of an experiment."""
    from mpm.records.variables import dataset_name

    output = experiment.output
    hot = any(experiment.materials[body.material].heat is not None for body in experiment.bodies.values())
    probes = tuple(f"temperature_{name}" for name in output.probes) if hot else ()
    names = tuple(dict.fromkeys((*probes, *map(dataset_name, output.observables))))
    return Asked(names, bool(probes), output.snapshots is not None, not names)


def bare(experiment: Any) -> dict[str, Any]:
    """The experiment as plain data to be cut down: no sweep, no choice of model left."""
    data = experiment.template()
    data.pop("model", None)
    return data


def loaded(data: dict[str, Any], experiment: Any) -> Any:
    """The smaller experiment, checked as any config is; it keeps name and title of the larger one."""
    from mpm.config import load

    made = load(data)
    made._path = experiment.path
    return made


def refused(experiment: Any, want: Asked) -> str:
    """Why nothing may be left out at all; empty where something may."""
    if experiment.exact is not None:
        return "the run is compared with an exact solution of the full model"
    if experiment.grid.dimension == 0:
        return "a material point is the smallest model there is"
    if any(single(name) is not None for name in experiment.output.observables):
        return "observables of one body are asked for, under names that a smaller model has not"
    if any(body.inflow is not None for body in experiment.bodies.values()):
        return "a body flows in, which no smaller model knows"
    if experiment.sources:
        return "sources act within the bodies, which no estimate of a smaller model knows"
    return "fields are asked for" if want.fields else ""


def only_body(experiment: Any) -> tuple[str, Any, Scales] | None:
    """(name, body, scales) where there is one body."""
    if len(experiment.bodies) != 1:
        return None
    ((name, body),) = experiment.bodies.items()
    return name, body, scales(experiment)[name]


def entries(experiment: Any, name: str) -> list[dict]:
    """Surface entries of a body as plain data without side and name."""
    plain = [entry for entry in bare(experiment)["surfaces"] if entry["of"] == name]
    return [{"of": name, "side": entry["side"], **{kind: entry[kind] for kind in EXCHANGES if entry[kind] is not None}} for entry in plain]


def driving(experiment: Any) -> float:
    """The temperature difference of which errors are a share [K]."""
    return span(experiment)


def own(experiment: Any) -> float:
    """What the steps of a rigid full model are off by themselves: its tolerance, of the driving difference. Another model steps otherwise, and differs by it.

    Measured: 7.9e-5 at the tolerance 1e-4 (configs/studies/reduction/wide_slab.yaml), where the side that is left out makes 7e-13.
    """
    from mpm.rigid import Method

    return 0.0 if experiment.moving else getattr(experiment.method.rigid, "tolerance", None) or Method.tolerance


def crossing(series: np.ndarray, times: np.ndarray, level: float) -> float:
    """When a series first reaches a level, linear in between; nan where it never does."""
    before, after = series[:-1] - level, series[1:] - level
    hits = np.flatnonzero((before * after <= 0) & (before != after))
    if not len(hits):
        return math.nan
    k = hits[0]
    return float(times[k] + (times[k + 1] - times[k]) * before[k] / (before[k] - after[k]))
