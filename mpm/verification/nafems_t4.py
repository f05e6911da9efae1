"""A plate in steady state: hot bottom, insulated left, convection right and top (NAFEMS benchmark T4: 18.25 degC at (0.6, 0.2)).

theta = out + (hot - out) sum C_n cos(z_n x) [z_n cosh z_n (b - y) + H sinh z_n (b - y)]/[z_n cosh z_n b + H sinh z_n b]
z tan z a = H = beta/kappa,   C_n = 4 sin z a/(2 z a + sin 2 z a)
Holds when the transient is gone. Order   1 in the cell, root mean square (declared 0.9): the temperature jumps where the bottom meets the right side.
"""

import numpy as np

from mpm.verification.robin_slab import roots
from mpm.verification.setup import constants, moved, only_body

ORDER = 0.9
TERMS = 400


def exact(experiment):
    """theta(x, t), the same at every t: a box in 2-D, bottom fixed, one convection each on right and top, nothing on the left."""
    name, body = only_body(experiment)
    entries = {entry.side: entry for entry in experiment.surfaces if entry.of == name}
    if experiment.grid.dimension != 2 or type(body.shape).kind != "box" or set(entries) != {"bottom", "right", "top"}:
        raise ValueError("nafems_t4 needs a box in grid.dimension 2 with surface entries bottom, right and top")
    hot, air = entries["bottom"].fixed, entries["right"].convection
    if hot is None or air is None or entries["top"].convection != air or not isinstance(hot.temperature, float) or not isinstance(air.outside, float):
        raise ValueError("nafems_t4 needs a fixed bottom and the same constant convection right and top")
    kappa, _ = constants(experiment, body)
    low, high = moved(experiment, body.shape.lower), moved(experiment, body.shape.upper)
    (a, b), H = high - low, air.beta / kappa
    z = roots(H * a, TERMS) / a
    C = 4 * np.sin(z * a) / (2 * z * a + np.sin(2 * z * a))

    def theta(x, t: float):
        s, y = x[:, 0] - low[0], np.maximum(x[:, 1:] - low[1], 0.0)
        echo = (z - H) / (z + H)  # of cosh and sinh: exp(-z y) (1 + echo exp(-2 z (b - y)))/(1 + echo exp(-2 z b))
        up = np.exp(-z * y) * (1 + echo * np.exp(-2 * z * (b - y))) / (1 + echo * np.exp(-2 * z * b))
        return air.outside + (hot.temperature - air.outside) * np.sum(C * np.cos(np.multiply.outer(s, z)) * up, axis=1)

    return theta
