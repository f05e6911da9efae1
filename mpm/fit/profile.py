"""Intervals by profile likelihood: how far a parameter can go, all others fitted anew, until S has risen by t^2 s^2 (mpm.fit.identify).

Both sides of all parameters advance together, a round each. Along a line the others take Gauss-Newton steps with the optimum's Jacobian, which Broyden's
rank-one update bends as the points come in; a place counts when a step promises less than DONE of the rise. The next place follows from sqrt(rise), which is
nearly straight. A side that reaches the end of its range before the rise is open: the data do not bound it there.
Source  Bates and Watts (1988), 6.1.2. Fails when: S has a second valley within the interval, which no local search sees
"""

from dataclasses import dataclass, field

import numpy as np

from mpm.fit.evaluate import Evaluator
from mpm.fit.identify import Known

DONE, NEAR = 0.01, 0.01  # of the rise: what a step may promise, and how near the rise must come
MOST_ROUNDS, MOST_INNER = 60, 12
FARTHEST = 3.0  # times as far as the last place, at most


@dataclass
class Side:
    """One side of one parameter: places that are done, and the one that is sought."""

    k: int
    sign: float
    aim: float  # u of the parameter, where the others are fitted now
    u: np.ndarray
    jacobian: np.ndarray
    last: tuple[np.ndarray, np.ndarray]  # (u, r) of the last number
    places: list[tuple[float, float]] = field(default_factory=list)  # (u_k, rise)
    best: tuple[float, np.ndarray, np.ndarray] | None = None  # (S, u, r) at this place
    inner: int = 0
    state: str = "on"  # then: found, open, lost
    limit: float = np.nan


def profile(evaluator: Evaluator, known: Known) -> list[Side]:
    """Both sides of every parameter, the lower one first."""
    low, high = evaluator.problem.bounds
    least = float(known.residuals @ known.residuals)
    rise = known.quantile**2 * known.variance
    half = known.quantile * np.sqrt(np.diag(known.covariance))
    sides = []
    for k in range(len(known.u)):
        for sign in (-1.0, 1.0):
            side = Side(k, sign, known.u[k], known.u.copy(), known.jacobian.copy(), (known.u, known.residuals))
            end = low[k] if sign < 0 else high[k]
            aim(side, known.u[k] + sign * half[k], known, low, high)
            if abs(end - known.u[k]) <= 1e-9 * (high[k] - low[k]):
                side.state, side.limit = "open", float(known.u[k])
            sides.append(side)
    for _ in range(MOST_ROUNDS):
        active = [side for side in sides if side.state == "on"]
        if not active:
            break
        for side, r in zip(active, evaluator.residuals([side.u for side in active]), strict=True):
            advance(side, r, known, least, rise, low, high)
    for side in sides:
        side.state = "lost" if side.state == "on" else side.state
    return sides


def aim(side: Side, where: float, known: Known, low: np.ndarray, high: np.ndarray) -> None:
    """Go to a place of the parameter; the others follow the valley as the covariance says."""
    from_u = side.best[1] if side.best is not None else known.u
    side.aim = float(np.clip(where, low[side.k], high[side.k]))
    slope = known.covariance[:, side.k] / known.covariance[side.k, side.k]
    if len(side.places) >= 1 and side.best is not None and side.places[-1][0] != known.u[side.k]:
        slope = (side.best[1] - known.u) / (side.places[-1][0] - known.u[side.k])  # the valley so far
    side.u = np.clip(from_u + slope * (side.aim - from_u[side.k]), low, high)
    side.u[side.k] = side.aim
    side.best, side.inner = None, 0


def advance(side: Side, r: np.ndarray | None, known: Known, least: float, rise: float, low: np.ndarray, high: np.ndarray) -> None:
    """Take in the residuals at side.u, and say where to look next."""
    from scipy.optimize import lsq_linear

    side.inner += 1
    if r is None:  # no number: half as far from the last place that is one
        base = side.last[0]
        side.u = base + 0.5 * (side.u - base)
        side.aim = float(side.u[side.k])
        if side.inner > MOST_INNER:
            side.state, side.limit = "lost", side.aim
        return
    step, change = side.u - side.last[0], r - side.last[1]
    if (size := float(step @ step)) > 0:
        side.jacobian += np.outer(change - side.jacobian @ step, step) / size
    side.last = side.u.copy(), r
    total = float(r @ r)
    if side.best is None or total < side.best[0]:
        side.best = total, side.u.copy(), r
    others = [k for k in range(len(side.u)) if k != side.k]
    total, u, r = side.best
    if others and side.inner < MOST_INNER:
        j = side.jacobian[:, others]
        room = high[others] - low[others]  # SciPy wants the ends apart from where it begins
        move = lsq_linear(j, -r, (low[others] - u[others] - 1e-9 * room, high[others] - u[others] + 1e-9 * room)).x
        wanted = np.clip(u[others] + move, low[others], high[others])
        promised = total - float(np.sum((r + j @ (wanted - u[others])) ** 2))
        if promised > DONE * rise:
            side.u = u.copy()
            side.u[others] = wanted
            return
    settle(side, total - least, known, rise, low, high)


def settle(side: Side, risen: float, known: Known, rise: float, low: np.ndarray, high: np.ndarray) -> None:
    """A place is done: the interval's end, or a better guess of it."""
    side.places.append((side.aim, max(risen, 0.0)))
    end, start = (low if side.sign < 0 else high)[side.k], known.u[side.k]
    if abs(np.sqrt(max(risen, 0.0) / rise) - 1) < NEAR:
        side.state, side.limit = "found", side.aim
        return
    if risen < rise and abs(side.aim - end) <= 1e-12 * max(1.0, abs(end)):
        side.state, side.limit = "open", float(end)
        return
    within = max((abs(u - start), s) for u, s in [(start, 0.0), *side.places] if s < rise)
    beyond = min(((abs(u - start), s) for u, s in side.places if s >= rise), default=None)
    if beyond is None:
        ratio = np.sqrt(rise / within[1]) if within[1] > 0 else FARTHEST
        distance = max(within[0], abs(side.aim - start)) * min(max(ratio, 1.05), FARTHEST)
    else:
        a, b, target = np.sqrt(within[1]), np.sqrt(beyond[1]), np.sqrt(rise)
        part = (target - a) / (b - a) if len(side.places) % 3 else 0.5  # halving where the valley has a kink
        distance = within[0] + (beyond[0] - within[0]) * min(max(part, 0.02), 0.98)
        if beyond[0] - within[0] < 1e-4 * beyond[0]:
            side.state, side.limit = "found", start + side.sign * distance
            return
    aim(side, start + side.sign * distance, known, low, high)
