"""Scatter and gather of quadratic B-splines in planes and volumes, a stencil row at once.

A node is four numbers [px py pz m], so the three nodes of a row are twelve in a row: lanes of eight (two nodes) and of four (the third). What a particle
puts on a row is w (c + i X + j Y) times fixed lanes, two multiply-adds a row; gather is its transpose, summed row by row, plane by plane, then in the row.
"""

from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, four, high, item, join, load4, load8, low, splat4, splat8, store
from mpm.transfer.roles import lay_down, uses_basis_gradient
from mpm.transfer.stencils import FIRST, OFFSET, B, G, W, stencil_chunk


@kernel(inline=True)
def place_chunk(space, x, first, chunk, count, box):
    """Positions of the chunk's particles and their stencils."""
    lay_down(x, first, count, chunk.place)
    stencil_chunk(space, chunk.place, count, chunk.s, box)


@kernel(inline=True)
def in_row(a, weights8, weights4):
    """The same four lanes on the three nodes of a row, weighted: (eight, four)."""
    return join(a, a) * weights8, a * weights4


@kernel(inline=True)
def along(eight, rest, w0, w1, w2):
    """Sum over the nodes of a row."""
    return fma(splat4(w0), low(eight), fma(splat4(w1), high(eight), splat4(w2) * rest))


@kernel(inline=True)
def add(nodes, at, w8, w4, eight, rest):
    """One row of nodes += w times what a particle puts there."""
    store(nodes, at, fma(w8, eight, load8(nodes, at)))
    store(nodes, at + 8, fma(w4, rest, load4(nodes, at + 8)))


@kernel(inline=True)
def scatter_plane(space, gradient, chunk, count, nodes):
    """The particles of a chunk on to the nodes (n, 4) of a plane."""
    s, a, A, T, m = chunk.s, chunk.a, chunk.A, chunk.G, chunk.m
    nought, h = nodes.dtype.type(0), nodes.dtype.type(space.h)
    h4 = splat4(h)
    for p in range(count):
        X, Y = four(A[0, 0, p], A[1, 0, p], nought, nought), four(A[0, 1, p], A[1, 1, p], nought, nought)
        corner = four(a[0, p], a[1, p], m[p], nought)
        corner = fma(splat4(s[0, OFFSET, p]), X, fma(splat4(s[1, OFFSET, p]), Y, corner))
        X, Y = h4 * X, h4 * Y
        w8, w4 = join(splat4(s[1, W, p]), splat4(s[1, W + 1, p])), splat4(s[1, W + 2, p])
        second = corner + Y
        eight, rest = join(corner, second) * w8, (second + Y) * w4
        X8, X4 = in_row(X, w8, w4)
        if uses_basis_gradient(gradient):
            g = four(T[0, 1, p], T[1, 1, p], nought, nought)
            gy8, gy4 = in_row(g, join(splat4(s[1, G, p]), splat4(s[1, G + 1, p])), splat4(s[1, G + 2, p]))
            gx8, gx4 = in_row(four(T[0, 0, p], T[1, 0, p], nought, nought), w8, w4)
            eight, rest = eight + gy8, rest + gy4
        at = 4 * (int(s[0, FIRST, p]) * space.n1 + int(s[1, FIRST, p]))
        for i in range(3):
            if uses_basis_gradient(gradient):
                add(nodes, at, splat8(s[0, G + i, p]), splat4(s[0, G + i, p]), gx8, gx4)
            add(nodes, at, splat8(s[0, W + i, p]), splat4(s[0, W + i, p]), eight, rest)
            eight, rest = eight + X8, rest + X4
            at += 4 * space.n1


@kernel(inline=True)
def scatter_volume(space, gradient, chunk, count, nodes):
    """The particles of a chunk on to the nodes (n, 4) of a volume."""
    s, a, A, T, m = chunk.s, chunk.a, chunk.A, chunk.G, chunk.m
    nought, h = nodes.dtype.type(0), nodes.dtype.type(space.h)
    h4 = splat4(h)
    for p in range(count):
        X = four(A[0, 0, p], A[1, 0, p], A[2, 0, p], nought)
        Y = four(A[0, 1, p], A[1, 1, p], A[2, 1, p], nought)
        Z = four(A[0, 2, p], A[1, 2, p], A[2, 2, p], nought)
        corner = fma(splat4(s[2, OFFSET, p]), Z, four(a[0, p], a[1, p], a[2, p], m[p]))
        corner = fma(splat4(s[0, OFFSET, p]), X, fma(splat4(s[1, OFFSET, p]), Y, corner))
        X, Y, Z = h4 * X, h4 * Y, h4 * Z
        w8, w4 = join(splat4(s[2, W, p]), splat4(s[2, W + 1, p])), splat4(s[2, W + 2, p])
        second = corner + Z
        eight, rest = join(corner, second) * w8, (second + Z) * w4
        X8, X4 = in_row(X, w8, w4)
        Y8, Y4 = in_row(Y, w8, w4)
        if uses_basis_gradient(gradient):
            g = four(T[0, 2, p], T[1, 2, p], T[2, 2, p], nought)
            gz8, gz4 = in_row(g, join(splat4(s[2, G, p]), splat4(s[2, G + 1, p])), splat4(s[2, G + 2, p]))
            gy8, gy4 = in_row(four(T[0, 1, p], T[1, 1, p], T[2, 1, p], nought), w8, w4)
            gx8, gx4 = in_row(four(T[0, 0, p], T[1, 0, p], T[2, 0, p], nought), w8, w4)
            eight, rest = eight + gz8, rest + gz4
        plane = 4 * ((int(s[0, FIRST, p]) * space.n1 + int(s[1, FIRST, p])) * space.n2 + int(s[2, FIRST, p]))
        for i in range(3):
            row8, row4, at = eight, rest, plane
            for j in range(3):
                w = s[0, W + i, p] * s[1, W + j, p]
                if uses_basis_gradient(gradient):
                    gx, gy = s[0, G + i, p] * s[1, W + j, p], s[0, W + i, p] * s[1, G + j, p]
                    add(nodes, at, splat8(gx), splat4(gx), gx8, gx4)
                    add(nodes, at, splat8(gy), splat4(gy), gy8, gy4)
                add(nodes, at, splat8(w), splat4(w), row8, row4)
                row8, row4 = row8 + Y8, row4 + Y4
                at += 4 * space.n2
            eight, rest = eight + X8, rest + X4
            plane += 4 * space.n1 * space.n2


@kernel(inline=True)
def keep(target, k, p, D, column):
    """Column k of a tensor of particle p."""
    for c in range(D):
        target[c, k, p] = item(column, c)


@kernel(inline=True)
def same_gradient(gradient, chunk, count):
    """With the MLS gradient it is the slope: copied where it has an array of its own."""
    if not uses_basis_gradient(gradient) and chunk.L.ctypes.data != chunk.C.ctypes.data:
        n = chunk.m.shape[0]
        for k in range(chunk.v.shape[0] * chunk.v.shape[0]):
            for p in range(0, count, EIGHT):
                store(chunk.L, k * n + p, load8(chunk.C, k * n + p))


@kernel(inline=True)
def gather_plane(space, gradient, chunk, count, nodes):
    """Velocity, slope and gradient of the particles of a chunk in a plane."""
    s = chunk.s
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
        v = along(v8, v4, w0, w1, w2)
        chunk.v[0, p], chunk.v[1, p] = item(v, 0), item(v, 1)
        keep(chunk.C, 0, p, 2, along(X8, X4, w0, w1, w2))
        keep(chunk.C, 1, p, 2, along(v8, v4, s[1, B, p], s[1, B + 1, p], s[1, B + 2, p]))
        if uses_basis_gradient(gradient):
            keep(chunk.L, 0, p, 2, along(gx8, gx4, w0, w1, w2))
            keep(chunk.L, 1, p, 2, along(v8, v4, s[1, G, p], s[1, G + 1, p], s[1, G + 2, p]))
    same_gradient(gradient, chunk, count)


@kernel(inline=True)
def gather_volume(space, gradient, chunk, count, nodes):
    """Velocity, slope and gradient of the particles of a chunk in a volume."""
    s = chunk.s
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
        v = along(v8, v4, w0, w1, w2)
        chunk.v[0, p], chunk.v[1, p], chunk.v[2, p] = item(v, 0), item(v, 1), item(v, 2)
        keep(chunk.C, 0, p, 3, along(X8, X4, w0, w1, w2))
        keep(chunk.C, 1, p, 3, along(Y8, Y4, w0, w1, w2))
        keep(chunk.C, 2, p, 3, along(v8, v4, s[2, B, p], s[2, B + 1, p], s[2, B + 2, p]))
        if uses_basis_gradient(gradient):
            keep(chunk.L, 0, p, 3, along(gx8, gx4, w0, w1, w2))
            keep(chunk.L, 1, p, 3, along(gy8, gy4, w0, w1, w2))
            keep(chunk.L, 2, p, 3, along(v8, v4, s[2, G, p], s[2, G + 1, p], s[2, G + 2, p]))
    same_gradient(gradient, chunk, count)
