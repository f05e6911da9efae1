"""The loop over steps, the same for every method: sizes from the error estimate, outputs and crossings from dense output.

A method has
    attempt(dt) -> error over tolerance (nan or inf: rejected)      accept()
    dense(s) -> (basis (S, m), columns (m, N), exchanged (S,))      temperature(state) -> theta - zero      heat(state) [J]
    CARRIES (names of what goes from step to step: what a run must remember)
    state, first (state at the start), first_size(end), power (error ~ dt^power), replan (a new size is costly), radius [1/s] (0 without an explicit limit)
    floor (steps this short are taken whatever their error: the cell resolves nothing faster), longest (of a step, so that none misses a programme)
state(t + s dt) = before + basis @ columns is the method's own variable: temperature, or specific enthalpy.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from mpm.memory import rows
from mpm.outcome import BUDGET, COMPLETED, MAX_PRINCIPLE, NON_FINITE, STEP_UNDERFLOW
from mpm.rigid.nodes import interpolate
from mpm.rigid.ordered import combined, dot

SAFETY, GROW, SHRINK, FEWEST = 0.8, 6.0, 0.2, 1e-12


class Whole:
    """What is told of the whole of one body."""

    def mean(self, weight, theta):
        return dot(weight, theta) / weight.sum()

    def least(self, seen):
        return seen.min()

    def most(self, seen):
        return seen.max()


@dataclass
class Shares:
    """What is told of each of several bodies (B,): by sums over their nodes, and where in the sight each begins."""

    sums: object  # (N,) -> (B,)
    begins: np.ndarray  # (B,)

    def mean(self, weight, theta):
        return self.sums(weight * theta) / self.sums(weight)

    def least(self, seen):
        return np.minimum.reduceat(seen, self.begins)

    def most(self, seen):
        return np.maximum.reduceat(seen, self.begins)


@dataclass
class Watch:
    """What is looked at: output times, probes (nodes, values), thresholds (probe, temperature less zero)."""

    times: np.ndarray
    probes: tuple[np.ndarray, np.ndarray]
    thresholds: list[tuple[int, float]]
    sight: tuple[np.ndarray, np.ndarray]
    shots: tuple[np.ndarray, np.ndarray, np.ndarray]  # times, and nodes and values of the points
    stop: object = None  # stop(fraction, time) -> whether to stop
    keeper: object = None  # mpm.memory
    limits: tuple[float, float] = (-math.inf, math.inf)  # of theta - zero, beyond which a record ends the run [K]
    told: object = field(default_factory=Whole)  # or Shares
    turns: tuple[float, ...] = ()  # times at which something jumps: steps end there, and enter(number, method) goes on [s]
    enter: object = None


@dataclass
class Trace:
    """What was seen. Arrays a time: probes (T, P), mean, min, max of theta - zero [K]; heat, exchanged [J]; of several bodies an array a time."""

    probes: list = field(default_factory=list)
    mean: list = field(default_factory=list)
    least: list = field(default_factory=list)
    most: list = field(default_factory=list)
    heat: list = field(default_factory=list)
    exchanged: list = field(default_factory=list)
    shots: list = field(default_factory=list)
    crossings: list = field(default_factory=list)
    steps: int = 0
    rejected: int = 0
    smallest: float = math.inf
    largest: float = 0.0
    code: int = COMPLETED
    time: float = 0.0
    final: np.ndarray | None = None
    found: str = ""  # what was wrong
    again: int = 0  # ways that were tried before (mpm.rigid.run)

    def memory(self) -> dict:
        """What was seen so far (mpm.memory)."""
        return {name: rows(value) if name in ROWS else value for name, value in vars(self).items()}

    @classmethod
    def recalled(cls, found: dict) -> "Trace":
        """As it was when `memory` was kept."""
        return cls(**{name: list(value) if name in ROWS else value for name, value in found.items()})


ROWS = ("probes", "mean", "least", "most", "heat", "exchanged", "shots")


def record(trace, watch, method, states, exchanged, weight):
    """Adds rows for states (S, N)."""
    for state, q in zip(states, exchanged, strict=True):
        theta = method.temperature(state)
        seen = interpolate(*watch.sight, theta)
        trace.probes.append(interpolate(*watch.probes, theta))
        trace.mean.append(watch.told.mean(weight, theta))
        trace.least.append(watch.told.least(seen))
        trace.most.append(watch.told.most(seen))
        trace.heat.append(method.heat(state))
        trace.exchanged.append(q)


def judge(trace, watch, zero: float, before: int) -> None:
    """Drops the rows from the first on, after `before` of them, whose temperatures are not finite or beyond the limits, and says so in the trace."""
    low, high = watch.limits
    for row in range(before, len(trace.heat)):
        least, most = np.min(trace.least[row]), np.max(trace.most[row])
        if low < least and most < high:
            continue
        trace.code = MAX_PRINCIPLE if math.isfinite(least + most) else NON_FINITE
        worst = most if most >= high else least
        said = "below absolute zero" if zero + worst <= 0 else f"limits {zero + low:.5g} to {zero + high:.5g} K"
        trace.found, trace.time = f"({zero + worst:.5g} K, {said})", float(watch.times[row])
        for name in ROWS[:-1]:
            del getattr(trace, name)[row:]
        return


def crossing(method, watch, before, t, dt, probe, level):
    """Time in the step at which a probe reaches a level, by the dense output."""
    from scipy.optimize import brentq  # rare, and slow to import

    index, value = watch.probes[0][probe], watch.probes[1][probe]

    def above(s):
        basis, columns, _ = method.dense(np.array([s]))
        return dot(value, method.temperature(before + combined(basis, columns)[0])[index]) - level

    low, high = above(0.0), above(1.0)
    return t + dt * brentq(above, 0.0, 1.0, xtol=1e-12) if low * high < 0 else t + dt


def begun(method, watch: Watch, ahead, weight) -> tuple:
    """The start of a run: (trace, time, outputs shown, snapshots shown, temperatures at the probes)."""
    trace, state = Trace(crossings=[math.nan] * len(watch.thresholds)), method.state
    first = int(np.searchsorted(ahead, 0.0, side="right"))
    record(trace, watch, method, [state] * first, [method.q] * first, weight)
    shown = int(np.searchsorted(watch.shots[0], 0.0, side="right"))
    trace.shots += [interpolate(*watch.shots[1:], method.temperature(state))] * shown
    seen = interpolate(*watch.probes, method.temperature(state))
    for k, (probe, level) in enumerate(watch.thresholds):
        if seen[probe] == level:
            trace.crossings[k] = 0.0
    return trace, 0.0, first, shown, seen


def planned(method, left: float, fixed: float | None) -> tuple[int, float]:
    """How many steps to what is ahead, and their size, to begin with; at most as many as may be tried."""
    size = fixed or min(method.first_size(left), method.longest)
    count = max(1, math.ceil(left / max(size, FEWEST * left) * (1 - 1e-9)))
    return count, left / count


def drive(method, watch: Watch, end: float, weight, fixed: float | None = None, before: dict | None = None) -> Trace:
    """Runs `method` to `end`; `fixed` sets the step and leaves the error unchecked; where no such step can be taken, a shorter one is.

    before: what `watch.keeper` was given when the run was cut.
    """
    ahead, goals, turn = np.asarray(watch.times, dtype=float), [*watch.turns, end], 0
    if before is None:
        trace, t, first, shown, seen = begun(method, watch, ahead, weight)
        count, dt = planned(method, goals[0] - t, fixed)
    else:
        turn = before["turn"]
        method = watch.enter(turn, method) if turn else method
        vars(method).update(before["method"])
        trace, seen = Trace.recalled(before["trace"]), before["seen"]
        t, count, dt, first, shown = (before[name] for name in ("t", "count", "dt", "first", "shown"))
    state, goal = method.state, goals[turn]
    while count > 0:
        error = method.attempt(dt)
        if fixed:
            error = 0.0 if math.isfinite(error) else error
        if not (error <= 1.0 or (math.isfinite(error) and dt <= method.floor)):
            trace.rejected += 1
            factor = max(SHRINK, SAFETY * error ** (-1 / method.power)) if math.isfinite(error) else 0.5 if fixed else SHRINK
            count = math.ceil((goal - t) / max(dt * factor, 0.0 if fixed else min(method.floor, 0.9 * dt)))
            dt = (goal - t) / count
            if dt < FEWEST * end:
                trace.code = STEP_UNDERFLOW if math.isfinite(error) else NON_FINITE
                break
            continue
        method.accept()
        before, state, count = state, method.state, count - 1
        new = goal if count == 0 else t + dt
        if first < len(ahead) and ahead[first] <= new * (1 + 1e-14):
            last = int(np.searchsorted(ahead, new * (1 + 1e-14), side="right"))
            basis, columns, exchanged = method.dense((np.minimum(ahead[first:last], new) - t) / dt)
            record(trace, watch, method, before + combined(basis, columns), exchanged, weight)
            judge(trace, watch, method.system.zero, first)
            if trace.code != COMPLETED:
                trace.final = state
                return trace
            first = last
        if shown < len(watch.shots[0]) and watch.shots[0][shown] <= new * (1 + 1e-14):
            last = int(np.searchsorted(watch.shots[0], new * (1 + 1e-14), side="right"))
            basis, columns, _ = method.dense((np.minimum(watch.shots[0][shown:last], new) - t) / dt)
            trace.shots += [interpolate(*watch.shots[1:], method.temperature(shot)) for shot in before + combined(basis, columns)]
            shown = last
        now = interpolate(*watch.probes, method.temperature(state)) if watch.thresholds else seen
        for k, (probe, level) in enumerate(watch.thresholds):
            if math.isnan(trace.crossings[k]) and (seen[probe] - level) * (now[probe] - level) <= 0:
                trace.crossings[k] = crossing(method, watch, before, t, dt, probe, level)
        seen, t = now, new
        trace.steps += 1
        trace.smallest, trace.largest = min(trace.smallest, dt), max(trace.largest, dt)
        if count and fixed and dt < fixed * (1 - 1e-9):  # back to the size that was asked for
            count = max(1, math.ceil((goal - t) / min(2 * dt, fixed) * (1 - 1e-9)))
            dt = (goal - t) / count
        if count and not fixed:
            factor = min(GROW, SAFETY * max(error, 1e-9) ** (-1 / method.power))
            wanted = min(max(dt * factor, min(method.floor, dt)), method.longest)
            fewer = max(1, math.ceil((goal - t) / wanted))
            if not method.replan or count - fewer > 2 or factor < 0.9:
                count = fewer
                dt = (goal - t) / count
        if count == 0 and turn + 1 < len(goals):
            turn += 1
            goal, method = goals[turn], watch.enter(turn, method)
            count, dt = planned(method, goal - t, fixed)
        stop = watch.stop is not None and watch.stop(t / end, t)
        if watch.keeper is not None and count and watch.keeper.due(stop):
            carried = {name: getattr(method, name) for name in method.CARRIES}
            where = {"turn": turn, "t": t, "count": count, "dt": dt, "first": first, "shown": shown, "seen": seen}
            watch.keeper.save({**where, "trace": trace.memory(), "method": carried})
        if stop:
            trace.code = BUDGET if count else COMPLETED
            break
    trace.time = t
    trace.final = state
    return trace
