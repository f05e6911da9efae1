"""Designs: samples of the unit cube, by scipy.stats, which takes 70 MB: `sample_apart` asks another interpreter for the numbers.

sobol, halton, uniform   the first n points do not depend on how many follow: a longer sample keeps the shorter one
latin                    every n is its own design
saltelli                 rows of d + 2 points: A, A with column 1 (2, ...) of B, B, where A and B are halves of a Sobol point in 2 d dimensions
"""

import json
import subprocess
import sys
import warnings

import numpy as np

from mpm.sweep.apart import apart

APART = "from mpm.sweep.designs import unit_sample; sys.stdout.buffer.write(unit_sample(*json.loads(sys.argv[1])).tobytes())"


def sample_apart(design: str, count: int, dimensions: int, seed: int) -> np.ndarray:
    """The same as `unit_sample`, without scipy.stats in this process. Where the other one fails it is drawn here, which tells why."""
    if design != "uniform" and "scipy.stats" not in sys.modules:
        made = apart(APART, json.dumps([design, count, dimensions, seed]), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        if made.returncode == 0:
            return np.frombuffer(made.stdout).reshape(count, dimensions)
    return unit_sample(design, count, dimensions, seed)


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
