"""FLIP with a blend of PIC, and its affine form.

v_p += sum w (v_i+ - v_i) + blend (sum w v_i - v_p);  blend = 1 is PIC.  `affine` = 1 keeps the gathered slope C for the next scatter, 0 does not.
Good values: blend 0 to 0.05; affine FLIP with 0.02.   Fails when: blend = 0 keeps every mode that the grid cannot see (ringing).
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import role
from mpm.transfer.roles import Bspline, Chunk, Mls, carry, collect, gather, scatter, spread, wants_change


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


@wants_change.register(Flip)
def _(scheme):
    return True


@spread.register(Flip)
def spread_apart(scheme, space, gradient, x, first, chunk, count, nodes, force, box):
    chunk.G[:] = 0.0
    scatter(space, gradient, x, first, chunk, count, nodes, box)
    # With either gradient the impulse S is read where it belongs: as slope (MLS) or as tensor (B-spline).
    massless = np.zeros_like(chunk.m)
    slope, tensor = impulse_parts(gradient, chunk)
    scatter(space, gradient, x, first, Chunk(massless, chunk.f, slope, tensor, chunk.v, chunk.C, chunk.L, chunk.f, chunk.S, chunk.e), count, force, box)


@collect.register(Flip)
def collect_apart(scheme, space, gradient, x, first, chunk, count, nodes, force, change):
    gather(space, gradient, x, first, Chunk(chunk.m, chunk.a, chunk.A, chunk.G, change, chunk.C, chunk.L, chunk.f, chunk.S, chunk.e), count, force)
    gather(space, gradient, x, first, chunk, count, nodes)


@role
def impulse_parts(gradient, chunk):
    """(slope, tensor) of the impulse S."""
    raise TypeError(f"no gradient {type(gradient).__name__}")


@impulse_parts.register(Mls)
def _(gradient, chunk):
    return chunk.S, chunk.G


@impulse_parts.register(Bspline)
def _(gradient, chunk):
    return chunk.G, chunk.S
