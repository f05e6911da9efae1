"""The matrix of an implicit heat step, C + dt A, on the nodes with capacity, and conjugate gradients on it with an incomplete Cholesky factor.

    A = sum V kappa grad(w) grad(w)^T + sum S beta w~ w~^T          ghost nodes of mirror walls stand for their images: R A R^T

Row r holds the entries (r, c), c not before r in raster order; a difference of node numbers (i, j, k) has the place (i W + j) W + k,
W = 2 (nodes a direction) - 1.
The factor has no entries beyond these places; where a pivot is not positive its diagonal is raised, doubling from SHIFT.
Iterations a solution (heat_iterations over heat_steps_implicit of a run), configs/studies/robin_cylinder.yaml as particles, 16 cells a radius: Bi 10: 3
in steps of 0.15 h^2 and 6 in steps of 1.5 h^2; beta = inf (a penalty of 1000 kappa/h): 13 and 36. In a prototype the diagonal alone took 10, 21, 141 and 296.
An iteration costs one product with the rows and two with the factor, and no passage over the particles.
"""

from typing import NamedTuple

import numpy as np

from mpm.basis import stencil
from mpm.boundary import CONTACT, directions
from mpm.jit import kernel, role
from mpm.state import PAD, Axisymmetric, Line, Plane, Volume

MOST_ITERATIONS, SHIFT = 5000, 1e-3


@kernel(inline=True)
def image(i, n, low, high):
    """The node that stands for node i of n: itself, or its image in a mirror wall."""
    if low != CONTACT and i < PAD:
        return 2 * PAD - i
    if high != CONTACT and i > n - 1 - PAD:
        return 2 * (n - 1 - PAD) - i
    return i


@role
def nodes_of(space, x, p, walls, at, w, g, d):
    """Numbers at (D, M) of the nodes that particle p reaches, weights w (M,), gradients g (D, M) and ways d (D, M) from the particle to them [m]."""
    raise TypeError(f"no nodes of {type(space).__name__}")


@nodes_of.register(Line)
def nodes_of_line(space, x, p, walls, at, w, g, d):
    i0, wx, gx, dx, _ = stencil(space.basis, x[p, 0] / space.h)
    for i in range(len(wx)):
        at[0, i] = image(i0 + i, space.n0, walls[0, 0], walls[0, 1])
        w[i], g[0, i], d[0, i] = wx[i], gx[i] / space.h, dx[i] * space.h


@nodes_of.register(Plane)
@nodes_of.register(Axisymmetric)
def nodes_of_axisymmetric_or_plane(space, x, p, walls, at, w, g, d):
    i0, wx, gx, dx, _ = stencil(space.basis, x[p, 0] / space.h)
    j0, wy, gy, dy, _ = stencil(space.basis, x[p, 1] / space.h)
    m = 0
    for i in range(len(wx)):
        for j in range(len(wy)):
            at[0, m], at[1, m] = image(i0 + i, space.n0, walls[0, 0], walls[0, 1]), image(j0 + j, space.n1, walls[1, 0], walls[1, 1])
            w[m], g[0, m], g[1, m] = wx[i] * wy[j], gx[i] * wy[j] / space.h, wx[i] * gy[j] / space.h
            d[0, m], d[1, m] = dx[i] * space.h, dy[j] * space.h
            m += 1


@nodes_of.register(Volume)
def nodes_of_volume(space, x, p, walls, at, w, g, d):
    i0, wx, gx, dx, _ = stencil(space.basis, x[p, 0] / space.h)
    j0, wy, gy, dy, _ = stencil(space.basis, x[p, 1] / space.h)
    k0, wz, gz, dz, _ = stencil(space.basis, x[p, 2] / space.h)
    m = 0
    for i in range(len(wx)):
        for j in range(len(wy)):
            for k in range(len(wz)):
                at[0, m], at[1, m] = image(i0 + i, space.n0, walls[0, 0], walls[0, 1]), image(j0 + j, space.n1, walls[1, 0], walls[1, 1])
                at[2, m] = image(k0 + k, space.n2, walls[2, 0], walls[2, 1])
                w[m] = wx[i] * wy[j] * wz[k]
                g[0, m], g[1, m], g[2, m] = gx[i] * wy[j] * wz[k] / space.h, wx[i] * gy[j] * wz[k] / space.h, wx[i] * wy[j] * gz[k] / space.h
                d[0, m], d[1, m], d[2, m] = dx[i] * space.h, dy[j] * space.h, dz[k] * space.h
                m += 1


@kernel
def name(number, shape, width, at, each, place):
    """Of the nodes `at`: rows, -1 where there is none, and what places are differences of."""
    D, M = at.shape
    for a in range(M):
        each[a], place[a] = number[flat(shape, at, a)], at[0, a]
        for k in range(1, D):
            place[a] = place[a] * width + at[k, a]


@kernel
def add(rows, each, place, t, scale):
    """rows += scale t t^T."""
    M = len(each)
    for a in range(M):
        row = each[a]
        if row < 0 or t[a] == 0.0:
            continue
        for b in range(M):
            if each[b] >= row:
                rows[row, place[b] - place[a]] += scale * t[a] * t[b]


@kernel(inline=True)
def flat(shape, at, a):
    """Number of a node in the arrays: directions that the space has come first, and the others are one node long."""
    n = at[0, a]
    for k in range(1, at.shape[0]):
        n = n * shape[k] + at[k, a]
    return n


@kernel
def matrix(space, shape, x, flow, pieces, met, capacity, each, dt, walls):
    """(rows (K, m), columns (K, m), -1 where there is none, `between` (m, m): place of the difference of two places) of C + dt A on the nodes `each`."""
    D = directions(space)
    _, one, _, _, _ = stencil(space.basis, x[0, 0] / space.h)
    reach = len(one) - 1
    M, width = len(one) ** D, 2 * reach + 1
    size = (width**D + 1) // 2
    number = np.full(len(capacity), -1)
    for k in range(len(each)):
        number[each[k]] = k
    rows = np.zeros((len(each), size))
    for k in range(len(each)):
        rows[k, 0] = capacity[each[k]]
    at, w, g, d, t = np.zeros((D, M), np.int64), np.zeros(M), np.zeros((D, M)), np.zeros((D, M)), np.zeros(M)
    own, place = np.empty(M, np.int64), np.empty(M, np.int64)
    for p in range(x.shape[0]):
        nodes_of(space, x, p, walls, at, w, g, d)
        name(number, shape, width, at, own, place)
        for k in range(D):
            add(rows, own, place, g[k], dt * flow[p])
    owner, area, offset = pieces
    for s in range(len(owner)):
        nodes_of(space, x, owner[s], walls, at, w, g, d)
        name(number, shape, width, at, own, place)
        for a in range(M):
            t[a] = w[a]
            for k in range(D):
                t[a] += g[k, a] * offset[k, s]
        add(rows, own, place, t, dt * area[s] * met[0, s])
    steps = np.zeros((size, D), np.int64)
    for o in range(size):
        rest = o
        for k in range(D - 1, -1, -1):
            steps[o, k] = (rest + reach) % width - reach
            rest = (rest - steps[o, k]) // width
    between = np.full((size, size), -1)
    for o in range(size):
        for p in range(o, size):
            near = True
            for k in range(D):
                near = near and abs(steps[p, k] - steps[o, k]) <= reach
            if near:
                between[o, p] = p - o
    columns = np.full((len(each), size), -1)
    for r in range(len(each)):
        for o in range(size):
            n, rest, inside = 0, each[r], True
            stride = len(capacity)
            for k in range(D):
                stride //= shape[k]
                i = rest // stride + steps[o, k]
                rest %= stride
                inside = inside and 0 <= i < shape[k]
                n = n * shape[k] + i
            if inside:
                columns[r, o] = number[n]
    return rows, columns, between


@kernel
def incomplete(rows, columns, between, shift, factor):
    """The factor, of rows whose diagonal is raised by `shift`; false where a pivot is not positive."""
    K, m = rows.shape
    for j in range(K):  # numpy's own way to fill an array compiles the words of its errors
        for o in range(m):
            factor[j, o] = rows[j, o]
        factor[j, 0] *= 1.0 + shift
    for j in range(K):
        if not factor[j, 0] > 0.0:
            return False
        factor[j, 0] = np.sqrt(factor[j, 0])
        for o in range(1, m):
            factor[j, o] /= factor[j, 0]
        for o in range(1, m):
            i, f = columns[j, o], factor[j, o]
            if i >= 0 and f != 0.0:
                for q in range(o, m):
                    if between[o, q] >= 0:
                        factor[i, between[o, q]] -= f * factor[j, q]
    return True


@kernel
def smooth(factor, columns, z):
    """z <- (L L^T)^-1 z."""
    K, m = factor.shape
    for j in range(K):
        z[j] /= factor[j, 0]
        for o in range(1, m):
            if columns[j, o] >= 0:
                z[columns[j, o]] -= factor[j, o] * z[j]
    for j in range(K - 1, -1, -1):
        for o in range(1, m):
            if columns[j, o] >= 0:
                z[j] -= factor[j, o] * z[columns[j, o]]
        z[j] /= factor[j, 0]


@kernel
def product(rows, columns, x, y):
    """y = (C + dt A) x."""
    K, m = rows.shape
    for r in range(K):
        y[r] = rows[r, 0] * x[r]
    for r in range(K):
        total = 0.0
        for o in range(1, m):
            c = columns[r, o]
            if c >= 0:
                total += rows[r, o] * x[c]
                y[c] += rows[r, o] * x[r]
        y[r] += total


class Rows(NamedTuple):
    """C + dt A of one body."""

    rows: np.ndarray  # (K, m)


@role
def times(operator, columns, x, y):
    """y = operator x."""
    raise TypeError(f"no product of {type(operator).__name__}")


@times.register(Rows)
def times_rows(operator, columns, x, y):
    product(operator.rows, columns, x, y)


@role
def blocks(operator):
    """Rows that the incomplete factor is made of."""
    raise TypeError(f"no rows of {type(operator).__name__}")


@blocks.register(Rows)
def blocks_rows(operator):
    return operator.rows


@kernel
def conjugate_gradients(operator, columns, between, weight, r, change, tolerance):
    """change with operator change = r, r spoilt; iterations, or -1. operator: Rows, or what registers `times` and `blocks`.

    Ends when the residual, as temperature (norm weighted with C = `weight`), is below `tolerance` of the change.
    """
    K, own = len(r), blocks(operator)
    factor, z, p, q = np.empty_like(own), np.empty(K), np.zeros(K), np.empty(K)
    shift = 0.0
    while not incomplete(own, columns, between, shift, factor):
        shift = max(2.0 * shift, SHIFT)
        if shift > 1e3:
            return -1
    change[:] = 0.0
    before = 1.0
    for count in range(MOST_ITERATIONS):
        size, moved, rho = 0.0, 0.0, 0.0
        for k in range(K):
            z[k] = r[k]
        smooth(factor, columns, z)
        for k in range(K):
            size += r[k] * r[k] / weight[k]
            moved += weight[k] * change[k] * change[k]
            rho += r[k] * z[k]
        if size <= tolerance * tolerance * moved or rho == 0.0:
            return count
        curve = 0.0
        for k in range(K):
            p[k] = z[k] + rho / before * p[k]
        times(operator, columns, p, q)
        for k in range(K):
            curve += p[k] * q[k]
        for k in range(K):
            change[k] += rho / curve * p[k]
            r[k] -= rho / curve * q[k]
        before = rho
    return -1
