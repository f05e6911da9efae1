"""Least squares from several starts: SciPy's trust-region reflective method in u, within the ranges.

A point that failed is no number: the method halves its region and more until the step is one (`least_squares` shortens it to a quarter on every residual that
is not finite). A start that fails is told and left out; where the config's own values fail, up to RESCUE spread points are tried.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from mpm.fit.evaluate import Evaluator, NoDerivative, values_in_words
from mpm.sweep.designs import unit_sample

TOLERANCE, OF_STEP = 1e-8, 1e-2  # of u and of the sum of squares; of u where `step` says that the answer is rough, as a share of that step
USUAL = 1e-3  # step
MOST_EVALUATIONS = 100  # evaluations of a start, without those for derivatives
RESCUE = 8
ALIKE = 1e-3  # of the range: optima that are nearer are one


@dataclass
class Search:
    """Where a start led. `why` it ended; cost S/2."""

    start: np.ndarray
    u: np.ndarray
    cost: float
    converged: bool
    why: str
    evaluations: int = 0


@dataclass
class Searches:
    """All starts, best first, and what is to be told."""

    found: list[Search]
    told: list[str] = field(default_factory=list)

    @property
    def best(self) -> Search:
        """The search that came lowest."""
        return self.found[0]

    def alike(self, span: np.ndarray) -> int:
        """How many starts led to the best optimum."""
        return sum(bool(np.all(np.abs(one.u - self.best.u) <= ALIKE * span)) for one in self.found)


class NoFit(ValueError):
    """Nothing could be fitted; the text says why."""


def search(evaluator: Evaluator, told: Callable[[str], None] = lambda _: None) -> Searches:
    """Every start of the problem."""
    problem = evaluator.problem
    low, high = problem.bounds
    own = np.array([float(p.to_u(p.start)) for p in problem.parameters])
    spread = low + (high - low) * unit_sample("latin", max(problem.starts - 1, RESCUE), len(low), problem.seed)
    starts, notes = [own, *spread[: problem.starts - 1]], []
    known = evaluator.residuals(starts)
    good = [u for u, r in zip(starts, known, strict=True) if r is not None]
    bad = len(starts) - len(good)
    if bad:
        notes.append(f"{bad} of {len(starts)} starts could not be computed and {'is' if bad == 1 else 'are'} left out")
    if not good:
        good = [u for u, r in zip(spread, evaluator.residuals(list(spread)), strict=True) if r is not None][:1]
        notes.append(f"it begins at one of {RESCUE} points spread over the ranges instead" if good else "")
    if not good:
        first = next(iter(evaluator.failed.values()), "")
        raise NoFit(f"no start can be computed: {len(evaluator.failed)} points failed, the first: {first}")
    found = []
    for number, u in enumerate(good, 1):
        try:
            found.append(one(evaluator, u))
        except NoDerivative as error:
            notes.append(f"start {number} ended: {error}")
            continue
        told(f"start {number} of {len(good)}: {values_in_words(problem, found[-1].u)}, sum of squares {2 * found[-1].cost:.4g}, {found[-1].evaluations} steps")
    if not found:
        raise NoFit("; ".join(notes))
    return Searches(sorted(found, key=lambda one: one.cost), [note for note in notes if note])


def one(evaluator: Evaluator, start: np.ndarray) -> Search:
    """From one start."""
    from scipy.optimize import least_squares

    low, high = evaluator.problem.bounds
    nothing = np.full(evaluator.problem.size, np.nan)

    def residuals(u: np.ndarray) -> np.ndarray:
        r = evaluator.residuals([u])[0]
        return nothing if r is None else r

    inside = np.clip(start, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    if evaluator.residuals([inside])[0] is None:
        raise NoDerivative(f"{values_in_words(evaluator.problem, inside)} could not be computed")
    near = max(TOLERANCE, OF_STEP * evaluator.problem.step) if evaluator.problem.step > USUAL else TOLERANCE
    done = least_squares(residuals, inside, evaluator.jacobian, (low, high), x_scale="jac", max_nfev=MOST_EVALUATIONS, xtol=near, ftol=TOLERANCE, gtol=None)
    return Search(start, done.x, float(done.cost), done.status > 0, done.message.rstrip("."), int(done.nfev))
