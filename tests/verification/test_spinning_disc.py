"""What inertia has to do with stress in the spinning disc: the mass as row sums, consistent, and as the total frame has it (mpm.total.inertia). By radial
splines of the same cells, which have neither particles nor cut surfaces."""

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


def error_of_stress(h, inertia):
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
    sums = load / (nodes[seen] * h)
    inverse = np.diag(1 / sums)
    if inertia == "spread":
        beyond = np.append(sums, 0)  # the node on the axis is held; beyond the last there is none
        across = 0.25 * np.minimum(np.insert(beyond[:-1], 0, np.inf), beyond)
        inverse += (np.diag(across[:-1] + across[1:]) - np.diag(across[1:-1], 1) - np.diag(across[1:-1], -1)) / np.outer(sums, sums)
    mass = N.T @ (w[:, None] * N) if inertia == "consistent" else np.linalg.inv(inverse)
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


@pytest.mark.parametrize(("inertia", "errors"), [
    ("row sums", (0.0321, 0.0121, 4.08e-3)), ("consistent", (1.45e-3, 3.64e-4, 9.27e-5)), ("spread", (0.0147, 4.03e-3, 1.10e-3)),
])  # fmt: skip
def test_row_sums_of_mass_would_limit_the_stress(inertia, errors):
    """In the total frame (test_exact.py): 6.8e-3, 2.2e-3, 1.06e-3 with 10, 20, 41 cells a radius; 0.040, 0.013, 0.0041 with row sums, as it was."""
    for h, error in zip((0.1, 0.05, 0.025), errors, strict=True):
        assert error_of_stress(h, inertia) == pytest.approx(error, rel=0.02)
