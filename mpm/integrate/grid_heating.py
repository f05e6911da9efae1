"""Elastic heating as the source document has it: a term of the heat equation on the grid (docs/physics.md 4, option `grid`).

C_i = sum alpha m w_ip,   Q_i = -dt sum V0 gamma Theta_p (div v+)_p w_ip,   Theta_p += sum w_ip Q_i/C_i    through the enthalpy
with the new velocity v+, the one that updates F; before the particles move. Conserves what it takes up: sum C_i (Q_i/C_i) = sum Q_i.

It is there to be compared with the adiabat at the particle (mpm.heat.local), which is exact in any step:
- first order in the step where the adiabat has no error: Theta_0 (1 - Gamma dt L)^n for Theta_0 exp(-Gamma ln J);
- wrong where flow changes the volume: div v is the rate of ln J, not of ln J^E, so a body that yields under pressure heats on;
- it smooths over a cell what is local.
Costs a gather, two scatters and a gather of one scalar more a step. tests/integrate/test_grid_heating.py measures all three.
"""

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.boundary.walls import fold, unfold
from mpm.heat.local import rise, temperature
from mpm.integrate.strain import HEATED
from mpm.jit import kernel, role
from mpm.materials.laws import value
from mpm.state import Axisymmetric, GridHeating, Heating, Line, NoHeating, Plane, Volume
from mpm.transfer import CHUNK, gather, gather_scalar, lay_down, scatter_scalar


@role
def divergence(space, x, i, chunk, p):
    """div v at particle i, which is p of the chunk, where the chunk was gathered."""
    raise TypeError(f"no divergence for {type(space).__name__}")


@divergence.register(Line)
def divergence_line(space, x, i, chunk, p):
    return chunk.L[0, 0, p]


@divergence.register(Plane)
def divergence_plane(space, x, i, chunk, p):
    return chunk.L[0, 0, p] + chunk.L[1, 1, p]


@divergence.register(Axisymmetric)
def divergence_axisymmetric(space, x, i, chunk, p):
    return chunk.L[0, 0, p] + chunk.L[1, 1, p] + chunk.v[0, p] / x[i, 0]


@divergence.register(Volume)
def divergence_volume(space, x, i, chunk, p):
    return chunk.L[0, 0, p] + chunk.L[1, 1, p] + chunk.L[2, 2, p]


@kernel(inline=True)
def compress_all(space, gradient, bodies, chunk, nodes, box, walls, dt, reports):
    """Heat of the coming step's change of volume, body by body, where a body takes it from the grid."""
    b = 0
    for body in literal_unroll(bodies):
        compress(body.heating, space, gradient, body, chunk, nodes, box, walls, dt, reports[b])
        b += 1


@role(arrays=True)
def compress(heating, space, gradient, body, chunk, nodes, box, walls, dt, report):
    """Heat one body by its change of volume, from the nodal velocities."""
    raise TypeError(f"no heating {type(heating).__name__}")


@compress.register(NoHeating)
@compress.register(Heating)
def compress_heating_or_no_heating(heating, space, gradient, body, chunk, nodes, box, walls, dt, report):
    return None


@compress.register(GridHeating)
def compress_grid_heating(heating, space, gradient, body, chunk, nodes, box, walls, dt, report):
    x, m, V0, thermal = body.particles.x, body.particles.m, body.particles.V0, body.thermal
    D, shape = directions(space), extents(space)
    heat, capacity = heating.rise, heating.capacity
    heat[:] = 0.0
    capacity[:] = 0.0
    at, load, zero = np.zeros(CHUNK), np.zeros(CHUNK), np.zeros((D, CHUNK))
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        lay_down(space, x, first, count, chunk)
        gather(space, gradient, x, first, chunk, count, nodes)
        for p in range(count):
            i = first + p
            theta = temperature(thermal, i)
            at[p] = m[i] * value(thermal.alpha, theta)
            load[p] = -dt * V0[i] * heating.gamma * theta * divergence(space, x, i, chunk, p)
        scatter_scalar(space, x, first, count, at, zero, zero, capacity)
        scatter_scalar(space, x, first, count, load, zero, zero, heat)
    fold(capacity.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(heat.reshape(-1, 1), 0, shape, box.copy(), walls)
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                heat[n] = heat[n] / capacity[n] if capacity[n] > 0.0 else 0.0
    unfold(heat.reshape(-1, 1), 0, shape, box, walls)
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        gather_scalar(space, x, first, count, heat, at, zero, np.zeros((D, CHUNK)))
        for p in range(count):
            i = first + p
            theta = temperature(thermal, i)
            joule = value(thermal.alpha, theta) * at[p]
            thermal.theta[i] += rise(thermal.alpha, theta, joule)
            report[HEATED] += m[i] * joule
