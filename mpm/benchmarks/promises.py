"""Does `mpm plan --tol` keep its promise? `python -m mpm.benchmarks.promises [NAME...]` prints the table, from the charts in fronts.json.

For the six charted problems and 3 %, 1 % and 0.3 %: what study/choose.py picks, the error that it then has, and its time over that of the cheapest setting of
the chart which meets the tolerance with the same model (interleaved, least of ROUNDS). The charts that the method is chosen from are those of these problems:
in sample for the method; the cell comes from pilots.
"""

import argparse
import math
import time
from dataclasses import dataclass
from typing import Any

PROBLEMS = ("robin_slab", "hencky_bar", "standing_wave", "gaussian_box", "robin_cylinder", "manufactured_2d")
TOLERANCES = (0.03, 0.01, 0.003)
ROUNDS, FASTEST = 5, 3  # of timing; of the charted settings that meet the tolerance, so many are timed beside the choice


@dataclass(frozen=True)
class Kept:
    """One line of the table."""

    problem: str
    tolerance: float
    method: str
    cell: float
    predicted: float
    error: float
    cost: float  # over the cheapest setting of the chart that meets the tolerance; nan where none does
    cheapest: str
    planning: float  # seconds

    def text(self) -> str:
        """As a row of Markdown."""
        numbers = f"{100 * self.tolerance:g} % | {self.method}, cell {self.cell:.4g} | {100 * self.predicted:.2g} % | {100 * self.error:.2g} %"
        return f"| {self.problem} | {numbers} | {'yes' if self.error <= self.tolerance else 'NO'} | {self.cost:.2f} | {self.cheapest} | {self.planning:.1f} |"


def promise(name: str, experiment: Any, tolerance: float, against: list[dict]) -> Kept:
    """Choose, run, compare. `against`: {label, error, seconds, experiment} of the chart's settings with the same model."""
    from mpm.config import load
    from mpm.runner import run_point
    from mpm.study.choose import choose
    from mpm.study.pilots import Gauge
    from mpm.study.timing import LEAST, clock

    began = time.process_time()
    choice = choose(experiment, tolerance)
    planning = time.process_time() - began
    point = load(experiment.template(), choice.settings)
    run = run_point(point)
    error = Gauge(experiment, choice.settings).error(run) if run.outcome.ok else math.inf
    fit = sorted((row for row in against if row["error"] <= tolerance), key=lambda row: row["seconds"])
    timed = [point, *(row["experiment"] for row in fit[:FASTEST])]
    least = [math.inf] * len(timed)
    numbers = [max(1, math.ceil(LEAST / max(1e-9, clock(run_point, rival, 1)[1]))) for rival in timed]
    for _ in range(ROUNDS):
        for k, rival in enumerate(timed):
            least[k] = min(least[k], clock(run_point, rival, numbers[k])[1])
    cost = least[0] / min(least[1:]) if fit else math.nan
    return Kept(name, tolerance, choice.method, choice.settings["grid.cell"], choice.predicted, error, cost, fit[0]["label"] if fit else "none", planning)


def rivals(name: str, experiment: Any) -> list[dict]:
    """The settings of a chart that compute the same model as the config itself."""
    from mpm.config import load
    from mpm.config.vary import label
    from mpm.study.choose import charted, physics

    kind, found = physics(experiment), []
    for row in charted():
        if row["study"] == name and row["physics"] == kind:
            settings = row["set"] | {"grid.cell": row["cell"]} | row.get("steps", {})
            words = [f"{path.rsplit('.', 1)[-1]} {label(value)}" for path, value in ({"cell": row["cell"]} | row.get("steps", {})).items()]
            setting = {"label": ", ".join([row["method"], *words]), "experiment": load(experiment.template(), settings)}
            found.append(setting | {"error": row["error"], "seconds": row["seconds"]})
    return found


def main() -> None:
    """The table of the problems named, or of all, and how many of its promises are kept."""
    from mpm.benchmarks.figures import STUDIES
    from mpm.config import load

    parser = argparse.ArgumentParser(prog="python -m mpm.benchmarks.promises", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PROBLEMS)}; all unless given")
    names = parser.parse_args().names or PROBLEMS
    if unknown := [name for name in names if name not in PROBLEMS]:
        parser.error(f"no charted problem is called {', '.join(unknown)}; there are {', '.join(PROBLEMS)}")
    print("| problem | tolerance | chosen | predicted | true | met | time over cheapest | cheapest charted | planning, s |\n" + "|---" * 9 + "|")
    rows = []
    for name in names:
        experiment = load(STUDIES / f"{name}.yaml")
        against = rivals(name, experiment)
        for tolerance in TOLERANCES:
            rows.append(promise(name, experiment, tolerance, against))
            print(rows[-1].text(), flush=True)
    met, costs = sum(row.error <= row.tolerance for row in rows), [row.cost for row in rows if math.isfinite(row.cost)]
    print(f"\n{met} of {len(rows)} met; time over the cheapest at most {max(costs):.2f}, within 2 in {sum(cost <= 2 for cost in costs)} of {len(costs)}")


if __name__ == "__main__":
    main()
