"""Laws of arrays: one NamedTuple for a batch, with an array in place of every number; `pick(law, i)` is the law of point i.

So kinds stay types and values stay run-time arguments: a batch of any size and any values shares one compiled kernel.
"""

import numpy as np

from mpm.jit import role
from mpm.materials import (
    LAWS,
    Alike,
    Arrhenius,
    EllipseClipped,
    EllipseRadial,
    Hencky,
    HenckyWarm,
    NeoHookean,
    NoFlow,
    Porous,
    Sets,
    Table,
)
from mpm.point.state import Lumped, NoConduction, Rigid, Sourced
from mpm.state import Expansion, Heating, Isothermal, Latched, NoExchange, NoExpansion, NoHeating, NoSetting, Setting, Softening, Thermal


@role
def pick(law, i):
    """The law of point i. Arrays of a point's own (tables, the temperature of `Thermal`) are views: to write into them changes the batch."""
    raise TypeError(f"{type(law).__name__} cannot be batched")


def pick_same(law, i):
    return law


for absent in (Rigid, NoFlow, NoConduction, NoExchange, NoExpansion, NoHeating, NoSetting):
    pick.register(absent, pick_same)


@pick.register(Hencky)
def pick_hencky(law, i):
    return Hencky(law.mu[i], law.lam[i])


@pick.register(NeoHookean)
def pick_neo_hookean(law, i):
    return NeoHookean(law.mu[i], law.lam[i])


@pick.register(HenckyWarm)
def pick_hencky_warm(law, i):
    return HenckyWarm(pick(law.one, i), pick(law.E, i))


@pick.register(Porous)
def pick_porous(law, i):
    return Porous(law.solid[i], law.exponent[i])


@pick.register(Softening)
def pick_softening(law, i):
    return Softening(pick(law.inner, i), pick(law.E, i))


def numbers_of(kind):
    """`pick` of a law of one to four numbers."""
    return {
        1: lambda law, i: kind(law[0][i]),
        2: lambda law, i: kind(law[0][i], law[1][i]),
        3: lambda law, i: kind(law[0][i], law[1][i], law[2][i]),
        4: lambda law, i: kind(law[0][i], law[1][i], law[2][i], law[3][i]),
    }[len(kind._fields)]


for law_of_temperature in LAWS:
    if law_of_temperature is not Table:
        pick.register(law_of_temperature, numbers_of(law_of_temperature))


@pick.register(Table)
def pick_table(law, i):
    return Table(law.theta[i], law.c[i], law.h[i])


@pick.register(Sets)
def pick_sets(law, i):
    return Sets(pick(law.raw, i), pick(law.baked, i))


@pick.register(Alike)
def pick_alike(law, i):
    return Alike(pick(law.law, i))


@pick.register(Arrhenius)
def pick_arrhenius(law, i):
    return Arrhenius(law.k0[i], law.Ta[i])


@pick.register(Setting)
def pick_setting(law, i):
    return Setting(law.X[i], law.k[i], pick(law.rate, i))


@pick.register(EllipseRadial)
def pick_ellipse_radial(law, i):
    return EllipseRadial(pick(law.M, i), pick(law.p0, i), pick(law.eta, i))


@pick.register(EllipseClipped)
def pick_ellipse_clipped(law, i):
    return EllipseClipped(pick(law.M, i), pick(law.p0, i), pick(law.eta, i))


@pick.register(Isothermal)
def pick_isothermal(law, i):
    return Isothermal(law.temperature[i])


@pick.register(Thermal)
def pick_thermal(law, i):
    return Thermal(law.theta[i], law.c[i], law.zero[i], pick(law.kappa, i), pick(law.alpha, i))


@pick.register(Lumped)
def pick_lumped(law, i):
    return Lumped(law.conductance[i], law.outside[i])


@pick.register(Sourced)
def pick_sourced(law, i):
    return Sourced(law.conductance[i], law.outside[i], law.rate[i])


@pick.register(Expansion)
def pick_expansion(law, i):
    return Expansion(law.gamma[i], law.shift[i])


@pick.register(Latched)
def pick_latched(law, i):
    return Latched(law.gamma[i], law.shift[i], law.most[i], law.set[i])


@pick.register(Heating)
def pick_heating(law, i):
    return Heating(law.gamma[i], law.fraction[i])


def kinds(law):
    """What must be equal for laws to share a batch: types, and shapes of tables."""
    if isinstance(law, tuple):
        return (type(law), *map(kinds, law))
    return np.shape(law)


def stack(laws):
    """One law of arrays from laws of the same kinds."""
    first = laws[0]
    if isinstance(first, tuple):
        return type(first)(*(stack(list(column)) for column in zip(*laws, strict=True)))
    return np.array(laws, dtype=np.float64)
