"""A sphere that cools through its surface (Carslaw & Jaeger 1959, 9.4).

theta = out + (hot - out) sum C_n exp(-z_n^2 Fo) sin(z_n r/R)/(z_n r/R),  1 - z cot z = Bi,  C = 4 (sin z - z cos z)/(2 z - sin 2 z);  beta = inf: z = n pi.
One solution for a ball in three dimensions and for an axisymmetric one on the axis: they must be equal within their errors.
Order   2 in the cell (declared 1.7)
"""

import functools
import math

import numpy as np

from mpm.verification.setup import bisected, constants, moved, one_exchange, only_body, series

ORDER = 1.7
TERMS = 200


@functools.lru_cache(maxsize=64)
def roots(Bi: float, terms: int = TERMS) -> np.ndarray:
    """z cos z = (1 - Bi) sin z, one root a half-turn."""
    lows = np.arange(terms) * np.pi
    if math.isinf(Bi):
        return lows + np.pi
    return bisected(lambda z: z * np.cos(z) - (1 - Bi) * np.sin(z), lows + 1e-9, lows + np.pi - 1e-9)


def exact(experiment):
    """theta(x, t) of a ball in 3-D, or of an axisymmetric one on the axis, that exchanges all over."""
    name, body = only_body(experiment)
    dimension = experiment.grid.dimension
    if type(body.shape).kind != "ball" or dimension not in (3, "axisymmetric") or (dimension == "axisymmetric" and body.shape.centre[0] != 0):
        raise ValueError("robin_sphere needs a ball in grid.dimension 3, or an axisymmetric one on the axis")
    kappa, diffusivity = constants(experiment, body)
    beta, out = one_exchange(experiment, name)
    z, centre = roots(beta * body.shape.radius / kappa), moved(experiment, body.shape.centre)
    theta = series(
        z, 4 * (np.sin(z) - z * np.cos(z)) / (2 * z - np.sin(2 * z)), lambda s: np.sinc(s / np.pi), body.temperature, out, body.shape.radius, diffusivity
    )
    return lambda x, t: theta(np.linalg.norm(x - centre, axis=1), t)
