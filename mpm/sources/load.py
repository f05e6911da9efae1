"""A dead load: the same force on a particle all the time, whatever it does; how a traction on a body's surface reaches its particles."""

from typing import NamedTuple

import numpy as np

from mpm.sources.roles import heat, push


class Load(NamedTuple):
    """Force by mass."""

    a: np.ndarray  # (N, D) [m/s2]


@push.register(Load)
def _(law, X, i, c, t):
    return law.a[i, c]


@heat.register(Load)
def _(law, X, i, t):
    return 0.0
