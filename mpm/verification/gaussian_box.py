"""A Gaussian that spreads in an insulated box, by images (docs/physics.md 7, problem 2; gaussian_box_1d.csv).

theta = cold + rise prod_a phi(x_a, t),   phi = sigma/s sum_k [exp(-(x - 2 k L - c)^2/2 s^2) + exp(-(x - 2 k L + c)^2/2 s^2)],  s^2 = sigma^2 + 2 D t
The run starts from the solution at t = 0. Total heat is constant.
Order   2 in the cell (declared 1.8)
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.verification.setup import constants, moved, only_body

ORDER = 1.8


@dataclass(frozen=True)
class Beginning:
    """A solution that the scene starts from, too."""

    theta: Any
    starts: bool = True

    def __call__(self, x, t: float):
        return self.theta(x, t)


def exact(experiment):
    """theta(x, t) of an insulated box in 1-D, 2-D or 3-D."""
    name, body = only_body(experiment)
    given = experiment.exact
    if experiment.grid.dimension not in (1, 2, 3) or type(body.shape).kind != "box" or any(entry.of == name for entry in experiment.surfaces):
        raise ValueError("gaussian_box needs a box in grid.dimension 1, 2 or 3 without surface entries")
    if len(given.centre) != experiment.grid.dimension or getattr(body.shape, "angle", 0.0):
        raise ValueError("gaussian_box needs a centre with one number a direction, and a box that is not turned")
    _, diffusivity = constants(experiment, body)
    low, high, centre = (moved(experiment, p) for p in (body.shape.lower, body.shape.upper, given.centre))

    def phi(x, c: float, length: float, t: float):
        s = math.sqrt(given.sigma**2 + 2 * diffusivity * t)
        reach = math.ceil(5 * s / length) + 1
        shifts = 2 * length * np.arange(-reach, reach + 1)
        waves = sum(np.exp(-((x[:, None] - shifts + sign * c) ** 2) / (2 * s * s)).sum(axis=1) for sign in (-1, 1))
        return given.sigma / s * waves

    def theta(x, t: float):
        factors = [phi(x[:, k] - low[k], centre[k] - low[k], high[k] - low[k], t) for k in range(len(low))]
        return body.temperature + given.rise * np.prod(factors, axis=0)

    return Beginning(theta)
