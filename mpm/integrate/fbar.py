"""F-bar: volume changes averaged over the grid, against volumetric locking (Zhao, Jiang & Choo 2022, with the B-splines of the scene).

g_p = det(1 + dt grad v) - 1,   g_i = sum w V g_p/sum w V,   g = sum w g_i,   1 + dt grad v  <-  ((1 + g)/(1 + g_p))^(1/D) (1 + dt grad v)

with g + own (g_p - g) for g: stress, J and areas see the averaged change of volume, a small share of the particle's own, and its own change of shape.
A uniform g stays what it is. In plane strain and axisymmetry the directions of the grid are scaled, the third is not. A gather of velocities, two scatters
and a gather of one scalar more: a step takes 1.8 times as long (10 000 particles in 3-D), where half the cell takes 8 to 16 times.
Why own: changes of volume that alternate from cell to cell average to nothing, so without it no pressure resists them. A layer that is drawn out then gathers
in clumps two cells apart, with voids between that J knows nothing of, and what holds it on a floor falls with its density. configs/scenes/chocolate_pour.yaml
with cells of 1 mm: the film's density falls to 0.4 and it runs to 75 mm; own 0.02 keeps it at 64 (0.005 does at 1 mm, not at 0.8 mm).
The price: tip of Cook's membrane at nu = 0.499, cells of 4 and 2, -1.5 and -0.5 % with own 0, -1.8 and -0.6 with 0.005, -2.4 and -0.8 with 0.02, -3.2 and
-1.2 with 0.05 (without F-bar -12.6 and -5.3).
Good values: Poisson ratio above 0.45; own 0.02, and 0 where the body keeps its shape.
Fails when: volume changes over a cell or two are the answer (thermal fronts, compaction bands): they are smeared.
"""

import math

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.boundary.walls import fold, unfold
from mpm.integrate.strain import increment3
from mpm.jit import kernel, role
from mpm.state import Average, Axisymmetric, Line, NoAverage, Plane, Volume
from mpm.tensors import dilation1, dilation2, dilation3
from mpm.transfer import CHUNK, gather, gather_scalar, lay_down, scatter_scalar


@role
def grown(space, x, i, chunk, p, dt):
    """det(1 + dt grad v) - 1 of particle i, which is p of the chunk, where the chunk was gathered."""
    raise TypeError(f"no volume change for {type(space).__name__}")


@grown.register(Line)
def grown_line(space, x, i, chunk, p, dt):
    return dilation1((dt * chunk.L[0, 0, p],))


@grown.register(Plane)
def grown_plane(space, x, i, chunk, p, dt):
    L = chunk.L
    return dilation2((dt * L[0, 0, p], dt * L[0, 1, p], dt * L[1, 0, p], dt * L[1, 1, p], 0.0))


@grown.register(Axisymmetric)
def grown_axisymmetric(space, x, i, chunk, p, dt):
    L = chunk.L
    return dilation2((dt * L[0, 0, p], dt * L[0, 1, p], dt * L[1, 0, p], dt * L[1, 1, p], dt * chunk.v[0, p] / x[i, 0]))


@grown.register(Volume)
def grown_volume(space, x, i, chunk, p, dt):
    return dilation3(increment3(chunk.L, p, dt))


@kernel(inline=True)
def average_all(space, gradient, bodies, chunk, nodes, box, walls, dt):
    """Nodal averages of the coming step's volume changes, body by body, where a body wants them."""
    for body in literal_unroll(bodies):
        average(body.locking, space, gradient, body, chunk, nodes, box, walls, dt)


@kernel(inline=True)
def any_averages(bodies):
    """Whether a body averages."""
    found = False
    for body in literal_unroll(bodies):
        found = found or averages(body.locking)
    return found


@role
def averages(locking):
    """Whether this averages."""
    raise TypeError(f"no averaging by {type(locking).__name__}")


@averages.register(NoAverage)
def averages_no_average(locking):
    return False


@averages.register(Average)
def averages_average(locking):
    return True


@role(arrays=True)
def average(locking, space, gradient, body, chunk, nodes, box, walls, dt):
    """Fill the nodal averages of one body from the nodal velocities."""
    raise TypeError(f"no averaging by {type(locking).__name__}")


@average.register(NoAverage)
def average_no_average(locking, space, gradient, body, chunk, nodes, box, walls, dt):
    return None


@average.register(Average)
def average_average(locking, space, gradient, body, chunk, nodes, box, walls, dt):
    x, V0, J = body.particles.x, body.particles.V0, body.particles.J
    D, shape = directions(space), extents(space)
    total, volume = locking.change, locking.volume
    total[:] = 0.0
    volume[:] = 0.0
    at, grow, zero = np.zeros(CHUNK), np.zeros(CHUNK), np.zeros((D, CHUNK))
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        lay_down(space, x, first, count, chunk)
        gather(space, gradient, x, first, chunk, count, nodes)
        for p in range(count):
            at[p] = V0[first + p] * J[first + p]
            grow[p] = at[p] * grown(space, x, first + p, chunk, p, dt)
        scatter_scalar(space, x, first, count, at, zero, zero, volume)
        scatter_scalar(space, x, first, count, grow, zero, zero, total)
    fold(volume.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(total.reshape(-1, 1), 0, shape, box.copy(), walls)
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                total[n] = total[n] / volume[n] if volume[n] > 0.0 else 0.0
    unfold(total.reshape(-1, 1), 0, shape, box, walls)


@role
def relax(locking, space, x, first, chunk, count, dt):
    """Give the gathered velocity gradients of a chunk the averaged change of volume; before the particles move."""
    raise TypeError(f"no averaging by {type(locking).__name__}")


@relax.register(NoAverage)
def relax_no_average(locking, space, x, first, chunk, count, dt):
    return None


@relax.register(Average)
def relax_average(locking, space, x, first, chunk, count, dt):
    D, at, unused = directions(space), chunk.e[0], chunk.S[0]  # rows that are filled after this: what passes over a chunk makes no arrays
    gather_scalar(space, x, first, count, locking.change, at, unused, unused)
    for p in range(count):
        alone = grown(space, x, first + p, chunk, p, dt)
        stretch = math.expm1((math.log1p(at[p] + locking.own * (alone - at[p])) - math.log1p(alone)) / D)
        for c in range(D):
            for d in range(D):
                chunk.L[c, d, p] += stretch * chunk.L[c, d, p]
            chunk.L[c, c, p] += stretch / dt
