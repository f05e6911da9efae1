"""Pilots: a user's own scene with ever more cells, until one keeps a tolerance or says which cell would (study/choose.py, `mpm plan --tol`).

    refine(experiment, settings, tolerance, told) -> (cell, predicted error, seconds, pilots)      or NoChoice, which says why

Each has PILOT times the cells of the last, until one keeps the tolerance, or until the error is within REACH of it, falls with an order p of ORDERS[0] or
more, and the cell which that asks for, n* = n (e/(MARGIN tol))^(1/p), is farther than the next two pilots (three, where errors are estimated). Where a
known error has fallen by the same p twice, it is SURE in place of MARGIN, and a cell coarser than the next pilot's is taken at once.
No pilot starts that would end, by the time of the last one, more than MOST_SECONDS after the first of any method began.
Error     as `mpm chart` has it: against `exact:`; without one, of the observables that the config lists (probes, time_to, ...) by how they change between
          pilots: |f - f_k|/((h_k/h)^p - 1), the larger for the two before; p = 1, less where three pilots say so, or up to 2 where two estimates of it
          agree, and SAFETY times that. 100 % is `chart.scale`, else how much each changes in the run (mpm.reduce.change)
          (cells that bodies cut make a change small by chance: the loaf's time to 95 degC at 2.9 mm lies 0.3 % from that at 4.4 mm, and 2.8 % from its limit)
Cost      the last pilot's time, times the ratio that `mpm.runner.estimate` gives between the two
Fails when: the scene has an error that no cell removes (a smooth approximation, a sharp latent front); the pilots then do not fall, and the choice says so.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.config.vary import label
from mpm.reduce.change import size, spread
from mpm.study.richardson import SAFETY, observed
from mpm.study.richardson import order as fitted

MARGIN, SURE, REACH, PILOT = 0.7, 0.9, 6.0, 1.5
NEAR, FAR = 2, 3  # pilots left out for a guess at the least: where errors are known, and where they are estimated
MOST_PILOTS, MOST_SECONDS = 10, 120.0
LONG = 1.0  # s of a pilot that is timed by the run which gives its error: shorter ones once more, warm
ORDERS = (0.7, 4.0)
SAME = 0.1  # orders of an error that is known which differ by no more are one
AGREE = 0.5  # two estimates of an order that differ by no more are believed


class NoChoice(ValueError):
    """No method or cell can be chosen; the text says why."""


@dataclass(frozen=True)
class Pilot:
    """A run on the way: cells over the smallest extent, cell [m], error (inf: none), seconds of processor time, why it ended early, which final is worst,
    whether its error is known or estimated."""

    cells: float
    cell: float
    error: float
    seconds: float
    ended: str = ""
    worst: str = ""
    exact: bool = False

    def said(self, first: bool) -> str:
        """In words."""
        if self.ended:
            return self.ended
        error = f"error {self.much()}" if math.isfinite(self.error) else "to compare the next with" if first else "no error"
        return f"{error}, {self.seconds:.2g} s"

    def much(self) -> str:
        """The error, and of what."""
        return f"{100 * self.error:.2g} %" + (f" ({self.worst})" if self.worst else "")


def silent(_: str) -> None:
    """Says nothing."""


def extent(experiment: Any) -> float:
    """The smallest extent of a body [m]."""
    from mpm.scene.shapes import shape

    shapes: list[Any] = [shape(body.shape, experiment.grid.dimension) for body in experiment.bodies.values()]  # each kind has its own bounds
    return min(float(np.min(np.subtract(upper, lower))) for lower, upper in (one.bounds() for one in shapes))


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


def refine(
    experiment: Any, settings: dict[str, Any], tolerance: float, told: Callable[[str], None] = silent, began: float | None = None
) -> tuple[float, float, float, list[Pilot]]:
    """(cell, predicted error, seconds, pilots) of one method. `began`: when the first pilot of all did, by the processor's clock."""
    L, available = extent(experiment), list(grids(experiment))
    pilots: list[Pilot] = []
    gauge, wanted = Gauge(experiment, settings), 3.0 if experiment.moving else 2.0
    began, stopped = time.process_time() if began is None else began, ""
    while len(pilots) < MOST_PILOTS:
        cell = next((h for h in available if h <= L / wanted * (1 + 1e-9)), None)
        if cell is None or (pilots and cell >= pilots[-1].cell):
            break
        expected = gauge.expected(cell, pilots)
        if time.process_time() - began + (expected or 0.0) > MOST_SECONDS:
            stopped = f"the next, of cells of {label(cell)} m, would take {expected or 0.0:.2g} s: pilots may take {MOST_SECONDS:g} s together"
            break
        told(f"pilot of cells of {label(cell)} m" + (f", {expected:.2g} s" if expected is not None and expected >= LONG else ""))
        pilots.append(gauge.run(cell, L / cell))
        told(f"pilot of cells of {label(cell)} m: {pilots[-1].said(len(pilots) == 1)}")
        known = [pilot for pilot in pilots if math.isfinite(pilot.error)]
        met = known and known[-1].error <= tolerance
        near = len(known) > 1 and known[-1].error <= REACH * tolerance and order(known) >= ORDERS[0]
        guess = PILOT ** (FAR if experiment.exact is None else NEAR)  # nearer than that the next pilots are as good as a guess
        aim = goal(known, tolerance) if near else cell
        if met or (near and (aim < cell / guess or (sure(known) and aim > cell / PILOT))):
            return finish(experiment, settings, tolerance, available, known)
        wanted = L / cell * PILOT
    if not pilots:
        raise NoChoice(stopped.replace("the next", "a pilot") or "no grid fits")
    known = [pilot for pilot in pilots if math.isfinite(pilot.error)]
    if len(known) > 1 and known[-1].error <= REACH * tolerance and order(known) >= ORDERS[0]:
        return finish(experiment, settings, tolerance, available, known)
    raise NoChoice(because(pilots, known, tolerance) + (f", and {stopped}" if stopped else ""))


def because(pilots: list[Pilot], known: list[Pilot], tolerance: float) -> str:
    """Why pilots do not lead to a cell."""
    if not known:
        return f"no pilot of {len(pilots)} has an error" + (f": {pilots[-1].ended}" if pilots[-1].ended else "")
    if len(known) > 1 and known[-1].error <= REACH * tolerance:
        return f"the error falls with order {order(known):.2g} only, from {100 * known[-2].error:.2g} % to {known[-1].much()}"
    return f"not within {100 * REACH * tolerance:g} % after {len(pilots)} pilots, the last {known[-1].much()}"


def finish(experiment: Any, settings: dict[str, Any], tolerance: float, available: list[float], known: list[Pilot]) -> tuple[float, float, float, list[Pilot]]:
    """From the pilots to the cell."""
    last = known[-1]
    good = next((pilot for pilot in known if pilot.error <= tolerance), None)
    if good is not None:
        return good.cell, good.error, good.seconds, known
    cell = next((h for h in available if h <= goal(known, tolerance) * (1 + 1e-9)), None)
    if cell is None:
        raise NoChoice("no grid is as fine as the tolerance asks for")
    predicted = last.error * (cell / last.cell) ** min(order(known), ORDERS[1])
    return cell, predicted, last.seconds * ratio(experiment, settings, cell, last.cell), known


def order(known: list[Pilot]) -> float:
    """Of the error in the cell, by the last two pilots."""
    return math.log(known[-2].error / known[-1].error) / math.log(known[-2].cell / known[-1].cell)


def sure(known: list[Pilot]) -> bool:
    """Whether the error, itself known, has fallen by one order twice."""
    return len(known) > 2 and known[-1].exact and abs(order(known) - order(known[:-1])) <= SAME


def goal(known: list[Pilot], tolerance: float) -> float:
    """The cell at which the error should be MARGIN of the tolerance, SURE of it where it falls by one order [m]."""
    margin = SURE if sure(known) else MARGIN
    return known[-1].cell * (margin * tolerance / known[-1].error) ** (1 / min(max(order(known), ORDERS[0]), ORDERS[1]))


def ratio(experiment: Any, settings: dict[str, Any], cell: float, other: float) -> float:
    """How much more a run costs with one cell than with another, by the estimates."""
    return estimated(experiment, settings, cell) / estimated(experiment, settings, other)


def estimated(experiment: Any, settings: dict[str, Any], cell: float) -> float:
    """Seconds of a run with a cell, by the estimates."""
    from mpm.config import load
    from mpm.runner import estimate

    return estimate(load(experiment.template(), settings | {"grid.cell": cell}))["seconds"]


class Gauge:
    """Runs pilots and says their errors."""

    def __init__(self, experiment: Any, settings: dict[str, Any]):
        self.experiment, self.settings = experiment, settings
        self.seen: list[tuple[float, dict[str, float]]] = []  # (cell, observables) of the pilots so far
        self.warm, self.worst = False, ""

    def expected(self, cell: float, pilots: list[Pilot]) -> float | None:
        """Seconds that a pilot should take: by the last one that ran, else by the estimates; None where neither is known."""
        from mpm.config import ConfigError
        from mpm.scene.refusal import SceneError

        timed = [pilot for pilot in pilots if math.isfinite(pilot.seconds)]
        try:
            if timed:
                return timed[-1].seconds * ratio(self.experiment, self.settings, cell, timed[-1].cell)
            return estimated(self.experiment, self.settings, cell)
        except (SceneError, ConfigError):
            return None

    def run(self, cell: float, cells: float) -> Pilot:
        """One pilot; of the first without an exact solution there is no error yet."""
        from mpm.config import ConfigError, load
        from mpm.runner import run_point, warm
        from mpm.scene.refusal import SceneError

        try:
            point = load(self.experiment.template(), self.settings | {"grid.cell": cell})
            if not self.warm:
                warm(point)
                self.warm = True
            began = time.process_time()
            run = run_point(point)
        except (SceneError, ConfigError) as error:
            return Pilot(cells, cell, math.inf, math.nan, str(error).splitlines()[0])
        seconds = time.process_time() - began
        if not run.outcome.ok:
            return Pilot(cells, cell, math.inf, math.nan, f"{run.outcome.kind}: {run.outcome.message}".strip(": "))
        if seconds < LONG:
            began = time.process_time()
            run_point(point, compare=False)
            seconds = min(seconds, time.process_time() - began)
        return Pilot(cells, cell, self.error(run, cell), seconds, worst=self.worst, exact=self.experiment.exact is not None)

    def error(self, run: Any, cell: float = math.nan) -> float:
        """Against the exact solution; else by the pilots before, of which the cell is then needed."""
        from mpm.study.chart import RELATIVE, wanted_errors

        given = self.experiment.chart.scale if self.experiment.chart is not None else None
        if self.experiment.exact is not None:
            names, scale = wanted_errors(self.experiment, run.finals), given or spread(run.series) or 1.0
            return max(abs(run.finals[name]) / (1.0 if name in RELATIVE else scale) for name in names)
        found = {name: run.finals[name] for name in told_of(self.experiment, run.finals) if math.isfinite(run.finals[name])}
        self.seen.append((cell, found))
        since = next((k for k in reversed(range(len(self.seen))) if set(self.seen[k][1]) != set(found)), -1) + 1
        alike = self.seen[since:]  # a time that only one of two reaches is infinitely far
        if not found or len(alike) < 2:
            return math.inf
        gaps = {name: left([h for h, _ in alike], [one[name] for _, one in alike]) for name in found}
        shares = {name: gap / (size(name, run.series, found[name]) if given is None or name.startswith("time_to_") else given) for name, gap in gaps.items()}
        self.worst = max(shares, key=shares.__getitem__)
        return shares[self.worst]


def left(cells: list[float], values: list[float]) -> float:
    """How far the last of several values is from its limit, by the two before."""
    p = settled(np.array(cells), np.array(values))
    return (SAFETY if p > 1 else 1.0) * max(abs(values[-1] - f) / ((h / cells[-1]) ** p - 1) for h, f in zip(cells[-3:-1], values[-3:-1], strict=True))


def settled(cells: np.ndarray, values: np.ndarray) -> float:
    """The order by which values approach their limit: below 1 as soon as the last three say so, above 1, up to 2, where the last two triples agree."""
    found = [fitted(cells[k : k + 3], values[k : k + 3]) for k in range(max(0, len(values) - 4), len(values) - 2)]
    if not found or found[-1] is None:
        return 1.0
    known = [order for order in found if order is not None]
    if known[-1] < 1 or len(known) < len(found) or len(found) < 2 or abs(known[0] - known[1]) > AGREE:
        return min(1.0, known[-1])
    return min(2.0, max(1.0, min(known)))


def told_of(experiment: Any, finals: dict[str, float]) -> list[str]:
    """Those of the finals that a config wants right."""
    found = [name for name in observed(experiment) if name in finals]
    if not found:
        raise NoChoice("nothing to keep a tolerance of: name `exact:`, or observables or probes under `output:`")
    return found
