"""Heat of a material point: its temperature less a zero, its enthalpy, and exchange as a lumped body.

R0 alpha dTheta/dt = -conductance J^(2/3) (Theta - outside) + rate     exact in any step for constant alpha and J
"""

import math

from mpm.heat.local import rise
from mpm.jit import role
from mpm.materials import LAWS, Constant, enthalpy, value
from mpm.point.state import Lumped, Sourced
from mpm.state import Isothermal, NoExchange, Thermal


@role
def above(thermal):
    """Temperature of the point less its zero [K]: where a run lives by small changes, their digits; 0 without heat."""
    raise TypeError(f"no temperature in {type(thermal).__name__}")


@above.register(Isothermal)
def above_isothermal(thermal):
    return 0.0


@above.register(Thermal)
def above_thermal(thermal):
    return thermal.theta[0]


@role
def datum(thermal):
    """The zero of `above` [K]."""
    raise TypeError(f"no temperature in {type(thermal).__name__}")


@datum.register(Isothermal)
def datum_isothermal(thermal):
    return thermal.temperature


@datum.register(Thermal)
def datum_thermal(thermal):
    return thermal.zero


@role
def put(thermal, theta):
    """Set the temperature of the point less its zero [K]."""
    raise TypeError(f"no temperature in {type(thermal).__name__}")


@put.register(Isothermal)
def put_isothermal(thermal, theta):
    return None


@put.register(Thermal)
def put_thermal(thermal, theta):
    thermal.theta[0] = theta


@role
def since(alpha, theta, zero):
    """Specific enthalpy at zero + theta less that at zero [J/kg]."""
    raise TypeError(f"{type(alpha).__name__} is no law of temperature")


@since.register(Constant)
def since_constant(alpha, theta, zero):
    return alpha.constant * theta


def since_through(alpha, theta, zero):
    return enthalpy(alpha, zero + theta) - enthalpy(alpha, zero)


for law in LAWS:
    if law is not Constant:
        since.register(law, since_through)


@role
def content(thermal):
    """Specific enthalpy less that at the zero of temperature [J/kg]; 0 without heat."""
    raise TypeError(f"no heat in {type(thermal).__name__}")


@content.register(Isothermal)
def content_isothermal(thermal):
    return 0.0


@content.register(Thermal)
def content_thermal(thermal):
    return since(thermal.alpha, thermal.theta[0], thermal.zero)


@role
def exchange(law, thermal, density, swell, dt):
    """Exchange heat for `dt`; returns the heat gained [J/m3 of reference]."""
    raise TypeError(f"no exchange {type(law).__name__}")


@exchange.register(NoExchange)
def exchange_no_exchange(law, thermal, density, swell, dt):
    return 0.0


@exchange.register(Lumped)
def exchange_lumped(law, thermal, density, swell, dt):
    # Exact for constant alpha. Otherwise alpha of the middle of the step (order 2), the heat through enthalpy and never past the surroundings.
    theta = thermal.zero + thermal.theta[0]
    gap = law.outside - theta
    flux = law.conductance * swell ** (2.0 / 3.0)
    capacity = density * value(thermal.alpha, theta)
    half = -capacity * gap * math.expm1(-0.5 * dt * flux / capacity)
    capacity = density * value(thermal.alpha, theta + rise(thermal.alpha, theta, half / density))
    heat = -capacity * gap * math.expm1(-dt * flux / capacity)
    most = density * (enthalpy(thermal.alpha, law.outside) - enthalpy(thermal.alpha, theta))
    if abs(heat) >= abs(most):
        thermal.theta[0] = law.outside - thermal.zero
        return most
    thermal.theta[0] += rise(thermal.alpha, theta, heat / density)
    return heat


@exchange.register(Sourced)
def exchange_sourced(law, thermal, density, swell, dt):
    if law.conductance == 0.0:
        thermal.theta[0] += rise(thermal.alpha, thermal.zero + thermal.theta[0], dt * law.rate / density)
        return dt * law.rate
    return exchange(Lumped(law.conductance, law.outside + law.rate / (law.conductance * swell ** (2.0 / 3.0))), thermal, density, swell, dt)


@role
def time_constant(law, thermal, density):
    """R0 alpha/conductance of the lumped body [s]; inf without exchange."""
    raise TypeError(f"no exchange {type(law).__name__}")


@time_constant.register(NoExchange)
def time_constant_no_exchange(law, thermal, density):
    return math.inf


@time_constant.register(Lumped)
def time_constant_lumped(law, thermal, density):
    if law.conductance == 0.0 or law.conductance == math.inf:
        return math.inf
    return density * value(thermal.alpha, thermal.zero + thermal.theta[0]) / law.conductance


@time_constant.register(Sourced)
def time_constant_sourced(law, thermal, density):
    return time_constant(Lumped(law.conductance, law.outside), thermal, density)
