"""The verification problems in single precision: `python -m mpm.benchmarks.single` writes configs/verification/single.md; with names, only those rows again.

`method.precision: float32` is for bodies that move: their particles and nodes. Bodies that do not move and material points always compute in float64, whatever
it says. So every problem that moves is run in both precisions at the two coarsest of the three resolutions of configs/verification/README.md. What float32 may
add to a displacement is what rounding the positions does, half an ulp of x at every step in x <- x + dt v. It would be all to one side where dt v repeats
itself; mpm.integrate.dither sees to it that it is a random walk at most. Relative to the displacement itself,

    to one side = steps 2^-24 max|x| / rms displacement,      random walk: its 1/sqrt(3 steps)-fold

A row holds if the error in float32 is below that in float64 plus SIGMAS random walks. Where the walk is near one or above, positions in float32 may not tell
the displacement at all: that a row holds then says nothing.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpm.benchmarks.verification import FOLDER, method, refinement

HALF_ULP = 2.0**-24
SIGMAS = 3.0
HEAD = """# Verification problems in single precision

Made by `python -m mpm.benchmarks.single`. The problems of [README.md](README.md) whose bodies move, at two resolutions, in both precisions: relative errors
of displacement. Rounding is what adding dt v to a position in float32 would leave after all steps, relative to the displacement: every half ulp to one
side (which `mpm/integrate/dither.py` prevents), and as a random walk: where that is near one (standing_wave moves by 1e-5 of its length), float32 cannot do
the problem. Bodies that do not move and material points compute in float64 whatever `method.precision` says, so their rows are those of README.md
(`tests/benchmarks/test_single.py` compares bits).

| config | method | refined | float64 | float32 | rounding to one side | random walk | order, float64 | float32 |
|---|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Pair:
    """One problem in both precisions at a few resolutions."""

    name: str
    method: str
    path: str
    values: tuple[float, ...]
    double: tuple[float, ...]
    single: tuple[float, ...]
    floor: tuple[float, ...]
    steps: tuple[int, ...]

    def holds(self) -> bool:
        """Whether single precision adds no more than rounding that favours no side."""
        return all(one <= two + SIGMAS * walk for one, two, walk in zip(self.single, self.double, self.walk(), strict=True))

    def walk(self) -> tuple[float, ...]:
        """What a random walk of half ulps leaves."""
        return tuple(floor / math.sqrt(3 * steps) for floor, steps in zip(self.floor, self.steps, strict=True))

    def text(self) -> str:
        """As a row of Markdown."""
        columns = [", ".join(f"{number:.3g}" for number in row) for row in (self.values, self.double, self.single, self.floor, self.walk())]
        orders = [f"{math.log(row[0] / row[1]) / math.log(self.values[0] / self.values[1]):.2f}" for row in (self.double, self.single)]
        return f"| {self.name} | {self.method} | {self.path} " + " | ".join([*columns, *orders]) + " |"


def moving(folder: Path = FOLDER) -> list[str]:
    """Names of the configs whose bodies move."""
    from mpm.config import load

    found = {path.stem: load(path) for path in sorted(folder.glob("*.yaml"))}
    return [name for name, experiment in found.items() if experiment.grid.dimension != 0 and experiment.moving]


def in_precision(experiment, precision: str):
    """The same point in that precision."""
    from mpm.config import load

    return load(experiment.resolved() | {"sweep": None}, {"method.precision": precision})


def measure(path: Path, count: int = 2) -> Pair:
    """Run one config at its `count` coarsest resolutions in both precisions. RuntimeError where one does not complete."""
    from mpm.config import load
    from mpm.runner import run_point

    experiment = load(path)
    refined, values, points = refinement(experiment)
    errors: dict[str, list[float]] = {"float64": [], "float32": []}
    floors, steps = [], []
    for value, point in zip(values[:count], points, strict=False):
        for precision, found in errors.items():
            run = run_point(in_precision(point, precision))
            if not run.outcome.ok:
                raise RuntimeError(f"{path.name} at {refined} {value:g} in {precision}: {run.outcome}")
            found.append(run.finals["error_displacement"])
        displacement = math.sqrt(float(np.mean(run.series["error_displacement_l2"] ** 2))) / run.finals["error_displacement"]
        steps.append(run.steps)
        floors.append(run.steps * HALF_ULP * max(experiment.grid.size) / displacement)
    return Pair(path.stem, method(experiment), refined, values[:count], tuple(errors["float64"]), tuple(errors["float32"]), tuple(floors), tuple(steps))


def written(text: str) -> dict[str, str]:
    """Rows by name of a table written before."""
    rows = [line for line in text.splitlines() if line.startswith("| ") and not line.startswith("| config ")]
    return {row.split("|")[1].strip(): row for row in rows}


def main(names: list[str]) -> None:
    """Measure every config that moves, or those named, and write the table; a line on standard error for each."""
    target, known = FOLDER / "single.md", moving()
    unknown = [name for name in names if name not in known]
    if unknown:
        raise SystemExit(f"no config {', '.join(unknown)} that moves; there are {', '.join(known)}")
    rows = written(target.read_text(encoding="utf-8")) if target.exists() else {}
    for name in names or known:
        rows[name] = measure(FOLDER / f"{name}.yaml").text()
        print(rows[name], file=sys.stderr, flush=True)
        target.write_text(HEAD + "\n".join(rows[name] for name in known if name in rows) + "\n", encoding="utf-8")  # a run that is cut keeps what it has


if __name__ == "__main__":
    main(sys.argv[1:])
