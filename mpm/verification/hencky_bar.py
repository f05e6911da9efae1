"""A bar of Hencky material in uniaxial strain that starts straight in its first mode (docs/physics.md 7, problem 5).

R0 u'' = dP/dX,  P = (lam + 2 mu) ln F/F,  v(X, 0) = V sin(k X),  u = 0 at X = 0;  upper end at the wall (k = pi/L) or free (k = pi/2 L).
Solved by one Legendre element of POINTS nodes (the free end is natural) and Runge-Kutta steps of order 8: against the tables of problem 5 to 1e-9.
Holds until the wave breaks: about 1/(1.5 k V) after the start.
Order   2 in the cell at a fixed Courant number; where velocity and stress stall, and why: configs/verification/README.md
"""

import functools
import math

import numpy as np

from mpm.error import Motion
from mpm.verification.setup import elastic_only, line_box

ORDER = 1.8
POINTS = 49


@functools.lru_cache(maxsize=1)
def element() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss-Lobatto-Legendre on [0, 1], and the derivative matrix."""
    from numpy.polynomial import legendre

    top = np.zeros(POINTS)
    top[-1] = 1.0
    inner = np.sort(legendre.legroots(legendre.legder(top)).real)
    x = np.concatenate([[-1.0], inner, [1.0]])
    P = legendre.legval(x, top)
    gap = x[:, None] - x + np.eye(POINTS)
    D = P[:, None] / P / gap * (1 - np.eye(POINTS))
    D -= np.diag(D.sum(axis=1))
    return (x + 1) / 2, 1 / (POINTS * (POINTS - 1) * P**2), 2 * D


@functools.lru_cache(maxsize=16)
def motion(V: float, free: bool, end: float):
    """t -> (u, v) at the nodes for length 1, speed of sound 1."""
    from scipy.integrate import solve_ivp

    x, w, D = element()
    k = math.pi / 2 if free else math.pi
    held = np.zeros(POINTS, bool)
    held[0], held[-1] = True, not free
    push = -(D * w[:, None]).T / w[:, None]

    def rates(_, y):
        F = 1 + D @ y[:POINTS]
        a = push @ (np.log(F) / F)
        a[held] = 0.0
        return np.concatenate([y[POINTS:], a])

    v = V * np.sin(k * x)
    v[held] = 0.0
    found = solve_ivp(rates, (0.0, end), np.concatenate([np.zeros(POINTS), v]), "DOP853", dense_output=True, rtol=1e-11, atol=1e-14)
    return found.sol


def lagrange(s: np.ndarray) -> np.ndarray:
    """Values at s of the polynomials of the nodes (S, POINTS)."""
    from numpy.polynomial import legendre

    x = element()[0]
    return legendre.legvander(2 * s - 1, POINTS - 1) @ np.linalg.inv(legendre.legvander(2 * x - 1, POINTS - 1))


def exact(experiment):
    """Displacement, velocity and stress. One box in 1-D from the wall, to the other wall or ending freely."""
    body, lower, length = line_box(experiment)
    elastic, density = elastic_only(experiment, body)
    if lower != 0:
        raise ValueError("hencky_bar starts at the left wall: lower 0")
    free = length < experiment.grid.size[0] * (1 - 1e-9)
    M = elastic.lam + 2 * elastic.mu
    sound = math.sqrt(M / density)
    k = math.pi / (2 * length if free else length)
    V = experiment.exact.amplitude
    solved = motion(V / sound, free, experiment.time.end * sound / length)

    def at(X, t):
        y, basis = solved(t * sound / length), lagrange(X[:, 0] / length)
        return basis @ y[:POINTS], basis @ y[POINTS:], 1 + basis @ (element()[2] @ y[:POINTS])

    def stress(X, t):
        e = np.log(at(X, t)[2])
        return np.stack([M * e, elastic.lam * e, elastic.lam * e], axis=1)

    def start(one):
        p = one.particles
        p.C[:, 0, 0] = V * k * np.cos(k * p.x[:, 0])
        p.v[:, 0] = V * np.sin(k * p.x[:, 0])
        return one

    return Motion({"displacement": lambda X, t: length * at(X, t)[0], "velocity": lambda X, t: sound * at(X, t)[1], "stress": stress}, start)
