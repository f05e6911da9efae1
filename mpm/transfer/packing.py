"""Chunks packed for the rows of a stencil, and unpacked: from components of eight particles to fours of one particle, by transposing.

Chunk.packed holds a particle a row. To scatter: value at the first node with the mass, growth from node to node by direction, with the basis gradient the
columns of its tensor. Gathered: velocity, moment by direction (see `slope`), gradient by direction.
"""

from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, high, join, load4, load8, low, splat8, store, transposed
from mpm.transfer.roles import uses_basis_gradient, uses_slopes
from mpm.transfer.stencils import CHUNK, OFFSET, ROWS, WITHIN

FOUR = 4


@kernel(inline=True)
def pack(packed, p, k, a, b, c, d):
    """Components a, b, c, d of eight particles from p to place k of their fours."""
    wide = packed.shape[1]
    at = p * wide + FOUR * k
    for four in transposed(a, b, c, d):
        store(packed, at, low(four))
        store(packed, at + FOUR * wide, high(four))
        at += wide


@kernel(inline=True)
def unpack(packed, p, k):
    """The inverse: components of eight particles from p."""
    wide = packed.shape[1]
    at, on = p * wide + FOUR * k, FOUR * packed.shape[1]
    a, b = join(load4(packed, at), load4(packed, at + on)), join(load4(packed, at + wide), load4(packed, at + wide + on))
    at += 2 * wide
    return transposed(a, b, join(load4(packed, at), load4(packed, at + on)), join(load4(packed, at + wide), load4(packed, at + wide + on)))


@kernel(inline=True)
def pack_volume(space, gradient, chunk, count):
    """Value at the first node [m], and what it grows by from node to node, as fours; with the basis gradient its tensor's columns."""
    s, a, A, T, n = chunk.s, chunk.a, chunk.A, chunk.G, CHUNK
    real = chunk.m.dtype.type
    h, nought = splat8(real(space.h)), splat8(real(0))
    rows = ROWS * n
    for p in range(0, count, EIGHT):
        x, y, z = load8(s, OFFSET * n + p), load8(s, rows + OFFSET * n + p), load8(s, 2 * rows + OFFSET * n + p)
        xx, xy, xz = load8(A, p), load8(A, n + p), load8(A, 2 * n + p)
        yx, yy, yz = load8(A, 3 * n + p), load8(A, 4 * n + p), load8(A, 5 * n + p)
        zx, zy, zz = load8(A, 6 * n + p), load8(A, 7 * n + p), load8(A, 8 * n + p)
        ax = fma(x, xx, fma(y, xy, fma(z, xz, load8(a, p))))
        ay = fma(x, yx, fma(y, yy, fma(z, yz, load8(a, n + p))))
        az = fma(x, zx, fma(y, zy, fma(z, zz, load8(a, 2 * n + p))))
        pack(chunk.packed, p, 0, ax, ay, az, load8(chunk.m, p))
        pack(chunk.packed, p, 1, h * xx, h * yx, h * zx, nought)
        pack(chunk.packed, p, 2, h * xy, h * yy, h * zy, nought)
        pack(chunk.packed, p, 3, h * xz, h * yz, h * zz, nought)
        if uses_basis_gradient(gradient):
            pack(chunk.packed, p, 4, load8(T, p), load8(T, 3 * n + p), load8(T, 6 * n + p), nought)
            pack(chunk.packed, p, 5, load8(T, n + p), load8(T, 4 * n + p), load8(T, 7 * n + p), nought)
            pack(chunk.packed, p, 6, load8(T, 2 * n + p), load8(T, 5 * n + p), load8(T, 8 * n + p), nought)


@kernel(inline=True)
def pack_plane(space, gradient, chunk, count):
    """The same in a plane."""
    s, a, A, T, n = chunk.s, chunk.a, chunk.A, chunk.G, CHUNK
    real = chunk.m.dtype.type
    h, nought = splat8(real(space.h)), splat8(real(0))
    rows = ROWS * n
    for p in range(0, count, EIGHT):
        x, y = load8(s, OFFSET * n + p), load8(s, rows + OFFSET * n + p)
        xx, xy, yx, yy = load8(A, p), load8(A, n + p), load8(A, 2 * n + p), load8(A, 3 * n + p)
        ax, ay = fma(x, xx, fma(y, xy, load8(a, p))), fma(x, yx, fma(y, yy, load8(a, n + p)))
        pack(chunk.packed, p, 0, ax, ay, load8(chunk.m, p), nought)
        pack(chunk.packed, p, 1, h * xx, h * yx, nought, nought)
        pack(chunk.packed, p, 2, h * xy, h * yy, nought, nought)
        if uses_basis_gradient(gradient):
            pack(chunk.packed, p, 3, load8(T, p), load8(T, 2 * n + p), nought, nought)
            pack(chunk.packed, p, 4, load8(T, n + p), load8(T, 3 * n + p), nought, nought)


@kernel(inline=True)
def columns_plane(target, k, p, column):
    """Column k of a tensor of eight particles from p, from components (x, y, ...)."""
    store(target, k * CHUNK + p, column[0])
    store(target, (2 + k) * CHUNK + p, column[1])


@kernel(inline=True)
def columns_volume(target, k, p, column):
    """The same in three directions."""
    store(target, k * CHUNK + p, column[0])
    store(target, (3 + k) * CHUNK + p, column[1])
    store(target, (6 + k) * CHUNK + p, column[2])


@kernel(inline=True)
def slope(space, chunk, k, p, v, moment):
    """Column k of the slope, 4/h^2 sum w u d_k, from v and the moment sum w u j: node j = -1, 0, 1 lies at d = h (j - f)."""
    scale, f = splat8(chunk.m.dtype.type(4.0 / space.h)), load8(chunk.s, (k * ROWS + WITHIN) * CHUNK + p)
    return scale * fma(-f, v[0], moment[0]), scale * fma(-f, v[1], moment[1]), scale * fma(-f, v[2], moment[2])


@kernel(inline=True)
def same_gradient(gradient, chunk, count):
    """With the MLS gradient it is the slope: copied where it has an array of its own."""
    if uses_slopes(gradient) and not uses_basis_gradient(gradient) and chunk.L.ctypes.data != chunk.C.ctypes.data:
        for k in range(chunk.v.shape[0] * chunk.v.shape[0]):
            for p in range(0, count, EIGHT):
                store(chunk.L, k * CHUNK + p, load8(chunk.C, k * CHUNK + p))


@kernel(inline=True)
def unpack_plane(space, gradient, chunk, count):
    """What was gathered, to v, C and L of the chunk."""
    packed = chunk.packed
    for p in range(0, count, EIGHT):
        v = unpack(packed, p, 0)
        store(chunk.v, p, v[0])
        store(chunk.v, CHUNK + p, v[1])
        if uses_slopes(gradient):
            columns_plane(chunk.C, 0, p, slope(space, chunk, 0, p, v, unpack(packed, p, 1)))
            columns_plane(chunk.C, 1, p, slope(space, chunk, 1, p, v, unpack(packed, p, 2)))
        if uses_basis_gradient(gradient):
            columns_plane(chunk.L, 0, p, unpack(packed, p, 3))
            columns_plane(chunk.L, 1, p, unpack(packed, p, 4))
    same_gradient(gradient, chunk, count)


@kernel(inline=True)
def unpack_volume(space, gradient, chunk, count):
    """The same in three directions."""
    packed = chunk.packed
    for p in range(0, count, EIGHT):
        v = unpack(packed, p, 0)
        store(chunk.v, p, v[0])
        store(chunk.v, CHUNK + p, v[1])
        store(chunk.v, 2 * CHUNK + p, v[2])
        if uses_slopes(gradient):
            columns_volume(chunk.C, 0, p, slope(space, chunk, 0, p, v, unpack(packed, p, 1)))
            columns_volume(chunk.C, 1, p, slope(space, chunk, 1, p, v, unpack(packed, p, 2)))
            columns_volume(chunk.C, 2, p, slope(space, chunk, 2, p, v, unpack(packed, p, 3)))
        if uses_basis_gradient(gradient):
            columns_volume(chunk.L, 0, p, unpack(packed, p, 4))
            columns_volume(chunk.L, 1, p, unpack(packed, p, 5))
            columns_volume(chunk.L, 2, p, unpack(packed, p, 6))
    same_gradient(gradient, chunk, count)
