"""Singly diagonally implicit Runge-Kutta methods, L-stable and stiffly accurate, with error estimate and dense output.

ORDER4  Hairer & Wanner, Solving ODEs II, table IV.6.5 (gamma = 1/4, five stages), embedded order 3, continuous
        extension (6.17): order 3 inside the step, as measured
ORDER2  Alexander 1977 (gamma = 1 - 1/sqrt 2, two stages), embedded order 1, dense output of order 2

Stages k_i of y' = f(y); y(t + s dt) = y + dt sum_i k_i w_i(s), w_i(s) = s (dense_i0 + s (dense_i1 + ...)), and w_i(1) = b_i = the last row of `a`.
"""

from typing import NamedTuple

import numpy as np

from mpm.rigid.ordered import combined


class Tableau(NamedTuple):
    """a (m, m) lower triangular with gamma on the diagonal, error weights b - b^ (m,), dense (m, powers), order of the estimate's step power."""

    a: np.ndarray
    error: np.ndarray
    dense: np.ndarray
    power: int

    @property
    def gamma(self) -> float:
        return float(self.a[0, 0])

    def weights(self, s: np.ndarray) -> np.ndarray:
        """w_i(s): (S, m)."""
        powers = np.asarray(s, dtype=float)[:, None] ** np.arange(1, self.dense.shape[1] + 1)
        return combined(powers, self.dense.T)


_A = np.zeros((5, 5))
_A[0, :1] = 1 / 4
_A[1, :2] = 1 / 2, 1 / 4
_A[2, :3] = 17 / 50, -1 / 25, 1 / 4
_A[3, :4] = 371 / 1360, -137 / 2720, 15 / 544, 1 / 4
_A[4] = 25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4
_DENSE = np.array(
    [
        [11 / 3, -463 / 72, 217 / 36, -20 / 9],
        [11 / 2, -385 / 16, 661 / 24, -10.0],
        [-125 / 18, 20125 / 432, -8875 / 216, 250 / 27],
        [0.0, -85 / 4, 85 / 6, 0.0],
        [-11 / 9, 557 / 108, -359 / 54, 80 / 27],
    ]
)
ORDER4 = Tableau(_A, np.array([-3 / 16, -27 / 32, 25 / 32, 0.0, 1 / 4]), _DENSE, 4)

_G = 1 - np.sqrt(0.5)
ORDER2 = Tableau(
    np.array([[_G, 0.0], [1 - _G, _G]]),
    np.array([1 - _G - 0.5, _G - 0.5]),
    np.array([[1 + _G / (1 - _G), -0.5 / (1 - _G)], [-_G / (1 - _G), 0.5 / (1 - _G)]]),
    2,
)
TABLEAUS = {4: ORDER4, 2: ORDER2}
