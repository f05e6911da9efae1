"""Trial states over the whole range that the return maps are for."""

import numpy as np


def states(n, seed=0, nearest=-14):
    """Rows (p_trial, q_trial, K, mu, M, p0, eta, dt): p0 in 1e-3..1e3, chi in 1e-12..1e12; trial states everywhere, at the axes and just off the ellipse."""
    rng = np.random.default_rng(seed)

    def decades(low, high):
        return 10.0 ** rng.uniform(low, high, n)

    M, p0, chi, omega, dt = decades(-2, 8), decades(-3, 3), decades(-12, 12), decades(-2, 5), decades(-7, 1)
    mu = M * decades(0, 8)
    K = 3 * mu * omega
    where = rng.integers(0, 4, n)
    phi = np.select([where == 1, where == 2], [decades(-12, 0), np.pi / 2 - decades(-12, 0)], rng.uniform(0, np.pi / 2, n))
    size = np.where(rng.random(n) < 0.4, 1 + decades(nearest, 0), decades(0, 8))
    p, q = p0 * M * size * np.cos(phi), M * size * np.abs(np.sin(phi))
    p, q = np.where(where == 3, M * decades(-8, 8), p), np.where(where == 3, M * decades(-8, 8), q)
    return np.stack([p * rng.choice([-1, 1], n), q, K, mu, M, p0, K * dt / chi, dt], axis=1)
