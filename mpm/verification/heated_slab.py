"""A slab heated evenly from within (microwaves) that cools through one face or both (Carslaw & Jaeger 1959, 3.14: steady parabola and series).

x from the middle, or from the insulated face; L half the thickness, or all of it; q [W/m3]:
    theta = S(x) + sum A_n exp(-z_n^2 Fo) cos(z_n x/L),   S = out + q L/beta + q (L^2 - x^2)/(2 kappa),   z tan z = Bi
    A_n = (hot - out - q L/beta) C_n - q L^2/(2 kappa) D_n,  C_n = 4 sin z/(2 z + sin 2 z),  D_n = 8 (sin z - z cos z)/(z^2 (2 z + sin 2 z))
Order   2 in the cell for particles, 3 on nodes (declared 1.7, as robin_slab)
"""

import math

import numpy as np

from mpm.verification.robin_slab import roots
from mpm.verification.setup import constants, moved, one_exchange, only_body

ORDER = 1.7


def exact(experiment):
    """theta(x, t) of the config's scene: one box in 1-D with one source, a number."""
    name, body = only_body(experiment)
    if experiment.grid.dimension != 1 or type(body.shape).kind != "box":
        raise ValueError("heated_slab needs a box in grid.dimension 1")
    if len(experiment.sources) != 1 or not isinstance(experiment.sources[0].heat, float) or experiment.sources[0].until is not None:
        raise ValueError("heated_slab needs one source, whose heat is a number that lasts")
    (source,) = experiment.sources
    if source.heat_by_mass is not None or source.force is not None or getattr(source, "from"):
        raise ValueError("heated_slab needs one source, whose heat is a number that lasts")
    kappa, diffusivity = constants(experiment, body)
    beta, out = one_exchange(experiment, name, "all", "left", "right")
    lower, upper = moved(experiment, body.shape.lower)[0], moved(experiment, body.shape.upper)[0]
    side = next(surface.side for surface in experiment.surfaces if surface.of == name)
    still = {"all": (lower + upper) / 2, "left": upper, "right": lower}[side]
    L, q, hot = (upper - lower) / (2 if side == "all" else 1), source.heat, body.temperature
    z = roots(beta * L / kappa)
    level, bend = out + (q * L / beta if math.isfinite(beta) else 0.0), q * L * L / (2 * kappa)
    norm = 2 * z + np.sin(2 * z)
    A = (hot - level) * 4 * np.sin(z) / norm - bend * 8 * (np.sin(z) - z * np.cos(z)) / (z * z * norm)

    def theta(x, t: float):
        s = np.abs(x[:, 0] - still) / L
        if t <= 0:
            return np.full(len(s), hot)
        fourier = diffusivity * t / L**2
        seen = z * z * fourier < 40 * math.log(10)
        return level + bend * (1 - s * s) + np.cos(np.multiply.outer(s, z[seen])) @ (A[seen] * np.exp(-(z[seen] ** 2) * fourier))

    return theta
