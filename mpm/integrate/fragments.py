"""Gaps in a body: into how many pieces its particles fall when those within a reach of one another hold together.

Distances alone, so a body that turns, moves or lies anywhere on the grid has the number it had. Particles of one cell of edge reach/sqrt(D) hold together;
what is left is whether two cells do, for cells at most two apart that are not of one piece already.
Cost          0.1 us a particle and output time in 2-D, 0.3 in 3-D with two particles a cell and direction (tests/integrate/test_fragments.py, -m slow)
Fails when    a crack does not reach through the body: what it leaves is one piece.
"""

import math

import numpy as np

from mpm.integrate.sorting import sorting
from mpm.jit import kernel

ONE, TWO = 1.05, 2.05  # reach in cells: particles exactly a cell apart are not told of, whatever round-off says
DENSE = 32  # cells of the box a particle, up to which counting sorts faster
STRETCH = 1.02  # strain that a body may have before a bond that it began with counts as lost


def torn(x: np.ndarray, h: float, strain: float = 1.0) -> tuple[int, int]:
    """Pieces of particles x (N, D) [m] that are more than a cell apart, and more than two; `strain` > 1: before the body is stretched by as much."""
    x = np.ascontiguousarray(x, dtype=float)
    one = pieces(x, ONE * h / strain)
    return one, pieces(x, TWO * h / strain) if one > 1 else 1


@kernel
def root(parent, k):
    """The piece of cell k; the way there becomes shorter."""
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@kernel
def close(x, order, a, b, c, d, reach):
    """Whether a particle of order[a:b] is within reach of one of order[c:d]."""
    for i in range(a, b):
        for j in range(c, d):
            square = 0.0
            for k in range(x.shape[1]):
                way = x[order[i], k] - x[order[j], k]
                square += way * way
            if square <= reach * reach:
                return True
    return False


@kernel
def join(x, order, key, first, cells, parent, way, reach):
    """Join every cell with the one `way` further on where a particle of each is within reach; how many became one with another."""
    joined, b = 0, 0
    for a in range(cells):
        there = key[order[first[a]]] + way
        while b < cells and key[order[first[b]]] < there:
            b += 1
        if b == cells:
            break
        if key[order[first[b]]] == there:
            one, other = root(parent, a), root(parent, b)
            if one != other and close(x, order, first[a], first[a + 1], first[b], first[b + 1], reach):
                parent[other] = one
                joined += 1
    return joined


@kernel
def place(x, edge, far, key, steps):
    """Number of each particle's cell, and what a cell further on in each direction has more."""
    N, D = x.shape
    stride = 1
    for k in range(D - 1, -1, -1):
        low, high = x[0, k], x[0, k]
        for i in range(N):
            low, high = min(low, x[i, k]), max(high, x[i, k])
        least = math.floor(low / edge)
        for i in range(N):
            key[i] += stride * (math.floor(x[i, k] / edge) - least)
        steps[k] = stride
        stride *= math.floor(high / edge) - least + 1 + far  # room at the end: no cell is beside one of another row


@kernel
def count(x, key, order, steps, far, reach):
    """Pieces of the particles in `order` of their cells."""
    N, D = x.shape
    first = np.zeros(N + 1, np.int64)  # of each cell in `order`
    cells = 0
    for i in range(N):
        if i == 0 or key[order[i]] != key[order[i - 1]]:
            first[cells] = i
            cells += 1
    first[cells] = N
    parent, left, wide = np.empty(cells, np.int64), cells, 2 * far + 1
    for k in range(cells):
        parent[k] = k
    for k in range(D):  # the next in each direction joins nearly all
        left -= join(x, order, key, first, cells, parent, steps[k], reach)
    offset = wide**D // 2 + 1  # then one of each pair of opposite ways
    while left > 1 and offset < wide**D:
        rest, way = offset, 0
        for k in range(D - 1, -1, -1):
            way += (rest % wide - far) * steps[k]
            rest //= wide
        left -= join(x, order, key, first, cells, parent, way, reach)
        offset += 1
    return left


def pieces(x: np.ndarray, reach: float) -> int:
    """Sets of particles x (N, D) that no chain of particles within `reach` [m] of one another joins."""
    (N, D), far = x.shape, math.ceil(math.sqrt(x.shape[1]))  # cells that a reach spans
    key, steps = np.zeros(N, np.int64), np.zeros(3, np.int64)
    place(x, reach / math.sqrt(D), far, key, steps)
    order = sorting(key) if key.max() < DENSE * N else np.argsort(key)  # which Numba would compile for seconds
    return int(count(x, key, order, steps, far, reach))
