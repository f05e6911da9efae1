"""What of a body is still in its nozzle moves as it is told (docs/physics.md 20).

x = place - behind way,   v = speed way,   C = 0,   B = 0,   J = 1,   F = 1,   no stress;   behind <- behind - speed dt, free once it is not above zero
On the nodes it is momentum m speed way, set anew in every step, so what has left it feels at the mouth that velocity and no other.
Work       m (speed way - v) . speed way of a particle that would go at v: force of the nozzle times its way; where the speed changes, the kinetic energy
Good values  nozzles of two cells and more: what has left one sees no node that anything but the nozzle's speed reaches
Fails when   what piles up before the mouth is to push back: a nozzle gives way to nothing
A body without an inflow compiles none of this.
"""

from typing import NamedTuple

import numpy as np

from mpm.integrate.given_source import act
from mpm.integrate.strain import WORKED
from mpm.jit import role
from mpm.state import PER_PARTICLE, NoExchange, Surface


class Nozzle(NamedTuple):
    """The particles of a body and where they are in its nozzle."""

    behind: np.ndarray  # (N,) how far behind the mouth [m]
    place: np.ndarray  # (N, D) where it passes the mouth [m]
    way: np.ndarray  # (D,) unit vector of the flow
    speed: np.ndarray  # (1,) of the nozzle in a block of steps [m/s]


PER_PARTICLE[Nozzle] = ("behind", "place")


@role
def unstretch(surface, i, D):
    """F of particle i is that of the start, where it owns pieces of surface."""
    raise TypeError(f"no surface {type(surface).__name__}")


@unstretch.register(NoExchange)
def unstretch_no_exchange(surface, i, D):
    return None


@unstretch.register(Surface)
def unstretch_surface(surface, i, D):
    if surface.row[i] >= 0:
        for c in range(D):
            for d in range(D):
                surface.F[surface.row[i], c, d] = 1.0 if c == d else 0.0


@act.register(Nozzle)
def act_nozzle(source, body, chunk, first, count, dt, next_dt, report):
    particles, speed = body.particles, source.speed[0]
    D = particles.v.shape[1]
    for p in range(count):
        i = first + p
        if source.behind[i] <= 0.0:
            continue
        source.behind[i] -= dt * speed
        for c in range(D):
            v, u = source.way[c] * speed, chunk.u[c, p]
            report[WORKED] += particles.m[i] * (v - u) * (v if dt > 0.0 else 0.5 * (v + u))
            x = source.place[i, c] - source.way[c] * source.behind[i]
            particles.x[i, c] = chunk.place[c, p] = x
            particles.v[i, c] = chunk.u[c, p] = v
            chunk.a[c, p] = particles.m[i] * v
            chunk.f[c, p] = 0.0
            for d in range(D):
                particles.C[i, c, d] = chunk.U[c, d, p] = chunk.A[c, d, p] = chunk.S[c, d, p] = 0.0
        for k in range(particles.B.shape[1]):
            particles.B[i, k] = 0.0
        particles.J[i] = 1.0
        unstretch(body.surface, i, D)
