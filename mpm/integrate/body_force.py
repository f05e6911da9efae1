"""A force and a heat source of their own at every particle: what a manufactured solution asks for.

impulse   m b(X, t) dt on to the nodes with the stress;   heat   theta grows by r(X, t + dt/2) dt through the enthalpy
Laws are in mpm.sources. A body without a source compiles none of this.
"""

from mpm.heat.local import rise
from mpm.integrate.strain import HEATED, WORKED
from mpm.jit import role
from mpm.sources import heat, push
from mpm.state import Isothermal, NoSource, Source, Thermal


@role
def take_up(thermal, i, joule):
    """Particle i takes up `joule` [J/kg]; returns what it took."""
    raise TypeError(f"no heat in {type(thermal).__name__}")


@take_up.register(Isothermal)
def take_up_isothermal(thermal, i, joule):
    return 0.0


@take_up.register(Thermal)
def take_up_thermal(thermal, i, joule):
    thermal.theta[i] += rise(thermal.alpha, thermal.zero + thermal.theta[i], joule)
    return joule


@role(inline=True)
def act(source, body, chunk, first, count, dt, next_dt, report):
    """After `respond`: heat of the past step `dt`, impulse of the coming one, on to chunk.f."""
    raise TypeError(f"no source {type(source).__name__}")


@act.register(NoSource)
def act_no_source(source, body, chunk, first, count, dt, next_dt, report):
    return None


@act.register(Source)
def act_source(source, body, chunk, first, count, dt, next_dt, report):
    particles = body.particles
    for p in range(count):
        i = first + p
        if dt > 0.0:
            report[HEATED] += particles.m[i] * take_up(body.thermal, i, dt * heat(source.law, source.X, i, source.t[i] + 0.5 * dt))
            for c in range(particles.v.shape[1]):
                report[WORKED] += dt * particles.m[i] * push(source.law, source.X, i, c, source.t[i]) * chunk.v[c, p]
            source.t[i] += dt
        for c in range(particles.v.shape[1]):
            chunk.f[c, p] += next_dt * particles.m[i] * push(source.law, source.X, i, c, source.t[i])
