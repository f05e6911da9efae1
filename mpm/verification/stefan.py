"""Melting of a half space behind a hot face: Neumann's similarity solution with equal properties (Carslaw & Jaeger 1959, 11.2).

front s = 2 xi sqrt(D t);  hot side  hot + (melt - hot) erf(e)/erf(xi),  cold side  cold + (melt - cold) erfc(e)/erfc(xi),  e = x/(2 sqrt(D t))
exp(-xi^2) [(hot - melt)/erf xi - (melt - cold)/erfc xi] = xi sqrt(pi) latent/alpha
Latent heat is a bump of alpha here, so the solution is approached as its width and the cell go to zero together.
Order   1 in the cell with a width in proportion (declared 0.8). Holds until the far end feels the front.
"""

import math

import numpy as np

from mpm.verification.setup import moved, only_body

ORDER = 0.8
FELT = 0.01  # of melt - cold at the far end


def exact(experiment):
    """theta(x, t): a box in 1-D whose left face is fixed, kappa constant, alpha a bump."""
    from scipy.optimize import brentq
    from scipy.special import erf, erfc

    name, body = only_body(experiment)
    material, entries = experiment.materials[body.material], [entry for entry in experiment.surfaces if entry.of == name]
    alpha, kappa = material.heat.alpha, material.heat.kappa
    if experiment.grid.dimension != 1 or type(body.shape).kind != "box" or type(alpha).kind != "bump" or type(kappa).kind != "constant":
        raise ValueError("stefan needs a box in grid.dimension 1 with constant kappa and a bump for alpha")
    if len(entries) != 1 or entries[0].side != "left" or entries[0].fixed is None or not isinstance(entries[0].fixed.temperature, float):
        raise ValueError("stefan needs one surface entry: left, fixed to a constant temperature")
    hot, cold, melt, diffusivity = entries[0].fixed.temperature, body.temperature, alpha.at, kappa.value / (material.density * alpha.base)
    if not cold < melt < hot:
        raise ValueError("stefan needs the start colder and the face hotter than the bump")

    def balance(xi):
        return math.exp(-xi * xi) * ((hot - melt) / erf(xi) - (melt - cold) / erfc(xi)) - xi * math.sqrt(math.pi) * alpha.heat / alpha.base

    xi = brentq(balance, 1e-9, 5.0, xtol=1e-14)
    left, right = (moved(experiment, end)[0] for end in (body.shape.lower, body.shape.upper))
    if erfc((right - left) / (2 * math.sqrt(diffusivity * experiment.time.end))) > FELT * erfc(xi):
        raise ValueError(f"stefan is a half space, and by {experiment.time.end:g} s its far end is warmer by more than {FELT:.0%} of melt - cold")

    def theta(x, t: float):
        if t <= 0:
            return np.full(len(x), cold)
        e = (x[:, 0] - left) / (2 * math.sqrt(diffusivity * t))
        return np.where(e < xi, hot + (melt - hot) * erf(e) / erf(xi), cold + (melt - cold) * erfc(e) / erfc(xi))

    return theta
