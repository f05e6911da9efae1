"""Scatter and gather of one scalar field by quadratic B-splines in planes and volumes: the three nodes of a stencil row as four lanes, the last one idle.

What concerns weights is done for eight particles at once, what concerns nodes particle by particle; packing.py turns the one into the other. Rows stay in
registers while consecutive particles share them. The form is that of rows.py, but sums over the last direction come last, over eight particles.
Heat is float64, whatever the particles are. Fewer than eight, as the pieces of a surface, and more than a chunk go one by one (plane.py, volume.py).
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, item, load4, load8, peek, poke, splat4, splat8, store
from mpm.transfer.packing import FOUR, pack, unpack
from mpm.transfer.roles import to_rows
from mpm.transfer.rows import NODE, Y, Z, added, begin_plane, begin_volume, sum_and_moment, summed, weights
from mpm.transfer.stencils import CHUNK, OFFSET, ROWS, WITHIN, W, stencil_chunk
from mpm.transfer.stencils import G as SLOPE


class Scalars(NamedTuple):
    """Scratch of one chunk of a scalar field, in float64."""

    place: np.ndarray  # (D, n) positions
    s: np.ndarray  # (D, ROWS, n) stencils
    begins: np.ndarray  # (n,) as of a chunk of vectors: NODE times the node where a particle's stencil begins
    packed: np.ndarray  # (n, 8 D - 4) fours of a particle: a row, what it grows by across rows, its gradient across rows
    told: np.ndarray  # (1 + 2 D, n) value, slope and gradient of eight particles at once


@kernel(arrays=True)
def new_scalars(D):
    """Uninitialised, at the start of a cache line. Made for every chunk: a chunk of heat has no scratch of its own to bring."""
    n, wide = CHUNK, 8 * D - 4
    pool = np.empty((D + D * ROWS + wide + 1 + 2 * D) * n + 8)
    at = -pool.ctypes.data % 64 // 8
    place, at = pool[at : at + D * n].reshape(D, n), at + D * n
    s, at = pool[at : at + D * ROWS * n].reshape(D, ROWS, n), at + D * ROWS * n
    packed, at = pool[at : at + wide * n].reshape(n, wide), at + wide * n
    return Scalars(place, s, np.empty(n, np.int64), packed, pool[at : at + (1 + 2 * D) * n].reshape(1 + 2 * D, n))


@kernel(inline=True)
def three_rows(s, at):
    """Three rows of the stencils, of eight particles."""
    return load8(s, at), load8(s, at + CHUNK), load8(s, at + 2 * CHUNK)


@kernel(inline=True)
def fill_in(told, a, A, G, count):
    """What is to be scattered."""
    D = A.shape[0]
    for p in range(count):
        told[0, p] = a[p]
    for k in range(D):
        for p in range(count):
            told[1 + k, p], told[1 + D + k, p] = A[k, p], G[k, p]


@kernel(inline=True)
def read_out(told, value, slope, grad, count):
    """What was gathered."""
    D = slope.shape[0]
    for p in range(count):
        value[p] = told[0, p]
    for k in range(D):
        for p in range(count):
            slope[k, p], grad[k, p] = told[1 + k, p], told[1 + D + k, p]


@kernel(inline=True)
def pack_row(packed, p, k, at_first, growth, w, tensor, g):
    """(at_first + growth j) w_j + tensor g_j on the nodes j = 0, 1, 2 of a row, for eight particles."""
    second = at_first + growth
    pack(packed, p, k, fma(at_first, w[0], tensor * g[0]), fma(second, w[1], tensor * g[1]), fma(second + growth, w[2], tensor * g[2]), splat8(0.0))


@kernel(inline=True)
def pack_times(packed, p, k, x, w):
    """x w_j on the nodes of a row."""
    pack(packed, p, k, x * w[0], x * w[1], x * w[2], splat8(0.0))


@kernel(inline=True)
def put_down(nodes, at, step, rows):
    """Nodes += three rows, `step` apart: three nodes of each, as the fourth may be another thread's."""
    for row in rows:
        poke(nodes, at, peek(nodes, at) + item(row, 0))
        poke(nodes, at + 1, peek(nodes, at + 1) + item(row, 1))
        poke(nodes, at + 2, peek(nodes, at + 2) + item(row, 2))
        at += step


@kernel(inline=True)
def nothing():
    """Three rows of zeros."""
    nought = splat4(0.0)
    return nought, nought, nought


@kernel(inline=True)
def row_of(told, k, p):
    return load8(told, k * CHUNK + p)


@kernel(arrays=True)
def scatter_scalar_plane(space, x, first, count, a, A, G, nodes):
    """Eight particles or more of a chunk, in a plane."""
    t = new_scalars(directions(space))
    to_rows(x, first, count, t.place)
    stencil_chunk(space, t.place, count, t.s)
    begin_plane(space, t, count)
    fill_in(t.told, a, A, G, count)
    s, packed, told, h, step = t.s, t.packed, t.told, splat8(space.h), space.n1
    for p in range(0, count, EIGHT):
        w, g = three_rows(s, Y + W * CHUNK + p), three_rows(s, Y + SLOPE * CHUNK + p)
        ax, ay = row_of(told, 1, p), row_of(told, 2, p)
        value = fma(ax, load8(s, OFFSET * CHUNK + p), fma(ay, load8(s, Y + OFFSET * CHUNK + p), row_of(told, 0, p)))
        pack_row(packed, p, 0, value, h * ay, w, row_of(told, 4, p), g)
        pack_times(packed, p, 1, h * ax, w)
        pack_times(packed, p, 2, row_of(told, 3, p), w)
    rows, last = nothing(), -1
    for p in range(count):
        at, mine = t.begins[p] // NODE, p * packed.shape[1]
        if at != last:
            if last >= 0:
                put_down(nodes, last, step, rows)
            rows = nothing()
        last = at
        row, across, tensor = load4(packed, mine), load4(packed, mine + FOUR), load4(packed, mine + 2 * FOUR)
        second = row + across
        rows = added(rows, weights(s, W * CHUNK + p), (row, second, second + across))
        rows = added(rows, weights(s, SLOPE * CHUNK + p), (tensor, tensor, tensor))
    put_down(nodes, last, step, rows)


@kernel(arrays=True)
def scatter_scalar_volume(space, x, first, count, a, A, G, nodes):
    """The same in a volume."""
    t = new_scalars(directions(space))
    to_rows(x, first, count, t.place)
    stencil_chunk(space, t.place, count, t.s)
    begin_volume(space, t, count)
    fill_in(t.told, a, A, G, count)
    s, packed, told, h, step, plane = t.s, t.packed, t.told, splat8(space.h), space.n2, space.n1 * space.n2
    for p in range(0, count, EIGHT):
        w, g = three_rows(s, Z + W * CHUNK + p), three_rows(s, Z + SLOPE * CHUNK + p)
        ax, ay, az = row_of(told, 1, p), row_of(told, 2, p), row_of(told, 3, p)
        value = fma(ay, load8(s, Y + OFFSET * CHUNK + p), fma(az, load8(s, Z + OFFSET * CHUNK + p), row_of(told, 0, p)))
        pack_row(packed, p, 0, fma(ax, load8(s, OFFSET * CHUNK + p), value), h * az, w, row_of(told, 6, p), g)
        pack_times(packed, p, 1, h * ax, w)
        pack_times(packed, p, 2, h * ay, w)
        pack_times(packed, p, 3, row_of(told, 4, p), w)
        pack_times(packed, p, 4, row_of(told, 5, p), w)
    front, middle, back, last = nothing(), nothing(), nothing(), -1
    for p in range(count):
        at, mine = t.begins[p] // NODE, p * packed.shape[1]
        if at != last:
            if last >= 0:
                put_down(nodes, last, step, front)
                put_down(nodes, last + plane, step, middle)
                put_down(nodes, last + 2 * plane, step, back)
            front, middle, back = nothing(), nothing(), nothing()
        last = at
        row, gx, gy = load4(packed, mine), load4(packed, mine + 3 * FOUR), load4(packed, mine + 4 * FOUR)
        X, rowY = load4(packed, mine + FOUR), load4(packed, mine + 2 * FOUR)
        u, U = weights(s, W * CHUNK + p), weights(s, SLOPE * CHUNK + p)
        v, V = weights(s, Y + W * CHUNK + p), weights(s, Y + SLOPE * CHUNK + p)
        second = row + X
        front = plane_of(front, row, rowY, (gx, gy), (u[0], U[0]), v, V)
        middle = plane_of(middle, second, rowY, (gx, gy), (u[1], U[1]), v, V)
        back = plane_of(back, second + X, rowY, (gx, gy), (u[2], U[2]), v, V)
    put_down(nodes, last, step, front)
    put_down(nodes, last + plane, step, middle)
    put_down(nodes, last + 2 * plane, step, back)


@kernel(inline=True)
def plane_of(sums, row, growth, tensor, across, v, V):
    """Three rows of a plane of nodes += v_j (u (row + j growth) + U gx) + V_j u gy, with tensor (gx, gy) and across (u, U)."""
    real = growth * across[0]
    first, more = fma(splat4(across[1]), tensor[0], row * across[0]), tensor[1] * across[0]
    second = first + real
    return added(added(sums, v, (first, second, second + real)), V, (more, more, more))


@kernel(inline=True)
def load_threes(nodes, at, step):
    """Three rows of nodes, `step` apart, each with the node behind it."""
    return load4(nodes, at), load4(nodes, at + step), load4(nodes, at + 2 * step)


@kernel(inline=True)
def fitted(space, s, k, p, value, moment):
    """Component k of the slope, 4/h^2 sum w u d_k, from the moment sum w u j: see packing.slope."""
    return (4.0 / space.h) * fma(-load8(s, (k * ROWS + WITHIN) * CHUNK + p), value, moment)


@kernel(arrays=True)
def gather_scalar_plane(space, x, first, count, nodes, value, slope, grad):
    """Eight particles or more of a chunk, in a plane."""
    t = new_scalars(directions(space))
    to_rows(x, first, count, t.place)
    stencil_chunk(space, t.place, count, t.s)
    begin_plane(space, t, count)
    s, packed, told, step = t.s, t.packed, t.told, space.n1
    for p in range(count):
        at, mine = t.begins[p] // NODE, p * packed.shape[1]
        rows = load_threes(nodes, at, step)
        row, across = sum_and_moment(rows, weights(s, W * CHUNK + p))
        store(packed, mine, row)
        store(packed, mine + FOUR, across)
        store(packed, mine + 2 * FOUR, summed(rows, weights(s, SLOPE * CHUNK + p)))
    for p in range(0, count, EIGHT):
        w, row = three_rows(s, Y + W * CHUNK + p), unpack(packed, p, 0)
        u, moment = sum_and_moment(row, w)
        store(told, p, u)
        store(told, CHUNK + p, fitted(space, s, 0, p, u, summed(unpack(packed, p, 1), w)))
        store(told, 2 * CHUNK + p, fitted(space, s, 1, p, u, moment))
        store(told, 3 * CHUNK + p, summed(unpack(packed, p, 2), w))
        store(told, 4 * CHUNK + p, summed(row, three_rows(s, Y + SLOPE * CHUNK + p)))
    read_out(told, value, slope, grad, count)


@kernel(arrays=True)
def gather_scalar_volume(space, x, first, count, nodes, value, slope, grad):
    """The same in a volume."""
    t = new_scalars(directions(space))
    to_rows(x, first, count, t.place)
    stencil_chunk(space, t.place, count, t.s)
    begin_volume(space, t, count)
    s, packed, told, step, plane = t.s, t.packed, t.told, space.n2, space.n1 * space.n2
    for p in range(count):
        at, mine = t.begins[p] // NODE, p * packed.shape[1]
        front, middle, back = load_threes(nodes, at, step), load_threes(nodes, at + plane, step), load_threes(nodes, at + 2 * plane, step)
        u, v, V = weights(s, W * CHUNK + p), weights(s, Y + W * CHUNK + p), weights(s, Y + SLOPE * CHUNK + p)
        (f, fY), (m, mY), (b, bY) = sum_and_moment(front, v), sum_and_moment(middle, v), sum_and_moment(back, v)
        row, X = sum_and_moment((f, m, b), u)
        store(packed, mine, row)
        store(packed, mine + FOUR, X)
        store(packed, mine + 2 * FOUR, summed((fY, mY, bY), u))
        store(packed, mine + 3 * FOUR, summed((f, m, b), weights(s, SLOPE * CHUNK + p)))
        store(packed, mine + 4 * FOUR, summed((summed(front, V), summed(middle, V), summed(back, V)), u))
    for p in range(0, count, EIGHT):
        w, row = three_rows(s, Z + W * CHUNK + p), unpack(packed, p, 0)
        u, moment = sum_and_moment(row, w)
        store(told, p, u)
        store(told, CHUNK + p, fitted(space, s, 0, p, u, summed(unpack(packed, p, 1), w)))
        store(told, 2 * CHUNK + p, fitted(space, s, 1, p, u, summed(unpack(packed, p, 2), w)))
        store(told, 3 * CHUNK + p, fitted(space, s, 2, p, u, moment))
        store(told, 4 * CHUNK + p, summed(unpack(packed, p, 3), w))
        store(told, 5 * CHUNK + p, summed(unpack(packed, p, 4), w))
        store(told, 6 * CHUNK + p, summed(row, three_rows(s, Z + SLOPE * CHUNK + p)))
    read_out(told, value, slope, grad, count)
