"""The table of the verification problems: `python -m mpm.benchmarks.verification` writes configs/verification/README.md; with names, only those rows again
(`python -m mpm.benchmarks.verification hencky_bar standing_wave`; the last brings the table of transfers of mpm.benchmarks.wave).

Every config there, as one point, at three resolutions: those of its sweep over grid.cell or time.step, else its own halved twice (cells of a
body on a grid, steps of a material point). The order is fitted to all three; a problem that is exact in any step, or
bounded by something else, declares none.
"""

import importlib
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mpm.benchmarks import CONFIGS
from mpm.benchmarks.wave import table

ERRORS = {
    "error_displacement": "displacement, relative",
    "error_l2": "temperature, K",
    "error_relative": "all fields, relative",
    "error_force": "force at the end, relative",
}  # the first that a run has
BESIDE = ("error_velocity", "error_stress")
FOLDER = CONFIGS / "verification"
HEAD = """# Verification problems

Made by `python -m mpm.benchmarks.verification`. Each line is a config of this folder at the three resolutions that are named; what the problem is stands
at the head of its config, the exact solution in `mpm/verification/`. Errors are root mean squares: of
displacement over all times and particles, relative (of what comes to rest: at the end), beside it of velocity and stress where the solution gives
them, with their order in brackets; of temperature at the end. Time is that of the three runs on a busy machine, without compilation. Robin problems have
Bi = 10 (ring: beta 10) and a fall of 1 K; particles fly across the grid as they cool. A problem
without an order is exact in any step, or (rigid_rotation) bounded by the load of its own motion.

Where velocity and stress stall: particles are the points of a quadrature that motion carries across the knots of the splines, and there the gradient of a
quadratic spline has a kink. The error of that falls with the number of particles a cell, not with the cell, and velocity and stress show it first. With 4
particles a cell `hencky_bar` goes from 1.3e-3 and 2.2e-3 at 32 cells to 1.5e-3 and 2.0e-3 at 64, where its end moves by two cells; with 8 to 2.5e-4 and
5.2e-4, order 1.5 or better from 8 cells on (`error_velocity`, `error_stress` of `mpm run configs/verification/hencky_bar.yaml --set grid.cell=0.015625 --set
method.particles=8`). Cubic splines have no such kink: `hencky_bar_cubic` is of order 2 in all three.
How heat is exchanged at a free surface, three ways measured: [surfaces.md](surfaces.md), made by `python -m mpm.benchmarks.surfaces`.
What bodies that meet are held to, most of it no field over a whole run: [contact.md](contact.md).

| config | method | refined | error | at three resolutions | order | declared | velocity | stress | time, s |
|---|---|---|---|---|---|---|---|---|---|
"""
WAVE = """
## Which transfer keeps a thermoelastic wave

`python -m mpm.benchmarks.wave`: errors of the frequency and of the physical damping of `standing_wave` at 64 cells, by transfer of velocity and of temperature.

"""


@dataclass(frozen=True)
class ProblemRow:
    """One row of the table."""

    name: str
    method: str
    path: str
    values: tuple[float, ...]
    field: str
    errors: tuple[float, ...]
    declared: float | None
    seconds: float
    beside: dict[str, tuple[float, ...]] = field(default_factory=dict)  # errors of BESIDE that the runs have

    def order(self) -> float | None:
        """Slope of the errors over the resolution; None where the problem declares none (exact in any step, or bounded)."""
        return None if self.declared is None else self.slope(self.errors)

    def slope(self, errors: tuple[float, ...]) -> float | None:
        """The order of these; None of what is zero."""
        return float(np.polyfit(np.log(self.values), np.log(errors), 1)[0]) if all(error > 0 for error in errors) else None

    def cell(self, name: str) -> str:
        """Errors of one of BESIDE, and their order where one is declared."""
        if name not in self.beside:
            return "-"
        errors, order = self.beside[name], self.slope(self.beside[name]) if self.declared is not None else None
        return ", ".join(f"{error:.3g}" for error in errors) + ("" if order is None else f" ({order:.2f})")

    def text(self) -> str:
        """As a row of Markdown."""
        order = self.order()
        shown = ["-" if number is None else f"{number:.2f}" for number in (order, self.declared)]
        values, errors = (", ".join(f"{number:.3g}" for number in row) for row in (self.values, self.errors))
        cells = [self.name, self.method, f"{self.path} {values}", ERRORS[self.field], errors, *shown, *map(self.cell, BESIDE), f"{self.seconds:.2g}"]
        return f"| {' | '.join(cells)} |"


def refinement(experiment):
    """What is refined, its three values, and the three points: along the sweep's own axis where it has one (others at their first value), else halved."""
    from mpm.config import load
    from mpm.sweep.cases import plan

    cases = plan(experiment)
    for k, dimension in enumerate(cases.dims):
        for path in ("grid.cell", "time.step"):
            if dimension.size >= 3 and path in (coordinate.config_path for coordinate in dimension.coords):
                found = [case for case in cases.cases if not any(index for j, index in enumerate(case.index) if j != k)]
                found = [case.experiment for case in sorted(found, key=lambda case: -value(case.experiment, path))[:3]]
                return path, tuple(value(point, path) for point in found), found
    path, base = ("grid.cell", experiment.grid.cell) if experiment.grid.dimension != 0 else ("time.step", experiment.time.step)
    if not isinstance(base, float):
        base = experiment.output.every
    values = (base, base / 2, base / 4)
    return path, values, [load(experiment.resolved() | {"sweep": None}, {path: value}) for value in values]


def value(experiment, path: str) -> float:
    return experiment.grid.cell if path == "grid.cell" else experiment.time.step


def method(experiment) -> str:
    """The method in a few words."""
    if experiment.grid.dimension == 0:
        return "material point"
    if not experiment.moving:
        return f"rigid, {type(experiment.method.rigid).kind}"
    used = experiment.method
    words = ["total frame"] if used.frame == "total" else [type(used.transfer).kind, used.gradient]
    words += [f"{used.particles} particles"]
    words += [experiment.grid.basis] * (experiment.grid.basis != "quadratic") + ([type(used.locking).kind] if used.locking is not None else [])
    return ", ".join(words)


def measure(path: Path) -> ProblemRow:
    """Run one config at its three resolutions. RuntimeError where one does not complete."""
    from mpm.config import load
    from mpm.runner import run_point

    experiment = load(path)
    refined, values, points = refinement(experiment)
    errors, seconds, name, beside = [], 0.0, "", {}
    run_point(points[0])  # compiles
    for point in points:
        began = time.perf_counter()
        run = run_point(point)
        seconds += time.perf_counter() - began
        if not run.outcome.ok:
            raise RuntimeError(f"{path.name} at {refined} {values[len(errors)]:g}: {run.outcome}")
        name = next(name for name in ERRORS if name in run.finals)
        errors.append(run.finals[name])
        for other in BESIDE:
            if other in run.finals:
                beside[other] = (*beside.get(other, ()), run.finals[other])
    problem = importlib.import_module(f"mpm.verification.{type(experiment.exact).kind}")
    declared = getattr(experiment.exact, "order", getattr(problem, "ORDERS", {}).get(experiment.method.frame, problem.ORDER))
    return ProblemRow(path.stem, method(experiment), refined, values, name, tuple(errors), declared, seconds, beside)


def written(text: str) -> tuple[dict[str, str], str]:
    """Rows by name, and the section on transfers, of a table written before."""
    before, _, wave = text.partition(WAVE)
    rows = [line for line in before.splitlines() if line.startswith("| ") and not line.startswith("| config ")]
    return {row.split("|")[1].strip(): row for row in rows}, wave


def main(names: list[str]) -> None:
    """Measure every config, or those named, and write the table; a line on standard error for each."""
    target, paths = FOLDER / "README.md", {path.stem: path for path in sorted(FOLDER.glob("*.yaml"))}
    unknown = [name for name in names if name not in paths]
    if unknown:
        raise SystemExit(f"no config {', '.join(unknown)}; there are {', '.join(paths)}")
    rows, wave = written(target.read_text(encoding="utf-8")) if target.exists() else ({}, "")
    for name in names or paths:
        rows[name] = measure(paths[name]).text()
        print(rows[name], file=sys.stderr, flush=True)
        write(target, [rows[name] for name in paths if name in rows], wave)  # a run that is cut keeps what it has
    if not wave or not names or "standing_wave" in names:
        wave = table()[1]
        print(wave, file=sys.stderr, flush=True)
        write(target, [rows[name] for name in paths if name in rows], wave)


def write(target: Path, lines: list[str], wave: str) -> None:
    """The table as it stands."""
    target.write_text(HEAD + "\n".join(lines) + "\n" + WAVE + wave, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
