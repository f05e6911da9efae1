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

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, empty, fold, unfold
from mpm.heat.local import rise
from mpm.integrate.timestep import conductance
from mpm.jit import kernel
from mpm.materials.laws import enthalpy
from mpm.state import NoExchange, Radiation, Thermal
from mpm.transfer import gather_scalar, scatter_scalar

FIELDS = 3  # scratch


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
    excess, room, some = np.zeros(N), np.zeros(N), np.zeros(N, np.bool_)
    at_bound = enthalpy(thermal.alpha, thermal.zero + bound)
    whole, space_left = 0.0, 0.0
    for i in range(N):
        beyond = sign * m[i] * (enthalpy(thermal.alpha, thermal.zero + theta[i]) - at_bound)
        excess[i], room[i], some[i] = max(beyond, 0.0), max(-beyond, 0.0), beyond > 0.0
    for i in range(N):  # sums apart from stores keep their bits, whichever arrays are neighbours
        whole += excess[i]
        space_left += room[i]
    if space_left < whole:
        return 0.0, whole
    beyond_at, room_at, near = nodes[0], nodes[1], nodes[2]
    work = np.zeros((1 + 3 * D, 1))
    value, slope, grad, zero = work[0], work[1 : 1 + D], work[1 + D : 1 + 2 * D], work[1 + 2 * D : 1 + 3 * D]
    box = reach_of(space, x, some)
    scatter_some(space, x, some, excess, zero, beyond_at)
    fold(beyond_at.reshape(-1, 1), 0, shape, box, walls)
    unfold(beyond_at.reshape(-1, 1), 0, shape, box, walls)
    beside(space, x, beyond_at, box, near, some)
    grown = reach_of(space, x, some)
    for a in range(3):
        box[a, 0], box[a, 1] = min(box[a, 0], grown[a, 0]), max(box[a, 1], grown[a, 1])
    scatter_some(space, x, some, room, zero, room_at)
    fold(room_at.reshape(-1, 1), 0, shape, box, walls)
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                beyond_at[n] = min(1.0, beyond_at[n] / room_at[n]) if room_at[n] > 0.0 else 0.0
    unfold(beyond_at.reshape(-1, 1), 0, shape, box, walls)
    given = 0.0
    taken = np.zeros(N)
    for i in range(N):
        if some[i]:
            gather_scalar(space, x, i, 1, beyond_at, value, slope, grad)
            taken[i] = room[i] * min(value[0], 1.0)
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
    clear(beyond_at.reshape(-1, 1), shape, box.copy())
    clear(room_at.reshape(-1, 1), shape, box)
    return whole, 0.0


@kernel
def scatter_some(space, x, some, values, zero, nodes):
    """nodes_i += sum w values, of `some` particles."""
    for i in range(x.shape[0]):
        if some[i]:
            scatter_scalar(space, x, i, 1, values[i : i + 1], zero, zero, nodes)


@kernel
def reach_of(space, x, some):
    """The box (3, 2) of nodes that `some` particles touch."""
    box = np.empty((3, 2), np.int64)
    empty(extents(space), box)
    for i in range(x.shape[0]):
        if some[i]:
            for a in range(x.shape[1]):
                i0, w, _, _, _ = stencil(space.basis, x[i, a] / space.h)
                box[a, 0], box[a, 1] = min(box[a, 0], i0), max(box[a, 1], i0 + len(w))
    return box


@kernel
def beside(space, x, nodes, box, near, some):
    """some: which particles touch a node of `box` where `nodes` is not nothing. near (n,): scratch, zero before and after."""
    D, shape, seen = directions(space), extents(space), len(stencil(space.basis, 0.5)[1])
    stride, begins = (shape[1] * shape[2], shape[2], 1), box.copy()  # of stencils that reach into the box
    for a in range(D):
        begins[a, 0] = max(box[a, 0] - seen + 1, 0)
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                near[n] = nodes[n]
    for a in range(D):  # the largest of the stencil that begins at a node, one direction after another: what is read is not yet written over
        for i in range(begins[0, 0], box[0, 1]):
            for j in range(begins[1, 0], box[1, 1]):
                for k in range(begins[2, 0], box[2, 1]):
                    n = i * stride[0] + j * stride[1] + k
                    for m in range(1, min(seen, box[a, 1] - (i, j, k)[a])):
                        near[n] = max(near[n], near[n + m * stride[a]])
    for p in range(x.shape[0]):
        n, inside = 0, True
        for a in range(D):
            first = stencil(space.basis, x[p, a] / space.h)[0]
            inside = inside and begins[a, 0] <= first < box[a, 1]
            n += first * stride[a]
        some[p] = inside and near[n] > 0.0
    clear(near.reshape(-1, 1), shape, begins)
