"""Evaluator: scaled parameters -> records, remembered; and derivatives by differences, all of one Jacobian in one round.

Differences  forward by `step` in u (unless told a thousandth of the parameter, or of the larger end of its range), backward at the end of a range or where
             the point failed, then shorter. The error of a derivative is of the order of the step: it slows the search a little and does not move the optimum
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mpm.fit.problem import Problem
from mpm.records.variables import OK


class NoDerivative(Exception):
    """Points on every side of one failed."""


class Evaluator:
    """`run` takes a list of points (SI values in the order of the parameters) and returns a record for each."""

    def __init__(self, problem: Problem, run: Callable[[list[tuple[float, ...]]], list[Any]]):
        self.problem, self.run = problem, run
        self.known: dict[tuple[float, ...], Any] = {}
        self.failed: dict[tuple[float, ...], str] = {}

    def records(self, points: Sequence[np.ndarray]) -> list[Any]:
        """A record each, those that are not known in one round."""
        keys = [self.problem.values(u) for u in points]
        wanted = [key for key in dict.fromkeys(keys) if key not in self.known]
        for key, record in zip(wanted, self.run(wanted) if wanted else (), strict=True):
            self.known[key] = record
            if record.status != OK:
                self.failed[key] = record.error
            elif self.problem.residuals(record) is None:
                self.failed[key] = "it does not tell what was measured (an observable is not reached, or not a number)"
        return [self.known[key] for key in keys]

    def residuals(self, points: Sequence[np.ndarray]) -> list[np.ndarray | None]:
        """r of each, None where it failed."""
        return [self.problem.residuals(record) for record in self.records(points)]

    def number(self, u: np.ndarray) -> np.ndarray:
        """r at a point that has one; NoDerivative where it failed after all."""
        if (r := self.residuals([u])[0]) is None:
            raise NoDerivative(f"no residuals at {values_in_words(self.problem, u)}: the point failed")
        return r

    def differences(self, u: np.ndarray) -> list[tuple[np.ndarray, float]]:
        """For each parameter a point beside u that is a number, and how far it is."""
        (low, high), step = self.problem.bounds, self.problem.step
        found: dict[int, tuple[np.ndarray, float]] = {}
        first = [1.0 if u[k] + step <= high[k] else -1.0 for k in range(len(u))]
        for turn in (1.0, -1.0, 0.1, -0.1, 0.01, -0.01):
            left = [k for k in range(len(u)) if k not in found]
            steps = {k: turn * first[k] * step for k in left}
            tried = {k: u + h * np.eye(len(u))[k] for k, h in steps.items() if low[k] <= u[k] + h <= high[k]}
            for (k, point), r in zip(tried.items(), self.residuals(list(tried.values())), strict=True):
                if r is not None:
                    found[k] = point, steps[k]
            if len(found) == len(u):
                return [found[k] for k in range(len(u))]
        name = next(parameter.name for k, parameter in enumerate(self.problem.parameters) if k not in found)
        raise NoDerivative(f"no derivative by {name} at {values_in_words(self.problem, u)}: the points on both sides failed")

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """dr/du, shape (values, parameters)."""
        beside = self.differences(u)
        r = self.number(u)
        return np.stack([(self.number(point) - r) / h for point, h in beside], axis=1)

    def sensitivity(self, u: np.ndarray, predict: Callable[[Any], np.ndarray]) -> np.ndarray:
        """d predict/du of any prediction from a record; the points are those of the Jacobian."""
        beside = self.differences(u)
        base, *moved = [predict(record) for record in self.records([u, *(point for point, _ in beside)])]
        return np.stack([(one - base) / h for one, (_, h) in zip(moved, beside, strict=True)], axis=1)


def values_in_words(problem: Problem, u: np.ndarray) -> str:
    """`kappa = 0.35, beta = 13.1`."""
    return ", ".join(f"{name} = {value:.4g}" for name, value in zip(problem.names, problem.values(u), strict=True))
