"""Scatter and gather of quadratic B-splines in planes and volumes, a stencil row at once.

A node is four numbers [px py pz m], so the three nodes of a row are twelve in a row (mpm.lanes: load_row). What a particle puts on a row is
v_j (u_i (c + i X) + j u_i Y) times fixed lanes. Gather sums row by row, plane by plane, then in the row; of a direction it finds the sum and the moment,
sum w u j over nodes j = -1, 0, 1, of which packing.py makes the slope.
The rows of a stencil stay in registers while consecutive particles share them, two nodes of each where the next particle is one node further along.
"""

from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, like, load4, load8, load_row, peek, splat4, store, thirds, three
from mpm.transfer.packing import pack_plane, pack_volume, unpack_plane, unpack_volume
from mpm.transfer.roles import uses_basis_gradient, uses_slopes
from mpm.transfer.stencils import CHUNK, FIRST, ROWS, G, W

NODE = 4  # numbers of a node
Y, Z = ROWS * CHUNK, 2 * ROWS * CHUNK  # where the stencils of the second and third direction begin


@kernel(inline=True)
def begin_plane(space, chunk, count):
    """Where the stencil of each particle begins among the numbers of the nodes: beforehand, since loads of rows would wait for it."""
    s, begins = chunk.s, chunk.begins
    for p in range(count):
        begins[p] = 4 * (int(peek(s, FIRST * CHUNK + p)) * space.n1 + int(peek(s, Y + FIRST * CHUNK + p)))


@kernel(inline=True)
def across(chunk, count):
    """Products of the weights across rows, in three directions."""
    s = chunk.s
    for p in range(0, count, EIGHT):
        for i in range(3):
            u = load8(s, (W + i) * CHUNK + p)
            for j in range(3):
                store(chunk.uv, (3 * i + j) * CHUNK + p, u * load8(s, Y + (W + j) * CHUNK + p))


@kernel(inline=True)
def begin_volume(space, chunk, count):
    """As begin_plane, in three directions."""
    s, begins = chunk.s, chunk.begins
    for p in range(count):
        row = int(peek(s, FIRST * CHUNK + p)) * space.n1 + int(peek(s, Y + FIRST * CHUNK + p))
        begins[p] = 4 * (row * space.n2 + int(peek(s, Z + FIRST * CHUNK + p)))


@kernel(inline=True)
def zeros(nodes):
    """Three rows of a plane of the stencil."""
    nought = splat4(nodes.dtype.type(0))
    row = three(nought, nought, nought)
    return row, row, row


@kernel(inline=True)
def weights(s, at):
    """Three weights of a particle: row `at` of the stencils and the two after it."""
    return peek(s, at), peek(s, at + CHUNK), peek(s, at + 2 * CHUNK)


@kernel(inline=True)
def weights_along(s, at):
    """The same along a row."""
    return three(splat4(peek(s, at)), splat4(peek(s, at + CHUNK)), splat4(peek(s, at + 2 * CHUNK)))


@kernel(inline=True)
def alike(packed, at):
    """The same four lanes on the three nodes of a row."""
    a = load4(packed, at)
    return three(a, a, a)


@kernel(inline=True)
def thrice(row):
    return row, row, row


@kernel(inline=True)
def growing(packed, at, step):
    """a, a + Z and a + 2 Z on the three nodes of a row."""
    real = packed.dtype.type
    return fma(three(splat4(real(0)), splat4(real(1)), splat4(real(2))), alike(packed, step), alike(packed, at))


@kernel(inline=True)
def added(sums, w, rows):
    """Sums += w_j row_j."""
    return fma(like(rows[0], w[0]), rows[0], sums[0]), fma(like(rows[1], w[1]), rows[1], sums[1]), fma(like(rows[2], w[2]), rows[2], sums[2])


@kernel(inline=True)
def flush(nodes, at, step, rows):
    """Nodes += three rows, `step` apart."""
    store(nodes, at, load_row(nodes, at) + rows[0])
    store(nodes, at + step, load_row(nodes, at + step) + rows[1])
    store(nodes, at + 2 * step, load_row(nodes, at + 2 * step) + rows[2])


@kernel(inline=True)
def left_behind(nodes, at, step, rows):
    """Nodes += the first node of three rows; the rows from the next node on."""
    a, b, c = thirds(rows[0]), thirds(rows[1]), thirds(rows[2])
    store(nodes, at, load4(nodes, at) + a[0])
    store(nodes, at + step, load4(nodes, at + step) + b[0])
    store(nodes, at + 2 * step, load4(nodes, at + 2 * step) + c[0])
    nought = splat4(nodes.dtype.type(0))
    return three(a[1], a[2], nought), three(b[1], b[2], nought), three(c[1], c[2], nought)


@kernel(inline=True)
def scatter_plane(space, gradient, chunk, count, nodes):
    """The particles of a chunk on to the nodes (n, 4) of a plane."""
    pack_plane(space, gradient, chunk, count)
    s, begins, packed, wide, step = chunk.s, chunk.begins, chunk.packed, chunk.packed.shape[1], 4 * space.n1
    rows, last = zeros(nodes), -1
    for p in range(count):
        at = begins[p]
        if at == last + NODE:
            rows = left_behind(nodes, last, step, rows)
        elif at != last:
            if last >= 0:
                flush(nodes, last, step, rows)
            rows = zeros(nodes)
        last = at
        mine = p * wide
        w = weights_along(s, Y + W * CHUNK + p)
        row = growing(packed, mine, mine + 8) * w
        if uses_basis_gradient(gradient):
            row = row + alike(packed, mine + 16) * weights_along(s, Y + G * CHUNK + p)
            rows = added(rows, weights(s, G * CHUNK + p), thrice(alike(packed, mine + 12) * w))
        X = alike(packed, mine + 4) * w
        second = row + X
        rows = added(rows, weights(s, W * CHUNK + p), (row, second, second + X))
    flush(nodes, last, step, rows)


@kernel(inline=True)
def scatter_volume(space, gradient, chunk, count, nodes):
    """The particles of a chunk on to the nodes (n, 4) of a volume."""
    pack_volume(space, gradient, chunk, count)
    s, begins, packed, wide = chunk.s, chunk.begins, chunk.packed, chunk.packed.shape[1]
    step, plane = 4 * space.n2, 4 * space.n1 * space.n2
    front, middle, back, last = zeros(nodes), zeros(nodes), zeros(nodes), -1
    for p in range(count):
        at = begins[p]
        if at == last + NODE:
            front = left_behind(nodes, last, step, front)
            middle = left_behind(nodes, last + plane, step, middle)
            back = left_behind(nodes, last + 2 * plane, step, back)
        elif at != last:
            if last >= 0:
                flush(nodes, last, step, front)
                flush(nodes, last + plane, step, middle)
                flush(nodes, last + 2 * plane, step, back)
            front, middle, back = zeros(nodes), zeros(nodes), zeros(nodes)
        last = at
        mine = p * wide
        w, uv = weights_along(s, Z + W * CHUNK + p), chunk.uv
        row, X, rowY = growing(packed, mine, mine + 12) * w, alike(packed, mine + 4) * w, alike(packed, mine + 8) * w
        if uses_basis_gradient(gradient):
            row = row + alike(packed, mine + 24) * weights_along(s, Z + G * CHUNK + p)
            gx, gy = alike(packed, mine + 16) * w, alike(packed, mine + 20) * w
            u, v, U, V = weights(s, W * CHUNK + p), weights(s, Y + W * CHUNK + p), weights(s, G * CHUNK + p), weights(s, Y + G * CHUNK + p)
            front = added(added(front, v, thrice(like(gx, U[0]) * gx)), V, thrice(like(gy, u[0]) * gy))
            middle = added(added(middle, v, thrice(like(gx, U[1]) * gx)), V, thrice(like(gy, u[1]) * gy))
            back = added(added(back, v, thrice(like(gx, U[2]) * gx)), V, thrice(like(gy, u[2]) * gy))
        second = row + rowY
        rows = row, second, second + rowY
        front = added(front, weights(uv, p), rows)
        rows = rows[0] + X, rows[1] + X, rows[2] + X
        middle = added(middle, weights(uv, 3 * CHUNK + p), rows)
        rows = rows[0] + X, rows[1] + X, rows[2] + X
        back = added(back, weights(uv, 6 * CHUNK + p), rows)
    flush(nodes, last, step, front)
    flush(nodes, last + plane, step, middle)
    flush(nodes, last + 2 * plane, step, back)


@kernel(inline=True)
def sum_and_moment(u, w):
    """(sum w_j u_j, sum w_j u_j j) of three u_j, j = -1, 0, 1."""
    first, third = like(u[0], w[0]) * u[0], like(u[2], w[2]) * u[2]
    return fma(like(u[1], w[1]), u[1], first + third), third - first


@kernel(inline=True)
def summed(u, w):
    """sum w_j u_j of three."""
    return fma(like(u[0], w[0]), u[0], fma(like(u[1], w[1]), u[1], like(u[2], w[2]) * u[2]))


@kernel(inline=True)
def load_rows(nodes, at, step):
    """Three rows of nodes, `step` apart."""
    return load_row(nodes, at), load_row(nodes, at + step), load_row(nodes, at + 2 * step)


@kernel(inline=True)
def gather_plane(space, gradient, chunk, count, nodes):
    """Velocity, moments and gradient of the particles of a chunk in a plane."""
    s, begins, packed, wide, step = chunk.s, chunk.begins, chunk.packed, chunk.packed.shape[1], 4 * space.n1
    for p in range(count):
        at = begins[p]
        rows, w, mine = load_rows(nodes, at, step), weights(s, Y + W * CHUNK + p), p * wide
        v, X = sum_and_moment(rows, weights(s, W * CHUNK + p))
        v = thirds(v)
        value, moment = sum_and_moment(v, w)
        store(packed, mine, value)
        if uses_slopes(gradient):
            store(packed, mine + 4, summed(thirds(X), w))
            store(packed, mine + 8, moment)
        if uses_basis_gradient(gradient):
            store(packed, mine + 12, summed(thirds(summed(rows, weights(s, G * CHUNK + p))), w))
            store(packed, mine + 16, summed(v, weights(s, Y + G * CHUNK + p)))
    unpack_plane(space, gradient, chunk, count)


@kernel(inline=True)
def gather_volume(space, gradient, chunk, count, nodes):
    """The same in a volume."""
    s, begins, packed, wide = chunk.s, chunk.begins, chunk.packed, chunk.packed.shape[1]
    step, plane = 4 * space.n2, 4 * space.n1 * space.n2
    for p in range(count):
        at = begins[p]
        w, uv = weights(s, Z + W * CHUNK + p), chunk.uv
        front, middle, back = load_rows(nodes, at, step), load_rows(nodes, at + plane, step), load_rows(nodes, at + 2 * plane, step)
        (f, fY), (m, mY), (b, bY) = (
            sum_and_moment(front, weights(uv, p)), sum_and_moment(middle, weights(uv, 3 * CHUNK + p)), sum_and_moment(back, weights(uv, 6 * CHUNK + p))
        )  # fmt: skip
        sums, X = f + b + m, b - f
        row, mine = thirds(sums), p * wide
        value, moment = sum_and_moment(row, w)
        store(packed, mine, value)
        if uses_slopes(gradient):
            store(packed, mine + 4, summed(thirds(X), w))
            store(packed, mine + 8, summed(thirds(fY + mY + bY), w))
            store(packed, mine + 12, moment)
        if uses_basis_gradient(gradient):
            v, V = weights(s, Y + W * CHUNK + p), weights(s, Y + G * CHUNK + p)
            gx = summed((summed(front, v), summed(middle, v), summed(back, v)), weights(s, G * CHUNK + p))
            gy = summed((summed(front, V), summed(middle, V), summed(back, V)), weights(s, W * CHUNK + p))
            store(packed, mine + 16, summed(thirds(gx), w))
            store(packed, mine + 20, summed(thirds(gy), w))
            store(packed, mine + 24, summed(row, weights(s, Z + G * CHUNK + p)))
    unpack_volume(space, gradient, chunk, count)
