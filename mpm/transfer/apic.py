"""APIC (Jiang et al. 2015): the particle keeps the gathered velocity and its slope. Conserves linear and angular momentum.

v_p = sum w v_i+,  C_p = 4/h^2 sum w v_i+ d^T.   Good for: nearly everything.   Fails when: modes near the cell size must ring on for thousands of steps.
"""

from typing import NamedTuple

from mpm.transfer.roles import carry, collect, gather, scatter, spread, uses_basis_gradient, wants_change


class Apic(NamedTuple):
    """No parameters."""


@carry.register(Apic)
def _(scheme, particles, first, chunk, count, change):
    for p in range(count):
        i = first + p
        for c in range(particles.v.shape[1]):
            particles.v[i, c] = chunk.v[c, p]
            for d in range(particles.v.shape[1]):
                particles.C[i, c, d] = chunk.C[c, d, p]


@wants_change.register(Apic)
def _(scheme):
    return False


@spread.register(Apic)
def _(scheme, space, gradient, x, first, chunk, count, nodes, force, box):
    D = chunk.a.shape[0]
    for c in range(D):
        for p in range(count):
            chunk.a[c, p] += chunk.f[c, p]
        for d in range(D):
            for p in range(count):
                if uses_basis_gradient(gradient):
                    chunk.G[c, d, p] = chunk.S[c, d, p]
                else:
                    chunk.A[c, d, p] += chunk.S[c, d, p]
    scatter(space, gradient, x, first, chunk, count, nodes, box)


@collect.register(Apic)
def _(scheme, space, gradient, x, first, chunk, count, nodes, force, change):
    gather(space, gradient, x, first, chunk, count, nodes)
