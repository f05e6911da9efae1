"""Through which nodes a contact acts on a body.

w~_i = w_ip + G_ip . (x_s - x_p)                     linear-exact: sum w~ = 1, sum w~ x_i = x_s, and sum w~ v_i is the speed of the piece as F carries it
r_i  = sum_p V_p G_ip - sum_s S_s n_s w~_is          what a uniform stress puts on a node beyond a uniform traction: the quadrature of cut cells
W_i  = w~_i + (n . r_i) w_ip/(n . T_i n),  T_i = sum_s S_s w_ip(s) n_s n_s^T,  then W_i += m_i (a + b . (x_i - x_s)) with sum W = 1, sum W x_i = x_s

With W a body in equilibrium under a traction has the same strain in its surface particles as inside; with w~ up to 1.5 times. Corners, and faces that do not
look along the normal, keep w~. In an axisymmetric body V_p carries its hoop stress too: r_i += V_p w_ip/r_p along r.
"""

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions, extents
from mpm.contact.spots import along, new_spots, pulls, seen, spot
from mpm.jit import kernel
from mpm.lanes import fma, load4, splat4, store
from mpm.state import PAD

WIDE = 4  # numbers of a weight: D directions and nothing
CLEAR = 1e-6  # cells: positions are rounded


@kernel
def weigh(space, gradient, bodies, fields, walls, skin, contacts, count, nodes, number):
    """(at (count, 2, M), coef (count, 2, M, WIDE)) of the contacts; nodes (F, n, columns); number (nodes,) -1 before and after."""
    weights, b = new_weights(space, count), 0
    for body in literal_unroll(bodies):
        f, x = fields[b], body.particles.x
        box, short = mark(space, b, walls[f], contacts, count, number)
        if len(short[0]) > 0:
            fall_short(space, gradient, body.particles, b, walls[f], skin, box, number, short, (0, x.shape[0]))
        shares(space, gradient, b, walls[f], contacts, (0, count), nodes[f], number, short, weights)
        unmark(contacts, b, count, number, weights)
        b += 1
    return weights


@kernel
def new_weights(space, count):
    """Room for (at, coef) of `count` contacts."""
    M = seen(space) ** directions(space)
    return np.empty((count, 2, M), np.int64), np.empty((count, 2, M, WIDE))


@kernel(inline=True)
def spans(space, place):
    """How many nodes there are in each of three directions."""
    D, reach = directions(space), place.shape[1]
    return reach, reach if D > 1 else 1, reach if D > 2 else 1


@kernel
def mark(space, b, walls, contacts, count, number):
    """Number the nodes where body b is balanced; the box (low, high) of what touches them, and room for r (nodes, WIDE) and T (nodes, D, D) of each."""
    D, shape, spots, marked = directions(space), extents(space), new_spots(space), 0
    place, low, high = spots[6], np.full(directions(space), 1e300), np.full(directions(space), -1e300)
    n0, n1, n2 = spans(space, place)
    for i in range(count):
        for k in range(2):
            if contacts.body[i, k] != b or not contacts.balanced[i, k]:
                continue
            along(space, walls, contacts.home[i, k], spots)
            for j0 in range(n0):
                for j1 in range(n1):
                    for j2 in range(n2):
                        n = (place[0, j0] * shape[1] + place[1, j1]) * shape[2] + place[2, j2]
                        if number[n] < 0:
                            number[n] = marked
                            marked += 1
            for a in range(D):
                for j in range(n0):
                    low[a], high[a] = min(low[a], place[a, j]), max(high[a], place[a, j])
    for a in range(D):  # from nodes to places, and half of what a particle sees on either side
        low[a], high[a] = (low[a] - PAD - 0.5 * n0 - CLEAR) * space.h, (high[a] - PAD + 0.5 * n0 + CLEAR) * space.h
    return (low, high), (np.zeros((marked, WIDE)), np.zeros((marked, D, D)))


@kernel
def shares(space, gradient, b, walls, contacts, some, nodes, number, short, weights):
    """W of body b for the contacts some[0] <= i < some[1]."""
    (at, coef), D, spots = weights, directions(space), new_spots(space)
    M = at.shape[2]
    system, W = np.empty((D + 1, D + 2)), np.empty(M)
    for i in range(some[0], some[1]):
        for k in range(2):
            if contacts.body[i, k] != b:
                continue
            mirrored = spot(space, gradient, walls, contacts.home[i, k], spots)
            plain(spots, contacts.home[i, k], contacts.point[i, k], W)
            if contacts.balanced[i, k] and nodes[spots[0][M // 2], D] < np.inf:  # a body that stands bears anything
                balance(space, contacts, i, k, nodes, number, spots, short, system, W)
            for m in range(M):
                at[i, k, m] = spots[0][m]
                for c in range(WIDE):
                    coef[i, k, m, c] = W[m] * spots[4][c, m] if c < D else 0.0
            if mirrored:
                merge(at[i, k], coef[i, k])


@kernel
def unmark(contacts, b, count, number, weights):
    """Take the numbers of `mark` away."""
    for i in range(count):
        for k in range(2):
            if contacts.body[i, k] == b and contacts.balanced[i, k]:
                for n in weights[0][i, k]:
                    number[n] = -1


@kernel(inline=True)
def plain(spots, home, point, W):
    """w~ of a point of the particle in `spots`."""
    for m in range(len(W)):
        W[m] = spots[1][m]
        for c in range(len(home)):
            W[m] += spots[2][c, m] * (point[c] - home[c])


@kernel
def fall_short(space, gradient, particles, b, walls, skin, box, number, short, some):
    """r and T of the marked nodes, from the particles some[0] <= p < some[1] of body b within `box` (low, high), and from their pieces."""
    spots, D, shape, home = new_spots(space), directions(space), extents(space), np.empty(directions(space))
    at, w, sign, place, lines = spots[0], spots[1], spots[4], spots[6], np.zeros((3, seen(space), WIDE))
    (low, high), (lack, T), W, (n0, n1, n2) = box, short, np.empty(len(at)), spans(space, place)
    for a in range(3):
        for c in range(WIDE):
            lines[a, 0, c] = 1.0
    for p in range(some[0], some[1]):
        inside = True
        for a in range(D):
            home[a] = particles.x[p, a]
            inside = inside and low[a] <= home[a] <= high[a]
        if not inside:
            continue
        along(space, walls, home, spots)
        pulls(space, gradient, walls, home, spots, lines)
        V = splat4(np.float64(particles.V0[p]) * np.float64(particles.J[p]))
        for i in range(n0):
            first = V * load4(lines, WIDE * i)
            for j in range(n1):
                row, both = (place[0, i] * shape[1] + place[1, j]) * shape[2], first * load4(lines, WIDE * (n0 + j))
                for k in range(n2):
                    n = number[row + place[2, k]]
                    if n >= 0:
                        store(lack, WIDE * n, fma(both, load4(lines, WIDE * (2 * n0 + k)), load4(lack, WIDE * n)))
    for s in range(skin.first[b], skin.first[b + 1]):
        inside = skin.area[s] > 0.0 and some[0] <= skin.owner[s] < some[1]
        for a in range(D):
            inside = inside and low[a] <= skin.home[s, a] <= high[a]
        if not inside:
            continue
        spot(space, gradient, walls, skin.home[s], spots)
        plain(spots, skin.home[s], skin.x[s], W)
        for m in range(len(at)):
            n = number[at[m]]
            if n >= 0:
                for c in range(D):
                    pressed = skin.area[s] * skin.normal[s, c]
                    lack[n, c] -= pressed * W[m] * sign[c, m]
                    for e in range(D):
                        T[n, c, e] += pressed * w[m] * skin.normal[s, e]


@kernel
def balance(space, contacts, i, k, nodes, number, spots, short, system, W):
    """From w~ to W; left at w~ where the nodes cannot carry it."""
    at, w, way, sign = spots[0], spots[1], spots[3], spots[4]
    D, M, out, (lack, T) = directions(space), len(at), -1.0 if k == 0 else 1.0, short
    system[:] = 0.0
    system[0, D + 1] = 1.0
    shift, before, y = np.empty(D), W.copy(), np.empty(D + 1)
    for a in range(D):
        shift[a] = (contacts.point[i, k, a] - contacts.home[i, k, a]) / space.h
    for m in range(M):
        n = number[at[m]]
        borne = 0.0
        for c in range(D):
            for e in range(D):
                borne += contacts.normal[i, c] * contacts.normal[i, e] * T[n, c, e]
        if borne > 1e-12 * space.h ** (D - 1):
            for c in range(D):
                W[m] += out * contacts.normal[i, c] * sign[c, m] * lack[n, c] * w[m] / borne
        terms(way, shift, space.h, m, y)
        mass = nodes[at[m], D]
        for r in range(D + 1):
            system[r, D + 1] -= W[m] * y[r]
            for c in range(D + 1):
                system[r, c] += mass * y[r] * y[c]
    scale = system[0, 0]
    for r in range(D + 1):
        for c in range(D + 1):
            system[r, c] /= max(scale, 1e-300)
    if not eliminate(system):
        for m in range(M):  # numpy's own way compiles the words of its errors
            W[m] = before[m]
        return
    for m in range(M):
        terms(way, shift, space.h, m, y)
        for r in range(D + 1):
            W[m] += nodes[at[m], D] / scale * system[r, D + 1] * y[r]


@kernel(inline=True)
def terms(way, shift, h, m, y):
    """1 and the way from the contact to node m in cells."""
    y[0] = 1.0
    for c in range(len(shift)):
        y[c + 1] = way[c, m] / h - shift[c]


@kernel
def eliminate(system):
    """Solve a symmetric positive system in place, the answer in its last column; false where it is singular."""
    n = system.shape[0]
    for p in range(n):
        if not system[p, p] > 1e-12:
            return False
        for r in range(n):
            if r != p:
                factor = system[r, p] / system[p, p]
                for c in range(p, n + 1):
                    system[r, c] -= factor * system[p, c]
    for p in range(n):
        system[p, n] /= system[p, p]
    return True


@kernel
def merge(at, coef):
    """A node that stands for its ghost too is one node."""
    for m in range(len(at)):
        for q in range(m):
            if at[q] == at[m]:
                for c in range(WIDE):
                    coef[q, c] += coef[m, c]
                    coef[m, c] = 0.0
                break
