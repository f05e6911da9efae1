"""Scatter and gather of quadratic B-splines in planes and volumes, a stencil row at once.

A node is four numbers [px py pz m], so the three nodes of a row are twelve in a row: lanes of eight (two nodes) and of four (the third). What a particle
puts on a row is v_j (u_i (c + i X) + j u_i Y) times fixed lanes; gather is its transpose, summed row by row, plane by plane, then in the row.
The rows of a stencil stay in registers while consecutive particles share them.
"""

from mpm.jit import kernel
from mpm.lanes import fma, high, join, load4, load8, low, splat4, splat8, store
from mpm.transfer.packing import pack_plane, pack_volume, unpack_plane, unpack_volume
from mpm.transfer.roles import uses_basis_gradient
from mpm.transfer.stencils import FIRST, B, G, W


@kernel(inline=True)
def zeros(nodes):
    """Three rows of a plane of the stencil: lanes of eight and of four each."""
    nought8, nought4 = splat8(nodes.dtype.type(0)), splat4(nodes.dtype.type(0))
    return nought8, nought4, nought8, nought4, nought8, nought4


@kernel(inline=True)
def added(rows, s, p, j, first, eight, rest, Y8, Y4):
    """Rows += weight times (row + j Y); the weights stand from row `first` of the stencils, in direction j."""
    a8, a4, b8, b4, c8, c4 = rows
    w, x, y = s[j, first, p], s[j, first + 1, p], s[j, first + 2, p]
    second8, second4 = eight + Y8, rest + Y4
    return (
        fma(splat8(w), eight, a8), fma(splat4(w), rest, a4), fma(splat8(x), second8, b8), fma(splat4(x), second4, b4),
        fma(splat8(y), second8 + Y8, c8), fma(splat4(y), second4 + Y4, c4),
    )  # fmt: skip


@kernel(inline=True)
def flush(nodes, at, step, rows):
    """Nodes += three rows, `step` apart."""
    a8, a4, b8, b4, c8, c4 = rows
    store(nodes, at, load8(nodes, at) + a8)
    store(nodes, at + 8, load4(nodes, at + 8) + a4)
    at += step
    store(nodes, at, load8(nodes, at) + b8)
    store(nodes, at + 8, load4(nodes, at + 8) + b4)
    at += step
    store(nodes, at, load8(nodes, at) + c8)
    store(nodes, at + 8, load4(nodes, at + 8) + c4)


@kernel(inline=True)
def in_row(a, weights8, weights4):
    """The same four lanes on the three nodes of a row, weighted: (eight, four)."""
    return join(a, a) * weights8, a * weights4


@kernel(inline=True)
def row_of(a, step, weights8, weights4):
    """a, a + step and a + 2 step on the three nodes of a row, weighted: (eight, four)."""
    second = a + step
    return join(a, second) * weights8, (second + step) * weights4


@kernel(inline=True)
def weights(s, d, first, p):
    """Three weights of direction d along a row."""
    return join(splat4(s[d, first, p]), splat4(s[d, first + 1, p])), splat4(s[d, first + 2, p])


@kernel(inline=True)
def scatter_plane(space, gradient, chunk, count, nodes):
    """The particles of a chunk on to the nodes (n, 4) of a plane."""
    pack_plane(space, gradient, chunk, count)
    s, packed, wide = chunk.s, chunk.packed, chunk.packed.shape[1]
    nought8, nought4, step = splat8(nodes.dtype.type(0)), splat4(nodes.dtype.type(0)), 4 * space.n1
    rows, last = zeros(nodes), -1
    for p in range(count):
        at = 4 * (int(s[0, FIRST, p]) * space.n1 + int(s[1, FIRST, p]))
        if at != last:
            if last >= 0:
                flush(nodes, last, step, rows)
            rows, last = zeros(nodes), at
        mine = p * wide
        w8, w4 = weights(s, 1, W, p)
        eight, rest = row_of(load4(packed, mine), load4(packed, mine + 8), w8, w4)
        X8, X4 = in_row(load4(packed, mine + 4), w8, w4)
        if uses_basis_gradient(gradient):
            g8, g4 = weights(s, 1, G, p)
            gy8, gy4 = in_row(load4(packed, mine + 16), g8, g4)
            gx8, gx4 = in_row(load4(packed, mine + 12), w8, w4)
            eight, rest = eight + gy8, rest + gy4
            rows = added(rows, s, p, 0, G, gx8, gx4, nought8, nought4)
        rows = added(rows, s, p, 0, W, eight, rest, X8, X4)
    flush(nodes, last, step, rows)


@kernel(inline=True)
def scatter_volume(space, gradient, chunk, count, nodes):
    """The particles of a chunk on to the nodes (n, 4) of a volume."""
    pack_volume(space, gradient, chunk, count)
    s, packed, wide = chunk.s, chunk.packed, chunk.packed.shape[1]
    nought8, nought4 = splat8(nodes.dtype.type(0)), splat4(nodes.dtype.type(0))
    step, plane = 4 * space.n2, 4 * space.n1 * space.n2
    front, middle, back, last = zeros(nodes), zeros(nodes), zeros(nodes), -1
    for p in range(count):
        at = 4 * ((int(s[0, FIRST, p]) * space.n1 + int(s[1, FIRST, p])) * space.n2 + int(s[2, FIRST, p]))
        if at != last:
            if last >= 0:
                flush(nodes, last, step, front)
                flush(nodes, last + plane, step, middle)
                flush(nodes, last + 2 * plane, step, back)
            front, middle, back, last = zeros(nodes), zeros(nodes), zeros(nodes), at
        mine = p * wide
        w8, w4 = weights(s, 2, W, p)
        eight, rest = row_of(load4(packed, mine), load4(packed, mine + 12), w8, w4)
        X8, X4 = in_row(load4(packed, mine + 4), w8, w4)
        Y8, Y4 = in_row(load4(packed, mine + 8), w8, w4)
        if uses_basis_gradient(gradient):
            g8, g4 = weights(s, 2, G, p)
            gz8, gz4 = in_row(load4(packed, mine + 24), g8, g4)
            gx8, gx4 = in_row(load4(packed, mine + 16), w8, w4)
            gy8, gy4 = in_row(load4(packed, mine + 20), w8, w4)
            eight, rest = eight + gz8, rest + gz4
            u8, u4, v8, v4 = splat8(s[0, G, p]), splat4(s[0, G, p]), splat8(s[0, W, p]), splat4(s[0, W, p])
            front = added(front, s, p, 1, W, u8 * gx8, u4 * gx4, nought8, nought4)
            front = added(front, s, p, 1, G, v8 * gy8, v4 * gy4, nought8, nought4)
            u8, u4, v8, v4 = splat8(s[0, G + 1, p]), splat4(s[0, G + 1, p]), splat8(s[0, W + 1, p]), splat4(s[0, W + 1, p])
            middle = added(middle, s, p, 1, W, u8 * gx8, u4 * gx4, nought8, nought4)
            middle = added(middle, s, p, 1, G, v8 * gy8, v4 * gy4, nought8, nought4)
            u8, u4, v8, v4 = splat8(s[0, G + 2, p]), splat4(s[0, G + 2, p]), splat8(s[0, W + 2, p]), splat4(s[0, W + 2, p])
            back = added(back, s, p, 1, W, u8 * gx8, u4 * gx4, nought8, nought4)
            back = added(back, s, p, 1, G, v8 * gy8, v4 * gy4, nought8, nought4)
        u8, u4 = splat8(s[0, W, p]), splat4(s[0, W, p])
        front = added(front, s, p, 1, W, u8 * eight, u4 * rest, u8 * Y8, u4 * Y4)
        eight, rest, u8, u4 = eight + X8, rest + X4, splat8(s[0, W + 1, p]), splat4(s[0, W + 1, p])
        middle = added(middle, s, p, 1, W, u8 * eight, u4 * rest, u8 * Y8, u4 * Y4)
        eight, rest, u8, u4 = eight + X8, rest + X4, splat8(s[0, W + 2, p]), splat4(s[0, W + 2, p])
        back = added(back, s, p, 1, W, u8 * eight, u4 * rest, u8 * Y8, u4 * Y4)
    flush(nodes, last, step, front)
    flush(nodes, last + plane, step, middle)
    flush(nodes, last + 2 * plane, step, back)


@kernel(inline=True)
def along(eight, rest, w0, w1, w2):
    """Sum over the nodes of a row."""
    return fma(splat4(w0), low(eight), fma(splat4(w1), high(eight), splat4(w2) * rest))


@kernel(inline=True)
def gather_plane(space, gradient, chunk, count, nodes):
    """Velocity, slope and gradient of the particles of a chunk in a plane."""
    s, packed, wide = chunk.s, chunk.packed, chunk.packed.shape[1]
    nought = nodes.dtype.type(0)
    for p in range(count):
        v8, X8, gx8 = splat8(nought), splat8(nought), splat8(nought)
        v4, X4, gx4 = splat4(nought), splat4(nought), splat4(nought)
        at = 4 * (int(s[0, FIRST, p]) * space.n1 + int(s[1, FIRST, p]))
        for i in range(3):
            eight, rest, w, b = load8(nodes, at), load4(nodes, at + 8), s[0, W + i, p], s[0, B + i, p]
            v8, v4 = fma(splat8(w), eight, v8), fma(splat4(w), rest, v4)
            X8, X4 = fma(splat8(b), eight, X8), fma(splat4(b), rest, X4)
            if uses_basis_gradient(gradient):
                g = s[0, G + i, p]
                gx8, gx4 = fma(splat8(g), eight, gx8), fma(splat4(g), rest, gx4)
            at += 4 * space.n1
        w0, w1, w2 = s[1, W, p], s[1, W + 1, p], s[1, W + 2, p]
        mine = p * wide
        store(packed, mine, along(v8, v4, w0, w1, w2))
        store(packed, mine + 4, along(X8, X4, w0, w1, w2))
        store(packed, mine + 8, along(v8, v4, s[1, B, p], s[1, B + 1, p], s[1, B + 2, p]))
        if uses_basis_gradient(gradient):
            store(packed, mine + 12, along(gx8, gx4, w0, w1, w2))
            store(packed, mine + 16, along(v8, v4, s[1, G, p], s[1, G + 1, p], s[1, G + 2, p]))
    unpack_plane(gradient, chunk, count)


@kernel(inline=True)
def gather_volume(space, gradient, chunk, count, nodes):
    """Velocity, slope and gradient of the particles of a chunk in a volume."""
    s, packed, wide = chunk.s, chunk.packed, chunk.packed.shape[1]
    nought = nodes.dtype.type(0)
    for p in range(count):
        v8, X8, Y8, gx8, gy8 = splat8(nought), splat8(nought), splat8(nought), splat8(nought), splat8(nought)
        v4, X4, Y4, gx4, gy4 = splat4(nought), splat4(nought), splat4(nought), splat4(nought), splat4(nought)
        plane = 4 * ((int(s[0, FIRST, p]) * space.n1 + int(s[1, FIRST, p])) * space.n2 + int(s[2, FIRST, p]))
        for i in range(3):
            sum8, slope8, grad8 = splat8(nought), splat8(nought), splat8(nought)
            sum4, slope4, grad4 = splat4(nought), splat4(nought), splat4(nought)
            at = plane
            for j in range(3):
                eight, rest, w, b = load8(nodes, at), load4(nodes, at + 8), s[1, W + j, p], s[1, B + j, p]
                sum8, sum4 = fma(splat8(w), eight, sum8), fma(splat4(w), rest, sum4)
                slope8, slope4 = fma(splat8(b), eight, slope8), fma(splat4(b), rest, slope4)
                if uses_basis_gradient(gradient):
                    g = s[1, G + j, p]
                    grad8, grad4 = fma(splat8(g), eight, grad8), fma(splat4(g), rest, grad4)
                at += 4 * space.n2
            w, b = s[0, W + i, p], s[0, B + i, p]
            v8, v4 = fma(splat8(w), sum8, v8), fma(splat4(w), sum4, v4)
            X8, X4 = fma(splat8(b), sum8, X8), fma(splat4(b), sum4, X4)
            Y8, Y4 = fma(splat8(w), slope8, Y8), fma(splat4(w), slope4, Y4)
            if uses_basis_gradient(gradient):
                g = s[0, G + i, p]
                gx8, gx4 = fma(splat8(g), sum8, gx8), fma(splat4(g), sum4, gx4)
                gy8, gy4 = fma(splat8(w), grad8, gy8), fma(splat4(w), grad4, gy4)
            plane += 4 * space.n1 * space.n2
        w0, w1, w2 = s[2, W, p], s[2, W + 1, p], s[2, W + 2, p]
        mine = p * wide
        store(packed, mine, along(v8, v4, w0, w1, w2))
        store(packed, mine + 4, along(X8, X4, w0, w1, w2))
        store(packed, mine + 8, along(Y8, Y4, w0, w1, w2))
        store(packed, mine + 12, along(v8, v4, s[2, B, p], s[2, B + 1, p], s[2, B + 2, p]))
        if uses_basis_gradient(gradient):
            store(packed, mine + 16, along(gx8, gx4, w0, w1, w2))
            store(packed, mine + 20, along(gy8, gy4, w0, w1, w2))
            store(packed, mine + 24, along(v8, v4, s[2, G, p], s[2, G + 1, p], s[2, G + 2, p]))
    unpack_volume(gradient, chunk, count)
