"""Indices of one observable, with 95 % intervals.

spearman    correlation of ranks; bootstrap over points
saltelli    first and total indices of a whole design by SALib; a base row of which any point failed is left out whole
Those of any other design: `projection`
Source  Saltelli et al., CPC 181 (2010) 259
"""

from typing import Any

import numpy as np

from mpm.sweep.lock import Refused

RESAMPLES, FEWEST = 200, 50


def salib() -> None:
    """Refused where SALib is not there."""
    try:
        import SALib  # noqa: F401
    except ImportError:
        raise Refused("mpm sensitivity of a Saltelli design or a surrogate needs SALib: pip install 'mpm[sensitivity]'") from None


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


def saltelli(y: np.ndarray, base: int, parameters: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, int]:
    """(first, total), each (parameters, 3), and how many base rows were whole."""
    salib()
    from SALib.analyze import sobol

    rows = y.reshape(base, parameters + 2)
    whole = rows[np.isfinite(rows).all(axis=1)]
    if len(whole) < FEWEST:
        raise Refused(f"only {len(whole)} of {base} rows of the Saltelli design are whole; at least {FEWEST} are needed")
    problem = {"num_vars": parameters, "names": [f"x{k}" for k in range(parameters)], "bounds": [[0, 1]] * parameters}
    found: Any = sobol.analyze(problem, whole.ravel(), calc_second_order=False, num_resamples=RESAMPLES, seed=seed)
    pack = lambda name: np.stack([found[name], found[name] - found[f"{name}_conf"], found[name] + found[f"{name}_conf"]], axis=1)  # noqa: E731
    return pack("S1"), pack("ST"), len(whole)
