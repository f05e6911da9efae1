"""What a piece of surface meets: every exchange as a flux beta (outside - theta) + q into the body [W/m2].

convection   beta, outside                                               fixed temperature is beta = inf, held at PENALTY kappa/h
flux         q
radiation    beta_r = sigma e (T^2 + Ts^2)(T + Ts), outside = Ts         a secant of sigma e (T^4 - Ts^4), exact at the T [K] it is taken at

The secant, not the tangent: with T from before the step, an implicit step still ends between the surface's and the surroundings' temperature, however
long it is; a tangent at a cold T would overshoot.
"""

from mpm.jit import role
from mpm.state import NoExchange, NoRadiation, Radiation, Surface

STEFAN_BOLTZMANN = 5.670374419e-8  # [W/(m2 K4)], exact in the SI of 2019
PENALTY = 1e3  # of kappa/h: fixed temperature to within h/(PENALTY L) of the temperature difference
FIRMER = 100.0  # in the total frame, whose heat steps are implicit and else of order 3: that h/(PENALTY L) was what thermal_cylinder was off by


@role
def meet(surface, s, theta, zero, part):
    """(beta, outside less zero, q) of piece s at temperature `theta` less zero, `part` of the heat step gone."""
    raise TypeError(f"no exchange for {type(surface).__name__}")


@meet.register(NoExchange)
def meet_no_exchange(surface, s, theta, zero, part):
    return 0.0, 0.0, 0.0


@meet.register(Surface)
def meet_surface(surface, s, theta, zero, part):
    beta, outside = radiate(surface.radiation, s, theta, zero, part, surface.beta[s], surface.outside[s] + part * surface.drift[s])
    return beta, outside, surface.flux[s]


@role
def radiate(radiation, s, theta, zero, part, beta, outside):
    """beta and outside with radiation added."""
    raise TypeError(f"no radiation for {type(radiation).__name__}")


@radiate.register(NoRadiation)
def radiate_no_radiation(radiation, s, theta, zero, part, beta, outside):
    return beta, outside


@radiate.register(Radiation)
def radiate_radiation(radiation, s, theta, zero, part, beta, outside):
    T, sky = zero + theta, radiation.sky[s] + part * radiation.drift[s]
    own = STEFAN_BOLTZMANN * radiation.emissivity[s] * (T * T + sky * sky) * (T + sky)
    both = beta + own
    if both <= 0.0:
        return beta, outside
    return both, outside + own / both * (sky - zero - outside)
