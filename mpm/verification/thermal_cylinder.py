"""A long thick cylinder between two temperatures, in plane strain and at rest (Timoshenko & Goodier, Theory of Elasticity, 3rd ed. 1970, section 151).

theta - theta_0 = d(r): theta = theta_o + (theta_i - theta_o) ln(b/r)/ln(b/a).  I(r) = int_a^r d r dr,  A = E alpha/(1 - nu),  c = 1/(b^2 - a^2)
u = alpha (1 + nu)/(1 - nu) [I(r)/r + ((1 - 2 nu) r^2 + a^2)/r c I(b)]
sigma_r = A/r^2 [(r^2 - a^2) c I(b) - I(r)],  sigma_t = A/r^2 [(r^2 + a^2) c I(b) + I(r) - d r^2],  sigma_z = A [2 nu c I(b) - d]
For small strains. The body starts in its steady temperature, without stress; what is compared is where it has come to rest.
Order   1.8 in the cell; 3.0 measured in the total frame, stress 2.6. With temperatures held to h/(1000 L), which is of order 1, it was 1.3
(mpm.heat.exchange: FIRMER)
"""

import math

import numpy as np

from mpm.verification.setup import at_rest, only_body

ORDER = 1.8


def exact(experiment):
    """Displacement and stress at rest: an axisymmetric box between walls that slip, held at a temperature on its sides inner and outer."""
    from mpm.scene.law import elastic_law, stress_temperature_modulus

    name, body = only_body(experiment)
    material, (width, height) = experiment.materials[body.material], experiment.grid.size
    if experiment.grid.dimension != "axisymmetric" or len(experiment.bodies) != 1 or type(body.shape).kind != "box" or any(experiment.method.offset):
        raise ValueError("thermal_cylinder needs one box in grid.dimension axisymmetric, and no offset")
    (a, low), (b, high) = body.shape.lower, body.shape.upper
    if not 0 < a < b < width or low != 0 or abs(high - height) > 1e-9 * height or any(wall.acts != "slip" for wall in experiment.walls.values()):
        raise ValueError("thermal_cylinder needs a hollow cylinder from the bottom to the top of the domain, both walls slip")
    if material.elastic is None or material.expansion is None or material.flow is not None or experiment.gravity is not None:
        raise ValueError("thermal_cylinder needs an elastic body with expansion, without flow and gravity")
    held = {entry.side: entry.fixed.temperature for entry in experiment.surfaces if entry.of == name and entry.fixed is not None}
    if set(held) != {"inner", "outer"} or len(experiment.surfaces) != 2 or not all(isinstance(one, float) for one in held.values()):
        raise ValueError("thermal_cylinder needs a fixed temperature on the sides inner and outer, constant in time, and nothing else")
    elastic = elastic_law(material.elastic)
    lam, mu, inside, outside = elastic.lam, elastic.mu, held["inner"], held["outer"]
    nu, E = lam / (2 * (lam + mu)), mu * (3 * lam + 2 * mu) / (lam + mu)
    alpha = float(stress_temperature_modulus(material.expansion, elastic)) / (3 * lam + 2 * mu)
    k, c, A = (inside - outside) / math.log(b / a), 1 / (b**2 - a**2), E * alpha / (1 - nu)

    def d(r):
        return outside - material.expansion.reference + k * np.log(b / r)

    def integral(r):
        part = lambda x: x**2 / 2 * (outside - material.expansion.reference) + k * x**2 * (np.log(b / x) / 2 + 0.25)  # noqa: E731
        return part(r) - part(a)

    whole = integral(b)

    def displacement(X):
        r = X[:, 0]
        return np.stack([alpha * (1 + nu) / (1 - nu) * (integral(r) / r + ((1 - 2 * nu) * r**2 + a**2) / r * c * whole), 0 * r], axis=1)

    def stress(X):
        r = X[:, 0]
        radial = A / r**2 * ((r**2 - a**2) * c * whole - integral(r))
        hoop = A / r**2 * ((r**2 + a**2) * c * whole + integral(r) - d(r) * r**2)
        return np.stack([radial, A * (2 * nu * c * whole - d(r)), hoop, 0 * r], axis=1)

    def start(one):
        x = one.particles.x.astype(float)
        one.thermal.theta[:] = d(x[:, 0]) + material.expansion.reference - one.thermal.zero
        one.thermal.c[:, 0] = -k / x[:, 0]
        return one

    return at_rest(displacement, stress, start=start)
