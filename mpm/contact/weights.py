"""Through which nodes a contact acts on a body.

w~_i = w_ip + G_ip . (x_s - x_p)                     linear-exact: sum w~ = 1, sum w~ x_i = x_s, and sum w~ v_i is the speed of the piece as F carries it
r_i  = sum_p V_p G_ip - sum_s S_s n_s w~_is          what a uniform stress puts on a node beyond a uniform traction: the quadrature of cut cells
W_i  = w~_i + (n . r_i) w_ip/(n . T_i n),  T_i = sum_s S_s w_ip(s) n_s n_s^T,  then W_i += m_i (a + b . (x_i - x_s)) with sum W = 1, sum W x_i = x_s

With W a body in equilibrium under a traction has the same strain in its surface particles as inside; with w~ up to 1.5 times. Corners, and faces that do not
look along the normal, keep w~. In an axisymmetric body V_p carries its hoop stress too: r_i += V_p w_ip/r_p along r.
"""

import numpy as np

from mpm.boundary import directions, extents
from mpm.contact.found import BODY, whole
from mpm.contact.spots import WIDE, along, lanes_of, new_lines, new_slopes, new_spots, seen, slopes, spans, sum4, turns, way_to
from mpm.contact.sums import forget, recall
from mpm.jit import kernel
from mpm.lanes import fma, four, item, load4, peek, splat4, store


@kernel
def weigh(space, gradient, walls, fields, skin, sums, contacts, count, nodes, number):
    """(at (count, 2, M), coef (count, 2, M, WIDE)) of the contacts; nodes (F, n, columns); number (nodes,) -1 before and after."""
    weights = new_weights(space, count)
    for b in range(len(fields)):
        recall(sums, b, number)
        shares(space, gradient, b, walls[fields[b]], skin, sums, contacts, (0, count), nodes[fields[b]], number, weights)
        forget(sums, b, number)
    return weights


@kernel
def new_weights(space, count):
    """Room for (at, coef) of `count` contacts."""
    M = seen(space) ** directions(space)
    return np.empty((count, 2, M), np.int64), np.empty((count, 2, M, WIDE))


@kernel
def shares(space, gradient, b, walls, skin, sums, contacts, some, nodes, number, weights):
    """W of body b for the contacts some[0] <= i < some[1]."""
    D, M = directions(space), weights[0].shape[2]
    room = new_spots(space), new_slopes(space), new_lines(space), np.empty((D + 1, D + 2)), np.empty(M), np.empty(M), np.empty(M), np.zeros(WIDE)
    for i in range(some[0], some[1]):
        for k in range(2):
            if contacts.body[i, k] == b:
                share(space, gradient, walls, skin, sums, contacts, i, k, nodes, number, weights, room)


@kernel(inline=True)
def share(space, gradient, walls, skin, sums, contacts, i, k, nodes, number, weights, room):
    """W of side k of contact i."""
    (at, coef), (spots, lines, signs, _, W, w, _, shift), D, shape = weights, room, directions(space), extents(space)
    place, (n0, n1, n2) = spots[1], spans(space)
    M = n0 * n1 * n2
    more, home, point, part, mirrored, total = -1, contacts.home[i, k], contacts.point[i, k], 1.0, False, 0.0
    if k == 0 and contacts.mates[i] >= 0:
        more, total, point = contacts.mates[i], whole(contacts, skin.area, i), skin.x[contacts.piece[i]]
        part = skin.area[contacts.piece[i]] / total
    for m in range(M):
        w[m] = W[m] = 0.0
    while True:  # pieces that act as one see the same nodes
        mirrored = along(space, walls, home, spots)
        slopes(space, gradient, spots, lines)
        way_to(home, point, shift)
        for j0 in range(n0):
            here, one = part * lines[0, 0, j0], part * (lines[0, 0, j0] + shift[0] * lines[1, 0, j0])
            for j1 in range(n1):
                both = here * lines[0, 1, j1]
                two, three = one * lines[0, 1, j1] + shift[1] * here * lines[1, 1, j1], shift[2] * both
                for j2 in range(n2):
                    m = (j0 * n1 + j1) * n2 + j2
                    w[m] += both * lines[0, 2, j2]
                    W[m] += two * lines[0, 2, j2] + three * lines[1, 2, j2]
        if more < 0:
            break
        home, point, part, more = skin.home[more], skin.x[more], skin.area[more] / total, contacts.after[more]
    for j0 in range(n0):
        for j1 in range(n1):
            row = (place[0, j0] * shape[1] + place[1, j1]) * shape[2]
            for j2 in range(n2):
                at[i, k, (j0 * n1 + j1) * n2 + j2] = row + place[2, j2]
    turns(space, walls, spots, signs)
    way_to(home, contacts.point[i, k], shift)
    if contacts.balanced[i, k] and nodes[at[i, k, M // 2], D] < np.inf:  # a body that stands bears anything
        balance(space, contacts, i, k, nodes, number, at, mirrored, sums, room)
    for j0 in range(n0):
        for j1 in range(n1):
            both = load4(signs, WIDE * j0) * load4(signs, WIDE * (n0 + j1))
            for j2 in range(n2):
                m = (j0 * n1 + j1) * n2 + j2
                store(coef, WIDE * ((2 * i + k) * M + m), splat4(W[m]) * both * load4(signs, WIDE * (2 * n0 + j2)))
    if mirrored:
        merge(at[i, k], coef[i, k])


@kernel(inline=True)
def balance(space, contacts, i, k, nodes, number, at, mirrored, sums, room):
    """From w~ to W; left at w~ where the nodes cannot carry it. `shift` (WIDE,): the way to the contact, as of way_to. y: 1 and a node's way in cells."""
    (spots, _, signs, system, W, w, before, shift), lack, T, lean = room, sums.lack, sums.T, sums.lean
    axis = contacts.against[i] // 2 if contacts.against[i] < BODY and not mirrored else -1  # of a wall
    line, D, h, out = spots[0], directions(space), space.h, -1.0 if k == 0 else 1.0
    (n0, n1, n2), zero = spans(space), splat4(0.0)
    for m in range(len(W)):  # numpy's own way compiles the words of its errors
        before[m] = W[m]
    right, first, second, third, fourth = zero, zero, zero, zero, zero  # sums of W y, m y, m y_1 y, m y_2 y, m y_3 y
    a, b, c = shift[0] / h, shift[1] / h, shift[2] / h
    normal, facing, m = lanes_of(D, contacts.normal[i]), out * contacts.normal[i, max(axis, 0)], 0
    for j0 in range(n0):
        y1 = line[2, 0, j0] / h - a
        for j1 in range(n1):
            y2, turned = (line[2, 1, j1] / h - b) if D > 1 else 0.0, splat4(out) * normal * load4(signs, WIDE * j0) * load4(signs, WIDE * (n0 + j1))
            for j2 in range(n2):
                y3, n = (line[2, 2, j2] / h - c) if D > 2 else 0.0, number[at[i, k, m]]
                if axis >= 0:
                    W[m] += facing * peek(lean, WIDE * n + axis) * w[m]
                else:
                    along_it = splat4(0.0)
                    for e in range(D):
                        along_it = fma(splat4(contacts.normal[i, e]), load4(T, WIDE * (D * n + e)), along_it)
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
            moments = first if r == 0 else second if r == 1 else third if r == 2 else fourth
            system[r, e] = item(moments, e) / max(scale, 1e-300)
    if not eliminate(system):
        for m in range(len(W)):
            W[m] = before[m]
        return
    for r in range(WIDE):
        shift[r] = system[r, D + 1] / scale if r <= D else 0.0
    m = 0
    for j0 in range(n0):
        for j1 in range(n1):
            row = shift[0] + shift[1] * (line[2, 0, j0] / h - a) + (shift[2] * (line[2, 1, j1] / h - b) if D > 1 else 0.0)
            for j2 in range(n2):
                W[m] += np.float64(nodes[at[i, k, m], D]) * (row + (shift[3] * (line[2, 2, j2] / h - c) if D > 2 else 0.0))
                m += 1


@kernel(inline=True)
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
