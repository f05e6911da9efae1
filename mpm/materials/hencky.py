"""Hencky elasticity: psi = mu e.e + lam/2 (tr e)^2 in principal logarithmic strains (docs/physics.md 1)."""

import math
from typing import NamedTuple

from mpm.lanes import like
from mpm.materials.ellipse import SQRT6
from mpm.materials.roles import energy, moduli, moduli_lanes, response, stress, tangent, turning


class Hencky(NamedTuple):
    """tau_i = 2 mu e_i + lam tr e - gamma (Theta - Theta_0), per unit reference volume.

    Good values  lam, mu >= 0 (3 lam + 2 mu > 0); K = lam + 2 mu/3.
    Fails when   stretched near e = 2.718: ellipticity is lost at a tensile log strain of 1 in uniaxial strain.
    """

    mu: float  # [Pa]
    lam: float  # [Pa]


@stress.register(Hencky)
def stress_hencky(law, e1, e2, e3, thermal):
    bulk = law.lam * (e1 + e2 + e3) - thermal
    return 2.0 * law.mu * e1 + bulk, 2.0 * law.mu * e2 + bulk, 2.0 * law.mu * e3 + bulk


@energy.register(Hencky)
def energy_hencky(law, e1, e2, e3):
    trace = e1 + e2 + e3
    return law.mu * (e1 * e1 + e2 * e2 + e3 * e3) + 0.5 * law.lam * trace * trace


@moduli.register(Hencky)
def moduli_hencky(law):
    return law.lam, law.mu


@moduli_lanes.register(Hencky)
def moduli_lanes_hencky(law, theta):
    return like(theta, law.lam), like(theta, law.mu)


@response.register(Hencky)
def response_hencky(elastic, law, trace, d, size, thermal, theta, dt, tau, a):
    """tau_i = 2 mu share d_i - p;  a as docs/physics.md 17."""
    mu, K, unit = elastic.mu, elastic.lam + 2.0 * elastic.mu / 3.0, 1.0 / size if size > 0.0 else 0.0
    W, p, share, c11, c12, c22, _, good = tangent(law, elastic, trace, size, thermal, theta, dt)
    for i in range(3):
        tau[i] = 2.0 * mu * share * d[i] - p
        for j in range(3):
            ni, nj = unit * d[i], unit * d[j]
            a[i, j] = K * c11 - SQRT6 * mu * c12 * (ni + nj) + 2.0 * mu * (c22 - share) * ni * nj - 2.0 / 3.0 * mu * share
        a[i, i] += 2.0 * mu * share
    return W, share, good


@turning.register(Hencky)
def turning_hencky(elastic, share, li, lj):
    apart = (li - lj) / (1.0 + lj)
    return elastic.mu * share * (math.log1p(apart) / apart if abs(apart) > 1e-12 else 1.0) / (1.0 + lj)
