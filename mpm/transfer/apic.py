"""APIC (Jiang et al. 2015): the particle keeps the gathered velocity and its slope. Conserves linear and angular momentum.

v_p = sum w v_i+,  C_p = 4/h^2 sum w v_i+ d^T.   Good for: nearly everything.   Fails when: modes near the cell size must ring on for thousands of steps.
"""

from typing import NamedTuple

from mpm.transfer import carry


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
