"""One whole step of 1-D thermoelastic particles as a matrix, and its spectral radius: what mpm.benchmarks.operators has by theory, and coupling.

State of every particle: v, C (APIC), eps, theta.    v_i = p_i/m_i, v_i+ = v_i + dt f_i/m_i, f = -sum V (eps - gamma theta) g
eps += dt g v+;   theta -= gamma Theta/(R0 alpha) dt g v    with v = v+ (new: how mpm steps) or v = v_i (old: here only, to show that it fails)

Units: cell, density, lam + 2 mu, Theta/(R0 alpha) are 1: dt is the Courant number, gamma^2 the coupling number eps_c.
"""

import numpy as np

from mpm.benchmarks.operators import Cloud


def step(cloud: Cloud, method: str, gradient: str, co: float, coupling: float = 0.0, old: bool = False) -> np.ndarray:
    """The matrix of one step: APIC, PIC, FLIP or XPIC(2)."""
    N = cloud.W.shape[1]
    one, Z = np.eye(N), np.zeros((N, N))
    g = (cloud.G if gradient == "bspline" else cloud.L)[:, :, 0]
    gamma = np.sqrt(coupling)
    P = cloud.W * cloud.V / cloud.m[:, None]
    slope = cloud.d[:, :, 0] * cloud.V / cloud.m[:, None]
    scatter = np.concatenate([P, slope if method == "APIC" else 0 * slope, 0 * P, 0 * P], axis=1)
    force = -g * cloud.V / cloud.m[:, None]
    change = co * np.concatenate([0 * P, 0 * P, force, -gamma * force], axis=1)
    moved = scatter + change
    value = {"APIC": cloud.W.T @ moved, "PIC": cloud.W.T @ moved}
    if method in value:
        v = value[method]
    else:
        lost = one - cloud.W.T @ P
        kept = one if method == "FLIP" else one - lost @ lost
        v = np.concatenate([kept, Z, Z, Z], axis=1) + cloud.W.T @ change
    C = 4.0 * cloud.d[:, :, 0].T @ moved if method == "APIC" else np.zeros((N, 4 * N))
    eps = np.concatenate([Z, Z, one, Z], axis=1) + co * g.T @ moved
    theta = np.concatenate([Z, Z, Z, one], axis=1) - gamma * co * g.T @ (scatter if old else moved)
    return np.concatenate([v, C, eps, theta])


def radius(matrix: np.ndarray) -> float:
    """Largest magnitude of an eigenvalue."""
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))


def last_stable(cloud: Cloud, method: str, gradient: str, coupling: float, old: bool, slack: float = 1e-6) -> float:
    """The largest Courant number below which every tried one is stable, by bisection between 1e-3 and 2; 0 where already 1e-3 is not."""

    def stable(co: float) -> bool:
        return radius(step(cloud, method, gradient, co, coupling, old)) <= 1.0 + slack

    low, high = 1e-3, 2.0
    if not stable(low):
        return 0.0
    while high / low > 1.005:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return float(low)
