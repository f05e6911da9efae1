"""Fit: parameters from measured curves, by least squares over points of an ordinary sweep, with what the data can and cannot tell.

    problem     config -> Problem: parameters (scaled), curves, residuals of a record
    evaluate    Evaluator: points -> records through `sweep.rounds`, differences for derivatives
    least       SciPy's least_squares from several starts
    identify    covariance, correlations, combinations that are fixed, which further curve would help
    profile     intervals by profile likelihood
    posterior   a sample by emcee (extra)
    api         `fit`; write: OUT/fit.nc; sentences: the answer in words

The package itself can be called: `mpm.fit(experiment, out=...)`, as `mpm.sweep`.
"""

import sys
import types
from typing import Any


class _Room(types.ModuleType):
    """A package that is also a function (see mpm.sweep)."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """See `mpm.fit.api.fit`."""
        from mpm.fit.api import fit

        return fit(*args, **kwargs)


sys.modules[__name__].__class__ = _Room
