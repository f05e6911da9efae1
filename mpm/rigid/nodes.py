"""The nodes of one rigid body: a box of the scene's grid, quadratic B-splines on it, and matrices as stencils.

Node i of a direction lies at origin + i h, its spline between knots origin + (i -+ 3/2) h; over the knot cell c = [(c - 1/2) h, (c + 1/2) h] the splines
c - 1, c, c + 1 live, N = (1/2 (1/2 - f)^2, 3/4 - f^2, 1/2 (1/2 + f)^2) with f = x/h - c. A body owns the nodes whose splines reach it.
A symmetric matrix is a stencil: S[o, i] = A[i, i + diff[o]] for the (5^d + 1)/2 differences >= 0, which is also LAPACK's lower band storage
row by row. Directions are numbered so that the longest changes slowest: the band is then narrowest.
"""

import functools
from typing import NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, load8, splat8, store

SNAP = 1e-9  # of a cell: an overlap thinner than this makes no nodes of its own
TOGETHER = 32  # points of a cell that assembly takes at a time


class Nodes(NamedTuple):
    """Box of nodes; arrays of length 3, a direction beyond the dimension has one node at weight one."""

    h: float
    origin: np.ndarray  # (3,) place of node 0 of the scene [m]
    first: np.ndarray  # (3,) number of the first node of the box
    count: np.ndarray  # (3,) nodes a direction
    stride: np.ndarray  # (3,) step in the flat index
    local: np.ndarray  # (m, 3) offsets of the splines of a cell: 0, 1, 2 in each direction; 0, 1 of hats
    diff: np.ndarray  # (n,) flat differences >= 0 of the stencil, rising
    place: np.ndarray  # (3^d, 3^d) row of the stencil of a pair, -1 where its difference is negative

    @property
    def size(self) -> int:
        return int(np.prod(self.count))


@functools.lru_cache
def corners(d: int) -> np.ndarray:
    """Offsets of the splines of a cell: 0, 1, 2 in each of d directions (3^d, 3)."""
    local = np.zeros((3**d, 3), dtype=np.int64)
    local[:, :d] = np.stack(np.meshgrid(*[np.arange(3)] * d, indexing="ij"), axis=-1).reshape(-1, d)
    return local


def make_nodes(lower, upper, h: float, origin) -> tuple[Nodes, list[np.ndarray]]:
    """Nodes that reach the box from `lower` to `upper`, and the knots (cell edges) of each direction."""
    d = len(lower)
    start = np.floor((np.asarray(lower) - origin) / h + 0.5 + SNAP).astype(np.int64)
    end = np.ceil((np.asarray(upper) - origin) / h - 0.5 - SNAP).astype(np.int64)
    count, first, place0 = np.ones(3, dtype=np.int64), np.zeros(3, dtype=np.int64), np.zeros(3)
    count[:d], first[:d], place0[:d] = end - start + 3, start - 1, origin
    stride, step = np.zeros(3, dtype=np.int64), 1
    for k in np.argsort(count[:d], kind="stable"):
        stride[k] = step
        step *= count[k]
    local = corners(d)
    pair = (local[None] - local[:, None]) @ stride
    diff = np.unique(pair[pair >= 0])
    place = np.where(pair >= 0, np.searchsorted(diff, pair), -1)
    edges = [origin[k] + h * (np.arange(start[k], end[k] + 2) - 0.5) for k in range(d)]
    return Nodes(h, place0, first, count, stride, local, diff, place), edges


@kernel(inline=True)
def spline(f, n, dn, k):
    """Values and derivatives (per h) of the three splines of a cell at f in [-1/2, 1/2], into row k."""
    n[k, 0], n[k, 1], n[k, 2] = 0.5 * (0.5 - f) ** 2, 0.75 - f * f, 0.5 * (0.5 + f) ** 2
    dn[k, 0], dn[k, 1], dn[k, 2] = f - 0.5, -2.0 * f, f + 0.5


@kernel
def products(n, dn, d, with_gradient, value, slope):
    """Values (m,) and, where wanted, slopes (d, m) of the splines of a cell from those of each direction."""
    a = 0
    for i in range(3):
        for j in range(3 if d > 1 else 1):
            for k in range(3 if d > 2 else 1):
                value[a] = n[0, i] * n[1, j] * n[2, k]
                if with_gradient:
                    slope[0, a] = dn[0, i] * n[1, j] * n[2, k]
                    if d > 1:
                        slope[1, a] = n[0, i] * dn[1, j] * n[2, k]
                    if d > 2:
                        slope[2, a] = n[0, i] * n[1, j] * dn[2, k]
                a += 1


@kernel
def squares(y, m, v, scale, count):
    """y (m, width) += sum_q scale_q v_q v_q^T over the first `count` rows of v (., width); m = 3, 9 or 27."""
    width = y.shape[1]
    for a in range(0, m, 3):
        for b in range(0, width, EIGHT):
            at = a * width + b
            first, second, third = load8(y, at), load8(y, at + width), load8(y, at + 2 * width)
            for q in range(count):
                whole = load8(v, q * width + b) * scale[q]
                first, second, third = fma(splat8(v[q, a]), whole, first), fma(splat8(v[q, a + 1]), whole, second), fma(splat8(v[q, a + 2]), whole, third)
            store(y, at, first)
            store(y, at + width, second)
            store(y, at + 2 * width, third)


@kernel
def assemble(nodes, d, x, w, cell, counts, with_gradient, mass, stiffness):
    """Adds sum_q w N_i N_j to `mass` and, with gradients, sum_q w grad N_i . grad N_j to `stiffness` (stencils).

    x (Q, d), w (Q,), cell (Q,) flat in C order over `counts` cells a direction. Consecutive points of one cell share an element matrix, TOGETHER at a time.
    """
    m = nodes.local.shape[0]
    width = -(-m // EIGHT) * EIGHT  # rows of whole lanes
    n, dn = np.ones((3, 3)), np.zeros((3, 3))
    value, slope, scale, scales = np.zeros((TOGETHER, width)), np.zeros((TOGETHER * d, width)), np.empty(TOGETHER), np.empty(TOGETHER * d)
    element, gradient = np.zeros((m, width)), np.zeros((m, width))
    at = np.zeros(3, dtype=np.int64)
    q = 0
    while q < len(w):
        home = cell[q]
        rest, base = home, np.int64(0)
        for k in range(d - 1, -1, -1):
            at[k] = rest % counts[k]
            rest //= counts[k]
            base += at[k] * nodes.stride[k]
        element[:], gradient[:] = 0.0, 0.0
        while q < len(w) and cell[q] == home:
            count = 0
            while count < TOGETHER and q < len(w) and cell[q] == home:
                for k in range(d):
                    spline((x[q, k] - nodes.origin[k]) / nodes.h - (nodes.first[k] + 1 + at[k]), n, dn, k)
                products(n, dn, d, with_gradient, value[count], slope[count * d : count * d + d])
                scale[count] = w[q]
                scales[count * d : count * d + d] = w[q] / nodes.h**2
                count += 1
                q += 1
            squares(element, m, value, scale, count)
            if with_gradient:
                squares(gradient, m, slope, scales, count * d)
        for a in range(m):
            i = base + nodes.local[a, 0] * nodes.stride[0] + nodes.local[a, 1] * nodes.stride[1] + nodes.local[a, 2] * nodes.stride[2]
            for b in range(m):
                o = nodes.place[a, b]
                if o >= 0:
                    mass[o, i] += element[a, b]
                    if with_gradient:
                        stiffness[o, i] += gradient[a, b]


@kernel
def evaluate(nodes, d, x):
    """Flat nodes (P, m) and values (P, m) of the m = 3^d splines, or 2^d hats, at points x (P, d); beyond the box the last cell's polynomials go on."""
    m = nodes.local.shape[0]
    hats = m == 2**d
    index, value = np.empty((len(x), m), dtype=np.int64), np.empty((len(x), m))
    n, dn = np.ones((3, 3)), np.zeros((3, 3))
    for p in range(len(x)):
        base = 0
        for k in range(d):
            f = (x[p, k] - nodes.origin[k]) / nodes.h - nodes.first[k]
            if hats:
                at = min(max(int(np.floor(f)), 0), nodes.count[k] - 2)
                n[k, 0], n[k, 1] = 1.0 - (f - at), f - at
                base += at * nodes.stride[k]
            else:
                at = min(max(int(np.floor(f + 0.5)), 1), nodes.count[k] - 2)
                spline(f - at, n, dn, k)
                base += (at - 1) * nodes.stride[k]
        for a in range(m):
            i, j, k = nodes.local[a, 0], nodes.local[a, 1], nodes.local[a, 2]
            index[p, a] = base + i * nodes.stride[0] + j * nodes.stride[1] + k * nodes.stride[2]
            value[p, a] = n[0, i] * n[1, j] * n[2, k]
    return index, value


@kernel
def apply(stencil, diff, x, y):
    """y = A x for a symmetric stencil: eight rows of A at once, x with zeros before and behind (what the stencil has there is not a number of A, or 0)."""
    n, reach = len(x), diff[-1]
    wide = np.zeros(n + 2 * reach + EIGHT)
    for i in range(n):
        wide[reach + i] = x[i]
    whole = n - n % EIGHT
    for i in range(0, whole, EIGHT):
        at = reach + i
        total = load8(stencil, i) * load8(wide, at)
        for o in range(1, len(diff)):
            k = diff[o]
            total = fma(load8(stencil, o * n + i), load8(wide, at + k), total)
            total = fma(load8(stencil, o * n + i - k), load8(wide, at - k), total)
        store(y, i, total)
    for i in range(whole, n):
        total = stencil[0, i] * x[i]
        for o in range(1, len(diff)):
            k = diff[o]
            if i + k < n:
                total += stencil[o, i] * x[i + k]
            if i >= k:
                total += stencil[o, i - k] * x[i - k]
        y[i] = total


@kernel
def interpolate(index, value, u):
    """Values at points of the field with coefficients u."""
    out = np.empty(len(index))
    for p in range(len(index)):
        s = 0.0
        for a in range(index.shape[1]):
            s += value[p, a] * u[index[p, a]]
        out[p] = s
    return out
