"""First and total indices from given data, with intervals: a polynomial surrogate, and what it misses measured on points that it was not shown.

    y = m + sum_a b_a phi_a(x) + e      phi_a products of polynomials that are orthonormal over each parameter; b by ridge regression; e from FOLDS parts, each
                                        predicted from the others
    V     = |b|^2 + 2 E(e f) + V(e)     f: the surrogate without its mean
    S_i V = |b_i|^2 + 2 E(e f_i) + V(E(e | x_i))                      b_i: terms of x_i alone; the last from pairs of points that are next along x_i
    T_i V = V - |b_o|^2 - 2 E(e f_o) - R                              b_o: terms without x_i; 0 <= R <= V(e) is not known, so both ends are taken

The surrogate need not be good: E is over the data, so what it misses is found there, and a bad one gives wide intervals. Their half is Student's t times the
larger of two standard errors: of the means of the data (delta method), which does not see that the surrogates of the parts share most of their points; and of
the jackknife, which leaves out each of GROUPS parts of the points and does all but the choice of the basis again. The jackknife errs to the safe side: its
variance is at least the true one in the mean. At least LEAST to each side: nobody needs a third digit of an index. For T_i also the range of R.
Basis   Legendre polynomials over the range; over at most LEVELS different values those that are orthonormal on them. Terms of up to three parameters by
        rising q-norm of their degrees; q, their number and the penalty by the leave-one-out error
Source  Sudret, RESS 93 (2008) 964 (indices from a basis); Da Veiga and Gamboa, J. Nonparametric Stat. 25 (2013) 573 (one step from a surrogate);
        Gamboa, Gremaud, Klein and Lagnoux, Bernoulli 28 (2022) 2345 (pairs that are next by rank);
        Chernozhukov et al., Econometrics J. 21 (2018) C1 (parts predicted from the others); Efron and Stein, Ann. Statist. 9 (1981) 586 (the jackknife)
Good values: 20 points a parameter and more. Fails when: parameters do not vary independently, as where failed points leave a corner empty: `failing.bounded`
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

FOLDS, DEGREE, LEVELS, MOST_FUNCTIONS, LEAST, GROUPS = 10, 16, 20, 300, 0.005, 20
NORMS, PARTS, PENALTIES = (0.4, 0.7, 1.0), (0.1, 0.25, 0.5), (1e-4, 1e-2, 0.1)


@dataclass
class Basis:
    """phi at every point (values, terms), the degrees of each term (terms, parameters), the penalty of each, and the polynomials of each parameter."""

    phi: np.ndarray
    degrees: np.ndarray
    penalty: np.ndarray
    single: list[np.ndarray]

    def of(self, points: np.ndarray) -> "Basis":
        """At some of the points."""
        return Basis(self.phi[points], self.degrees, self.penalty, [one[points] for one in self.single])


def polynomials(column: np.ndarray) -> np.ndarray:
    """Orthonormal polynomials of one parameter at its points, the constant first."""
    levels, at, count = np.unique(column, return_inverse=True, return_counts=True)
    if len(levels) <= LEVELS:
        weight = np.sqrt(count / len(column))
        q, r = np.linalg.qr(np.polynomial.legendre.legvander(2 * levels - 1, min(len(levels) - 1, DEGREE)) * weight[:, None])
        return (q * np.sign(np.diag(r)) / weight[:, None])[at]
    return np.polynomial.legendre.legvander(2 * column - 1, DEGREE) * np.sqrt(2 * np.arange(DEGREE + 1) + 1)


def candidates(tops: list[int], q: float, most: int) -> np.ndarray:
    """Degrees of the terms, by rising q-norm: shape (terms, parameters)."""
    found = []
    for size, least in ((1, DEGREE), (2, 12), (3, 8)):
        for which in itertools.combinations(range(len(tops)), min(size, len(tops))) if size <= len(tops) else ():
            for degrees in itertools.product(*(range(1, min(tops[k], least) + 1) for k in which)):
                found.append((sum(d**q for d in degrees) ** (1 / q), size, which, degrees))
    rows = np.zeros((min(most, len(found)), len(tops)), int)
    for row, (*_, which, degrees) in zip(rows, sorted(found), strict=False):
        row[list(which)] = degrees
    return rows


def chosen(unit: np.ndarray, y: np.ndarray) -> Basis:
    """The basis and penalty with the least leave-one-out error."""
    single = [polynomials(column) for column in unit.T]
    best: tuple[float, Basis] | None = None
    for q, part in itertools.product(NORMS, PARTS):
        degrees = candidates([one.shape[1] - 1 for one in single], q, min(MOST_FUNCTIONS, int(part * len(y))))
        phi = np.hstack([np.ones((len(y), 1)), np.prod([one[:, degrees[:, k]] for k, one in enumerate(single)], axis=0)])
        gram, by, cost = phi.T @ phi, phi.T @ y, np.concatenate([[0], (degrees.astype(float) ** 2).sum(axis=1)])
        for strength in PENALTIES:
            inverse = np.linalg.inv(gram + np.diag(strength * cost + 1e-9 * len(y)))
            lever = np.minimum(np.einsum("ij,jk,ik->i", phi, inverse, phi, optimize=True), 0.99)
            error = float(np.mean(((y - phi @ (inverse @ by)) / (1 - lever)) ** 2))
            if best is None or error < best[0]:
                best = error, Basis(phi, degrees, strength * cost + 1e-9 * len(y), single)
    assert best is not None  # there are norms and penalties to try
    return best[1]


@dataclass
class Indices:
    """(value, lower, upper) of each parameter, and the share of the variance that the surrogate predicts at points that it was not shown."""

    first: np.ndarray
    total: np.ndarray
    explained: float


def estimate(basis: Basis, y: np.ndarray, seed: int = 0, groups: int = GROUPS) -> Indices:
    """Both indices of every parameter; without the jackknife where `groups` is 0."""
    from scipy.stats import norm, t

    random = np.random.default_rng(seed)
    part = random.permutation(len(y)) % FOLDS
    value, error, rest = once(basis, y, part)
    half = norm.ppf(0.975) * error
    if groups:
        group = random.permutation(len(y)) % groups
        others = np.stack([once(basis.of(group != k), y[group != k], part[group != k])[0] for k in range(groups)])
        jackknife = np.sqrt((groups - 1) / groups * np.sum((others - others.mean(axis=0)) ** 2, axis=0))
        half = np.maximum(half, t.ppf(0.975, groups - 1) * jackknife)
    half = np.maximum(half, LEAST)
    first, total = value
    ends = (np.stack([first, first - half[0], first + half[0]], axis=1), np.stack([total - rest / 2, total - rest - half[1], total + half[1]], axis=1))
    return Indices(*ends, float(1 - rest))


def once(basis: Basis, y: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Values of first and total indices, shape (2, parameters); their standard errors by the delta method; the share that the surrogate misses."""
    phi, degrees, count = basis.phi, basis.degrees, len(y)
    gram, by = phi.T @ phi + np.diag(basis.penalty), phi.T @ y
    b = np.stack([np.linalg.solve(gram - phi[part == k].T @ phi[part == k], by - phi[part == k].T @ y[part == k]) for k in range(FOLDS)])
    e = y - np.einsum("ij,ij->i", phi, b[part])
    e = e - e.mean()
    terms, square = phi[:, 1:] * b[part, 1:], np.mean(b[:, 1:] ** 2, axis=0)
    f, rest = terms.sum(axis=1), float(e.var(ddof=1))
    variance = square.sum() + 2 * np.mean(e * f) + rest
    of_variance = 2 * e * f + e**2
    values, errors = np.empty((2, len(basis.single))), np.empty((2, len(basis.single)))
    for k, single in enumerate(basis.single):
        alone, without = (degrees[:, k] > 0) & ((degrees > 0).sum(axis=1) == 1), degrees[:, k] == 0
        known = terms[:, alone].sum(axis=1)
        missed = beside(e, single[:, 1])
        values[0, k] = (square[alone].sum() + np.mean(2 * e * known + missed)) / variance
        errors[0, k] = math.sqrt(np.var((2 * e * known + missed - values[0, k] * of_variance) / variance, ddof=1) / count)
        known = terms[:, without].sum(axis=1)
        values[1, k] = 1 - (square[without].sum() + 2 * np.mean(e * known)) / variance
        errors[1, k] = math.sqrt(np.var((2 * e * known - (1 - values[1, k]) * of_variance) / variance, ddof=1) / count)
    return values, errors, rest / variance


def beside(e: np.ndarray, column: np.ndarray) -> np.ndarray:
    """e of each point times e of the next one along a parameter, whose mean is the variance of E(e | x_i) whatever its shape; of points that share a value of
    it, times the mean of the others."""
    levels, at, count = np.unique(column, return_inverse=True, return_counts=True)
    if len(levels) < len(column) / 2:
        return e * (np.bincount(at, e)[at] - e) / np.maximum(count[at] - 1, 1)
    order = np.argsort(column, kind="stable")
    found = np.empty(len(e))
    found[order] = e[order] * np.append(e[order][1:], e[order][-2])
    return found
