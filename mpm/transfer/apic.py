"""APIC (Jiang et al. 2015): the particle keeps the gathered velocity and its slope. Conserves linear and angular momentum.

v_p = sum w v_i+,  C_p = 4/h^2 sum w v_i+ d^T.   Good for: nearly everything.   Fails when: modes near the cell size must ring on for thousands of steps.
"""

from typing import NamedTuple

from mpm.boundary import directions
from mpm.lanes import EIGHT, load8, store
from mpm.transfer.roles import CHUNK, aim, carry, collect, deliver, gather, scatter, spread, uses_basis_gradient, wants_change


class Apic(NamedTuple):
    """No parameters."""


@carry.register(Apic)
def carry_apic(scheme, particles, first, chunk, count, last):
    if last:
        deliver(particles, first, chunk, count)


@wants_change.register(Apic)
def wants_change_apic(scheme):
    return False


@spread.register(Apic)
def spread_apic(scheme, space, gradient, x, first, chunk, count, nodes, force, box):
    D, n = directions(space), CHUNK
    for p in range(0, count, EIGHT):
        for c in range(D):
            store(chunk.a, c * n + p, load8(chunk.a, c * n + p) + load8(chunk.f, c * n + p))
        for k in range(D * D):
            if uses_basis_gradient(gradient):
                store(chunk.G, k * n + p, load8(chunk.S, k * n + p))
            else:
                store(chunk.A, k * n + p, load8(chunk.A, k * n + p) + load8(chunk.S, k * n + p))
    aim(space, chunk, count)
    scatter(space, gradient, x, first, chunk, count, nodes, box)


@collect.register(Apic)
def collect_apic(scheme, space, gradient, x, first, chunk, count, nodes, force):
    gather(space, gradient, x, first, chunk, count, nodes)
