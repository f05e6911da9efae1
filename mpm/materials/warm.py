"""Moduli that follow temperature: Young's modulus a law of temperature, Poisson's ratio constant.

tau = E(Theta) (2 mu_1 eps + lam_1 tr eps), mu_1 and lam_1 the Lame constants of E = 1: every modulus follows the one law, so the law at a temperature is
Hencky's with its two numbers scaled. A linear expansion coefficient keeps its strain: gamma(Theta) = 3 K(Theta) alpha_L (mpm.state.Softening).
"""

from typing import Any, NamedTuple

from mpm.materials.hencky import Hencky
from mpm.materials.roles import moduli_lanes, value, values, warmed


class HenckyWarm(NamedTuple):
    """Hencky's law with E(Theta).

    Good values  E > 0 at every temperature; the wave limit of the step follows the stiffest present temperature.
    Fails when   heat and work are to balance: Psi then has a term in E'(Theta) whose heat is left out (configs refuse elastic heating with it), so
                 what a body stores while it stiffens under strain is energy that no ledger shows.
    """

    one: Hencky  # of E = 1 Pa
    E: Any  # law of temperature [Pa]


@warmed.register(Hencky)
def warmed_hencky(law, theta):
    return law


@warmed.register(HenckyWarm)
def warmed_hencky_warm(law, theta):
    E = value(law.E, theta)
    return Hencky(law.one.mu * E, law.one.lam * E)


@moduli_lanes.register(HenckyWarm)
def moduli_lanes_hencky_warm(law, theta):
    E = values(law.E, theta)
    return law.one.lam * E, law.one.mu * E
