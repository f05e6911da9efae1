"""XPIC's extra transfers, of velocity and of temperature (transfer/xpic.py has the method).

velocity     q_1 = u_i,   q_(j+1) = q_1 + (1 - P G) q_j,   with P weighted by mass, or by heat capacity, and walls in P as in any scatter
temperature  theta_p -= (1 - G P)^(k-1) (theta_p - sum w theta_i): what the grid does not see, less what of that it does; theta_i with the particles' slopes
             where they have some, which is beside a surface (mpm.integrate.bounds.needs_slopes). Without, nodes outside it read the particles inside, off by
             O(h d theta/dn); with them a linear field loses nothing there, and the explicit step is bounded about as APIC's is: 1.13 R0 alpha h^2/kappa at
             the ends of configs/studies/stability/heat_end.yaml (APIC 0.94 to 0.96), without them 2.25 to 2.33
P G keeps sum m_i q_i, so momentum and heat are kept exactly, whatever the order.
"""

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, fold, impose, unfold
from mpm.heat.local import rise
from mpm.integrate.heat_step import over_nodes, reach, scatter_heat
from mpm.jit import kernel, role
from mpm.materials.laws import value
from mpm.state import Isothermal, Thermal
from mpm.transfer import CHUNK, Apic, Flip, Xpic, gather, gather_scalar, lay_down, scatter, scatter_scalar

FIELDS = 4  # scratch fields of `sharpened`


@role(arrays=True)
def sharpen(scheme, method, bodies, chunk, buffers, now, walls):
    """Between `update` and gather: add q_k to the change of velocity of buffer `now`. The other is scratch, zero before and after."""
    raise TypeError(f"no transfer scheme {type(scheme).__name__}")


@sharpen.register(Apic)
@sharpen.register(Flip)
def sharpen_flip_or_apic(scheme, method, bodies, chunk, buffers, now, walls):
    return None


@sharpen.register(Xpic)
def sharpen_xpic(scheme, method, bodies, chunk, buffers, now, walls):
    space, gradient, box, blocks = method.space, method.gradient, buffers.boxes[now], buffers.blocks[now]
    shape, D = extents(space), directions(space)
    nodes, force, spare, field = buffers.nodes[now], buffers.force[now], buffers.nodes[1 - now], buffers.force[1 - now]
    blend_nodes(field, nodes, force, spare, D, shape, box, 0.0, 0.0)
    for _ in range(1, scheme.order):
        there_and_back(space, gradient, bodies, chunk, field, spare, box)
        fold(spare, D, shape, box.copy(), walls)
        divide(spare, D, shape, box)
        impose(spare, D, shape, box, walls)
        blend_nodes(field, nodes, force, spare, D, shape, box, 1.0, 1.0)
        unfold(field, D, shape, box, walls, blocks)
        clear(spare, shape, box.copy())
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                for c in range(D):
                    force[n, c] += field[n, c]
    impose(force, D, shape, box, walls)
    clear(field, shape, box.copy())


@kernel
def blend_nodes(field, nodes, force, spare, D, shape, box, old, seen):
    """field <- v_i + old field - seen spare, v_i = nodes - force."""
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                for c in range(D):
                    field[n, c] = nodes[n, c] - force[n, c] + old * field[n, c] - seen * spare[n, c]


@kernel
def there_and_back(space, gradient, bodies, chunk, field, spare, box):
    """spare += P G field, as momentum and mass."""
    touched = box.copy()
    chunk.A[:] = 0.0
    chunk.G[:] = 0.0
    for body in literal_unroll(bodies):
        pass_body(space, gradient, body.particles.x, body.particles.m, chunk, field, spare, touched)


@kernel
def pass_body(space, gradient, x, m, chunk, field, spare, box):
    """There and back, one body."""
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        lay_down(space, x, first, count, chunk)
        gather(space, gradient, x, first, chunk, count, field)
        for p in range(count):
            chunk.m[p] = m[first + p]
            for c in range(chunk.a.shape[0]):
                chunk.a[c, p] = m[first + p] * chunk.v[c, p]
        scatter(space, gradient, x, first, chunk, count, spare, box)


@kernel
def divide(spare, D, shape, box):
    """Momentum becomes velocity."""
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                inverse = 1.0 / spare[n, D] if spare[n, D] > 0.0 else 0.0
                for c in range(D):
                    spare[n, c] *= inverse


@kernel
def sharpened(space, body, nodes, walls, order):
    """-(1 - G P)^(order - 1) (theta - sum w theta_i) of the particles (N,), for `correct` after a FLIP heat step; nodes: (FIELDS, n) zero before and after."""
    return what_is_lost(body.thermal, space, body, nodes, walls, order)


@role
def what_is_lost(thermal, space, body, nodes, walls, order):
    """See sharpened."""
    raise TypeError(f"no heat for {type(thermal).__name__}")


@what_is_lost.register(Isothermal)
def what_is_lost_isothermal(thermal, space, body, nodes, walls, order):
    return np.zeros(0)


@what_is_lost.register(Thermal)
def what_is_lost_thermal(thermal, space, body, nodes, walls, order):
    shape, D = extents(space), directions(space)
    x, m = body.particles.x, body.particles.m
    box = reach(space, x)
    capacity, start, field, back = nodes[0], nodes[1], nodes[2], nodes[3]
    work = np.zeros((2 + 3 * D, CHUNK))
    scatter_heat(space, x, m, thermal, capacity, start, work)
    fold(capacity.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(start.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(start, capacity, field, shape, box, True)
    unfold(start.reshape(-1, 1), 0, shape, box, walls)
    unfold(field.reshape(-1, 1), 0, shape, box, walls)
    at, slope, grad, zero = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D], work[2 + 2 * D : 2 + 3 * D]
    zero[:] = 0.0
    out = np.zeros(x.shape[0])
    for k in range(order):
        for first in range(0, x.shape[0], CHUNK):
            count = min(CHUNK, x.shape[0] - first)
            gather_scalar(space, x, first, count, field, at, slope, grad)
            for p in range(count):
                out[first + p] += at[p] - thermal.theta[first + p] if k == 0 else -at[p]
        if k == order - 1:
            break
        for first in range(0, x.shape[0], CHUNK):
            count = min(CHUNK, x.shape[0] - first)
            for p in range(count):
                at[p] = m[first + p] * value(thermal.alpha, thermal.zero + thermal.theta[first + p]) * out[first + p]
            scatter_scalar(space, x, first, count, at, zero, zero, back)
        fold(back.reshape(-1, 1), 0, shape, box.copy(), walls)
        over_nodes(back, capacity, field, shape, box, True)
        unfold(field.reshape(-1, 1), 0, shape, box, walls)
        clear(back.reshape(-1, 1), shape, box.copy())
    for row in range(FIELDS):
        clear(nodes[row].reshape(-1, 1), shape, box.copy())
    return out


@kernel
def specific(thermal):
    """alpha of every particle (N,) [J/(kg K)]."""
    out = np.empty(thermal.theta.shape[0])
    for i in range(len(out)):
        out[i] = value(thermal.alpha, thermal.zero + thermal.theta[i])
    return out


@kernel
def correct(thermal, alpha, change):
    """theta += change, through enthalpy: alpha is that of the start of the step, with which `change` keeps the sum of heat."""
    for i in range(len(change)):
        old = thermal.theta[i]
        thermal.theta[i] = old + rise(thermal.alpha, thermal.zero + old, alpha[i] * change[i])


def lost_to_grid(scene, body, rows, walls):
    """What XPIC takes from the temperatures of a body in this heat step, and alpha at its start; None with other transfers."""
    warm = scene.sharp and isinstance(body.thermal, Thermal)
    return (specific(body.thermal), sharpened(scene.space, body, rows[:FIELDS], walls, scene.sharp)) if warm else None
