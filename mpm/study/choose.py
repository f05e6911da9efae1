"""Method, cell and step for a tolerance (`mpm plan --tol 1%`): the method from the charted fronts, the cell from pilot runs of the user's own scene.

    choose(experiment, tolerance) -> Choice      offer, told: the same for `mpm plan`

1  The kind of physics (rigid heat, heat in particles, mechanics, coupled) picks the charts that speak for it (fronts.json, from `python -m mpm.study.figures`).
   Of the numerical methods in them, at the automatic step, the one that reaches the tolerance in the least time, over all of those charts, is taken.
2  Pilots: the scene itself with ever more cells, each PILOT times the last, until one keeps the tolerance, or until the error is within REACH of it and the
   cell that their order p asks for, n* = n (e/(MARGIN tol))^(1/p), is farther than the next two pilots.
Error     as `mpm chart` has it: against `exact:`; without one, the change of the observables that the config lists (probes, time_to, ...) between pilots
Cost      the last pilot's time, times the ratio that `mpm.runner.estimate` gives between the two
Fails when: the scene has an error that no cell removes (a smooth approximation, a sharp latent front); the pilots then do not fall, and the choice says so.
"""

import json
import math
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

FRONTS = Path(__file__).with_name("fronts.json")
MARGIN, REACH, PILOT = 0.7, 6.0, 1.5
MOST_PILOTS, MOST_SECONDS = 8, 120.0
ORDERS = (0.7, 4.0)
NUMERICS = ("grid.basis", "method.", "time.")


class NoChoice(ValueError):
    """No method or cell can be chosen; the text says why."""


@dataclass(frozen=True)
class Pilot:
    """A run on the way: cells over the smallest extent, cell [m], error, seconds of processor time."""

    cells: float
    cell: float
    error: float
    seconds: float


@dataclass(frozen=True)
class Choice:
    """What to set, the error that it should have, its seconds a run; from which method of which charts, and the pilots."""

    settings: dict[str, Any]
    predicted: float
    seconds: float
    method: str
    charts: tuple[str, ...]
    pilots: tuple[Pilot, ...] = field(default=())


def physics(experiment: Any) -> str:
    """rigid, heat, mechanics or coupled: which charts speak for a scene."""
    materials = [experiment.materials[body.material] for body in experiment.bodies.values()]
    if not experiment.moving:
        return "rigid"
    warm = any(material.heat is not None for material in materials)
    return "mechanics" if not warm else "coupled" if any(material.expansion is not None for material in materials) else "heat"


def numerical(settings: dict[str, Any]) -> dict[str, Any] | None:
    """The numerical part of a method of a chart; None where it is another model (another dimension), which is not ours to choose."""
    if any(path.startswith(("grid.dimension", "bodies")) for path in settings):
        return None
    return {path: value for path, value in settings.items() if path.startswith(NUMERICS)}


def charted() -> list[dict]:
    """The settings of the charts: {study, physics, method, set, cell, steps (none: automatic), error, seconds} (`python -m mpm.study.figures`)."""
    return json.loads(FRONTS.read_text(encoding="utf-8"))


def rank(kind: str, tolerance: float, fronts: list[dict] | None = None) -> list[tuple[str, dict[str, Any], tuple[str, ...]]]:
    """Methods (name, settings, charts), the cheapest first: by the mean of the logarithms of their time over the best, of those that reach the tolerance."""
    rows = [row for row in (charted() if fronts is None else fronts) if row["physics"] == kind and not row.get("steps")]
    studies = tuple(dict.fromkeys(row["study"] for row in rows))
    found: dict[str, list[float]] = {}
    settings = {json.dumps(row["set"], sort_keys=True): row for row in rows}
    for study in studies:
        times = {key: reach([row for row in rows if row["study"] == study and json.dumps(row["set"], sort_keys=True) == key], tolerance) for key in settings}
        best = min(times.values())
        if math.isinf(best):
            continue  # nothing in this chart gets there: it has no say
        for key, seconds in times.items():
            found.setdefault(key, []).append(math.log(seconds / best))
    order = sorted(found, key=lambda key: sum(found[key]))
    return [(settings[key]["method"], settings[key]["set"], studies) for key in order if math.isfinite(sum(found[key]))]


def reach(rows: list[dict], tolerance: float) -> float:
    """Seconds to a tolerance along one method's settings, interpolated in logarithms; a little beyond the finest too; inf where it is out of reach."""
    rows = sorted((row for row in rows if row["error"] and row["seconds"]), key=lambda row: row["seconds"])
    below = [row for row in rows if row["error"] <= tolerance]
    if below:
        last = below[0]
        before = [row for row in rows if row["seconds"] < last["seconds"]]
        if not before:
            return last["seconds"]
        first = before[-1]
        part = math.log(first["error"] / tolerance) / max(1e-9, math.log(first["error"] / last["error"]))
        return first["seconds"] * (last["seconds"] / first["seconds"]) ** min(1.0, max(0.0, part))
    if len(rows) < 2 or rows[-1]["error"] > 4 * tolerance or rows[-1]["error"] >= rows[-2]["error"]:
        return math.inf
    slope = math.log(rows[-1]["seconds"] / rows[-2]["seconds"]) / math.log(rows[-2]["error"] / rows[-1]["error"])
    return rows[-1]["seconds"] * (rows[-1]["error"] / tolerance) ** slope


def extent(experiment: Any) -> float:
    """The smallest extent of a body [m]."""
    from mpm.scene.shapes import shape

    bounds = [shape(body.shape, experiment.grid.dimension).bounds() for body in experiment.bodies.values()]
    return min(float(np.min(upper - lower)) for lower, upper in bounds)


def grids(experiment: Any) -> Iterator[float]:
    """Cells [m] from coarse to fine that the scene can have: walls of moving bodies stand on grid lines, so sizes are whole numbers of cells."""
    L, size = extent(experiment), experiment.grid.size
    if not experiment.moving:
        yield from (L / n for n in range(2, 4000))
        return
    first = size[0]
    for n in range(1, 20000):
        h = first / n
        if h <= L / 2 and all(abs(length / h - round(length / h)) < 1e-6 for length in size):
            yield h


def choose(experiment: Any, tolerance: float, fronts: list[dict] | None = None) -> Choice:
    """The cheapest settings that keep `tolerance` (0.01 is 1 %), by the charts and by pilots; NoChoice where there is none."""
    if experiment.grid.dimension == 0:
        raise NoChoice("a material point has no cell to choose: take time.step from a chart of its own (mpm chart)")
    kind = physics(experiment)
    ranked = rank(kind, tolerance, fronts)
    if not ranked:
        raise NoChoice(f"no chart of {kind} reaches {100 * tolerance:g} %")
    told = []
    for method, settings, charts in ranked[:3]:
        try:
            cell, predicted, seconds, pilots = refine(experiment, settings, tolerance)
        except NoChoice as why:
            told.append(f"{method}: {why}")
            continue
        return Choice(settings | {"grid.cell": cell}, predicted, seconds, method, charts, tuple(pilots))
    raise NoChoice("; ".join(told))


def refine(experiment: Any, settings: dict[str, Any], tolerance: float) -> tuple[float, float, float, list[Pilot]]:
    """(cell, predicted error, seconds, pilots) of one method."""
    L, available = extent(experiment), list(grids(experiment))
    pilots: list[Pilot] = []
    gauge, wanted = Gauge(experiment, settings), 3.0 if experiment.moving else 2.0
    began = time.process_time()
    while len(pilots) < MOST_PILOTS and time.process_time() - began < MOST_SECONDS:
        cell = next((h for h in available if h <= L / wanted * (1 + 1e-9)), None)
        if cell is None or (pilots and cell >= pilots[-1].cell):
            break
        pilots += gauge.run(cell, L / cell)
        known = [pilot for pilot in pilots if math.isfinite(pilot.error)]
        met = known and known[-1].error <= enough(experiment) * tolerance
        near = len(known) > 1 and known[-1].error <= REACH * tolerance
        if met or (near and goal(known, tolerance) < known[-1].cell / PILOT**2):  # nearer than that the next pilots are as good as a guess
            return finish(experiment, settings, tolerance, available, known)
        wanted = L / cell * PILOT
    if not pilots:
        raise NoChoice("no grid fits")
    raise NoChoice(f"not within {100 * REACH * tolerance:g} % after {len(pilots)} pilots, the last {100 * pilots[-1].error:.2g} %")


def finish(experiment: Any, settings: dict[str, Any], tolerance: float, available: list[float], known: list[Pilot]) -> tuple[float, float, float, list[Pilot]]:
    """From the pilots to the cell."""
    last = known[-1]
    good = next((pilot for pilot in known if pilot.error <= enough(experiment) * tolerance), None)
    if good is not None:
        return good.cell, good.error, good.seconds, known
    p = order(known)
    if p < ORDERS[0]:
        raise NoChoice(f"the error falls with order {p:.2g} only, from {100 * known[-2].error:.2g} % to {100 * last.error:.2g} %")
    cell = next(h for h in available if h <= goal(known, tolerance) * (1 + 1e-9))
    predicted = last.error * (cell / last.cell) ** min(p, ORDERS[1])
    return cell, predicted, last.seconds * ratio(experiment, settings, cell, last.cell), known


def enough(experiment: Any) -> float:
    """The part of the tolerance that a pilot's error may take: all of it where the error is known, MARGIN where it is estimated."""
    return 1.0 if experiment.exact is not None else MARGIN


def order(known: list[Pilot]) -> float:
    """Of the error in the cell, by the last two pilots."""
    return math.log(known[-2].error / known[-1].error) / math.log(known[-2].cell / known[-1].cell)


def goal(known: list[Pilot], tolerance: float) -> float:
    """The cell at which the error should be MARGIN of the tolerance [m]."""
    return known[-1].cell * (MARGIN * tolerance / known[-1].error) ** (1 / min(max(order(known), ORDERS[0]), ORDERS[1]))


def ratio(experiment: Any, settings: dict[str, Any], cell: float, other: float) -> float:
    """How much more a run costs with one cell than with another, by the estimates."""
    from mpm.config import load
    from mpm.runner import estimate

    fine, coarse = (estimate(load(experiment.template(), settings | {"grid.cell": h}))["seconds"] for h in (cell, other))
    return fine / coarse


class Gauge:
    """Runs pilots and says their errors."""

    def __init__(self, experiment: Any, settings: dict[str, Any]):
        self.experiment, self.settings = experiment, settings
        self.before: dict[str, float] | None = None
        self.warm = False

    def run(self, cell: float, cells: float) -> list[Pilot]:
        """One pilot; of the first without an exact solution nothing is known."""
        from mpm.config import load
        from mpm.runner import run_point

        point = load(self.experiment.template(), self.settings | {"grid.cell": cell})
        run = run_point(point)
        if not run.outcome.ok:
            return [Pilot(cells, cell, math.inf, math.nan)]
        began = time.process_time()
        run_point(point, compare=False)
        seconds = time.process_time() - began
        return [Pilot(cells, cell, self.error(run), seconds)]

    def error(self, run: Any) -> float:
        """Against the exact solution; else the change since the last pilot."""
        from mpm.study.chart import RELATIVE, wanted_errors

        series = run.series
        spread = float(np.max(series["temperature_max"]) - np.min(series["temperature_min"])) if "temperature_max" in series else 1.0
        chart = self.experiment.chart
        scale = chart.scale if chart is not None and chart.scale is not None else spread or 1.0
        if self.experiment.exact is not None:
            names = wanted_errors(self.experiment, run.finals)
            return max(abs(run.finals[name]) / (1.0 if name in RELATIVE else scale) for name in names)
        found = {name: run.finals[name] for name in observed(self.experiment, run.finals)}
        before, self.before = self.before, found
        if before is None:
            return math.inf
        return max(abs(value - before[name]) / (scale if "temperature" in name else abs(value) or 1.0) for name, value in found.items())


def observed(experiment: Any, finals: dict[str, float]) -> list[str]:
    """The finals that a config cares about: what it lists under chart.observables, else its observables and probes."""
    from mpm.records.variables import dataset_name

    listed = experiment.chart.observables if experiment.chart is not None and experiment.chart.observables else ()
    listed = listed or [dataset_name(name) for name in experiment.output.observables] + [f"temperature_{probe}" for probe in experiment.output.probes]
    found = [name for name in listed if name in finals and math.isfinite(finals[name])]
    if not found:
        raise NoChoice("nothing to keep a tolerance of: name `exact:`, or observables or probes under `output:`")
    return found


def offer(experiment: Any, tolerance: float) -> dict[str, Any]:
    """`choose` as plain data for `mpm plan --tol`: settings, predicted error, seconds and where they come from; or `none`: why not."""
    try:
        found = choose(experiment, tolerance)
    except (NoChoice, ValueError) as why:
        return {"tolerance": tolerance, "none": str(why)}
    return {"tolerance": tolerance, **asdict(found)}


def told(found: dict[str, Any]) -> str:
    """The same in words, ready to be pasted behind a command."""
    if "none" in found:
        return f"settings  none for {100 * found['tolerance']:g} %: {found['none']}"
    from mpm.config.vary import label

    chosen = " ".join(f"--set '{path}={value if isinstance(value, float | int | str) else json.dumps(value)}'" for path, value in found["settings"].items())
    pilots = ", ".join(f"{label(pilot['cell'])} m {100 * pilot['error']:.2g} %" for pilot in found["pilots"])
    expected = f"error {100 * found['predicted']:.2g} % expected, {found['seconds']:.2g} s a run"
    lines = [f"settings  for {100 * found['tolerance']:g} %: {found['method']}, {expected}"]
    return "\n".join([*lines, f"          {chosen}", f"          method from the charts of {', '.join(found['charts'])}; cell from pilots: {pilots}"])
