"""A slab that is cooled at one face at once, held across and free along: thermal stress, quasi-static, in uniaxial strain.

sigma along = 0:  eps = gamma (theta - theta_0)/(lam + 2 mu),  u = int_0^X eps,  across = -2 mu eps,  theta(X, t) by the series of robin_slab.
For small strains, and a slab so light that it is at rest at every time (waves cross it in a ten-thousandth of the run).
Order   2 in the cell; stress too in the total frame, in the updated one of order 1 at the particles, 1.5 once recovered (mpm.fields)
"""

import numpy as np

from mpm.error import Motion
from mpm.verification import robin_slab
from mpm.verification.setup import line_box

ORDER = 1.8
POINTS = 4001  # of the integral of strain


def exact(experiment):
    """Displacement, stress and temperature. One box in 1-D from the left wall, at the reference temperature of its expansion, exchange on its right side."""
    from mpm.scene.law import elastic_law, stress_temperature_modulus

    body, lower, length = line_box(experiment)
    material = experiment.materials[body.material]
    if lower != 0 or material.elastic is None or material.expansion is None or material.flow is not None or experiment.gravity is not None:
        raise ValueError("thermal_shock needs an elastic body with expansion, without flow and gravity, from the left wall")
    if body.temperature != material.expansion.reference or any(entry.side != "right" for entry in experiment.surfaces):
        raise ValueError("thermal_shock needs a body that starts at the reference temperature, and exchange on its side right alone")
    theta, elastic = robin_slab.exact(experiment), elastic_law(material.elastic)
    slope = float(stress_temperature_modulus(material.expansion, elastic)) / (elastic.lam + 2 * elastic.mu)
    line = np.linspace(0, length, POINTS)

    def strain(X, t):
        return slope * (theta(X, t) - body.temperature)

    def displacement(X, t):
        e = strain(line[:, None], t)
        return np.interp(X[:, 0], line, np.concatenate([[0.0], np.cumsum((e[1:] + e[:-1]) / 2 * np.diff(line))]))[:, None]

    def stress(X, t):
        across = -2 * elastic.mu * strain(X, t)
        return np.stack([0 * across, across, across], axis=1)

    return Motion({"displacement": displacement, "stress": stress, "temperature": theta})
