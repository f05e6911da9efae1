"""solve: a batch of material points, as arrays, to their Runs."""

import time

import numpy as np

from mpm.memory import arrays, fill
from mpm.outcome import BUDGET, COMPLETED, Outcome, Run, outcome
from mpm.point.state import COLUMNS, LOCAL, NO_EQUILIBRIUM, WIDTH, Matter, Program, Progress, Rigid
from mpm.point.time_loop import advance
from mpm.state import Isothermal, Setting

ADVICE = "the prescribed stress may be past what the material bears (eta = 0 has a limit load), or lower `time.step`"
MECHANICAL = COLUMNS[:14]
QUIET = 0.1  # seconds between two questions to `beat`, about


def start(matter: Matter, program: Program) -> Progress:
    """Nothing done yet."""
    N, K = program.thresholds.shape
    return Progress(
        row=np.full(N, -1), stage=np.zeros(N, np.int64), entered=np.zeros((N, 5)), rate=np.zeros((N, 3)), sums=np.zeros((N, 3)), zero=np.zeros(N),
        crossed=np.full((N, K), np.nan), steps=np.zeros(N, np.int64), code=np.zeros(N, np.int64), time=np.zeros(N),
    )  # fmt: skip


def solve(matter: Matter, program: Program, beat=None, keeper=None) -> list[Run]:
    """Carry every point to its end or its failure. `beat(fraction, time) -> bool` is asked between output times; true stops the batch.

    The arrays of `matter` are the run's own: solving changes them. keeper: mpm.memory; the points go on where they were cut, with the same bits.
    """
    began = time.perf_counter()
    progress = start(matter, program)
    out = np.zeros((len(program.times), WIDTH + isinstance(matter.setting, Setting)))
    most = int(np.max(np.diff(program.first))) - 1
    done, rows, stopped, earlier = 0, 1 if beat is not None or keeper is not None else most, False, 0.0
    before = keeper.found if keeper is not None else None
    if before is not None:
        done, earlier, out[...] = before["done"], before["spent"], before["out"]
        fill((matter, progress), before["points"])
    while done < most and not stopped:
        asked = time.perf_counter()
        advance(matter, program, progress, out, rows)
        done += rows
        spent = time.perf_counter() - asked
        rows = max(1, min(2 * rows, int(rows * QUIET / max(spent, 1e-6))))
        stopped = beat is not None and done < most and beat(done / most, float(np.min(progress.time)))
        if keeper is not None and done < most and keeper.due(stopped):
            keeper.save({"done": done, "spent": earlier + time.perf_counter() - began, "out": out, "points": arrays((matter, progress))})
    wall = (earlier + time.perf_counter() - began) / len(matter.density)
    return [run(matter, program, progress, out, i, wall) for i in range(len(matter.density))]


def run(matter: Matter, program: Program, progress: Progress, out: np.ndarray, i: int, wall: float) -> Run:
    """The Run of point i; its series are views of the batch's record."""
    first, count = program.first[i], progress.row[i] + 1
    rows = out[first : first + count]
    series = {}
    if not isinstance(matter.elastic, Rigid):
        series |= {name: rows[:, k] for k, name in enumerate(MECHANICAL)}
        series["J_min"] = series["J_max"] = series.pop("J")
    if not isinstance(matter.thermal, Isothermal):
        series |= {name: rows[:, len(MECHANICAL) + k] for k, name in enumerate(COLUMNS[len(MECHANICAL) : -1])}
        series["temperature_min"] = series["temperature_max"] = series["temperature_mean"]
        series["heat_ledger"] = series["heat_total"] - series["heat_exchanged"] - rows[:, LOCAL]
    if isinstance(matter.setting, Setting):
        series["setting_mean"] = series["setting_min"] = rows[:, WIDTH]
    finals = {name: float(values[-1]) for name, values in series.items()}
    finals["steps"] = float(progress.steps[i])
    facts = {"crossed": progress.crossed[i].tolist()}
    return Run(ending(program, progress, i), program.times[first : first + count], series, finals, steps=int(progress.steps[i]), wall_time=wall, facts=facts)


def ending(program: Program, progress: Progress, i: int) -> Outcome:
    """How point i ended."""
    code, when, steps = int(progress.code[i]), float(progress.time[i]), int(progress.steps[i])
    if code == NO_EQUILIBRIUM:
        return Outcome("no_equilibrium", f"no strain gives the prescribed stress, t = {when:.6g} s, step {steps}", ADVICE)
    if code == COMPLETED and progress.row[i] + 1 < program.first[i + 1] - program.first[i]:
        code = BUDGET
    return outcome(code, time=when, step=steps)
