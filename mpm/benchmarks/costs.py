"""What `mpm plan` says a point costs, beside what it costs: `python -m mpm.benchmarks.costs [PART OF A NAME...]` prints the table (a minute, once compiled).

Predicted     mpm.costs.estimate, which runs nothing
Measured      processor time of a run without the comparison with an exact solution, after one that compiles: the least of ROUNDS, or of one of LONG seconds
The constants of mpm/costs.py are fitted to this table. What they cannot foresee: steps that change as a scene stiffens or speeds up, and how many steps an
adaptive method will take. A factor of two is what they aim at; tests/benchmarks/test_costs.py asks for it.
"""

import sys
import time
from dataclasses import dataclass
from typing import Any

from mpm.benchmarks import CONFIGS

SCENES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("scenes/slab", {}),
    ("scenes/loaf", {}),
    ("verification/robin_cylinder", {}),
    ("verification/nafems_t3", {}),
    ("verification/stefan", {}),
    ("verification/gaussian_box", {}),
    ("scenes/dough_rheometer", {}),
    ("verification/hencky_bar", {}),
    ("verification/hencky_bar", {"grid.cell": 0.0078125}),
    ("verification/standing_wave", {}),
    ("verification/manufactured_2d", {}),
    ("scenes/slump", {"time.end": 0.5}),
    ("scenes/loaf_oven_spring", {}),
    ("scenes/dough_creep", {}),
    ("scenes/cube", {}),
    ("scenes/chocolate_pour", {}),
    ("verification/two_bars", {}),
    ("verification/incline", {}),
)
ROUNDS, LONG = 5, 2.0


@dataclass(frozen=True)
class CostRow:
    """One row of the table."""

    name: str
    predicted: float
    measured: float
    counts: dict[str, Any]  # what the run counted: particles, steps, heat steps, outputs

    @property
    def ratio(self) -> float:
        """Predicted over measured."""
        return self.predicted / self.measured

    def text(self) -> str:
        """As a row of Markdown."""
        return f"| {self.name} | {self.predicted:.3g} | {self.measured:.3g} | {self.ratio:.2f} | {', '.join(f'{k} {v}' for k, v in self.counts.items())} |"


def measure(name: str, changes: dict[str, Any]) -> CostRow:
    """Foretell and run one config."""
    from mpm.config import load
    from mpm.runner import estimate, run_point

    experiment = load(CONFIGS / f"{name}.yaml", changes)
    found = estimate(experiment)
    run_point(experiment, compare=False)
    rounds: list[float] = []
    while len(rounds) < ROUNDS and (not rounds or rounds[0] < LONG):
        began = time.process_time()
        run = run_point(experiment, compare=False)
        rounds.append(time.process_time() - began)
    counts = {"particles": found["particles"], "steps": run.steps, "heat steps": run.facts.get("heat_steps", 0), "outputs": len(run.times)}
    label = ", ".join([name.rsplit("/", maxsplit=1)[-1], *(f"{path} {value}" for path, value in changes.items())])
    return CostRow(label, found["seconds"], min(rounds), counts)


def main() -> None:
    """The table of the scenes whose name holds one of the words given, or of all."""
    wanted, lines = sys.argv[1:], []
    print("| scene | predicted, s | measured, s | ratio | counted |\n" + "|---" * 5 + "|")
    for name, changes in SCENES:
        if not wanted or any(word in name for word in wanted):
            lines.append(measure(name, changes))
            print(lines[-1].text(), flush=True)
    print(f"\nwithin a factor of 2: {sum(0.5 <= line.ratio <= 2 for line in lines)} of {len(lines)}")


if __name__ == "__main__":
    main()
