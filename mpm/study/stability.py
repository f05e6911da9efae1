"""`mpm stability`: where a method fails. Every column of the map is bracketed on the given values, then the bracket is quartered until it is narrow.

Each round is an ordinary sweep over one folder, so a point that is on disk never runs again, and an interrupted map goes on where it was.

    points of all rounds -> OUT/sweep.nc (a list of points)         what each point came to
                         -> OUT/stability.nc (mpm.study.boundary)   boundaries, theory, growth, sentences
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpm.config.rules_stability import axes_of
from mpm.config.sweep import Sweep
from mpm.records.variables import OK
from mpm.sweep.api import default_out, execute
from mpm.sweep.cases import plan as plan_of
from mpm.sweep.engine import Options
from mpm.sweep.report import Reporter
from mpm.sweep.result import Result
from mpm.sweep.store import Refused, Store

CUTS = 4  # parts of a bracket a round: fewer rounds than halving, and workers have something to share
ROUNDS = 12


@dataclass(frozen=True)
class Verdict:
    """What one point came to. `beyond`: it failed, or its final exceeds what the map allows."""

    run_id: str
    beyond: bool
    outcome: str
    growth: float


@dataclass
class Column:
    """One value across, in one panel: verdicts by value along."""

    panel: int
    place: int
    verdicts: dict[float, Verdict] = field(default_factory=dict)

    def bracket(self, toward: str) -> tuple[float, float]:
        """The last value that is within and the first beyond, going the way things fail; NaN where there is none."""
        order = sorted(self.verdicts, reverse=toward == "smaller")
        last = math.nan
        for value in order:
            if self.verdicts[value].beyond:
                return last, value
            last = value
        return last, math.nan


@dataclass
class Map:
    """The axes of a map and its columns."""

    experiment: Any
    panels: list[str]
    settings: list[dict[str, Any]]
    across: Any  # Coordinate
    along: Any
    columns: list[Column]

    @property
    def stability(self) -> Any:
        """The section of the config."""
        return self.experiment.stability

    def narrow(self, low: float, high: float) -> bool:
        """Whether a bracket is as narrow as asked: relative, or in absolute terms where the axis reaches zero."""
        return abs(high - low) <= self.stability.resolution * max(abs(low), abs(high)) * (1 + 1e-9)

    def between(self, low: float, high: float) -> list[float]:
        """Values inside a bracket: even in the logarithm where both ends are positive."""
        parts = np.arange(1, CUTS) / CUTS
        if low > 0 and high > 0:
            return [float(f"{low * (high / low) ** part:.12g}") for part in parts]
        return [float(f"{low + (high - low) * part:.12g}") for part in parts]

    def wanted(self) -> list[tuple[Column, float]]:
        """Points of the next round."""
        found = []
        for column in self.columns:
            if not column.verdicts:
                found += [(column, value) for value in self.along.values]
                continue
            low, high = column.bracket(self.stability.toward)
            if not (math.isnan(low) or math.isnan(high) or self.narrow(low, high)):
                found += [(column, value) for value in self.between(low, high)]
        return found

    def point(self, column: Column, value: float) -> dict[str, Any]:
        """A point of the map as an entry of `sweep.points`."""
        said = dict(self.settings[column.panel])
        said |= {self.across.config_path: self.across.values[column.place], self.along.config_path: value}
        said = {name: ".inf" if item == math.inf else item for name, item in said.items()}
        if self.stability.steps is not None:
            end = value * self.stability.steps
            said |= {"time.end": end, "output.every": end / self.stability.frames}
        return said


def read(experiment: Any) -> Map:
    """The map that an experiment asks for; Refused where it asks for none."""
    stability = experiment.stability
    if stability is None:
        raise Refused("the config has no `stability:` section, which says what is mapped: axes, panels, what counts as beyond, lines of theory")
    coarse = plan_of(experiment.model_copy(update={"sweep": axes_of(stability)}), max_runs=10**6)
    across, along = (dim.coords[0] for dim in coarse.dims[:2])
    if along.values.dtype == object:
        raise Refused("stability.along: a boundary is sought between numbers; put what has names into `panels`, or on `across`")
    panels = list(stability.panels) or [""]
    settings = [dict(panel) for panel in stability.panels.values()] or [{}]
    columns = [Column(panel, place) for panel in range(len(panels)) for place in range(len(across.values))]
    return Map(experiment, panels, settings, across, along, columns)


@dataclass
class Done:
    """A map that is computed, as far as it went."""

    map: Map
    result: Result
    ran: int
    dataset: Path | None


def run(experiment: Any, out: Path | None, options: Options | None = None, reporter: Reporter | None = None, told: Callable[[str], None] = print) -> Done:
    """Rounds until every bracket is narrow, then the datasets. Stops early, resumably, where a round was stopped."""
    from mpm.study.boundary import write

    asked = read(experiment)
    options, out = options or Options(), out or default_out(experiment)
    store, points, ran, result = Store(out), [], 0, None
    known: list[dict[str, Any]] = []
    for number in range(1, ROUNDS + 1):
        wanted = asked.wanted()
        if not wanted:
            break
        points = [asked.point(column, value) for column, value in wanted]
        known += points
        result, ids = sweep(experiment, points, out, options, reporter)
        ran += result.ran
        if result.stopped:
            return Done(asked, result, ran, None)
        for (column, value), run_id in zip(wanted, ids, strict=True):
            column.verdicts[value] = judge(asked, store, run_id, result.lines[run_id], value)
        beyond = sum(column.verdicts[value].beyond for column, value in wanted)
        told(f"round {number}: {len(wanted)} points, {beyond} beyond; {result.ran} run now, {result.seconds:.1f} s")
    result, _ = sweep(experiment, known, out, options, reporter)
    return Done(asked, result, ran, write(asked, out))


def sweep(experiment: Any, points: list[dict[str, Any]], out: Path, options: Options, reporter: Reporter | None) -> tuple[Result, list[str]]:
    """One round: the result, and the run ids in the order of the points."""
    listed = experiment.model_copy(update={"sweep": Sweep(points=tuple(points))})
    result = execute(listed, out, options, reporter, max_runs=10**6)
    return result, [case.run_id for case in plan_of(listed, max_runs=10**6).cases]


def judge(asked: Map, store: Store, run_id: str, line: dict, value: float) -> Verdict:
    """What a finished point came to."""
    record, stability = store.load(run_id, fields=False), asked.stability
    beyond, outcome = line["status"] != OK, line["outcome"] or line["error"].split(":")[0]
    for name, most in stability.beyond.items():
        if not beyond and not abs(record.finals.get(name, math.nan)) <= most:
            beyond, outcome = True, f"{name} above {most:g}"
    return Verdict(run_id, beyond, outcome, growth(stability, record, value))


def growth(stability: Any, record: Any, value: float) -> float:
    """Rate of the logarithm of a series over the second half of what is there: a step where the map counts steps, else a second; NaN if it cannot be told."""
    asked = stability.growth
    if asked is None or asked.of not in record.series:
        return math.nan
    size = np.abs(record.series[asked.of] - asked.less)
    good = np.flatnonzero(np.isfinite(size) & (size > 0))
    if len(good) < 3:
        return math.nan
    first, last = good[len(good) // 2], good[-1]
    if first == last:
        first = good[0]
    rate = math.log(size[last] / size[first]) / (record.times[last] - record.times[first])
    return float(rate * value) if stability.steps is not None else float(rate)
