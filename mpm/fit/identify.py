"""What the data fix and what they leave open, from the Jacobian at the optimum.

    C = s^2 (J^T J)^-1      covariance in u; s^2 = 1 where sigma is given, else S/(values - parameters)
    interval                u +- t sqrt(C_kk), t Student's (normal where sigma is given), 95 %; ends are carried to the parameter
    pair                    |correlation| of TOGETHER or more: with C_l of the logarithms, a = -C_ij/C_jj makes p_i p_j^a the combination that is fixed,
                            and its relative standard error is sqrt(C_ii (1 - rho^2))
    gain                    the errors if a further series had been measured at the times, and with the sigma, of the best measured curve
Source  Bates and Watts, Nonlinear Regression Analysis and its Applications (1988), ch. 2. Fails when: residuals are not independent (model error)
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.fit.evaluate import Evaluator
from mpm.fit.problem import Curve, Problem

TOGETHER = 0.95
LEVEL = 0.95
SHORT = 0.25  # half as far as the interval reaches
FLOOR = 1e-14  # of the largest eigenvalue of J^T J: what lies below is not known at all


@dataclass
class Known:
    """Covariance in u, the optimum, and what follows."""

    problem: Problem
    u: np.ndarray
    jacobian: np.ndarray
    residuals: np.ndarray
    variance: float  # s^2
    quantile: float  # t
    shape: np.ndarray  # (J^T J)^-1

    @property
    def covariance(self) -> np.ndarray:
        """In u."""
        return self.variance * self.shape

    @property
    def values(self) -> np.ndarray:
        """The parameters, in SI."""
        return np.array(self.problem.values(self.u))

    @property
    def covariance_si(self) -> np.ndarray:
        """Of the parameters themselves."""
        slope = np.array([p.slope(v) for p, v in zip(self.problem.parameters, self.values, strict=True)])
        return self.covariance * slope[:, None] * slope[None, :]

    @property
    def error(self) -> np.ndarray:
        """Standard errors."""
        return np.sqrt(np.diag(self.covariance_si))

    @property
    def correlation(self) -> np.ndarray:
        """Of the parameters, without units."""
        d = np.sqrt(np.diag(self.shape))
        return self.shape / d[:, None] / d[None, :]

    def short(self) -> bool:
        """Whether a step within the ranges still promises a lower sum of squares, by more than SHORT of the rise at the interval's end."""
        from scipy.optimize import lsq_linear

        low, high = self.problem.bounds
        room = 1e-9 * (high - low)  # SciPy wants the ends apart
        step = lsq_linear(self.jacobian, -self.residuals, (low - self.u - room, high - self.u + room)).x
        promised = float(self.residuals @ self.residuals - np.sum((self.residuals + self.jacobian @ step) ** 2))
        return promised > SHORT * self.quantile**2 * self.variance

    def interval(self) -> np.ndarray:
        """95 % by the covariance, shape (parameter, 2); not cut at the ends of the range."""
        half = self.quantile * np.sqrt(np.diag(self.covariance))
        ends = [(p.to_u(v) - h, p.to_u(v) + h) for p, v, h in zip(self.problem.parameters, self.values, half, strict=True)]
        with np.errstate(over="ignore"):
            return np.array([[float(np.exp(e)) if p.log else float(e) * p.scale for e in pair] for p, pair in zip(self.problem.parameters, ends, strict=True)])


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Of J^T J; directions that the data do not see get a variance that says so."""
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    eigen, vectors = np.linalg.eigh(matrix / scale[:, None] / scale[None, :])
    eigen = np.maximum(eigen, FLOOR * max(eigen[-1], 1e-300))
    return (vectors / eigen) @ vectors.T / scale[:, None] / scale[None, :]


def identify(evaluator: Evaluator, u: np.ndarray) -> Known:
    """What is known at the optimum."""
    from scipy.stats import norm, t

    problem, r, jacobian = evaluator.problem, evaluator.number(u), evaluator.jacobian(u)
    free = len(r) - len(u)
    variance = 1.0 if problem.known_sigma else float(r @ r) / free if free else math.nan
    quantile = float(norm.ppf(0.5 + LEVEL / 2) if problem.known_sigma else t.ppf(0.5 + LEVEL / 2, free)) if problem.known_sigma or free else math.nan
    return Known(problem, u, jacobian, r, variance, quantile, inverse(jacobian.T @ jacobian))


@dataclass(frozen=True)
class Pair:
    """Two parameters that cannot be told apart, and the combination that is fixed: p_i p_j^power (or p_i + power p_j) = value +- error."""

    i: int
    j: int
    correlation: float
    product: bool
    power: float
    value: float
    error: float


def pairs(known: Known) -> list[Pair]:
    """Every such pair."""
    found, values = [], known.values
    for i in range(len(values)):
        for j in range(i + 1, len(values)):
            rho = float(known.correlation[i, j])
            if abs(rho) < TOGETHER:
                continue
            product = values[i] > 0 and values[j] > 0
            unit = np.outer(values[[i, j]], values[[i, j]]) if product else np.ones((2, 2))
            slope = np.array([p.slope(v) for p, v in zip(known.problem.parameters, values, strict=True)])[[i, j]]
            c = known.shape[np.ix_([i, j], [i, j])] * np.outer(slope, slope) / unit
            i_, j_ = i, j
            if abs(c[0, 1]) > c[1, 1]:  # the power is at most one
                i_, j_, c = j, i, c[::-1, ::-1]
            power = float(-c[0, 1] / c[1, 1])
            value = float(values[i_] * values[j_] ** power) if product else float(values[i_] + power * values[j_])
            error = math.sqrt(max(0.0, known.variance * c[0, 0] * (1 - rho**2))) * (abs(value) if product else 1.0)
            found.append(Pair(i_, j_, rho, product, power, value, error))
    return found


def gains(evaluator: Evaluator, known: Known) -> dict[str, np.ndarray]:
    """Standard errors of the parameters if a further series were measured, by curve or series: those that tell as much as a curve of the same unit."""
    problem = known.problem
    like = next((curve for curve in problem.curves if curve.times is not None), None)
    if like is None:
        return {}
    used, found = {curve.variable for curve in problem.curves}, {}
    names = {f"temperature_{probe}": probe for probe in problem.experiment.output.probes}
    record = evaluator.records([known.u])[0]
    for variable in (name for name in names if name in record.series and name not in used and like.units == "K"):
        further = Curve(names[variable], variable, like.times, like.values, like.sigma, like.weight, like.units)

        def predicted(record: Any, further: Curve = further) -> np.ndarray:
            return further.scaled(further.predict(record))

        j = evaluator.sensitivity(known.u, predicted)
        c = known.variance * inverse(known.jacobian.T @ known.jacobian + j.T @ j)
        slope = np.array([p.slope(v) for p, v in zip(problem.parameters, known.values, strict=True)])
        found[names[variable]] = np.sqrt(np.diag(c)) * slope
    return found


def band(evaluator: Evaluator, known: Known, predict: Any) -> tuple[np.ndarray, np.ndarray]:
    """(prediction, half width of its 95 % confidence band) of anything a record tells."""
    j = evaluator.sensitivity(known.u, predict)
    return predict(evaluator.records([known.u])[0]), known.quantile * np.sqrt(np.einsum("ij,jk,ik->i", j, known.covariance, j))
