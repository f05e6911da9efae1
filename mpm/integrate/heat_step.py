"""One explicit heat step (docs/physics.md 3, 10, 11).

C_i = sum alpha m w,   C_i theta_i = sum alpha m w (theta_p + c_p d)
C_i d(theta_i) = dt [ sum V q grad(w) - sum S beta (theta_s - theta_out) w~ ],   q = -kappa grad(theta),   w~: integrate/surface_flux.py
theta_p += sum w d(theta_i) + blend (sum w theta_i - theta_p),   c_p = affine sum w theta_i+ d/(sum w d^2)      alpha(theta): enthalpy_steps.py

Both w and w~ sum to one over the nodes, and grad(w) to nothing, so the heat of the particles changes by exactly what the surface exchanged,
whatever alpha is. blend = 1 and affine = 1 is APIC; blend = affine = 0 is FLIP; blend = 1, affine = 0 is PIC.
Good values: APIC with steps of 0.1 to 0.2 R0 alpha h^2/(kappa J).   Fails when: heat steps are much smaller (APIC and PIC damp by the step), or a step
is over the limit of integrate/timestep.py.
"""

from typing import NamedTuple

import numpy as np

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, empty, fold, unfold
from mpm.heat.lanes import specify, warm_up
from mpm.integrate.surface_flux import exchange, expose, place
from mpm.jit import kernel, role
from mpm.materials.laws import Constant
from mpm.state import Isothermal, Thermal
from mpm.transfer import CHUNK, gather_scalar, scatter_scalar

ROWS = 4  # scratch fields


class Back(NamedTuple):
    """What of the nodes goes back to the particles: the share of PIC in the value, and the share of the gathered slope that is kept (1, 1: APIC)."""

    blend: float
    affine: float


@kernel
def heat_step(space, body, nodes, walls, dt, substeps, back):
    """Advance one body's temperatures by dt in `substeps` grid steps; nodes: (ROWS, n) scratch, zero before and after. Returns the heat gained [J]."""
    return advance_heat(body.thermal, space, body, nodes, walls, dt, substeps, back)


@role
def advance_heat(thermal, space, body, nodes, walls, dt, substeps, back):
    """See heat_step."""
    raise TypeError(f"no heat for {type(thermal).__name__}")


@advance_heat.register(Isothermal)
def advance_heat_isothermal(thermal, space, body, nodes, walls, dt, substeps, back):
    return 0.0


@advance_heat.register(Thermal)
def advance_heat_thermal(thermal, space, body, nodes, walls, dt, substeps, back):
    return explicit_by_law(thermal.alpha, thermal, space, body, nodes, walls, dt, substeps, back)


@role
def explicit_by_law(alpha, thermal, space, body, nodes, walls, dt, substeps, back):
    """heat_step of a body with heat, by the law of its specific heat: enthalpy_steps.py where it follows temperature."""
    raise TypeError(f"{type(alpha).__name__} is no law of temperature")


@explicit_by_law.register(Constant)
def explicit_by_law_constant(alpha, thermal, space, body, nodes, walls, dt, substeps, back):
    shape = extents(space)
    x, m = body.particles.x, body.particles.m
    box = reach(space, x)
    capacity, theta, start, rate = nodes[0], nodes[1], nodes[2], nodes[3]
    D = directions(space)
    work = np.zeros((2 + 3 * D, CHUNK))
    scatter_heat(space, x, m, thermal, capacity, theta, work)
    folded = box.copy()
    fold(capacity.reshape(-1, 1), 0, shape, folded, walls)
    fold(theta.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(theta, capacity, start, shape, box, True)
    unfold(theta.reshape(-1, 1), 0, shape, box, walls)
    unfold(start.reshape(-1, 1), 0, shape, box, walls)
    gained, pieces = 0.0, place(body.surface, space, body)
    for k in range(substeps):
        conduct(space, body, thermal, theta, rate, dt / substeps, work)
        gained += exchange(body, space, pieces, thermal, theta, rate, dt / substeps, (k + 0.5) / substeps, work)
        expose(body.surface, space, x, pieces, theta, dt / substeps, (k + 0.5) / substeps, work)
        fold(rate.reshape(-1, 1), 0, shape, box, walls)
        over_nodes(rate, capacity, theta, shape, box, False)
        unfold(theta.reshape(-1, 1), 0, shape, box, walls)
    gather_heat(space, x, thermal, start, theta, back, work)
    for field in range(4):
        used = box.copy()
        clear(nodes[field].reshape(-1, 1), shape, used)
    return gained


@kernel
def reach(space, x):
    """The box (3, 2) of nodes that the particles touch."""
    box = np.empty((3, 2), np.int64)
    empty(extents(space), box)
    for i in range(x.shape[0]):
        for a in range(x.shape[1]):
            i0, w, _, _, _ = stencil(space.basis, x[i, a] / space.h)
            box[a, 0], box[a, 1] = min(box[a, 0], i0), max(box[a, 1], i0 + len(w))
    return box


@kernel
def over_nodes(heat, capacity, theta, shape, box, opening):
    """Opening: heat becomes temperature, copied to `theta`. Later: theta += heat/capacity, and heat is cleared."""
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                change = heat[n] / capacity[n] if capacity[n] > 0.0 else 0.0
                if opening:
                    heat[n] = change
                    theta[n] = change
                else:
                    theta[n] += change
                    heat[n] = 0.0


@kernel
def scatter_heat(space, x, m, thermal, capacity, heat, work):
    """Capacity and heat on to the nodes."""
    D = directions(space)
    a, A, zero = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D]
    zero[:] = 0.0
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        for p in range(count):
            a[p] = thermal.zero + thermal.theta[first + p]
        specify(thermal.alpha, a, count)
        for p in range(count):
            a[p] *= m[first + p]
        scatter_scalar(space, x, first, count, a, zero, zero, capacity)
        for p in range(count):
            for k in range(D):
                A[k, p] = a[p] * thermal.c[first + p, k]
            a[p] *= thermal.theta[first + p]
        scatter_scalar(space, x, first, count, a, A, zero, heat)


@kernel
def conduct(space, body, thermal, theta, rate, dt, work):
    """rate_i += dt sum V q grad(w)."""
    D = directions(space)
    particles = body.particles
    at, slope, grad, zero = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D], work[2 + 2 * D : 2 + 3 * D]
    for first in range(0, particles.x.shape[0], CHUNK):
        count = min(CHUNK, particles.x.shape[0] - first)
        gather_scalar(space, particles.x, first, count, theta, at, slope, grad)
        for p in range(count):
            at[p] += thermal.zero
        specify(thermal.kappa, at, count)
        for p in range(count):
            flow = -dt * particles.J[first + p] * particles.V0[first + p] * at[p]
            at[p] = 0.0
            for k in range(D):
                grad[k, p] *= flow
                zero[k, p] = 0.0
        scatter_scalar(space, particles.x, first, count, at, zero, grad, rate)


@kernel
def gather_heat(space, x, thermal, start, end, back, work):
    """Particle temperatures and gradients from the nodes before and after."""
    D = directions(space)
    before, after, slope, grad = work[0], work[1], work[2 : 2 + D], work[2 + D : 2 + 2 * D]
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        gather_scalar(space, x, first, count, start, before, slope, grad)
        gather_scalar(space, x, first, count, end, after, slope, grad)
        for p in range(count):
            old = thermal.theta[first + p]
            after[p] = after[p] - before[p] + back.blend * (before[p] - old)
            before[p] = thermal.zero + old
        warm_up(thermal.alpha, before, after, count)
        for p in range(count):
            thermal.theta[first + p] += after[p]
            for k in range(D):
                thermal.c[first + p, k] = back.affine * slope[k, p]
