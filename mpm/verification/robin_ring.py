"""A hollow cylinder that cools inside and outside alike (Carslaw & Jaeger 1959, 13.4).

theta = out + (hot - out) sum C_n exp(-D z_n^2 t) phi_n(r),  phi = J0(z r) (kappa z Y1(z a) + beta Y0(z a)) - Y0(z r) (kappa z J1(z a) + beta J0(z a)),
kappa phi'(b) + beta phi(b) = 0,  C = int r phi/int r phi^2 = -[r phi'/z^2]/[r^2 (phi^2 + phi'^2/z^2)/2] from a to b;  beta = inf: phi(a) = phi(b) = 0.
Order   2 in the cell
"""

import functools
import math

import numpy as np

from mpm.verification.setup import bisected, constants, moved, one_exchange, only_body

ORDER = 1.7
TERMS = 200


def mode(z, r, a: float, Bi: float):
    """phi(r) and phi'(r)/z, with Bi = beta/kappa [1/m]."""
    from scipy.special import j0, j1, y0, y1

    first, second = (y0(z * a), j0(z * a)) if math.isinf(Bi) else (z * y1(z * a) + Bi * y0(z * a), z * j1(z * a) + Bi * j0(z * a))
    return j0(z * r) * first - y0(z * r) * second, -j1(z * r) * first + y1(z * r) * second


@functools.lru_cache(maxsize=16)
def roots(a: float, b: float, Bi: float) -> np.ndarray:
    """The first roots of the outer condition, from its changes of sign."""

    def outer(z):
        value, slope = mode(z, b, a, Bi)
        return value if math.isinf(Bi) else z * slope + Bi * value

    z = np.linspace(1e-6, (TERMS + 1) * math.pi / (b - a), 40 * TERMS)
    sign = np.sign(outer(z))
    k = np.flatnonzero(sign[:-1] * sign[1:] < 0)
    return bisected(outer, z[k], z[k + 1])


def radii(experiment, body):
    """(inner, outer, centre) of a ring in 2-D, or of a box off the axis in axisymmetric scenes (centre on the axis)."""
    kind, dimension = type(body.shape).kind, experiment.grid.dimension
    if kind == "ring" and dimension == 2:
        return body.shape.inner, body.shape.outer, moved(experiment, body.shape.centre)
    if kind == "box" and dimension == "axisymmetric" and body.shape.lower[0] > 0 and experiment.method.offset[0] == 0:
        return body.shape.lower[0], body.shape.upper[0], np.zeros(1)
    raise ValueError("robin_ring needs a ring in grid.dimension 2, or a box off the axis in an axisymmetric scene")


def exact(experiment):
    """theta(x, t) of the config's scene."""
    name, body = only_body(experiment)
    a, b, centre = radii(experiment, body)
    kappa, diffusivity = constants(experiment, body)
    beta, out = one_exchange(experiment, name, "lateral" if experiment.grid.dimension == "axisymmetric" else "all")
    Bi = beta / kappa
    z = roots(a, b, Bi)
    ends = [mode(z, r, a, Bi) for r in (a, b)]
    mean = -(b * ends[1][1] - a * ends[0][1]) / z
    norm = 0.5 * (b**2 * (ends[1][0] ** 2 + ends[1][1] ** 2) - a**2 * (ends[0][0] ** 2 + ends[0][1] ** 2))

    def theta(x: np.ndarray, t: float) -> np.ndarray:
        if t <= 0:
            return np.full(len(x), body.temperature)
        r = np.linalg.norm(x[:, : len(centre)] - centre, axis=1)
        values, _ = mode(z, r[:, None], a, Bi)
        return out + (body.temperature - out) * values @ (mean / norm * np.exp(-diffusivity * t * z**2))

    return theta
