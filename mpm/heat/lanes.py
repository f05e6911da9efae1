"""Heat over lanes: what a law of temperature says of a row of particles, the rise that heat gives them, and heating eight at once (mpm.heat.local, one by one).

Rows are float64 whatever the particles are, and at least as long as the whole eights that `count` needs: what lies behind the last one repeats it.
"""

from mpm.jit import kernel, role
from mpm.lanes import EIGHT, expm1, like, load8, store
from mpm.materials import LAWS, enthalpies, temperatures, values
from mpm.materials.laws import Constant
from mpm.state import GridHeating, Heating, Isothermal, NoHeating, Thermal


@role(inline=True)
def rises(alpha, theta, heat):
    """`rise` over lanes."""
    raise TypeError(f"{type(alpha).__name__} is no law of temperature")


@rises.register(Constant)
def rises_constant(alpha, theta, heat):
    return heat / alpha.constant


def rises_through(alpha, theta, heat):
    return temperatures(alpha, enthalpies(alpha, theta) + heat, theta) - theta


for law in LAWS:
    if law is not Constant:
        rises.register(law, rises_through)


@kernel
def filled(row, count):
    """Repeats the last of the first `count` of a row up to a whole eight."""
    for p in range(count, -(-count // EIGHT) * EIGHT):
        row[p] = row[count - 1]


@kernel
def specify(law, row, count):
    """Temperatures [K] become what the law says of them."""
    filled(row, count)
    for p in range(0, count, EIGHT):
        store(row, p, values(law, load8(row, p)))


@kernel
def warm_up(alpha, theta, change, count):
    """Changes at constant alpha [K] become those through enthalpy, from temperatures theta [K]: the same heat."""
    filled(theta, count)
    filled(change, count)
    for p in range(0, count, EIGHT):
        before = load8(theta, p)
        store(change, p, rises(alpha, before, values(alpha, before) * load8(change, p)))


@role(inline=True)
def grow_warmer(thermal, i, rise):
    """Adds to the temperature of particle i."""
    raise TypeError(f"no temperature in {type(thermal).__name__}")


@grow_warmer.register(Isothermal)
def grow_warmer_isothermal(thermal, i, rise):
    return None


@grow_warmer.register(Thermal)
def grow_warmer_thermal(thermal, i, rise):
    thermal.theta[i] += rise


@role(inline=True)
def heat_eight(heating, thermal, theta, density, stretched, dissipated):
    """`heat_locally` over lanes of temperatures [K]: (heat gained [J/m3 of reference], rise [K])."""
    raise TypeError(f"no heating in {type(heating).__name__}")


@heat_eight.register(NoHeating)
def heat_eight_no_heating(heating, thermal, theta, density, stretched, dissipated):
    return like(theta, 0.0), like(theta, 0.0)


@heat_eight.register(Heating)
def heat_eight_heating(heating, thermal, theta, density, stretched, dissipated):
    capacity = density * values(thermal.alpha, theta)
    gained = capacity * theta * expm1(stretched * (-heating.gamma / capacity)) + heating.fraction * dissipated
    return gained, rises(thermal.alpha, theta, gained / density)


@heat_eight.register(GridHeating)
def heat_eight_grid_heating(heating, thermal, theta, density, stretched, dissipated):
    gained = heating.fraction * dissipated
    return gained, rises(thermal.alpha, theta, gained / density)
