"""Hencky elasticity: psi = mu e.e + lam/2 (tr e)^2 in principal logarithmic strains (docs/physics.md 1)."""

from typing import NamedTuple

from mpm.lanes import like
from mpm.materials.roles import energy, moduli, moduli_lanes, stress


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
