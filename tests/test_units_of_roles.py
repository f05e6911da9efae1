"""Every law of the menus on quantities with units, in plain Python: right units go through and come out right; each argument in a wrong unit fails.

Wrong is a metre more: an argument in pascal is given in pascal metre. It must raise, or leave a result that is not of the promised unit.
"""

import os
import subprocess
import sys

SCRIPT = '''
import math

import numpy as np
import pint

import mpm.heat.exchange as exchange
from mpm.heat.exchange import meet
from mpm.heat.local import heat_locally, latch, rise, temperature, thermal_stress
from mpm.materials import (
    ELASTIC, FLOW, LAWS, Bump, Constant, EllipseClipped, EllipseRadial, Hencky, HenckyWarm, Logistic, NoFlow, Porous, Table, energy, enthalpy, flow, moduli,
    settled, stress, table, temperature_of, value, warmed,
)
from mpm.point.heat import content, exchange as lump, time_constant
from mpm.point.state import Lumped, Sourced
from mpm.point.step import relaxation
from mpm.sources import Made, heat, push
from mpm.state import Expansion, GridHeating, Heating, Isothermal, Latched, NoExpansion, NoHeating, NoRadiation, Radiation, Softening, Surface, Thermal

u = pint.UnitRegistry()
Q = u.Quantity
exchange.STEFAN_BOLTZMANN = exchange.STEFAN_BOLTZMANN * u.W / u.m**2 / u.K**4
seen = set()


def spoiled(thing, at, wrong):
    """A copy of nested tuples and lists with the leaf at path `at` replaced."""
    if not at:
        return wrong
    if isinstance(thing, tuple):
        fields = [spoiled(item, at[1:], wrong) if k == at[0] else copied(item) for k, item in enumerate(thing)]
        return type(thing)(*fields) if hasattr(thing, "_fields") else tuple(fields)
    out = copied(thing)
    if isinstance(out, np.ndarray):
        out[np.unravel_index(at[0], out.shape)] = wrong
    else:
        out[at[0]] = spoiled(out[at[0]], at[1:], wrong)
    return out


def copied(thing):
    if isinstance(thing, tuple):
        return type(thing)(*map(copied, thing)) if hasattr(thing, "_fields") else tuple(map(copied, thing))
    return [copied(item) for item in thing] if isinstance(thing, list) else thing.copy() if isinstance(thing, np.ndarray) and thing.ndim else thing


def leaves(thing, path=()):
    if isinstance(thing, Q) and not isinstance(thing.m, np.ndarray):
        yield path, thing
    elif isinstance(thing, np.ndarray):
        for k, item in enumerate(thing.ravel()):
            yield (*path, k), item
    elif isinstance(thing, (tuple, list)):
        for k, item in enumerate(thing):
            yield from leaves(item, (*path, k))


def units(function, arguments, *promised, free=()):
    """Call it; then once for every quantity in its arguments, a metre too much. `free`: paths that this call does not read."""
    seen.add(type(arguments[0]).__name__)

    def call(given):
        found = function(*given)
        found = found if isinstance(found, tuple) else (found,)
        for one, unit in zip(found, promised):
            if unit is not None:
                Q(one).to(unit)

    call(copied(arguments))
    for path, good in leaves(arguments):
        if any(path[: len(one)] == one for one in free):
            continue
        bad = spoiled(arguments, path, good * u.m)
        try:
            call(bad)
        except (pint.DimensionalityError, TypeError):
            continue
        except ValueError as error:  # how pint refuses to compare a length with a number
            assert "Cannot compare" in str(error), error
            continue
        raise AssertionError(f"{function.__name__} {type(arguments[0]).__name__}: {path} ({good}) may be anything")


J, K, Pa = u.J, u.K, u.Pa
theta = 340 * K
strains = (Q(0.02), Q(-0.03), Q(0.001))
solid = Hencky(1e5 * Pa, 1.5e5 * Pa)


def tabled(temperatures, values, unit):
    """A table whose entries have units."""
    bare = table(temperatures, values, "pchip")
    c, h = np.empty(bare.c.shape, object), np.empty(len(bare.h), object)
    for k, p in np.ndindex(*bare.c.shape):
        c[k, p] = bare.c[k, p] * unit / K**p
    for k in range(len(h)):
        h[k] = bare.h[k] * unit * K
    return Table([t * K for t in bare.theta], c, list(h))


def laws(unit):
    """One of each kind around 340 K."""
    return [Constant(2.0 * unit), Bump(2.0 * unit, 20.0 * unit * K, 345 * K, 4 * K), Logistic(1.0 * unit, 3.0 * unit, 342 * K, 5 * K),
            tabled([300, 338, 350, 400], [1, 2, 3, 2], unit)]


alpha = 1000 * J / u.kg / K
assert {type(law) for law in laws(alpha)} == set(LAWS)
for law in laws(alpha):
    off = {Table: [(0, 1, k) for k in (0, 1, 2, 3, 8, 9, 10, 11)] + [(0, 2, k) for k in (0, 2, 3)]}.get(type(law), [])  # pieces that 340 K is not in
    ends = [(0, 0, k) for k in range(4)]  # temperatures only compared with: a comparison of kelvin with kelvin metre raises, but not all are reached
    units(value, (law, theta), "J/kg/K", free=off + [(0, 2)] + ends + ([(1,)] if isinstance(law, Constant) else []))
    units(enthalpy, (law, theta), "J/kg", free=off + ends)
    for guess in (330 * K, 341 * K):
        h = enthalpy(law, 341 * K)
        if not isinstance(law, Table):
            units(temperature_of, (law, h, guess), "K", free=[(2,)] if isinstance(law, Constant) else [])
        assert abs(temperature_of(law, h, guess).to("K").m - 341) < 1e-7
    units(rise, (law, theta, 500 * J / u.kg), "K", free=off + ends + [(1,)] * isinstance(law, Constant) + [(0, 2)] * isinstance(law, Table))

units(stress, (solid, *strains, 100 * Pa), "Pa", "Pa", "Pa")
units(energy, (solid, *strains), "J/m^3")
assert {Hencky} <= set(ELASTIC)
stiff = HenckyWarm(Hencky(Q(0.4), Q(0.3)), Logistic(1e4 * Pa, 5e4 * Pa, 342 * K, 5 * K))
units(lambda law, theta: moduli(warmed(law, theta)), (stiff, theta), "Pa", "Pa")
units(lambda law, theta: stress(warmed(law, theta), *strains, 100 * Pa), (stiff, theta), "Pa", "Pa", "Pa")

steps, eta, p0 = Logistic(2 * u.kPa, 500 * Pa, 330 * K, 3 * K), Constant(50 * Pa * u.s), Logistic(Q(0.5), Q(0.9), 342 * K, 5 * K)
assert set(FLOW) == {NoFlow, EllipseRadial, EllipseClipped}
for kind in (EllipseRadial, EllipseClipped):
    law = kind(steps, p0, eta)
    units(flow, (law, solid, *strains, 100 * Pa, theta, 1e-4 * u.s), "", "", "", "J/m^3")
    units(relaxation, (law, solid, theta), "s", "")
    porous = kind(Constant(2e3 * Pa), Porous(Q(0.4), 2.0), eta)
    units(lambda law, J: settled(law, J).p0.constant, (porous, Q(0.9)), "", free=[(0, 0), (0, 2)])


def thermal(alpha=Constant(alpha)):
    return Thermal([20 * K, 40 * K], None, 300 * K, None, alpha)


read = [(1, 0, 0)]  # of two particles the second is asked for
units(temperature, (thermal(), 1), "K", free=[(0, 0, 0), (0, 4)])
units(temperature, (Isothermal(theta), 1), "K")
expansion = Expansion(20 * Pa / K, -10 * K)
unread = [(1, 0, 0), (1, 2), (1, 4)]
units(thermal_stress, (expansion, thermal(), 1, theta), "Pa", free=[*unread, (3,)])
latched = Latched(20 * Pa / K, -10 * K, [10 * K, 25 * K], 35 * K)
units(thermal_stress, (latched, thermal(), 1, theta), "Pa", free=[*unread, (0, 2, 0), (3,)])
units(lambda law, thermal, i: (latch(law, thermal, i), law.most[i])[1], (latched, thermal(), 1), "K", free=[*unread, (0, 2, 0), (0, 0), (0, 1)])
units(thermal_stress, (Softening(Expansion(1e-3 / K, -10 * K), stiff.E), thermal(), 1, theta), "Pa", free=[(1, 0, 0), (1, 4), (1, 2)])
assert thermal_stress(NoExpansion(), thermal(), 1, theta) == 0.0

R0, lost = 300 * u.kg / u.m**3, 40 * J / u.m**3
hot = Heating(20 * Pa / K, Q(0.9))
for capacity in laws(alpha)[:3]:
    units(heat_locally, (hot, thermal(capacity), 1, R0, Q(-0.01), lost), "J/m^3", free=[(1, 0, 0)])
grid = GridHeating(20 * Pa / K, Q(0.9), None, None)
units(heat_locally, (grid, thermal(), 1, R0, Q(-0.01), lost), "J/m^3", free=[(0, 0), (1, 0, 0), (1, 2), (4,)])
assert heat_locally(NoHeating(), thermal(), 1, R0, Q(-0.01), lost) == 0.0

beta, W = 12 * u.W / u.m**2 / K, u.W
for radiation in (NoRadiation(), Radiation([Q(0.9)], [450 * K], [5 * K])):
    surface = Surface(None, None, None, None, None, [beta], [20 * K], [3 * K], [50 * W / u.m**2], radiation)
    units(meet, (surface, 0, 40 * K, 300 * K, Q(0.5)), "W/m^2/K", "K", "W/m^2", free=[(2,), (3,)] if isinstance(radiation, NoRadiation) else [])
units(lump, (Lumped(20 * W / u.m**3 / K, 400 * K), Thermal([20 * K], None, 300 * K, None, Constant(alpha)), R0, Q(1.1), 3 * u.s), "J/m^3")
units(lump, (Sourced(20 * W / u.m**3 / K, 400 * K, 50 * W / u.m**3), Thermal([20 * K], None, 300 * K, None, Constant(alpha)), R0, Q(1.1), 3 * u.s), "J/m^3")
units(time_constant, (Lumped(20 * W / u.m**3 / K, 400 * K), thermal(), R0), "s", free=[(0, 1), (1, 0), (1, 2)])
units(content, (Thermal([20 * K], None, 300 * K, None, Constant(alpha)),), "J/kg", free=[(0, 2)])

motion = Made(1e5 * Pa, 1.5e5 * Pa, 70 * Pa / K, 1500 * u.kg / u.m**3, alpha, 0.3 * W / u.m / K, 300 * K, 0.05 * u.m, 2 * K, 3 / u.s, 2 / u.s, math.pi / u.m)
X = np.empty((1, 2), object)
X[0, 0], X[0, 1] = 0.3 * u.m, 0.4 * u.m
units(push, (motion, X, 0, 0, 0.2 * u.s), "m/s^2", free=[(0, 4), (0, 5), (0, 6)])
units(heat, (motion, X, 0, 0.2 * u.s), "W/kg", free=[(0, 0), (0, 1)])
print("units hold for", len(seen), "kinds")
'''


def test_every_law_on_quantities():
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=False)
    assert done.stdout.startswith("units hold for"), done.stderr
