"""Nodes to particles and back by the basis and its own gradient alone: what a body on fixed weights asks at every step (mpm.total).

    take   v = sum w u,  L = sum u grad(w)            give   node += w a + G grad(w)

The sums of `gather` and `scatter` (roles.py) without slopes and masses: quadratic splines by rows of lanes (rows.py) with two thirds of their work, others by
those two, with m and A of the chunk zero.
"""

from mpm.jit import role
from mpm.lanes import EIGHT, fma, like, load8, splat8, store, thirds
from mpm.state import Axisymmetric, Cubic, Line, Plane, Quadratic, Volume
from mpm.transfer.packing import columns_plane, columns_volume, pack, unpack
from mpm.transfer.roles import Bspline, gather, scatter
from mpm.transfer.rows import NODE, Y, Z, added, alike, flush, left_behind, load_rows, summed, thrice, weights, weights_along, zeros
from mpm.transfer.stencils import CHUNK, G, W


@role(inline=True)
def take(space, x, first, chunk, count, nodes):
    """Fill v and L of the chunk from `nodes` (n, columns(D)), at the positions x that `lay_down` put into it."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role(inline=True)
def give(space, x, first, chunk, count, nodes):
    """Add a and G of the chunk on to `nodes`."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role(inline=True)
def take_plane(basis, space, x, first, chunk, count, nodes):
    """`take` in two directions."""
    raise TypeError(f"no basis {type(basis).__name__}")


@role(inline=True)
def give_plane(basis, space, x, first, chunk, count, nodes):
    """`give` in two directions."""
    raise TypeError(f"no basis {type(basis).__name__}")


@role(inline=True)
def take_volume(basis, space, x, first, chunk, count, nodes):
    """`take` in three directions."""
    raise TypeError(f"no basis {type(basis).__name__}")


@role(inline=True)
def give_volume(basis, space, x, first, chunk, count, nodes):
    """`give` in three directions."""
    raise TypeError(f"no basis {type(basis).__name__}")


@take.register(Line)
def take_in_line(space, x, first, chunk, count, nodes):
    gather(space, Bspline(), x, first, chunk, count, nodes)


@take.register(Plane)
@take.register(Axisymmetric)
def take_in_axisymmetric_or_plane(space, x, first, chunk, count, nodes):
    take_plane(space.basis, space, x, first, chunk, count, nodes)


@take.register(Volume)
def take_in_volume(space, x, first, chunk, count, nodes):
    take_volume(space.basis, space, x, first, chunk, count, nodes)


@give.register(Line)
def give_in_line(space, x, first, chunk, count, nodes):
    scatter(space, Bspline(), x, first, chunk, count, nodes, chunk.reach)


@give.register(Plane)
@give.register(Axisymmetric)
def give_in_axisymmetric_or_plane(space, x, first, chunk, count, nodes):
    give_plane(space.basis, space, x, first, chunk, count, nodes)


@give.register(Volume)
def give_in_volume(space, x, first, chunk, count, nodes):
    give_volume(space.basis, space, x, first, chunk, count, nodes)


@take_plane.register(Cubic)
@take_volume.register(Cubic)
def take_cubic(basis, space, x, first, chunk, count, nodes):
    gather(space, Bspline(), x, first, chunk, count, nodes)


@give_plane.register(Cubic)
@give_volume.register(Cubic)
def give_cubic(basis, space, x, first, chunk, count, nodes):
    scatter(space, Bspline(), x, first, chunk, count, nodes, chunk.reach)


@take_plane.register(Quadratic)
def take_plane_quadratic(basis, space, x, first, chunk, count, nodes):
    s, begins, packed, wide, step = chunk.s, chunk.begins, chunk.packed, chunk.packed.shape[1], 4 * space.n1
    for p in range(count):
        rows, w, mine = load_rows(nodes, begins[p], step), weights(s, Y + W * CHUNK + p), p * wide
        row = thirds(summed(rows, weights(s, W * CHUNK + p)))
        store(packed, mine, summed(row, w))
        store(packed, mine + 4, summed(thirds(summed(rows, weights(s, G * CHUNK + p))), w))
        store(packed, mine + 8, summed(row, weights(s, Y + G * CHUNK + p)))
    for p in range(0, count, EIGHT):
        v = unpack(packed, p, 0)
        store(chunk.v, p, v[0])
        store(chunk.v, CHUNK + p, v[1])
        columns_plane(chunk.L, 0, p, unpack(packed, p, 1))
        columns_plane(chunk.L, 1, p, unpack(packed, p, 2))


@give_plane.register(Quadratic)
def give_plane_quadratic(basis, space, x, first, chunk, count, nodes):
    """The stencils of the chunk are those of the `take` before."""
    a, T, n, nought = chunk.a, chunk.G, CHUNK, splat8(chunk.m.dtype.type(0))
    for p in range(0, count, EIGHT):
        pack(chunk.packed, p, 0, load8(a, p), load8(a, n + p), nought, nought)
        pack(chunk.packed, p, 1, load8(T, p), load8(T, 2 * n + p), nought, nought)
        pack(chunk.packed, p, 2, load8(T, n + p), load8(T, 3 * n + p), nought, nought)
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
        mine, w = p * wide, weights_along(s, Y + W * CHUNK + p)
        across = fma(alike(packed, mine), w, alike(packed, mine + 8) * weights_along(s, Y + G * CHUNK + p))
        rows = added(rows, weights(s, W * CHUNK + p), thrice(across))
        rows = added(rows, weights(s, G * CHUNK + p), thrice(alike(packed, mine + 4) * w))
    flush(nodes, last, step, rows)


@take_volume.register(Quadratic)
def take_volume_quadratic(basis, space, x, first, chunk, count, nodes):
    s, begins, packed, wide = chunk.s, chunk.begins, chunk.packed, chunk.packed.shape[1]
    step, plane = 4 * space.n2, 4 * space.n1 * space.n2
    for p in range(count):
        at, mine = begins[p], p * wide
        u, v, w = weights(s, W * CHUNK + p), weights(s, Y + W * CHUNK + p), weights(s, Z + W * CHUNK + p)
        V = weights(s, Y + G * CHUNK + p)
        front, middle, back = load_rows(nodes, at, step), load_rows(nodes, at + plane, step), load_rows(nodes, at + 2 * plane, step)
        planes = summed(front, v), summed(middle, v), summed(back, v)
        row = thirds(summed(planes, u))
        store(packed, mine, summed(row, w))
        store(packed, mine + 4, summed(thirds(summed(planes, weights(s, G * CHUNK + p))), w))
        store(packed, mine + 8, summed(thirds(summed((summed(front, V), summed(middle, V), summed(back, V)), u)), w))
        store(packed, mine + 12, summed(row, weights(s, Z + G * CHUNK + p)))
    for p in range(0, count, EIGHT):
        value = unpack(packed, p, 0)
        store(chunk.v, p, value[0])
        store(chunk.v, CHUNK + p, value[1])
        store(chunk.v, 2 * CHUNK + p, value[2])
        columns_volume(chunk.L, 0, p, unpack(packed, p, 1))
        columns_volume(chunk.L, 1, p, unpack(packed, p, 2))
        columns_volume(chunk.L, 2, p, unpack(packed, p, 3))


@give_volume.register(Quadratic)
def give_volume_quadratic(basis, space, x, first, chunk, count, nodes):
    """The stencils of the chunk are those of the `take` before."""
    a, T, n, nought = chunk.a, chunk.G, CHUNK, splat8(chunk.m.dtype.type(0))
    for p in range(0, count, EIGHT):
        pack(chunk.packed, p, 0, load8(a, p), load8(a, n + p), load8(a, 2 * n + p), nought)
        pack(chunk.packed, p, 1, load8(T, p), load8(T, 3 * n + p), load8(T, 6 * n + p), nought)
        pack(chunk.packed, p, 2, load8(T, n + p), load8(T, 4 * n + p), load8(T, 7 * n + p), nought)
        pack(chunk.packed, p, 3, load8(T, 2 * n + p), load8(T, 5 * n + p), load8(T, 8 * n + p), nought)
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
        mine, w = p * wide, weights_along(s, Z + W * CHUNK + p)
        u, v, U, V = weights(s, W * CHUNK + p), weights(s, Y + W * CHUNK + p), weights(s, G * CHUNK + p), weights(s, Y + G * CHUNK + p)
        along = fma(alike(packed, mine), w, alike(packed, mine + 12) * weights_along(s, Z + G * CHUNK + p))
        gx, gy = alike(packed, mine + 4) * w, alike(packed, mine + 8) * w
        front = added(added(front, v, thrice(fma(like(gx, U[0]), gx, like(along, u[0]) * along))), V, thrice(like(gy, u[0]) * gy))
        middle = added(added(middle, v, thrice(fma(like(gx, U[1]), gx, like(along, u[1]) * along))), V, thrice(like(gy, u[1]) * gy))
        back = added(added(back, v, thrice(fma(like(gx, U[2]), gx, like(along, u[2]) * along))), V, thrice(like(gy, u[2]) * gy))
    flush(nodes, last, step, front)
    flush(nodes, last + plane, step, middle)
    flush(nodes, last + 2 * plane, step, back)
