"""The nodes of one rigid body: a box of the scene's grid, quadratic B-splines on it, and matrices as stencils.

Node i of a direction lies at origin + i h, its spline between knots origin + (i -+ 3/2) h; over the knot cell c = [(c - 1/2) h, (c + 1/2) h] the splines
c - 1, c, c + 1 live, N = (1/2 (1/2 - f)^2, 3/4 - f^2, 1/2 (1/2 + f)^2) with f = x/h - c. A body owns the nodes whose splines reach it.
A symmetric matrix is a stencil: S[o, i] = A[i, i + diff[o]] for the (5^d + 1)/2 differences >= 0, which is also LAPACK's lower band storage
row by row. Directions are numbered so that the longest changes slowest: the band is then narrowest.
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel

SNAP = 1e-9  # of a cell: an overlap thinner than this makes no nodes of its own


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
    local = np.zeros((3**d, 3), dtype=np.int64)
    local[:, :d] = np.stack(np.meshgrid(*[np.arange(3)] * d, indexing="ij"), axis=-1).reshape(-1, d)
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
def assemble(nodes, d, x, w, cell, counts, with_gradient, mass, stiffness):
    """Adds sum_q w N_i N_j to `mass` and, with gradients, sum_q w grad N_i . grad N_j to `stiffness` (stencils).

    x (Q, d), w (Q,), cell (Q,) flat in C order over `counts` cells a direction. Consecutive points of one cell share an element matrix.
    """
    m = nodes.local.shape[0]
    n, dn = np.ones((3, 3)), np.zeros((3, 3))
    value, slope = np.empty(m), np.empty((m, 3))
    element, gradient = np.zeros((m, m)), np.zeros((m, m))
    at = np.zeros(3, dtype=np.int64)
    last = np.int64(-1)
    base = np.int64(0)
    for q in range(len(w) + 1):
        if q == len(w) or cell[q] != last:
            if last >= 0:
                for a in range(m):
                    i = base + nodes.local[a, 0] * nodes.stride[0] + nodes.local[a, 1] * nodes.stride[1] + nodes.local[a, 2] * nodes.stride[2]
                    for b in range(m):
                        o = nodes.place[a, b]
                        if o >= 0:
                            mass[o, i] += element[a, b]
                            if with_gradient:
                                stiffness[o, i] += gradient[a, b]
                        element[a, b] = 0.0
                        gradient[a, b] = 0.0
            if q == len(w):
                break
            last = cell[q]
            rest = last
            base = 0
            for k in range(d - 1, -1, -1):
                at[k] = rest % counts[k]
                rest //= counts[k]
                base += at[k] * nodes.stride[k]
        for k in range(d):
            spline((x[q, k] - nodes.origin[k]) / nodes.h - (nodes.first[k] + 1 + at[k]), n, dn, k)
        for a in range(m):
            i, j, k = nodes.local[a, 0], nodes.local[a, 1], nodes.local[a, 2]
            value[a] = n[0, i] * n[1, j] * n[2, k]
            slope[a, 0] = dn[0, i] * n[1, j] * n[2, k]
            slope[a, 1] = n[0, i] * dn[1, j] * n[2, k]
            slope[a, 2] = n[0, i] * n[1, j] * dn[2, k]
        scale = w[q] / nodes.h**2
        for a in range(m):
            wa = w[q] * value[a]
            for b in range(m):
                element[a, b] += wa * value[b]
            if with_gradient:
                s0, s1, s2 = scale * slope[a, 0], scale * slope[a, 1], scale * slope[a, 2]
                for b in range(m):
                    gradient[a, b] += s0 * slope[b, 0] + s1 * slope[b, 1] + s2 * slope[b, 2]


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
    """y = A x for a symmetric stencil."""
    n = len(x)
    y[:] = 0.0
    for o in range(len(stencil)):
        k = diff[o]
        s = stencil[o]
        if k == 0:
            for i in range(n):
                y[i] += s[i] * x[i]
        else:
            for i in range(n - k):
                y[i] += s[i] * x[i + k]
            for i in range(n - k):
                y[i + k] += s[i] * x[i]


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
