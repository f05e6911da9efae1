"""Neo-Hookean elasticity: psi = mu/2 (tr b - 3) - mu ln J + lam/2 (J - 1)^2: no principal axes are needed, so it is the cheapest law here."""

import math
from typing import NamedTuple

from mpm.materials.roles import energy, moduli, response, stress, turning, warmed


class NeoHookean(NamedTuple):
    """tau = mu (b - 1) + lam J (J - 1) 1, per unit reference volume; elastic only.

    Good values  mu > 0, lam >= 0.   Fails when   crushed: the pressure stays finite as J goes to 0.
    Source       Simo & Pister 1984, as in the demonstration programs of MPM libraries.
    """

    mu: float  # [Pa]
    lam: float  # [Pa]


@stress.register(NeoHookean)
def stress_neo_hookean(law, e1, e2, e3, thermal):
    J = math.exp(e1 + e2 + e3)
    pressure = law.lam * J * math.expm1(e1 + e2 + e3) - thermal
    return law.mu * math.expm1(2.0 * e1) + pressure, law.mu * math.expm1(2.0 * e2) + pressure, law.mu * math.expm1(2.0 * e3) + pressure


@energy.register(NeoHookean)
def energy_neo_hookean(law, e1, e2, e3):
    swell, trace = math.expm1(e1 + e2 + e3), math.expm1(2.0 * e1) + math.expm1(2.0 * e2) + math.expm1(2.0 * e3)
    return law.mu * (0.5 * trace - (e1 + e2 + e3)) + 0.5 * law.lam * swell * swell


@moduli.register(NeoHookean)
def moduli_neo_hookean(law):
    return law.lam, law.mu


@warmed.register(NeoHookean)
def warmed_neo_hookean(law, theta):
    return law


@response.register(NeoHookean)
def response_neo_hookean(elastic, law, trace, d, size, thermal, theta, dt, tau, a):
    """a_ij = 2 mu exp(2 e_i) delta_ij + lam J (2 J - 1); no flow, no thermal stress."""
    swell = math.expm1(trace)
    pressure, stretched = elastic.lam * (1.0 + swell) * swell, 0.0
    for i in range(3):
        grown = math.expm1(2.0 * (trace / 3.0 + d[i]))
        stretched += grown
        tau[i] = elastic.mu * grown + pressure
        for j in range(3):
            a[i, j] = elastic.lam * (1.0 + swell) * (1.0 + 2.0 * swell)
        a[i, i] += 2.0 * elastic.mu * (1.0 + grown)
    return elastic.mu * (0.5 * stretched - trace) + 0.5 * elastic.lam * swell * swell, 1.0, True


@turning.register(NeoHookean)
def turning_neo_hookean(elastic, share, li, lj):
    return elastic.mu
