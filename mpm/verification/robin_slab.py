"""A slab that cools through both faces, or through one face with the other insulated (Carslaw & Jaeger 1959, 3.11).

x from the middle, or from the insulated face; L half the thickness, or all of it:
theta = out + (hot - out) sum C_n exp(-z_n^2 Fo) cos(z_n x/L),  z tan z = Bi,  C = 4 sin z/(2 z + sin 2 z);  beta = inf: z = (n + 1/2) pi.
Order   2 in the cell (declared 1.7: the worst of several offsets wobbles)
"""

import functools
import math

import numpy as np

from mpm.verification.setup import bisected, constants, moved, one_exchange, only_body, series

ORDER = 1.7
TERMS = 400


@functools.lru_cache(maxsize=64)
def roots(Bi: float, terms: int = TERMS) -> np.ndarray:
    """z tan z = Bi, one root a branch, by bisection of z sin z - Bi cos z to round-off: all at once."""
    branch = np.arange(terms) * np.pi
    if math.isinf(Bi):
        return branch + 0.5 * np.pi
    return bisected(lambda z: z * np.sin(z) - Bi * np.cos(z), branch, branch + 0.5 * np.pi)


def exact(experiment):
    """theta(x, t) of the config's scene: one box in 1-D, or a box exchanging through two opposite faces."""
    name, body = only_body(experiment)
    if experiment.grid.dimension != 1 or type(body.shape).kind != "box":
        raise ValueError("robin_slab needs a box in grid.dimension 1")
    kappa, diffusivity = constants(experiment, body)
    beta, out = one_exchange(experiment, name, "all", "left", "right")
    lower, upper = moved(experiment, body.shape.lower)[0], moved(experiment, body.shape.upper)[0]
    side = next(surface.side for surface in experiment.surfaces if surface.of == name)
    still = {"all": (lower + upper) / 2, "left": upper, "right": lower}[side]
    length = (upper - lower) / (2 if side == "all" else 1)
    z = roots(beta * length / kappa)
    theta = series(z, 4 * np.sin(z) / (2 * z + np.sin(2 * z)), np.cos, body.temperature, out, length, diffusivity)
    return lambda x, t: theta(np.abs(x[:, 0] - still), t)
