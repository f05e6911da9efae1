"""Inertia of the nodes: momentum p (over m) moves them by an inverse of their mass that is right for longer waves.

    v_i = p_i + sum_j b_ij (p_i - p_j)/m_i,   b_ij = s min(m_i, m_j) of neighbours j along the grid,   s = 1/4 (quadratic), 1/3 (cubic)

m_i = sum_p m_p w_ip alone (row sums) makes waves of number k late: the consistent mass has the symbol 1 - s (kh)^2 + ..., with s the variance of the spline in
cells. Here its inverse is 1 + s (kh)^2 + ... (a reciprocal mass), and waves are right to (kh)^4. b is symmetric, so momentum and its moment are kept, and
1/2 sum m p.v is the kinetic energy, which a free vibration keeps. What rests does not feel it.
Walls   one that slips: a node on it has half a neighbourhood, so m counts twice for the pair across. One that sticks: its nodes keep the row sum, and count as
        0 for their neighbours, as the spline is there.
Source  A. Tkachuk, M. Bischoff, Int. J. Numer. Meth. Engng 101 (2015) 435 (reciprocal mass); J. A. Nairn, arXiv:2604.07307 (FMPM, a series for the inverse)
Errors  of the sum over neighbours, of order h where m changes from node to node: at a surface, and within a few cells of the axis in axisymmetry
"""

import numpy as np

from mpm.boundary import CONTACT, STICK, directions, extents
from mpm.jit import kernel
from mpm.lanes import load4, peek, splat4, store
from mpm.state import PAD, Cubic
from mpm.total.reference import hold

SWEEPS = 200  # at most: the gap falls by a third or more in each


def spreading(space, m: np.ndarray, active: np.ndarray, walls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(spread (n, 1 + 2 D): sum of b_ij/m_i, and each b_ij/m_i or 0 for a j that counts as 0; beside (2 D,): from a node's number to its neighbours')."""
    D, shape = directions(space), np.array(extents(space)[: directions(space)])
    variance, strides = 1 / 3 if isinstance(space.basis, Cubic) else 1 / 4, np.append(np.cumprod(shape[:0:-1])[::-1], 1)
    spread, beside = np.zeros((len(m), 1 + 2 * D)), np.stack([-strides, strides], axis=-1).ravel()
    place, there, stuck, across = np.unravel_index(active, shape), np.zeros(len(m), bool), np.zeros(len(m), bool), [m.copy() for _ in range(D)]
    there[active] = True
    for axis, side in np.argwhere(walls[:D] < CONTACT):
        on = active[place[axis] == (PAD if side == 0 else shape[axis] - 1 - PAD)]
        if walls[axis, side] == STICK:
            stuck[on] = True
        else:
            across[axis][on] *= 2
    for k, by in enumerate(beside):
        i = active[there[active + by] & ~stuck[active]]
        j, weight = i + by, across[k // 2]
        b = variance * np.minimum(weight[i], weight[j]) / m[i]
        spread[i, 0] += b
        spread[i, 1 + k] = np.where(stuck[j], 0.0, b)
    return spread, beside


@kernel
def follow(reference):
    """v of the nodes from the momentum that they carry."""
    p, v, spread, beside = reference.p, reference.v, reference.spread, reference.beside
    one, row = spread.dtype.type(1), spread.shape[1]
    if p.shape[1] == 4:  # lanes of a node
        for n in reference.active:
            total = splat4(one + peek(spread, row * n)) * load4(p, 4 * n)
            for k in range(row - 1):
                total = total - splat4(peek(spread, row * n + 1 + k)) * load4(p, 4 * (n + beside[k]))
            store(v, 4 * n, total)
    else:
        for n in reference.active:
            v[n, 0] = (one + spread[n, 0]) * p[n, 0] - spread[n, 1] * p[n + beside[0], 0] - spread[n, 2] * p[n + beside[1], 0]
    hold(v, reference)


@kernel
def impel(reference):
    """The momentum that v of the nodes is, by Richardson's method to round-off: eigenvalues lie between 1 and 1 + twice the largest sum of b_ij/m_i."""
    p, v, D, most, before = reference.p, reference.v.copy(), reference.X.shape[1], 0.0, np.inf
    for n in reference.active:
        most = max(most, 2.0 * reference.spread[n, 0])
        for c in range(D):
            p[n, c] = v[n, c]
    for _ in range(SWEEPS):
        follow(reference)
        off = 0.0
        for n in reference.active:
            for c in range(D):
                off = max(off, abs(v[n, c] - reference.v[n, c]))
        if not off < 0.9 * before:
            break
        before = off
        for n in reference.active:
            for c in range(D):
                p[n, c] += 2.0 / (2.0 + most) * (v[n, c] - reference.v[n, c])
        hold(p, reference)
    follow(reference)
