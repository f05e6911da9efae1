"""What sets does not soften again: parameters that follow a degree of setting X from 0 (raw) to 1 (set), first-order kinetics (docs/physics.md 18).

    dX/dt = k(Theta) (1 - X),   k = k0 exp(-Ta/Theta) (Arrhenius, Ta = Ea/R) or a law of temperature;   parameter = raw + X (baked - raw)
raw and baked may follow temperature. A material that sets has one X a particle; its laws are asked with (Theta, X) in the place of Theta, so each of them is a
`Sets`, or `Alike` where it does not follow X. Elsewhere neither is compiled.
Source: k0 = 2.8e18 1/s and Ea = 139 kJ/mol are those of starch in bread (B. Zanoni, C. Peri, D. Bruno, LWT 28 (1995) 314),
as quoted elsewhere: not compared with the paper itself.
"""

import math
from typing import Any, NamedTuple

from mpm.materials.roles import aspects, at_volume, value, values

GAS = 8.314462618  # J/(mol K)


class Condition(NamedTuple):
    """What the laws of a material that sets are asked with: a row of these, or a row of an array."""

    theta: Any  # [K]
    X: Any  # degree of setting [-]


class Sets(NamedTuple):
    """raw + X (baked - raw), both laws of temperature.

    Good values  baked > raw, within a thousandfold.
    Fails when   E grows under strain: what is stored at the same strain then grows too, and that energy comes from no heat (as in mpm.materials.warm).
    """

    raw: Any
    baked: Any


class Alike(NamedTuple):
    """A law that does not follow X, of a material that sets."""

    law: Any


class Arrhenius(NamedTuple):
    """k0 exp(-Ta/theta)."""

    k0: float  # [1/s]
    Ta: float  # activation energy over the gas constant [K]


@value.register(Arrhenius)
def value_arrhenius(law, theta):
    return law.k0 * math.exp(-law.Ta / theta)


@value.register(Sets)
def value_sets(law, theta):
    raw = value(law.raw, theta[0])
    return raw + theta[1] * (value(law.baked, theta[0]) - raw)


@value.register(Alike)
def value_alike(law, theta):
    return value(law.law, theta[0])


@values.register(Sets)
def values_sets(law, theta):
    raw = values(law.raw, theta[0])
    return raw + theta[1] * (values(law.baked, theta[0]) - raw)


@values.register(Alike)
def values_alike(law, theta):
    return values(law.law, theta[0])


@at_volume.register(Alike)
def at_volume_alike(law, J):
    return Alike(at_volume(law.law, J))


@aspects.register(Alike)
def aspects_alike(law, theta, J):
    return aspects(law.law, theta[0], J)
