"""A bar between a fixed end and one that follows a sine (NAFEMS benchmark T3: 36.60 degC at x = 0.08 m, t = 32 s).

theta = cold + A [x/L sin wt + sum b_n sin(n pi x/L)],   b_n = -c_n w (l cos wt + w sin wt - l exp(-l t))/(l^2 + w^2),
l = D (n pi/L)^2,  c_n = 2 (-1)^(n+1)/(n pi)      (Carslaw & Jaeger 1959, 3.6, by Duhamel)
Order   2 in the cell (declared 1.7)
"""

import math

import numpy as np

from mpm.verification.setup import constants, moved, only_body

ORDER = 1.7
TERMS = 400


def exact(experiment):
    """theta(x, t): a box in 1-D, left end fixed at its own temperature, right end fixed to a sine about it that starts at phase 0."""
    name, body = only_body(experiment)
    ends = {entry.side: entry.fixed for entry in experiment.surfaces if entry.of == name and entry.fixed is not None}
    sine = ends["right"].temperature if "right" in ends else None
    if experiment.grid.dimension != 1 or type(body.shape).kind != "box" or getattr(type(sine), "kind", "") != "sine":
        raise ValueError("nafems_t3 needs a box in grid.dimension 1 whose right end is fixed to a sine")
    if "left" not in ends or ends["left"].temperature != body.temperature or sine.mean != body.temperature or sine.phase != 0:
        raise ValueError("nafems_t3 needs its left end, its start and the mean of the sine at one temperature, and phase 0")
    _, diffusivity = constants(experiment, body)
    lower, upper = moved(experiment, body.shape.lower)[0], moved(experiment, body.shape.upper)[0]
    length, w, n = upper - lower, 2 * math.pi / sine.period, np.arange(1, TERMS + 1)
    decay = diffusivity * (n * np.pi / length) ** 2
    c = 2 * (-1.0) ** (n + 1) / (n * np.pi)

    def theta(x, t: float):
        s = (x[:, 0] - lower) / length
        b = -c * w * (decay * math.cos(w * t) + w * math.sin(w * t) - decay * np.exp(-decay * t)) / (decay**2 + w**2)
        return body.temperature + sine.amplitude * (s * math.sin(w * t) + np.sin(np.multiply.outer(s, n * np.pi)) @ b)

    return theta
