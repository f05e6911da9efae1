"""Temperatures of a moving body kept between their bounds, heat kept to round-off: conservative repair after a heat step (Shashkov & Wendroff 2004).

Exchange and conduction alone take no particle beyond what body and surroundings had at the start of the step; weights that are exact to first order, affine
transfers, FLIP's noise and the consistent products of splines all do, at corners and sharp fronts. What lies beyond a bound is moved to the neighbours:
    excess e_p = m (h_p - h_bound) > 0,   room r_p = m (h_bound - h_p) > 0,   E_i = sum w e,  R_i = sum w r,   r_p sum_i w_ip min(1, E_i/R_i) is received
and what they have no room for goes to all particles, by their room. Heat is counted as enthalpy, so latent heat is kept too.
It is the default (`method.bounds: free` does without), as it costs APIC neither order nor time. Measured, with it, and without where that differs:
    configs/verification/robin_slab_particles.yaml, n = 16, 32, 64: APIC 8.58e-4, 2.04e-4, 4.57e-5 (Bi = 10), 7.43e-4, 1.68e-4, 4.66e-5 (beta = inf). Behind
    beta = inf affine FLIP 6.80e-4, 2.20e-4, 1.86e-4, without 6.73e-4, 2.19e-4, 1.94e-4; FLIP 1.9e-3, 9.4e-4, 6.1e-4, without 1.6e-2, 6.2e-3, 2.4e-3;
    XPIC 9.7e-4, 2.4e-4, 6.0e-5 (Bi = 10), 8.7e-4, 2.1e-4, 5.4e-5 (beta = inf)
FLIP carries no slopes, so nodes outside a surface read the particles inside, too warm by O(h d theta/dn), and the grid meets the temperature that a side
is held at only while particles beside it lie beyond the bound by as much. To bring those back at every step is an exchange that no law asks for (FLIP
1.7e-2 at n = 64). So beside such a side (`needs_slopes`) FLIP keeps slopes while it is repaired; XPIC keeps them beside every surface (integrate/xpic.py).
    slump.yaml, beta = 2000: without it 3.1 % of the range below its start; beta = 5000, kappa = 0.1, alpha = 4000: 10 %; 0.61 s of processor, without 0.62 s
A box of three cells, 2-D, Bi_h = 10: APIC passes the bounds by 8 % without, FLIP by 51 %.
Good values  with APIC and affine FLIP.
Fails when   FLIP cools through the touch of another body; the body as a whole has left the bounds (none of its particles
             has room): then the rest stays where it was, and the result says `heat_unrepaired`.
"""

import math

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, fold, unfold
from mpm.heat.local import rise
from mpm.integrate.heat_step import reach
from mpm.integrate.timestep import conductance
from mpm.jit import kernel
from mpm.materials.laws import enthalpy
from mpm.state import NoExchange, Radiation, Thermal
from mpm.transfer import CHUNK, gather_scalar, scatter_scalar

FIELDS = 2  # scratch


def bounds_of(body, seen: np.ndarray) -> tuple[float, float]:
    """Lowest and highest temperature, less zero, that the heat step ahead may lead to: those of the body and of what surrounded it so far, which `seen` (2,)
    remembers; none where a flux is given that way. What heats a body from within has done so before the step.
    """
    surface = body.surface
    seen[:] = min(seen[0], np.min(body.thermal.theta)), max(seen[1], np.max(body.thermal.theta))
    if isinstance(surface, NoExchange):
        return seen[0], seen[1]
    ends = [np.concatenate([surface.outside, surface.outside + surface.drift])[np.tile(surface.beta > 0, 2)]]
    if isinstance(surface.radiation, Radiation):
        sky = surface.radiation.sky - body.thermal.zero
        ends.append(np.concatenate([sky, sky + surface.radiation.drift])[np.tile(surface.radiation.emissivity > 0, 2)])
    around = np.concatenate(ends)
    seen[:] = low, high = around.min(initial=seen[0]), around.max(initial=seen[1])
    return -math.inf if surface.flux.min(initial=0.0) < 0 else low, math.inf if surface.flux.max(initial=0.0) > 0 else high


def needs_slopes(scene, body, repaired: bool) -> bool:
    """Whether a transfer that has none is to keep slopes: XPIC beside any surface; FLIP, where repaired, beside a side that all but holds its surface at
    the temperature outside, beta h > kappa."""
    if scene.blend == 1 or isinstance(body.surface, NoExchange) or not isinstance(body.thermal, Thermal):
        return False
    if scene.sharp:
        return True
    return repaired and float(body.surface.beta.max(initial=0.0)) * scene.space.h > conductance(body.thermal)[0]


def keep_between(space, body, nodes, walls, low: float, high: float) -> tuple[float, float]:
    """(heat moved, heat that found no room) [J]; nodes: (FIELDS, n) scratch, zero before and after."""
    moved = left = 0.0
    for bound, sign in ((high, 1.0), (low, -1.0)):
        if math.isfinite(bound) and np.any(sign * (body.thermal.theta - bound) > 0):
            some, rest = repair(space, body.particles, body.thermal, nodes, walls, bound, sign)
            moved, left = moved + some, left + rest
    return moved, left


@kernel
def repair(space, particles, thermal, nodes, walls, bound, sign):
    """Move what lies above `bound` (sign 1), or is missing below it (sign -1): (heat moved, heat left where it was)."""
    x, m, theta = particles.x, particles.m, thermal.theta
    N, D, shape = x.shape[0], directions(space), extents(space)
    excess, room = np.zeros(N), np.zeros(N)
    at_bound = enthalpy(thermal.alpha, thermal.zero + bound)
    whole, space_left = 0.0, 0.0
    for i in range(N):
        beyond = sign * m[i] * (enthalpy(thermal.alpha, thermal.zero + theta[i]) - at_bound)
        excess[i], room[i] = max(beyond, 0.0), max(-beyond, 0.0)
    for i in range(N):  # sums apart from stores keep their bits, whichever arrays are neighbours
        whole += excess[i]
        space_left += room[i]
    if space_left < whole:
        return 0.0, whole
    beyond_at, room_at = nodes[0], nodes[1]
    work = np.zeros((1 + 3 * D, CHUNK))
    value, slope, grad, zero = work[0], work[1 : 1 + D], work[1 + D : 1 + 2 * D], work[1 + 2 * D : 1 + 3 * D]
    for first in range(0, N, CHUNK):
        count = min(CHUNK, N - first)
        scatter_scalar(space, x, first, count, excess[first : first + count], zero, zero, beyond_at)
        scatter_scalar(space, x, first, count, room[first : first + count], zero, zero, room_at)
    box = reach(space, x)
    fold(beyond_at.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(room_at.reshape(-1, 1), 0, shape, box, walls)
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                beyond_at[n] = min(1.0, beyond_at[n] / room_at[n]) if room_at[n] > 0.0 else 0.0
    unfold(beyond_at.reshape(-1, 1), 0, shape, box, walls)
    given = 0.0
    taken = np.zeros(N)
    for first in range(0, N, CHUNK):
        count = min(CHUNK, N - first)
        gather_scalar(space, x, first, count, beyond_at, value, slope, grad)
        for p in range(count):
            taken[first + p] = room[first + p] * min(value[p], 1.0)
    for i in range(N):
        given += taken[i]
    share = max(0.0, whole - given) / (space_left - given) if space_left > given else 0.0
    for i in range(N):
        if excess[i] > 0.0:
            theta[i] = bound
        elif room[i] > 0.0:
            heat = sign * (taken[i] + share * (room[i] - taken[i]))
            warmer = theta[i] + rise(thermal.alpha, thermal.zero + theta[i], heat / m[i])
            theta[i] = sign * min(sign * warmer, sign * bound)
    for field in range(FIELDS):
        used = box.copy()
        clear(nodes[field].reshape(-1, 1), shape, used)
    return whole, 0.0
