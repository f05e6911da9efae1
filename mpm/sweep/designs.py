"""Designs: samples of the unit cube. Loads scipy.stats when one is asked for.

sobol, halton, uniform   the first n points do not depend on how many follow: a longer sample keeps the shorter one
latin                    every n is its own design
saltelli                 rows of d + 2 points: A, A with column 1 (2, ...) of B, B, where A and B are halves of a Sobol point in 2 d dimensions
"""

import warnings

import numpy as np


def unit_sample(design: str, count: int, dimensions: int, seed: int) -> np.ndarray:
    """`count` points in [0, 1)^dimensions, shape (count, dimensions); the same seed gives the same points."""
    random = np.random.default_rng(seed)
    if design == "saltelli":
        a, b = np.split(unit_sample("sobol", count // (dimensions + 2), 2 * dimensions, seed), 2, axis=1)
        mixed = [np.where(np.arange(dimensions) == k, b, a) for k in range(dimensions)]
        return np.stack([a, *mixed, b], axis=1).reshape(count, dimensions)
    if design == "uniform":
        return random.random((count, dimensions))
    from scipy.stats import qmc

    if design == "latin":
        return qmc.LatinHypercube(dimensions, seed=random).random(count)
    if design == "halton":
        return qmc.Halton(dimensions, scramble=True, seed=random).random(count)
    if design != "sobol":
        raise ValueError(f"no design {design!r}")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties of Sobol", category=UserWarning)  # any count is allowed, so that samples can grow
        return qmc.Sobol(dimensions, scramble=True, bits=30, seed=random).random(count)
