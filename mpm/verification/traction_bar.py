"""A bar of Hencky material in uniaxial strain, held at one end and pulled at the other until it rests: uniform stress, up to its end.

P = M ln F/F = T,  M = lam + 2 mu:  ln F = -W(-T/M) by Lambert's W;  u = (F - 1) X,  tau = M ln F along, lam ln F across.
Order   none in the total frame, where it is exact in any cell; the updated frame errs in the last two cells under the traction (docs/frames.md)
"""

import math

import numpy as np

from mpm.verification.setup import at_rest, elastic_only, line_box

ORDER = None


def exact(experiment):
    """Displacement and stress at rest. One box in 1-D from the left wall, one traction on its right side."""
    from scipy.special import lambertw

    body, lower, length = line_box(experiment)
    elastic, _ = elastic_only(experiment, body)
    pulls = [load for load in experiment.loads if load.traction is not None]
    if lower != 0 or length > experiment.grid.size[0] * (1 - 1e-9) or len(pulls) != 1 or pulls[0].side != "right" or not pulls[0].traction.nominal:
        raise ValueError("traction_bar needs a box from the left wall that ends in the domain, and one nominal traction on its side right")
    M, T = elastic.lam + 2 * elastic.mu, pulls[0].traction.nominal[0]
    if T >= M / math.e:
        raise ValueError("traction_bar needs a traction below (lam + 2 mu)/e, the most that Hencky's law bears")
    e = -float(lambertw(-T / M).real)
    return at_rest(lambda X: math.expm1(e) * X, lambda X: np.tile([M * e, elastic.lam * e, elastic.lam * e], (len(X), 1)))
