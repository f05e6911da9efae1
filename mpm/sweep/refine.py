"""Refine: `sweep: {axes: ..., refine: {of: ..., until: 1 %, points: 200}}` puts new points where the answer bends, where it crosses `level`, and where ok meets
failed, on one or two axes. Every point is one of an ordinary sweep, along the dimension `point` (one axis: its own); the same command goes on.

On two axes with a `level`, while every point is ok: see `contour`. Else the axes' own values span cells. A cell is split in halves (quarters), which adds the
points between its corners, when
    level given   the corners lie on both sides of it, and the crossing is not yet known to `until` of the ranges: where the cell it came from foretold its new
                  points to within that distance, given how steep the answer is, it is
    no level      its new points were foretold (linearly from the corners) worse than `until` of the answer's spread
    a corner is not ok or was not reached, and another is: until the cell is as small as `until` of the ranges
Largest errors first, as long as there are points. Fails when: what bends or crosses lies wholly between the first points
"""

import itertools
import math
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpm.config.names import Names
from mpm.config.vary import Vary
from mpm.records.variables import OK, dataset_name
from mpm.sweep.contour import follow
from mpm.sweep.engine import Options
from mpm.sweep.lock import Refused
from mpm.sweep.queue import Points, exit_code, warned
from mpm.sweep.ranges import columns
from mpm.sweep.report import Reporter
from mpm.sweep.result import Result
from mpm.sweep.rounds import Rounds, Stopped

Place = tuple[float, ...]
DIGITS = 12


@dataclass
class Cell:
    """Corners `low` and `high` in u (the value, or its logarithm); `error`: how badly it is known, infinite where nothing is foretold yet."""

    low: Place
    high: Place
    error: float = math.inf

    def corners(self) -> list[Place]:
        """Its 2^d corners."""
        return list(itertools.product(*zip(self.low, self.high, strict=True)))

    def lattice(self) -> list[Place]:
        """Corners and all points halfway."""
        return list(itertools.product(*((a, rounded((a + b) / 2), b) for a, b in zip(self.low, self.high, strict=True))))

    def parts(self) -> list["Cell"]:
        """Halves, or quarters."""
        middle = [rounded((a + b) / 2) for a, b in zip(self.low, self.high, strict=True)]
        ends = [((a, m), (m, b)) for a, m, b in zip(self.low, middle, self.high, strict=True)]
        return [Cell(tuple(one[0] for one in pick), tuple(one[1] for one in pick)) for pick in itertools.product(*ends)]


def rounded(value: float) -> float:
    """So that two cells name their common points alike."""
    return float(f"{value:.{DIGITS}g}")


@dataclass
class Mesh:
    """Cells over the axes, and the answer at every point that is known (NaN: not ok, or not reached)."""

    asked: Any
    names: list[str]
    logs: list[bool]
    grid: list[list[float]]
    known: dict[Place, float] = field(default_factory=dict)
    cells: list[Cell] = field(default_factory=list)

    @property
    def spans(self) -> np.ndarray:
        """Length of each axis, of its logarithm where points are even in that."""
        return np.array([axis[-1] - axis[0] for axis in self.grid])

    @property
    def follows(self) -> bool:
        """Whether a line is followed rather than cells split."""
        return self.asked.level is not None and len(self.grid) == 2 and all(map(math.isfinite, self.known.values()))

    def on_line(self) -> list[Place]:
        """Points that a line on which the answer crosses the level still wants."""
        low = np.array([axis[0] for axis in self.grid])
        found = follow((np.array([*self.known]) - low) / self.spans, np.array([*self.known.values()]), self.asked.level, self.asked.until)
        return [place for place in (tuple(map(rounded, row)) for row in low + found * self.spans) if place not in self.known]

    def value(self, place: Place) -> tuple[float, ...]:
        """A point in SI."""
        return tuple(rounded(math.exp(u)) if log else u for u, log in zip(place, self.logs, strict=True))

    def begin(self) -> list[Place]:
        """The first points, and their cells."""
        sides = [list(itertools.pairwise(axis)) for axis in self.grid]
        self.cells = [Cell(tuple(a for a, _ in pick), tuple(b for _, b in pick)) for pick in itertools.product(*sides)]
        return list(itertools.product(*self.grid))

    def small(self, cell: Cell) -> bool:
        """Whether a cell is as small along every axis as was asked for."""
        return bool(np.all((np.array(cell.high) - np.array(cell.low)) / self.spans <= self.asked.until * (1 + 1e-9)))

    def wants(self, cell: Cell) -> bool:
        """Whether a cell is to be split."""
        if self.small(cell):
            return False
        values = np.array([self.known[corner] for corner in cell.corners()])
        bad = ~np.isfinite(values)
        if bad.all():
            return False
        if bad.any():
            return True
        if self.asked.level is not None and not values.min() <= self.asked.level <= values.max():
            return False
        return cell.error > self.asked.until

    def split(self, cell: Cell) -> None:
        """Put its parts in its place; a quarter of the error by which it foretold its new points is that of each (second order)."""
        error = self.foretold(cell) / 4
        self.cells.remove(cell)
        self.cells += [Cell(part.low, part.high, error) for part in cell.parts()]

    def foretold(self, cell: Cell) -> float:
        """Error of linear interpolation between the corners at the new points: over the steepness (a distance in ranges), or over the answer's spread."""
        low, high = np.array(cell.low), np.array(cell.high)
        corners = {corner: self.known[corner] for corner in cell.corners()}
        if not np.isfinite(list(corners.values())).all():
            return math.inf
        worst = 0.0
        for place in cell.lattice():
            t = (np.array(place) - low) / (high - low)
            guess = sum(v * np.prod([w if c == h else 1 - w for c, w, h in zip(corner, t, cell.high, strict=True)]) for corner, v in corners.items())
            worst = max(worst, abs(self.known[place] - guess)) if math.isfinite(self.known[place]) else math.inf
        if self.asked.level is None:
            found = np.array([v for v in self.known.values() if math.isfinite(v)])
            return worst / (float(np.ptp(found)) or 1.0)
        mean = lambda k, end: np.mean([v for corner, v in corners.items() if corner[k] == end[k]])  # noqa: E731
        slope = math.hypot(*((mean(k, cell.high) - mean(k, cell.low)) / ((high[k] - low[k]) / self.spans[k]) for k in range(len(low))))
        return worst / slope if slope > 0 else math.inf


def read(experiment: Any) -> Mesh:
    """The mesh of a config."""
    sweep = experiment.sweep
    if sweep.zip or sweep.sample or sweep.points or sweep.where or not 1 <= len(sweep.axes) <= 2:
        raise Refused("sweep.refine works on one or two axes, without zip, sample, points and where")
    variation = Vary(sweep, Names(experiment)).read()
    grid, logs, names = [], [], []
    for group in variation.groups:
        parameter, values = group.parameters[0], columns(group)[0]
        if not all(isinstance(value, float) and math.isfinite(value) for value in values) or len(values) < 2:
            raise Refused(f"sweep.refine: the axis {parameter.short} must be two finite numbers or more")
        logs.append(parameter.log)
        grid.append(sorted(rounded(math.log(value)) if parameter.log else value for value in values))
        names.append(parameter.spoken)
    return Mesh(sweep.refine, names, logs, grid)


def refine(experiment: Any, out: Path, options: Options, reporter: Reporter) -> Result:
    """All rounds; the dataset at the end, also of what there is where it was stopped."""
    began, mesh, stopped = time.monotonic(), read(experiment), ""
    name, asked = dataset_name(mesh.asked.of), experiment.sweep.refine
    rounds = Rounds(experiment, mesh.names, out, options, reporter, experiment.sweep.derive, axis=len(mesh.names) == 1)
    with rounds:
        wanted = mesh.begin()
        pending: list[Cell] = []
        try:
            while wanted:
                records = rounds.run([mesh.value(place) for place in wanted])
                mesh.known |= {place: final_of(record, name) for place, record in zip(wanted, records, strict=True)}
                for cell in pending:
                    mesh.split(cell)
                wanted, pending = choose(mesh)
        except Stopped as error:
            stopped = error.why
        left = 0 if stopped else len(mesh.on_line()) if mesh.follows else sum(mesh.wants(cell) for cell in mesh.cells)
        if left:
            used = f"{len(mesh.known)} of {asked.points} points are used"
            what = "place" if mesh.follows else "cell"
            reporter.note(f"sweep.refine: {used}, and {left} {what}{'s are' if left > 1 else ' is'} not yet as fine as asked; more `points` would do")
        plan, found = rounds.collect()
    points = Points.of(plan)
    lines, _ = rounds.store.lines(points.ids)
    code = exit_code(found, stopped)
    return Result(out, lines, found, rounds.ran, stopped, code, time.monotonic() - began, True, bool(rounds.stopped), warned(points, lines), rounds.compiling)


def choose(mesh: Mesh) -> tuple[list[Place], list[Cell]]:
    """New points, and the cells that they split; the worst known cells first, as many as there are points for."""
    if mesh.follows:
        return mesh.on_line()[: max(0, mesh.asked.points - len(mesh.known))], []
    while True:
        wanted: dict[Place, None] = {}
        pending: list[Cell] = []
        for cell in sorted((cell for cell in mesh.cells if mesh.wants(cell)), key=lambda cell: -cell.error):
            new = [place for place in cell.lattice() if place not in mesh.known and place not in wanted]
            if len(mesh.known) + len(wanted) + len(new) > mesh.asked.points:
                break
            wanted |= dict.fromkeys(new)
            pending.append(cell)
        if wanted or not pending:
            return list(wanted), pending
        for cell in pending:  # neighbours have asked for all of their points already
            mesh.split(cell)


def final_of(record: Any, name: str) -> float:
    """What a point tells; NaN where it is not ok or not reached."""
    if record.status != OK:
        return math.nan
    value = record.finals.get(name)
    return float(value) if value is not None else float(record.series[name][-1]) if name in record.series else math.nan
