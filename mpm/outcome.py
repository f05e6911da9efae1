"""How a run can end, and what came out of it. A failure is a value with advice, never an exception: a map of failures is an ordinary sweep.

Compiled loops report the integer; everything else reads `Outcome`.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

COMPLETED, NON_FINITE, INVERTED, OVERSTRETCHED, LEFT_GRID, RETURN_MAP, STEP_UNDERFLOW, ENERGY_GROWTH, MAX_PRINCIPLE, BUDGET, HEAT_SOLVER, FRACTURED = range(12)
UNPREPARED, NO_EQUILIBRIUM, OUTGROWN = 12, 13, 14
UNSOUND = -1  # what a block of steps was to begin from: mpm.guards looks again, and says which of these it is

KINDS = {
    COMPLETED: ("completed", "", ""),
    NON_FINITE: ("non_finite", "a value is not finite", "lower `time.safety`, or look for a parameter that is out of scale"),
    INVERTED: ("inverted", "det F <= 0", "lower `time.safety`; if it stays, the load inverts the material: a stiffer body, slower walls or a finer grid"),
    OVERSTRETCHED: ("overstretched", "dt |grad v| > 1/2 or J outside (1e-3, 1e3)", "lower `time.safety`; a body that tears has left the model"),
    LEFT_GRID: ("left_grid", "a particle left the grid", "enlarge `grid.size`, or close the side with a wall"),
    RETURN_MAP: ("return_map", "the return map did not converge", "check M, p0 and eta: p0 within 1e-3..1e3, K dt/eta within 1e-12..1e12"),
    STEP_UNDERFLOW: ("step_underflow", "the stable step fell below 1/256 of the first", "the scene stiffens or speeds up: look at velocity.max and J.max"),
    ENERGY_GROWTH: ("energy_growth", "energy grows without a source", "lower `time.safety`"),
    MAX_PRINCIPLE: ("max_principle", "a temperature left the bounds of its data", "lower `time.safety` or `method.heat_step`"),
    HEAT_SOLVER: ("heat_solver", "an implicit heat step did not converge", "lower `method.heat_step`, or raise `method.heat.implicit.tolerance`"),
    FRACTURED: ("fractured", "particles are more than two cells apart", "more `method.particles` or larger cells; `method.fracture: warn` lets it run on"),
    UNPREPARED: ("unprepared", "a body came near a wall or another body unforeseen", "name what it meets: the wall as `contact`, the pair under `contacts`"),
    NO_EQUILIBRIUM: (
        "no_equilibrium",
        "no step of implicit mechanics finds a balance of forces",
        "the load may be more than a material without viscosity bears: a smaller load, `eta` in flow, or `method.mechanics: explicit` to see it collapse",
    ),
    OUTGROWN: ("outgrown", "a body outgrew the total frame", "`method.frame: updated`, or auto, which goes over to it"),
    BUDGET: ("budget", "stopped before the end", "run again to go on, or give it more time"),
}


@dataclass(frozen=True)
class Outcome:
    """`kind` is one of the names of `KINDS`; `message` says where and when, `advice` what to do."""

    kind: str
    message: str = ""
    advice: str = ""

    @property
    def ok(self) -> bool:
        return self.kind == "completed"

    def __str__(self) -> str:
        return f"{self.kind}: {self.message}" if self.message else self.kind


DONE = Outcome(KINDS[COMPLETED][0])


def outcome(code: int, particle: int = -1, time: float | None = None, step: int = -1, detail: str = "") -> Outcome:
    """The outcome of a code, with the particle, time [s] and step at which it was seen."""
    if code == COMPLETED:
        return DONE
    kind, what, advice = KINDS[code]
    place = [f"particle {particle}"] if particle >= 0 else []
    text = " at ".join([" ".join(x for x in (what, detail) if x), *place])
    if time is not None:
        text += f", t = {time:.6g} s"
    if step >= 0:
        text += f", step {step}"
    return Outcome(kind, text, advice)


@dataclass
class Run:
    """The result of one point."""

    outcome: Outcome
    times: np.ndarray
    series: dict[str, np.ndarray]
    finals: dict[str, float]
    axes: dict[str, np.ndarray] = field(default_factory=dict)
    snapshot_times: np.ndarray = field(default_factory=lambda: np.zeros(0))
    grid: dict[str, np.ndarray] = field(default_factory=dict)
    particles: list[dict[str, np.ndarray]] = field(default_factory=list)
    frames: Any = None  # in the place of grid and particles where snapshots went to a file as they were made (mpm.records.frames)
    steps: int = 0
    wall_time: float = 0.0
    facts: dict = field(default_factory=dict)
