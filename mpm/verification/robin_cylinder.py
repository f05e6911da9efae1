"""A long cylinder, or a disc in plane strain, that cools through its side (docs/physics.md 7, problem 1; Carslaw & Jaeger 1959, 7.7).

theta = out + (hot - out) sum C_n exp(-z_n^2 Fo) J0(z_n r/R),  z J1(z) = Bi J0(z),  C = 2 J1/(z (J0^2 + J1^2)).
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
    """z J1(z) = Bi J0(z), one root between neighbouring zeros of J1 and J0."""
    from scipy.special import j0, j1, jn_zeros

    highs = jn_zeros(0, terms)
    if math.isinf(Bi):
        return highs
    lows = np.concatenate([[0.0], jn_zeros(1, terms - 1)])
    return bisected(lambda z: z * j1(z) - Bi * j0(z), lows, highs)


def exact(experiment):
    """theta(x, t) of a disc (ball in 2-D) or of a cylinder that exchanges through its side only (axisymmetric, side lateral)."""
    from scipy.special import j0, j1

    name, body = only_body(experiment)
    kind, dimension = type(body.shape).kind, experiment.grid.dimension
    if (kind, dimension) not in (("ball", 2), ("cylinder", "axisymmetric")):
        raise ValueError("robin_cylinder needs a ball in grid.dimension 2, or a cylinder in an axisymmetric scene with side lateral")
    kappa, diffusivity = constants(experiment, body)
    beta, out = one_exchange(experiment, name, "lateral" if kind == "cylinder" else "all")
    z = roots(beta * body.shape.radius / kappa)
    theta = series(z, 2 * j1(z) / (z * (j0(z) ** 2 + j1(z) ** 2)), j0, body.temperature, out, body.shape.radius, diffusivity)
    centre = moved(experiment, body.shape.centre) if kind == "ball" else None
    return lambda x, t: theta(x[:, 0] if centre is None else np.linalg.norm(x - centre, axis=1), t)
