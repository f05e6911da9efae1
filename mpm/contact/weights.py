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
from mpm.contact.spots import WIDE, along, new_lines, new_spots, pulls, seen, slopes, turns
from mpm.jit import kernel
from mpm.lanes import fma, four, item, load4, splat4, store
from mpm.state import PAD

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
    """Number the nodes where body b is balanced; the box (low, high) of what touches them, and room for r (nodes, WIDE) and T (nodes, D, WIDE) of each."""
    D, shape, spots, marked = directions(space), extents(space), new_spots(space), 0
    place, low, high = spots[1], np.full(directions(space), 1e300), np.full(directions(space), -1e300)
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
    return (low, high), (np.zeros((marked, WIDE)), np.zeros((marked, D, WIDE)))


@kernel
def shares(space, gradient, b, walls, contacts, some, nodes, number, short, weights):
    """W of body b for the contacts some[0] <= i < some[1]."""
    (at, coef), D, shape, spots = weights, directions(space), extents(space), new_spots(space)
    M, place, lines, signs = at.shape[2], spots[1], new_lines(space), new_lines(space)
    system, W, w, shift, (n0, n1, n2) = np.empty((D + 1, D + 2)), np.empty(M), np.empty(M), np.zeros(WIDE), spans(space, place)
    for i in range(some[0], some[1]):
        for k in range(2):
            if contacts.body[i, k] != b:
                continue
            mirrored = along(space, walls, contacts.home[i, k], spots)
            slopes(space, gradient, spots, lines)
            turns(space, walls, spots, signs)
            way_to(contacts.home[i, k], contacts.point[i, k], shift)
            way, m = load4(shift, 0), 0
            for j0 in range(n0):
                for j1 in range(n1):
                    row, both = (place[0, j0] * shape[1] + place[1, j1]) * shape[2], load4(lines, WIDE * j0) * load4(lines, WIDE * (n0 + j1))
                    for j2 in range(n2):
                        pulled = both * load4(lines, WIDE * (2 * n0 + j2))
                        at[i, k, m], w[m], W[m] = row + place[2, j2], item(pulled, 3), sum4(pulled * way)
                        m += 1
            if contacts.balanced[i, k] and nodes[at[i, k, M // 2], D] < np.inf:  # a body that stands bears anything
                balance(space, contacts, i, k, nodes, number, (at, w, W, signs, spots), short, system, shift)
            m = WIDE * (2 * i + k) * M
            for j0 in range(n0):
                for j1 in range(n1):
                    both = load4(signs, WIDE * j0) * load4(signs, WIDE * (n0 + j1))
                    for j2 in range(n2):
                        store(coef, m, splat4(W[m // WIDE - (2 * i + k) * M]) * both * load4(signs, WIDE * (2 * n0 + j2)))
                        m += WIDE
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
def sum4(a):
    """Of all lanes."""
    return (item(a, 0) + item(a, 1)) + (item(a, 2) + item(a, 3))


@kernel(inline=True)
def way_to(home, point, shift):
    """What the gradients and the weight are multiplied by for w~ of a point: the way there [m], and one."""
    for c in range(WIDE - 1):
        shift[c] = point[c] - home[c] if c < len(home) else 0.0
    shift[WIDE - 1] = 1.0


@kernel
def fall_short(space, gradient, particles, b, walls, skin, box, number, short, some):
    """r and T of the marked nodes, from the particles some[0] <= p < some[1] of body b within `box` (low, high), and from their pieces."""
    spots, D, shape, home = new_spots(space), directions(space), extents(space), np.empty(directions(space))
    place, lines, signs, shift = spots[1], new_lines(space), new_lines(space), np.zeros(WIDE)
    (low, high), (lack, T), (n0, n1, n2) = box, short, spans(space, place)
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
        along(space, walls, skin.home[s], spots)
        slopes(space, gradient, spots, lines)
        turns(space, walls, spots, signs)
        way_to(skin.home[s], skin.x[s], shift)
        way = load4(shift, 0)
        for c in range(D):
            shift[c] = skin.normal[s, c]
        shift[WIDE - 1] = 0.0
        normal = load4(shift, 0)
        pressed = splat4(skin.area[s]) * normal
        for i in range(n0):
            for j in range(n1):
                row, both = (place[0, i] * shape[1] + place[1, j]) * shape[2], load4(lines, WIDE * i) * load4(lines, WIDE * (n0 + j))
                turned = load4(signs, WIDE * i) * load4(signs, WIDE * (n0 + j))
                for k in range(n2):
                    n = number[row + place[2, k]]
                    if n < 0:
                        continue
                    pulled = both * load4(lines, WIDE * (2 * n0 + k))
                    sign = turned * load4(signs, WIDE * (2 * n0 + k))
                    store(lack, WIDE * n, fma(splat4(-sum4(pulled * way)) * sign, pressed, load4(lack, WIDE * n)))
                    borne = splat4(item(pulled, 3)) * pressed
                    for c in range(D):
                        store(T, WIDE * (D * n + c), fma(splat4(shift[c]), borne, load4(T, WIDE * (D * n + c))))


@kernel
def balance(space, contacts, i, k, nodes, number, spread, short, system, shift):
    """From w~ to W; left at w~ where the nodes cannot carry it. `shift` (WIDE,): the way to the contact, as of way_to. y: 1 and a node's way in cells."""
    (at, w, W, signs, spots), (lack, T) = spread, short
    line, place, D, h, out = spots[0], spots[1], directions(space), space.h, -1.0 if k == 0 else 1.0
    (n0, n1, n2), before = spans(space, place), W.copy()
    zero = splat4(0.0)
    right, first, second, third, fourth = zero, zero, zero, zero, zero  # sums of W y, m y, m y_1 y, m y_2 y, m y_3 y
    a, b, c = shift[0] / h, shift[1] / h, shift[2] / h
    for e in range(D):
        shift[e] = contacts.normal[i, e]
    shift[WIDE - 1], m = 0.0, 0
    normal = load4(shift, 0)
    for j0 in range(n0):
        y1 = line[2, 0, j0] / h - a
        for j1 in range(n1):
            y2, turned = (line[2, 1, j1] / h - b) if D > 1 else 0.0, splat4(out) * normal * load4(signs, WIDE * j0) * load4(signs, WIDE * (n0 + j1))
            for j2 in range(n2):
                y3, n = (line[2, 2, j2] / h - c) if D > 2 else 0.0, number[at[i, k, m]]
                along_it = zero
                for e in range(D):
                    along_it = fma(splat4(shift[e]), load4(T, WIDE * (D * n + e)), along_it)
                borne = sum4(along_it * normal)
                if borne > 1e-12 * h ** (D - 1):
                    W[m] += sum4(turned * load4(signs, WIDE * (2 * n0 + j2)) * load4(lack, WIDE * n)) * w[m] / borne
                y, mass = four(1.0, y1, y2, y3), np.float64(nodes[at[i, k, m], D])
                heavy = splat4(mass) * y
                right, first, second = fma(splat4(W[m]), y, right), first + heavy, fma(splat4(y1), heavy, second)
                third, fourth, m = fma(splat4(y2), heavy, third), fma(splat4(y3), heavy, fourth), m + 1
    scale = item(first, 0)
    for r in range(D + 1):
        system[r, D + 1] = (1.0 if r == 0 else 0.0) - item(right, r)
        for e in range(D + 1):
            sums = first if r == 0 else second if r == 1 else third if r == 2 else fourth
            system[r, e] = item(sums, e) / max(scale, 1e-300)
    if not eliminate(system):
        for m in range(len(W)):  # numpy's own way compiles the words of its errors
            W[m] = before[m]
        return
    shift[:] = 0.0
    for r in range(D + 1):
        shift[r] = system[r, D + 1] / scale
    found, m = load4(shift, 0), 0
    for j0 in range(n0):
        for j1 in range(n1):
            for j2 in range(n2):
                y = four(1.0, line[2, 0, j0] / h - a, (line[2, 1, j1] / h - b) if D > 1 else 0.0, (line[2, 2, j2] / h - c) if D > 2 else 0.0)
                W[m] += np.float64(nodes[at[i, k, m], D]) * sum4(found * y)
                m += 1


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
