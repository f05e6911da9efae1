"""What deformation and temperature do to each other at a particle: thermal stress, heating along the adiabat, heat of dissipation.

thermal stress   gamma (Theta - Theta_0)                                                     docs/physics.md 1
latched          gamma (min(max over time of Theta, T_set) - Theta_0)                        docs/physics.md 10
heating          Theta <- Theta exp(-gamma/(R0 alpha) (tr eps_new - tr eps_old)) + chi_d D/(R0 alpha)   docs/physics.md 4, step 7
The exponential is the exact adiabat, so any step gives Theta = Theta_0 J^-Gamma.
"""

import math

from mpm.jit import role
from mpm.materials import LAWS
from mpm.materials.laws import Constant, enthalpy, temperature_of, value
from mpm.state import Expansion, GridHeating, Heating, Isothermal, Latched, NoExpansion, NoHeating, Softening, Thermal


@role
def rise(alpha, theta, heat):
    """Temperature rise [K] of one kilogram at `theta` [K] that takes up `heat` [J/kg]: through enthalpy, so no step jumps over latent heat."""
    raise TypeError(f"{type(alpha).__name__} is no law of temperature")


@rise.register(Constant)
def rise_constant(alpha, theta, heat):
    return heat / alpha.constant


def rise_through(alpha, theta, heat):
    return temperature_of(alpha, enthalpy(alpha, theta) + heat, theta) - theta


for law in LAWS:
    if law is not Constant:
        rise.register(law, rise_through)  # one by one: compiled code does not see the function that a role falls back to


@role
def temperature(thermal, i):
    """Absolute temperature of particle i [K]."""
    raise TypeError(f"no temperature in {type(thermal).__name__}")


@temperature.register(Isothermal)
def temperature_isothermal(thermal, i):
    return thermal.temperature


@temperature.register(Thermal)
def temperature_thermal(thermal, i):
    return thermal.zero + thermal.theta[i]


@role
def thermal_stress(expansion, thermal, i, at):
    """gamma (Theta - Theta_0) of particle i [Pa]; `at` is what its laws are asked with (mpm.heat.setting.condition)."""
    raise TypeError(f"no thermal stress in {type(expansion).__name__}")


@thermal_stress.register(NoExpansion)
def thermal_stress_no_expansion(expansion, thermal, i, at):
    return 0.0


@thermal_stress.register(Expansion)
def thermal_stress_expansion(expansion, thermal, i, at):
    return expansion.gamma * (thermal.theta[i] + expansion.shift)


@thermal_stress.register(Latched)
def thermal_stress_latched(expansion, thermal, i, at):
    return expansion.gamma * (max(expansion.most[i], min(thermal.theta[i], expansion.set)) + expansion.shift)


@thermal_stress.register(Softening)
def thermal_stress_softening(expansion, thermal, i, at):
    return value(expansion.E, at) * thermal_stress(expansion.inner, thermal, i, at)


@role
def latch(expansion, thermal, i):
    """Remember what particle i has reached, at the end of a step."""
    raise TypeError(f"nothing to latch in {type(expansion).__name__}")


@latch.register(NoExpansion)
@latch.register(Expansion)
def latch_expansion_or_no_expansion(expansion, thermal, i):
    return None


@latch.register(Latched)
def latch_latched(expansion, thermal, i):
    expansion.most[i] = max(expansion.most[i], min(thermal.theta[i], expansion.set))


@latch.register(Softening)
def latch_softening(expansion, thermal, i):
    latch(expansion.inner, thermal, i)


@role
def heat_locally(heating, thermal, i, density, stretched, dissipated):
    """Heat particle i after tr eps grew by `stretched` and `dissipated` [J/m3 of reference] was lost; returns the heat gained [J/m3]."""
    raise TypeError(f"no heating in {type(heating).__name__}")


@heat_locally.register(NoHeating)
def heat_locally_no_heating(heating, thermal, i, density, stretched, dissipated):
    return 0.0


@heat_locally.register(Heating)
def heat_locally_heating(heating, thermal, i, density, stretched, dissipated):
    theta = thermal.zero + thermal.theta[i]
    alpha = value(thermal.alpha, theta)
    gained = density * alpha * theta * math.expm1(-heating.gamma / (density * alpha) * stretched) + heating.fraction * dissipated
    thermal.theta[i] += rise(thermal.alpha, theta, gained / density)
    return gained


@heat_locally.register(GridHeating)
def heat_locally_grid_heating(heating, thermal, i, density, stretched, dissipated):
    theta = thermal.zero + thermal.theta[i]
    gained = heating.fraction * dissipated
    thermal.theta[i] += rise(thermal.alpha, theta, gained / density)
    return gained
