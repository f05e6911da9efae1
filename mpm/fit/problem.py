"""Problem: what is fitted to what.

    u        scaled parameter: ln p where its range is logarithmic, else p over the larger end of its range
    r(u)     residuals sqrt(weight) (model - measured)/sigma over all curves, one after another; sigma = 1 in the unit where none is given
    S(u)     sum of squares of r

The model's series is interpolated linearly at the measured times, so `output.every` must resolve the curve.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.config.fit import ranges
from mpm.config.measured import recorded
from mpm.config.names import Names
from mpm.config.variation import at_path
from mpm.config.vary import Vary
from mpm.records.variables import OK
from mpm.sweep.lock import Refused


@dataclass(frozen=True)
class Parameter:
    """A parameter that is fitted: range and start in SI."""

    name: str
    path: str
    low: float
    high: float
    log: bool
    start: float
    units: str
    long_name: str

    @property
    def scale(self) -> float:
        """What one in u is, where it is linear."""
        return max(abs(self.low), abs(self.high))

    def to_u(self, value: Any) -> Any:
        """The scaled parameter."""
        return np.log(value) if self.log else np.asarray(value) / self.scale

    def from_u(self, u: Any) -> Any:
        """The parameter; within its range, whatever rounding says."""
        return np.clip(np.exp(u) if self.log else np.asarray(u) * self.scale, self.low, self.high)

    def slope(self, value: float) -> float:
        """dp/du."""
        return value if self.log else self.scale


@dataclass(frozen=True)
class Curve:
    """A measured curve: times [s] (none where it is one number a run), values and sigma in SI."""

    name: str
    variable: str
    times: np.ndarray | None
    values: np.ndarray
    sigma: np.ndarray | None
    weight: float
    units: str
    source: str = ""
    late: int = 0  # measured values after the end of the run, which do not count

    def predict(self, record: Any) -> np.ndarray:
        """What a record says at the measured times; NaN where it does not reach them."""
        if self.times is None:
            return np.array([record.finals.get(self.variable, math.nan)])
        if self.variable not in record.series:
            return np.full(len(self.values), math.nan)
        times = np.asarray(record.times)
        late = self.times > times[-1] * (1 + 1e-9)
        return np.where(late, math.nan, np.interp(self.times, times, record.series[self.variable]))

    def scaled(self, predicted: np.ndarray) -> np.ndarray:
        """Residuals as they count."""
        return math.sqrt(self.weight) * (predicted - self.values) / (1.0 if self.sigma is None else self.sigma)


@dataclass(frozen=True)
class Problem:
    """Parameters and curves of a fit, and the curves that were held out."""

    experiment: Any
    parameters: tuple[Parameter, ...]
    curves: tuple[Curve, ...]
    held: tuple[Curve, ...]
    starts: int
    seed: int
    known_sigma: bool
    step: float = 1e-3  # in u, of differences
    left_out: tuple[str, ...] = ()  # curves of which a short run reaches no time

    @property
    def names(self) -> list[str]:
        """Of the parameters."""
        return [parameter.name for parameter in self.parameters]

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest u."""
        return np.array([float(p.to_u(p.low)) for p in self.parameters]), np.array([float(p.to_u(p.high)) for p in self.parameters])

    @property
    def size(self) -> int:
        """Number of measured values that count."""
        return sum(len(curve.values) for curve in self.curves)

    def values(self, u: Any) -> tuple[float, ...]:
        """Parameters in SI."""
        return tuple(float(f"{float(p.from_u(one)):.15g}") for p, one in zip(self.parameters, u, strict=True))

    def residuals(self, record: Any) -> np.ndarray | None:
        """r of a record; None where the point is no number."""
        if record is None or record.status != OK:
            return None
        found = np.concatenate([curve.scaled(curve.predict(record)) for curve in self.curves])
        return found if np.isfinite(found).all() else None


def read(experiment: Any, hold_out: tuple[str, ...] = (), short: bool = False) -> Problem:
    """The problem of a config; Refused where it asks for none. `short`: of a smoke run, which goes without the curves that it does not reach."""
    asked, measured = experiment.fit, experiment.output.measured
    if asked is None:
        raise Refused("the config has no `fit:` section; say fit: {parameters: {kappa: [0.1, 1]}}, and the curves under output.measured")
    if unknown := [name for name in hold_out if name not in measured]:
        raise Refused(f"--hold-out {unknown[0]}: there is no such curve; here are {', '.join(measured)}")
    names = [name for name in asked.data or measured if name not in hold_out]
    if not names:
        raise Refused("every curve is held out, and none is left to fit to")
    left_out = tuple(name for name in (*names, *hold_out) if short and first_time(experiment, name) > last_time(experiment))
    if set(names) <= set(left_out):
        raise beyond(experiment, names[0], "smoke.time.end")
    known = Names(experiment)
    variation = Vary(ranges(asked), known).read()
    parameters = []
    for one in (parameter for group in variation.groups for parameter in group.parameters):  # and none that follows from these by a formula
        low, high = one.low, one.high
        value = at_path(experiment.resolved(), one.path)
        start = float(value) if isinstance(value, float | int) else math.sqrt(low * high) if one.log else (low + high) / 2
        units = one.slot.quantity.units if one.slot.quantity else "1"
        parameters.append(Parameter(one.short, one.spoken, low, high, one.log, min(max(start, low), high), units, one.slot.description or one.short))
    curves, held = (tuple(curve_of(experiment, name) for name in listed if name not in left_out) for listed in (names, hold_out))
    problem = Problem(experiment, tuple(parameters), curves, held, asked.starts, asked.seed, curves[0].sigma is not None, asked.step, left_out)
    if problem.size < len(parameters):
        raise Refused(f"{len(parameters)} parameters cannot be found from {problem.size} measured value{'s' * (problem.size != 1)}")
    return problem


def curve_of(experiment: Any, name: str) -> Curve:
    """A measured curve as arrays."""
    curve = experiment.output.measured[name]
    variable, units = recorded(experiment, name, curve)
    if curve.equals is not None:
        sigma = None if curve.sigma is None else np.array([curve.sigma])
        return Curve(name, variable, None, np.array([curve.equals]), sigma, curve.weight, units)
    rows = np.array(curve.samples, dtype=float)
    late = rows[:, 0] > last_time(experiment)
    if late.all():
        raise beyond(experiment, name)
    rows = rows[~late]
    sigma = rows[:, 2] if rows.shape[1] > 2 else None if curve.sigma is None else np.full(len(rows), curve.sigma)
    return Curve(name, variable, rows[:, 0], rows[:, 1], sigma, curve.weight, units, curve.file, int(late.sum()))


def last_time(experiment: Any) -> float:
    """The end of a run [s], with what rounding may add."""
    return experiment.time.end * (1 + 1e-9)


def first_time(experiment: Any, name: str) -> float:
    """When a curve begins [s]; at the start where it is one number a run."""
    return min((float(row[0]) for row in experiment.output.measured[name].samples), default=0.0)


def beyond(experiment: Any, name: str, key: str = "time.end") -> Refused:
    """The refusal of a curve of which the run reaches no time."""
    end, first = experiment.time.end, first_time(experiment, name)
    return Refused(f"output.measured.{name}: every measured time lies after the end of the run, {end:g} s; set {key} to {first:g} s or later")


def bare(experiment: Any) -> Any:
    """The experiment of the points: what was measured does not change a run, so it is no part of it."""
    output = experiment.output.model_copy(update={"measured": {}})
    made = experiment.model_copy(update={"output": output, "sweep": None, "fit": None})
    made._source, made._path, made._tree = experiment._source, experiment._path, None
    return made
