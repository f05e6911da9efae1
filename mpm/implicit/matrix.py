"""The second derivative of a step's potential, and how K du = -r is solved: a banded Cholesky factor in one and two directions, conjugate gradients in three.

Band     lower half of K by unknowns, band[j, i - j] = K_ij; LAPACK's dpbtrf. A factor that fails says that K is not positive.
Blocks   D x D blocks of each node with those it shares a particle or a line of ghosts with, by the offset between the two: at most two nodes aside
         in any direction, or three along one. Conjugate gradients with the inverse of the nodes' own blocks, to RESIDUAL of the start's
         (M. R. Hestenes, E. Stiefel, J. Res. Nat. Bur. Stand. 49 (1952) 409); a direction along which K does not rise says that K is not positive.
Why      a band in three directions is a whole layer of nodes wide: at 30 000 particles a factor takes longer than hundreds of products.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dpbtrf, dpbtrs

from mpm.boundary import directions
from mpm.jit import kernel, role

RESIDUAL, MOST_PRODUCTS = 1e-7, 5000  # of the residual in the norm of the inverse blocks; products
TWISTED, ROUNDED, MOST_TWISTS = 1e-3, 1e-10, 50  # of the residual in the norm of K^-1; of its size; solutions with K
FAR, WIDE = 3, 7  # nodes aside: what particles and ghosts reach; 2 FAR + 1


class Band(NamedTuple):
    """n unknowns, b of them reached below the diagonal."""

    values: np.ndarray  # (n, b + 1)


class Blocks(NamedTuple):
    """A nodes with S neighbours each."""

    values: np.ndarray  # (A, S, D, D)
    near: np.ndarray  # (A, S) number of the node at an offset; -1: none
    slot: np.ndarray  # (WIDE^3,) number of an offset; -1: none has it
    place: np.ndarray  # (A, D) where a node is on the grid
    free: np.ndarray  # (A, D) 0 where a wall holds
    shift: np.ndarray  # (A, D) added to the diagonal


def offsets() -> np.ndarray:
    """(S, 3) offsets of nodes that share a row."""
    every = np.stack(np.meshgrid(*[np.arange(-FAR, FAR + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    size = np.abs(every)
    return every[(size.max(axis=1) < FAR) | ((size.max(axis=1) == FAR) & (size.sum(axis=1) == FAR))]


def new_matrix(space, nodes):
    """A matrix of zeros for the nodes of a step."""
    if directions(space) < 3:
        return Band(np.zeros((nodes.unknowns, nodes.band + 1)))
    every, places = offsets(), nodes.places
    low = places.min(axis=0) - FAR
    number = np.full(places.max(axis=0) - low + 1 + FAR, -1)
    number[tuple((places - low).T)] = np.arange(len(places))
    near = np.stack([number[tuple((places - low + offset).T)] for offset in every], axis=1)
    slot = np.full(WIDE**3, -1)
    slot[(every + FAR) @ (WIDE * WIDE, WIDE, 1)] = np.arange(len(every))
    A, S, D = len(places), len(every), 3
    return Blocks(np.zeros((A, S, D, D)), near, slot, places, (nodes.eq >= 0).astype(float), np.zeros((A, D)))


@role
def add(matrix, nodes, n, c, m, d, value):
    """K of component c at node n and d at node m grows by value; called for both orders of the two."""
    raise TypeError(f"no matrix {type(matrix).__name__}")


@add.register(Band)
def add_band(matrix, nodes, n, c, m, d, value):
    i, j = nodes.eq[n, c], nodes.eq[m, d]
    if i >= j >= 0:
        matrix.values[j, i - j] += value


@add.register(Blocks)
def add_blocks(matrix, nodes, n, c, m, d, value):
    matrix.values[n, between(matrix, n, m), c, d] += value


@kernel(inline=True)
def between(blocks, n, m):
    """Number of the offset from node n to node m."""
    at = 0
    for a in range(3):
        at = WIDE * at + blocks.place[m, a] - blocks.place[n, a] + FAR
    return blocks.slot[at]


def add_diagonal(matrix, nodes, value: np.ndarray) -> None:
    """value (A, D) to the diagonal."""
    if isinstance(matrix, Band):
        free = nodes.eq >= 0
        matrix.values[nodes.eq[free], 0] += value[free]
    else:
        own = matrix.values[:, matrix.slot[(FAR * WIDE + FAR) * WIDE + FAR]]
        own[:, np.arange(3), np.arange(3)] += value


def diagonal(matrix, nodes) -> np.ndarray:
    """|K_ii| (A, D), 0 where a wall holds."""
    if isinstance(matrix, Blocks):
        own = matrix.values[:, matrix.slot[(FAR * WIDE + FAR) * WIDE + FAR]]
        return np.abs(own[:, np.arange(3), np.arange(3)]) * matrix.free
    free = nodes.eq >= 0
    found = np.zeros(free.shape)
    found[free] = np.abs(matrix.values[nodes.eq[free], 0])
    return found


def solver(matrix, nodes, shift: np.ndarray):
    """right (R, A, D) -> K^-1 right of R right sides, with `shift` (A, D) added to K's diagonal, which is spent; None where it is not positive."""
    if isinstance(matrix, Blocks):
        own = matrix.values[:, matrix.slot[(FAR * WIDE + FAR) * WIDE + FAR]]
        matrix.shift[:] = shift
        blocks = inverse(own, matrix)

        def by_gradients(right):
            out = np.zeros(right.shape)
            done = [conjugate(matrix, one * matrix.free, blocks, found) for one, found in zip(right, out, strict=True)]
            return out if min(done) >= 0 and np.isfinite(out).all() else None

        return by_gradients
    free, band = nodes.eq >= 0, matrix.values
    band[nodes.eq[free], 0] += shift[free]
    factor, info = dpbtrf(band.T, lower=1, overwrite_ab=1)

    def by_factor(right):
        columns, out = np.empty((nodes.unknowns, len(right)), order="F"), np.zeros(right.shape)
        columns[nodes.eq[free]] = right[:, free].T
        found, _ = dpbtrs(factor, columns, lower=1)
        out[:, free] = found[nodes.eq[free]].T
        return out if np.isfinite(found).all() else None

    return by_factor if info == 0 else None


def untwisted(solve, twist, right: np.ndarray) -> np.ndarray | None:
    """(K + S)^-1 right (A, D) of a skew S, twist(x) = S x, by solutions with K to TWISTED of the first (O. Widlund, SIAM J. Numer. Anal. 15 (1978) 801)."""
    x, old, past, share = *np.zeros((3, *right.shape)), 1.0
    Ax, first, size = past.copy(), 0.0, 0.0
    for count in range(MOST_TWISTS):
        left = right - Ax
        v = solve(left[None])
        if v is None:
            return None
        last, size = size, float(np.sum(v[0] * left))
        if size <= TWISTED * TWISTED * first:
            break
        if count == 0:
            first = size
        else:
            share = 1.0 / (1.0 + size / (last * share))
        Av = left + twist(v[0])
        x, old = old + share * (v[0] + x - old), x
        Ax, past = past + share * (Av + Ax - past), Ax
        if count == 0 and np.sum((Av - left) ** 2) <= ROUNDED * ROUNDED * np.sum(left * left):  # nothing is twisted
            break
    return x


def inverse(own: np.ndarray, blocks: Blocks) -> np.ndarray:
    """Inverse of the nodes' own blocks (A, D, D), the identity where a wall holds; where a block is not positive, of the size of its diagonal."""
    both = own * blocks.free[:, :, None] * blocks.free[:, None, :]
    size = np.abs(both[:, np.arange(3), np.arange(3)]) + blocks.shift
    both[:, np.arange(3), np.arange(3)] += blocks.shift + (1.0 - blocks.free)
    wrong = np.linalg.eigvalsh(both)[:, 0] <= 0.0
    both[wrong] = 0.0
    both[wrong[:, None, None] & np.eye(3, dtype=bool)] = np.where(size[wrong] > 0.0, size[wrong], 1.0).ravel()
    return np.linalg.inv(both)


@kernel
def product(blocks, x, out):
    """out <- K x (A, D), 0 where a wall holds."""
    A, S = blocks.near.shape
    for n in range(A):
        a0, a1, a2 = blocks.shift[n, 0] * x[n, 0], blocks.shift[n, 1] * x[n, 1], blocks.shift[n, 2] * x[n, 2]
        for s in range(S):
            m = blocks.near[n, s]
            if m >= 0:
                v = blocks.values[n, s]
                x0, x1, x2 = x[m, 0], x[m, 1], x[m, 2]
                a0 += v[0, 0] * x0 + v[0, 1] * x1 + v[0, 2] * x2
                a1 += v[1, 0] * x0 + v[1, 1] * x1 + v[1, 2] * x2
                a2 += v[2, 0] * x0 + v[2, 1] * x1 + v[2, 2] * x2
        out[n, 0], out[n, 1], out[n, 2] = blocks.free[n, 0] * a0, blocks.free[n, 1] * a1, blocks.free[n, 2] * a2


@kernel
def conjugate(blocks, right, inverse, x):
    """x (A, D) <- K^-1 right from x = 0; how many products it took, -1 where K does not rise along a direction or they do not suffice."""
    A = x.shape[0]
    r, z, q = right.copy(), np.empty(x.shape), np.empty(x.shape)
    first = weigh(inverse, r, z)
    rho, aim, p = first, RESIDUAL * RESIDUAL * first, z.copy()
    for count in range(MOST_PRODUCTS):
        if rho <= aim:
            return count
        product(blocks, p, q)
        rise = 0.0
        for n in range(A):
            for a in range(3):
                rise += p[n, a] * q[n, a]
        if not rise > 0.0:
            return -1
        part = rho / rise
        for n in range(A):
            for a in range(3):
                x[n, a] += part * p[n, a]
                r[n, a] -= part * q[n, a]
        new = weigh(inverse, r, z)
        part = new / rho
        rho = new
        for n in range(A):
            for a in range(3):
                p[n, a] = z[n, a] + part * p[n, a]
    return -1


@kernel
def weigh(inverse, r, z):
    """z (A, D) <- inverse r; r.z"""
    total = 0.0
    for n in range(r.shape[0]):
        for a in range(3):
            z[n, a] = inverse[n, a, 0] * r[n, 0] + inverse[n, a, 1] * r[n, 1] + inverse[n, a, 2] * r[n, 2]
            total += z[n, a] * r[n, a]
    return total
