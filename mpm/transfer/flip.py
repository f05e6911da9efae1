"""FLIP with a blend of PIC, and its affine form.

v_p += sum w (v_i+ - v_i) + blend (sum w v_i - v_p);  blend = 1 is PIC.  `affine` = 1 keeps the gathered slope C for the next scatter, 0 does not.
Good values: blend 0 to 0.05; affine FLIP with 0.02.   Fails when: blend = 0 keeps every mode that the grid cannot see (ringing).
"""

from typing import NamedTuple

from mpm.jit import role
from mpm.lanes import EIGHT, load8, store
from mpm.transfer.roles import (
    CHUNK,
    Bspline,
    Chunk,
    Mls,
    Values,
    aim,
    carry,
    collect,
    deliver,
    gather,
    pick_up,
    scatter,
    spread,
    to_rows,
    uses_basis_gradient,
    wants_change,
)  # fmt: skip


class Flip(NamedTuple):
    """blend [-] in 0..1, affine 0 or 1."""

    blend: float
    affine: float


@carry.register(Flip)
def carry_flip(scheme, particles, first, chunk, count, last):
    D, n, u = chunk.u.shape[0], CHUNK, chunk.u
    to_rows(particles.v, first, count, u)
    for p in range(0, count, EIGHT):
        for k in range(0, D * n, n):
            old, dv = load8(u, k + p), load8(chunk.change, k + p)
            store(u, k + p, old + dv + scheme.blend * (load8(chunk.v, k + p) - dv - old))
        for k in range(0, D * D * n, n):
            store(chunk.U, k + p, scheme.affine * load8(chunk.C, k + p))
    if last:
        deliver(particles, first, chunk, count)
    else:
        pick_up(particles.v, first, count, u)  # the next step wants them again


@wants_change.register(Flip)
def wants_change_flip(scheme):
    return True


@spread.register(Flip)
def spread_apart(scheme, space, gradient, x, first, chunk, count, nodes, force, box):
    if uses_basis_gradient(gradient):
        chunk.G[:] = 0.0
    aim(space, chunk, count)
    scatter(space, gradient, x, first, chunk, count, nodes, box)
    # With either gradient the impulse S is read where it belongs: as slope (MLS) or as tensor (B-spline).
    slope, tensor = impulse_parts(gradient, chunk)
    c = chunk
    apart = Chunk(c.none, c.f, slope, tensor, c.v, c.change, c.C, c.L, c.u, c.U, c.f, c.S, c.e, c.place, c.s, c.reach, c.none, c.uv, c.begins, c.packed)
    scatter(space, gradient, x, first, apart, count, force, box)


@collect.register(Flip)
def collect_apart(scheme, space, gradient, x, first, chunk, count, nodes, force):
    c = chunk
    changed = Chunk(c.m, c.a, c.A, c.G, c.change, c.change, c.C, c.L, c.u, c.U, c.f, c.S, c.e, c.place, c.s, c.reach, c.none, c.uv, c.begins, c.packed)
    gather(space, Values(), x, first, changed, count, force)
    gather(space, gradient, x, first, chunk, count, nodes)


@role
def impulse_parts(gradient, chunk):
    """(slope, tensor) of the impulse S."""
    raise TypeError(f"no gradient {type(gradient).__name__}")


@impulse_parts.register(Mls)
def impulse_parts_mls(gradient, chunk):
    return chunk.S, chunk.G


@impulse_parts.register(Bspline)
def impulse_parts_bspline(gradient, chunk):
    return chunk.G, chunk.S
