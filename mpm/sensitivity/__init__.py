"""Sensitivity: which parameter moves which observable, from any finished sample, failed points and all; what distinguishes those that failed.

    sample      dataset -> Sample: parameters, observables, which points are ok
    indices     Spearman, and first and total indices from a whole Saltelli design, with intervals
    projection  first and total indices from given data, with intervals: polynomials, and what they miss
    failing     which ranges fail, and bounds on indices where failing depends on the parameters
    surrogate   radial basis functions through a smooth sample, with their cross-validated error; `ask`: what value gives an answer
    api         `sensitivity`: sentences and OUT/sensitivity.nc

The package itself can be called: `mpm.sensitivity(out)`, as `mpm.sweep`.
"""

import sys
import types
from typing import Any


class _Room(types.ModuleType):
    """A package that is also a function (see mpm.sweep)."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """See `mpm.sensitivity.api.sensitivity`."""
        from mpm.sensitivity.api import sensitivity

        return sensitivity(*args, **kwargs)


sys.modules[__name__].__class__ = _Room
