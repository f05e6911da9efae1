"""A column of Hencky material under its own weight, in uniaxial strain and at rest.

P = M ln F/F = -R0 g (H - X),  M = lam + 2 mu:  with q = R0 g (H - X)/M and Lambert's W of q,  ln F = -W,
x(X) = M/(R0 g) [w(q(0)) - w(q(X))],  w = W + W^2/2.  In the limit of small load: u = -R0 g (H X - X^2/2)/M.
The body starts there, at rest; what it does then is the error.
Order   2 in the cell
"""

import numpy as np

from mpm.error import Motion
from mpm.verification.setup import elastic_only, line_box

ORDER = 1.8


def exact(experiment):
    """Displacement and stress. One box in 1-D from the left wall, gravity towards it."""
    from scipy.special import lambertw

    body, lower, height = line_box(experiment)
    elastic, density = elastic_only(experiment, body, gravity=True)
    if lower != 0 or experiment.gravity is None or experiment.gravity[0] >= 0 or height > experiment.grid.size[0] * (1 - 1e-9):
        raise ValueError("hydrostatic_column needs a box from the left wall with a free upper end, and gravity below 0")
    M = elastic.lam + 2 * elastic.mu
    load = -density * experiment.gravity[0] / M

    def strain(X):
        """-ln F."""
        return lambertw(load * (height - X)).real

    def place(X):
        bottom, here = strain(np.zeros(1)), strain(X)
        return (bottom + bottom**2 / 2 - here - here**2 / 2) / load

    def start(one):
        p = one.particles
        W = strain(p.x[:, 0])
        p.x[:, 0] = place(p.x[:, 0])
        p.B[:, 0] = np.expm1(-2 * W)
        p.J[:] = np.exp(-W)
        return one

    def stress(X, t):
        e = -strain(X[:, 0])
        return np.stack([M * e, elastic.lam * e, elastic.lam * e], axis=1)

    return Motion({"displacement": lambda X, t: place(X[:, 0]) - X[:, 0], "stress": stress}, start)
