"""The posterior by emcee (affine-invariant ensemble): exp(-S/(2 s^2)) within the ranges, flat in u. Every step of every walker is a point of the sweep.

A third of the steps is left out as the way there. The sample is reproducible: the same seed asks for the same points, which a second run finds on disk.
Source  Goodman and Weare (2010); Foreman-Mackey et al., PASP 125 (2013) 306. Good values: 50 autocorrelations (`told`): some 1 500 steps for three parameters.
"""

from collections.abc import Callable

import numpy as np

from mpm.fit.evaluate import Evaluator
from mpm.fit.identify import Known
from mpm.sweep.lock import Refused


def needed() -> None:
    """Refused where emcee is not there."""
    try:
        import emcee  # noqa: F401
    except ImportError:
        raise Refused("--posterior needs emcee: pip install 'mpm[posterior]'") from None


def sample(evaluator: Evaluator, known: Known, steps: int, told: Callable[[str], None]) -> np.ndarray:
    """Draws in SI, shape (draw, parameter)."""
    import emcee

    problem = evaluator.problem
    low, high = problem.bounds
    least = float(known.residuals @ known.residuals)

    def density(points: np.ndarray) -> np.ndarray:
        inside = [bool(np.all((u >= low) & (u <= high))) for u in points]
        found = iter(evaluator.residuals([u for u, good in zip(points, inside, strict=True) if good]))
        r = [next(found) if good else None for good in inside]
        return np.array([-np.inf if one is None else -0.5 * (float(one @ one) - least) / known.variance for one in r])

    walkers = max(2 * len(known.u) + 2, 12)
    random = np.random.RandomState(problem.seed)
    spread = np.minimum(np.sqrt(np.diag(known.covariance)), (high - low) / 4)
    start = np.clip(known.u + spread * random.standard_normal((walkers, len(known.u))), low + 1e-6 * (high - low), high - 1e-6 * (high - low))
    sampler = emcee.EnsembleSampler(walkers, len(known.u), density, vectorize=True)
    sampler.run_mcmc(emcee.State(start, random_state=random.get_state()), steps, progress=False)
    taken = float(np.mean(sampler.acceptance_fraction))
    memory = float(np.max(sampler.get_autocorr_time(quiet=True, tol=0)))
    told(f"posterior: {walkers} walkers, {steps} steps, {100 * taken:.0f} % accepted, autocorrelation {memory:.0f} steps"
         + (f": too few steps, say --posterior {round(100 * memory)}" if steps < 50 * memory else ""))  # fmt: skip
    draws = sampler.get_chain(discard=steps // 3, flat=True)
    return np.array([problem.values(u) for u in draws])
