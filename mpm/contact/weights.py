"""Through which nodes a contact acts on a body.

w~_i = w_ip + G_ip . (x_s - x_p)                     linear-exact: sum w~ = 1, sum w~ x_i = x_s, and sum w~ v_i is the speed of the piece as F carries it
r_i  = sum_p V_p G_ip - sum_s S_s n_s w~_is          what a uniform stress puts on a node beyond a uniform traction: the quadrature of cut cells
W_i  = w~_i + (n . r_i) w_ip/(n . T_i n),  T_i = sum_s S_s w_ip(s) n_s n_s^T,  then W_i += m_i (a + b . (x_i - x_s)) with sum W = 1, sum W x_i = x_s

With W a body in equilibrium under a traction has the same strain in its surface particles as inside; with w~ up to 1.5 times. Corners, and faces that do not
look along the normal, keep w~. In an axisymmetric body V_p carries its hoop stress too: r_i += V_p w_ip/r_p along r.
"""

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions
from mpm.contact.skin import hoop
from mpm.contact.spots import new_spots, seen, spot
from mpm.jit import kernel

WIDE = 4  # numbers of a weight: D directions and nothing


@kernel
def weigh(space, gradient, bodies, fields, walls, skin, contacts, count, nodes, number):
    """(at (count, 2, M), coef (count, 2, M, WIDE)) of the contacts; nodes (F, n, columns); number (nodes,) -1 before and after."""
    weights, b = new_weights(space, count), 0
    for body in literal_unroll(bodies):
        f, x = fields[b], body.particles.x
        box, short = mark(space, gradient, b, walls[f], contacts, count, number)
        if len(short) > 0:
            fall_short(space, gradient, body.particles, b, walls[f], skin, box, number, short, (0, x.shape[0]))
        shares(space, gradient, b, walls[f], contacts, (0, count), nodes[f], number, short, weights)
        unmark(contacts, b, count, number, weights)
        b += 1
    return weights


@kernel
def new_weights(space, count):
    """Room for (at, coef) of `count` contacts."""
    M = seen(space) ** directions(space)
    return np.zeros((count, 2, M), np.int64), np.zeros((count, 2, M, WIDE))


@kernel
def mark(space, gradient, b, walls, contacts, count, number):
    """Number the nodes where body b is balanced; the box (low, high) of the particles there, and room for r and T of each node."""
    D, spots, marked = directions(space), new_spots(space), 0
    low, high = np.full(D, 1e300), np.full(D, -1e300)
    for i in range(count):
        for k in range(2):
            if contacts.body[i, k] != b or not contacts.balanced[i, k]:
                continue
            spot(space, gradient, walls, contacts.home[i, k], spots)
            for n in spots[0]:
                if number[n] < 0:
                    number[n] = marked
                    marked += 1
            for a in range(D):
                low[a], high[a] = min(low[a], contacts.home[i, k, a]), max(high[a], contacts.home[i, k, a])
    return (low, high), np.zeros((marked, D + D * D))


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
            if contacts.balanced[i, k]:
                balance(space, contacts, i, k, nodes, number, spots, short, system, W)
            for m in range(M):
                at[i, k, m] = spots[0][m]
                for c in range(D):
                    coef[i, k, m, c] = W[m] * spots[4][c, m]
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
    spots = new_spots(space)
    at, w, G, _, sign = spots[0], spots[1], spots[2], spots[3], spots[4]
    low, high = box
    D, M, far, home, W = directions(space), len(at), seen(space) * space.h, np.empty(directions(space)), np.empty(len(at))
    for p in range(some[0], some[1]):
        inside = True
        for a in range(D):
            home[a] = particles.x[p, a]
            inside = inside and low[a] - far < home[a] < high[a] + far
        if not inside:
            continue
        spot(space, gradient, walls, home, spots)
        V = float(particles.V0[p]) * float(particles.J[p])
        for m in range(M):
            n = number[at[m]]
            if n >= 0:
                for c in range(D):
                    short[n, c] += V * G[c, m] * sign[c, m]
                if hoop(space):
                    short[n, 0] += V * w[m] / home[0] * sign[0, m]
    for s in range(skin.first[b], skin.first[b + 1]):
        inside = skin.area[s] > 0.0 and some[0] <= skin.owner[s] < some[1]
        for a in range(D):
            inside = inside and low[a] - far < skin.home[s, a] < high[a] + far
        if not inside:
            continue
        spot(space, gradient, walls, skin.home[s], spots)
        plain(spots, skin.home[s], skin.x[s], W)
        for m in range(M):
            n = number[at[m]]
            if n >= 0:
                for c in range(D):
                    for e in range(D):
                        short[n, D + c * D + e] += skin.area[s] * w[m] * skin.normal[s, c] * skin.normal[s, e]
                    short[n, c] -= skin.area[s] * skin.normal[s, c] * W[m] * sign[c, m]


@kernel
def balance(space, contacts, i, k, nodes, number, spots, short, system, W):
    """From w~ to W; left at w~ where the nodes cannot carry it."""
    at, w, way, sign = spots[0], spots[1], spots[3], spots[4]
    D, M, out = directions(space), len(at), -1.0 if k == 0 else 1.0
    system[:] = 0.0
    system[0, D + 1] = 1.0
    shift = (contacts.point[i, k] - contacts.home[i, k]) / space.h
    before, y = W.copy(), np.empty(D + 1)
    for m in range(M):
        n = number[at[m]]
        borne = 0.0
        for c in range(D):
            for e in range(D):
                borne += contacts.normal[i, c] * contacts.normal[i, e] * short[n, D + c * D + e]
        if borne > 1e-12 * space.h ** (D - 1):
            for c in range(D):
                W[m] += out * contacts.normal[i, c] * sign[c, m] * short[n, c] * w[m] / borne
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
        W[:] = before
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
