"""Surface pieces during a heat step: where they are now, and what they load on to the nodes (docs/physics.md 11, linear-exact).

load_i = dt S [q - beta (theta_s - outside)] w~_i,   theta_s = sum_j w~_j theta_j,   w~ = w + grad(w) (x_s - x_p)

Every wall and tool has its own beta and outside, but all share theta_s: with its integral over a heat step (`expose`) the heat of each is known.
"""

import numpy as np

from mpm.boundary import directions
from mpm.heat.exchange import meet
from mpm.heat.surface import area_and_offset
from mpm.jit import kernel, role
from mpm.state import Exposure, NoExchange, NoExposure, Surface
from mpm.transfer import gather_scalar, scatter_scalar


@role
def place(surface, space, body):
    """Present pieces: owner (S,), area (S,), offset (D, S)."""
    raise TypeError(f"no pieces of {type(surface).__name__}")


@place.register(NoExchange)
def place_no_exchange(surface, space, body):
    return np.zeros(0, np.int64), np.zeros(0), np.zeros((1, 0))


@place.register(Surface)
def place_surface(surface, space, body):
    D, S = directions(space), surface.owner.shape[0]
    area, offset, one = np.empty(S), np.empty((D, S)), np.zeros((D, 1))
    for s in range(S):
        p = surface.owner[s]
        area[s] = area_and_offset(space, surface.F, surface.row[p], body.particles.J[p], surface.area, surface.offset, s, one)
        for k in range(D):  # a slice assignment would compile the text of its own error
            offset[k, s] = one[k, 0]
    return surface.owner, area, offset


@kernel
def temperature_at(space, x, owner, offset, s, theta, work):
    """theta_s of piece s."""
    D = directions(space)
    at, slope, grad = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D]
    gather_scalar(space, x, owner[s], 1, theta, at, slope, grad)
    there = at[0]
    for k in range(D):
        there += grad[k, 0] * offset[k, s]
    return there


@kernel
def load_piece(space, x, owner, offset, s, load, rate, work):
    """rate_i += load w~_i."""
    D = directions(space)
    at, slope, grad = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D]
    at[0] = load
    for k in range(D):
        slope[k, 0], grad[k, 0] = 0.0, load * offset[k, s]
    scatter_scalar(space, x, owner[s], 1, at, slope, grad, rate)


@kernel
def exchange(body, space, pieces, thermal, theta, rate, dt, part, work):
    """What the surroundings do in dt at nodal temperatures `theta`, on to `rate`; returns the heat gained [J]."""
    owner, area, offset = pieces
    x, gained = body.particles.x, 0.0
    for s in range(owner.shape[0]):
        there = temperature_at(space, x, owner, offset, s, theta, work)
        beta, outside, q = meet(body.surface, s, there, thermal.zero, part)
        load = dt * area[s] * (q - beta * (there - outside))
        load_piece(space, x, owner, offset, s, load, rate, work)
        gained += load
    return gained


@role
def expose(surface, space, x, pieces, theta, time, part, work):
    """Integrals over `time` of a stage at nodal temperatures `theta`, `part` of the heat step gone, on to the surface's Exposure."""
    raise TypeError(f"no exposure of {type(surface).__name__}")


@expose.register(NoExchange)
def expose_no_exchange(surface, space, x, pieces, theta, time, part, work):
    return 0.0


@expose.register(Surface)
def expose_surface(surface, space, x, pieces, theta, time, part, work):
    return expose_pieces(surface.exposure, space, x, pieces, theta, time, part, work)


@role
def expose_pieces(exposure, space, x, pieces, theta, time, part, work):
    """See expose."""
    raise TypeError(f"no exposure in {type(exposure).__name__}")


@expose_pieces.register(NoExposure)
def expose_pieces_no_exposure(exposure, space, x, pieces, theta, time, part, work):
    return 0.0


@expose_pieces.register(Exposure)
def expose_pieces_exposure(exposure, space, x, pieces, theta, time, part, work):
    owner, area, offset = pieces
    for s in range(owner.shape[0]):
        exposure.area[s] += time * area[s]
        exposure.theta[s] += time * area[s] * temperature_at(space, x, owner, offset, s, theta, work)
        exposure.part[s] += time * area[s] * part
    return 0.0
