"""Which transfer keeps a thermoelastic wave: errors of its frequency and damping, by transfer. `python -m mpm.benchmarks.wave` prints the table.

configs/verification/standing_wave.yaml at CELLS cells: 4 particles a cell, 0.6 of the automatic step, heat every 0.01 s. The wave loses 0.9 % of its height
a second to heat, so what a transfer loses by itself shows in the damping: that is the best separator there is (docs/physics.md 7, problem 6).
"""

from dataclasses import dataclass

from mpm.benchmarks import CONFIGS

CELLS = 64
PROMISED = 2e-3, 0.05  # errors of frequency and of damping that the best transfer must be within
PAIRS = (
    ({"apic": {}}, {"apic": {}}), ({"affine_flip": {}}, {"affine_flip": {}}), ({"xpic": {"order": 2}}, {"xpic": {"order": 2}}), ({"flip": {}}, {"flip": {}}),
    ({"flip": {}}, {"apic": {}}), ({"xpic": {"order": 2}}, {"apic": {}}), ({"pic": {}}, {"apic": {}}), ({"apic": {}}, {"pic": {}}),
)  # fmt: skip
HEAD = """| velocity | temperature | elastic heating | frequency | damping | displacement |
|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Kept:
    """One pair of transfers: relative errors of frequency, damping and displacement."""

    velocity: str
    temperature: str
    heating: str
    frequency: float
    damping: float
    displacement: float

    def text(self) -> str:
        """As a row of Markdown."""
        return (f"| {self.velocity} | {self.temperature} | {self.heating} | {100 * self.frequency:+.3f} % | {100 * self.damping:+.3g} % "
                f"| {100 * self.displacement:.2g} % |")  # fmt: skip

    def promised(self) -> bool:
        """Whether it keeps both within the promise."""
        return abs(self.frequency) < PROMISED[0] and abs(self.damping) < PROMISED[1]


def measure(velocity: dict, temperature: dict, form: str = "adiabat", cells: int = CELLS) -> Kept:
    """Run the wave with one pair of transfers. RuntimeError where it does not complete."""
    from mpm.config import load
    from mpm.runner import run_point

    changes = {"method.transfer": velocity, "method.temperature": temperature, "materials.unit.heating.elastic.form": form, "grid.cell": 1 / cells}
    run = run_point(load(CONFIGS / "verification" / "standing_wave.yaml", changes))
    if not run.outcome.ok:
        raise RuntimeError(f"{velocity}, {temperature}: {run.outcome}")
    names = (next(iter(velocity)), next(iter(temperature)), form)
    return Kept(*names, *(run.finals[f"error_{what}"] for what in ("frequency", "damping", "displacement")))


def table(cells: int = CELLS) -> tuple[list[Kept], str]:
    """Every pair, best damping first, and the table with what it says."""
    found = [measure(*pair, cells=cells) for pair in PAIRS] + [measure(*PAIRS[0], "grid", cells)]
    found.sort(key=lambda one: abs(one.damping))
    good = ", ".join(f"{one.velocity}/{one.temperature}" + (" (grid)" if one.heating == "grid" else "") for one in found if one.promised())
    said = f"Within {100 * PROMISED[0]:g} % of the frequency and {100 * PROMISED[1]:g} % of the damping at {cells} cells: {good or 'none'}.\n"
    return found, HEAD + "\n".join(one.text() for one in found) + "\n\n" + said


if __name__ == "__main__":
    print(table()[1], end="")
