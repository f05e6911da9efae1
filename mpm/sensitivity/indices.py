"""Indices of one observable, with 95 % intervals.

spearman    correlation of ranks; bootstrap over points
first       S_i = V(E(y | x_i))/V(y) from given data by RBD-FAST (SALib): the spectrum of y in the order of x_i, HARMONICS of it, corrected for bias.
            Interval by halves of the sample drawn without repetition (the spread of an estimate from half of the points, about that from all, is that of the
            whole): the bootstrap repeats points, and repeated points lie side by side in the order of x and count as an effect. It reaches up from the value
            without the correction, as points of a low-discrepancy design carry less noise than the correction takes off
saltelli    first and total indices of a whole design by SALib; a base row of which any point failed is left out whole
Source  Tarantola et al. (2006), Plischke (2010) RESS 95, 354; Tissot and Prieur (2012) RESS 107, 205; Saltelli et al. (2010) CPC 181, 259
Fails when: parameters do not vary independently, as where failed points leave a corner empty: see `failing.bounded`
"""

from typing import Any

import numpy as np

from mpm.sweep.lock import Refused

HARMONICS, RESAMPLES, FEWEST = 10, 200, 50
Z = 1.96


def salib() -> None:
    """Refused where SALib is not there."""
    try:
        import SALib  # noqa: F401
    except ImportError:
        raise Refused("mpm sensitivity needs SALib: pip install 'mpm[sensitivity]'") from None


def spearman(x: np.ndarray, y: np.ndarray, seed: int = 0) -> np.ndarray:
    """(value, lower, upper) of each parameter, shape (parameters, 3)."""
    from scipy.stats import rankdata

    ranks, of_y = np.apply_along_axis(rankdata, 0, x), rankdata(y)
    draws = np.random.default_rng(seed).integers(0, len(y), (RESAMPLES, len(y)))
    found = []
    for column in ranks.T:
        many = [np.corrcoef(column[draw], of_y[draw])[0, 1] for draw in draws]
        found.append((np.corrcoef(column, of_y)[0, 1], *np.nanpercentile(many, [2.5, 97.5])))
    return np.array(found)


def shares(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Share of the spectrum in the first harmonics, of each parameter."""
    from SALib.analyze import rbd_fast

    return np.array([rbd_fast.compute_first_order(rbd_fast.permute_outputs(column, y), HARMONICS) for column in x.T])


def unbiased(share: np.ndarray, count: int) -> np.ndarray:
    """Less what independent noise puts into the first harmonics."""
    bias = 2 * HARMONICS / count
    return share - bias / (1 - bias) * (1 - share)


def first(x: np.ndarray, y: np.ndarray, seed: int = 0) -> np.ndarray:
    """(value, lower, upper) of each parameter, shape (parameters, 3)."""
    random, share = np.random.default_rng(seed), shares(x, y)
    value = unbiased(share, len(y))
    halves = [random.permutation(len(y))[: len(y) // 2] for _ in range(RESAMPLES)]
    spread = np.std([unbiased(shares(x[half], y[half]), len(half)) for half in halves], axis=0)
    return np.stack([value, value - Z * spread, share + Z * spread], axis=1)


def saltelli(y: np.ndarray, base: int, parameters: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, int]:
    """(first, total), each (parameters, 3), and how many base rows were whole."""
    from SALib.analyze import sobol

    rows = y.reshape(base, parameters + 2)
    whole = rows[np.isfinite(rows).all(axis=1)]
    if len(whole) < FEWEST:
        raise Refused(f"only {len(whole)} of {base} rows of the Saltelli design are whole; at least {FEWEST} are needed")
    problem = {"num_vars": parameters, "names": [f"x{k}" for k in range(parameters)], "bounds": [[0, 1]] * parameters}
    found: Any = sobol.analyze(problem, whole.ravel(), calc_second_order=False, num_resamples=RESAMPLES, seed=seed)
    pack = lambda name: np.stack([found[name], found[name] - found[f"{name}_conf"], found[name] + found[f"{name}_conf"]], axis=1)  # noqa: E731
    return pack("S1"), pack("ST"), len(whole)
