"""What limits stress in the spinning disc: masses as row sums. Shown by radial splines of the same cells, which have neither particles nor cut surfaces."""

import numpy as np
import pytest
from scipy.linalg import eigh

from mpm.verification.spinning_disc import radial

NU, R = 0.3, 1.03
LAM, MU = NU / ((1 + NU) * (1 - 2 * NU)), 1 / (2 * (1 + NU))
M = LAM + 2 * MU


def spline(x):
    """A quadratic B-spline and its slope."""
    a = np.abs(x)
    return np.where(a < 0.5, 0.75 - a * a, np.where(a < 1.5, (1.5 - a) ** 2 / 2, 0)), np.where(a < 0.5, -2 * x, np.where(a < 1.5, -np.sign(x) * (1.5 - a), 0))


def error_of_stress(h, consistent):
    """Root mean square over the disc and the ten times of spinning_disc.yaml, relative; exact in time, odd about the axis, by Galerkin's method."""
    nodes, edges = np.arange(1, int(R / h) + 3), np.unique(np.clip([0, *((np.arange(int(R / h) + 2) + 0.5) * h), R], 0, R))
    g, weight = np.polynomial.legendre.leggauss(4)
    r = (edges[:-1, None] + np.diff(edges)[:, None] * (g + 1) / 2).ravel()
    w = (np.diff(edges)[:, None] * weight / 2).ravel() * r
    (N, D), (behind, slope) = spline(r[:, None] / h - nodes), spline(r[:, None] / h + nodes)
    N, E = N - behind, (D - slope) / h
    seen = (N**2).T @ w > 1e-12 * h
    N, E, H = N[:, seen], E[:, seen], N[:, seen] / r[:, None]
    K = E.T @ (w[:, None] * (M * E + LAM * H)) + H.T @ (w[:, None] * (LAM * E + M * H))
    load = N.T @ (w * r)  # of a centrifugal force, over r the row sum of a mass
    mass = N.T @ (w[:, None] * N) if consistent else np.diag(load / (nodes[seen] * h))
    square, V = eigh(K, mass)
    rest = np.linalg.solve(K, load)
    begun = V.T @ (mass @ rest)
    found = np.zeros(2)
    for t in 0.8 * np.arange(1, 11):
        u = rest - V @ (begun * np.cos(np.sqrt(np.abs(square)) * t))
        s, _, *strains = radial(2 * MU / M, np.sqrt(M) * t / R)
        a, b = (R**2 / (8 * M) * np.interp(r / R, s, one) for one in strains)
        exact = np.stack([M * a + LAM * b, LAM * a + M * b, LAM * (a + b)])
        wrong = np.stack([M * E @ u + LAM * H @ u, LAM * E @ u + M * H @ u, LAM * (E + H) @ u]) - exact
        found += np.sum(w * wrong**2), np.sum(w * exact**2)
    return float(np.sqrt(found[0] / found[1]))


def test_row_sums_of_mass_limit_the_stress():
    """0.032, 0.012, 0.0041 as in the total frame (0.040, 0.013, 0.0041 with 10, 20, 41 cells a radius); 0.0014, 3.6e-4, 9.3e-5 with the consistent mass."""
    for h, lumped, consistent in ((0.1, 0.0321, 1.45e-3), (0.05, 0.0121, 3.64e-4), (0.025, 4.08e-3, 9.27e-5)):
        assert error_of_stress(h, False) == pytest.approx(lumped, rel=0.02)
        assert error_of_stress(h, True) == pytest.approx(consistent, rel=0.02)
