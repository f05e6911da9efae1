"""FLIP with a blend of PIC, and its affine form.

v_p += sum w (v_i+ - v_i) + blend (sum w v_i - v_p);  blend = 1 is PIC.  `affine` = 1 keeps the gathered slope C for the next scatter, 0 does not.
Good values: blend 0 to 0.05; affine FLIP with 0.02.   Fails when: blend = 0 keeps every mode that the grid cannot see (ringing).
"""

from typing import NamedTuple

from mpm.transfer import carry


class Flip(NamedTuple):
    """blend [-] in 0..1, affine 0 or 1."""

    blend: float
    affine: float


@carry.register(Flip)
def _(scheme, particles, first, chunk, count, change):
    for p in range(count):
        i = first + p
        for c in range(particles.v.shape[1]):
            old = particles.v[i, c]
            dv = change[c, p]
            particles.v[i, c] = old + dv + scheme.blend * (chunk.v[c, p] - dv - old)
            for d in range(particles.v.shape[1]):
                particles.C[i, c, d] = scheme.affine * chunk.C[c, d, p]
