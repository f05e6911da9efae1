"""Through which nodes a contact acts on a body.

w~_i = w_ip + G_ip . (x_s - x_p)                     linear-exact: sum w~ = 1, sum w~ x_i = x_s, and sum w~ v_i is the speed of the piece as F carries it
r_i  = sum_p V_p G_ip - sum_s S_s n_s w~_is          what a uniform stress puts on a node beyond a uniform traction: the quadrature of cut cells
W_i  = w~_i + (n . r_i) w_ip/(n . T_i n),  T_i = sum_s S_s w_ip(s) n_s n_s^T,  then W_i += m_i (a + b . (x_i - x_s)) with sum W = 1, sum W x_i = x_s

With W a body in equilibrium under a traction has the same strain in its surface particles as inside; with w~ up to 1.5 times. Corners, and faces that do not
look along the normal, keep w~. In an axisymmetric body V_p carries its hoop stress too: r_i += V_p w_ip/r_p along r.
"""

import numpy as np

from mpm.boundary import directions
from mpm.contact.found import BODY, whole
from mpm.contact.spots import WIDE, along, gathered, lanes_of, level, new_lines, new_slopes, new_spots, products, row_of, slopes_at, spans, sum4, turns, way_to
from mpm.contact.sums import forget, recall
from mpm.jit import kernel
from mpm.lanes import fma, four, item, load4, poke, put, splat4, store


@kernel
def weigh(space, gradient, walls, fields, skin, sums, problem, number):
    """Fill the weights of the problem that solve.pose lays out; number (nodes,): -1 before and after."""
    for b in range(len(fields)):
        seat = seats(sums, b, fields[b], problem, number)
        shares(space, gradient, b, walls[fields[b]], skin, sums, seat, problem, (0, len(problem.impulse)))


@kernel
def seats(sums, b, f, problem, number):
    """Where the nodes of the problem (K,) are among the sums of body b, whose field is f; -1 where they are not."""
    found = np.full(len(problem.place), -1)
    recall(sums, b, number)
    for j in range(len(found)):
        if problem.field[j] == f:
            found[j] = number[problem.place[j]]
    forget(sums, b, number)
    return found


@kernel
def shares(space, gradient, b, walls, skin, sums, seat, problem, some):
    """W of body b for the contacts some[0] <= i < some[1]."""
    n0, n1, _ = spans(space)
    room = new_spots(space), new_slopes(space), new_lines(space), np.empty((4, n0 * n1, WIDE)), np.zeros(WIDE)
    for i in range(some[0], some[1]):
        for k in range(2):
            if problem.contacts.body[i, k] == b:
                share(space, gradient, walls, skin, sums, seat, problem, i, k, room)


@kernel(inline=True)
def share(space, gradient, walls, skin, sums, seat, problem, i, k, room):
    """W of side k of contact i. rows: W, w, W as it was, and masses, of a row of nodes along the last direction at once."""
    (spots, lines, signs, rows, shift), D, contacts, (n0, n1, n2) = room, directions(space), problem.contacts, spans(space)
    R, M, nothing = WIDE * n0 * n1, n0 * n1 * n2, splat4(0.0)
    more, home, point, part, total = -1, contacts.home[i, k], contacts.point[i, k], 1.0, 0.0
    mirrored = along(space, walls, home, spots)
    if k == 0 and contacts.mates[i] >= 0:
        more, total, point = contacts.mates[i], whole(contacts, skin.area, i), skin.x[contacts.piece[i]]
        part = skin.area[contacts.piece[i]] / total
    for r in range(0, 2 * R, WIDE):
        store(rows, r, nothing)
    while True:  # pieces that act as one see the same nodes
        slopes_at(space, gradient, home, lines)
        way_to(home, point, shift)
        weight, slope = row_of(n2, lines[0, 2]), row_of(n2, lines[1, 2])
        for j0 in range(n0):
            here, one = part * lines[0, 0, j0], part * (lines[0, 0, j0] + shift[0] * lines[1, 0, j0])
            for j1 in range(n1):
                both, r = here * lines[0, 1, j1], WIDE * (j0 * n1 + j1)
                two = splat4(one * lines[0, 1, j1] + shift[1] * here * lines[1, 1, j1])
                store(rows, r, fma(two, weight, fma(splat4(shift[2] * both), slope, load4(rows, r))))
                store(rows, R + r, fma(splat4(both), weight, load4(rows, R + r)))
        if more < 0:
            break
        home, point, part, more = skin.home[more], skin.x[more], skin.area[more] / total, contacts.after[more]
    way_to(contacts.home[i, k], contacts.point[i, k], shift)
    turned, here, square = mirrored or contacts.against[i] >= BODY, (2 * i + k) * M, nothing
    if turned:
        level(space, signs)
    if mirrored:
        turns(space, walls, spots, signs)
    if contacts.balanced[i, k] and problem.mass[problem.row[here + M // 2]] < np.inf:  # a body that stands bears anything
        balance(space, contacts, i, k, here, mirrored, seat, problem, sums, room)
    narrow, every = problem.coef.shape[3] == 1, four(1.0, 1.0 if D > 1 else 0.0, 1.0 if D > 2 else 0.0, 0.0)
    for j0 in range(n0):
        for j1 in range(n1):
            r, m = j0 * n1 + j1, here + (j0 * n1 + j1) * n2
            size = load4(rows, WIDE * r) * gathered(problem.light, problem.row, m, n2)
            square = fma(size, size, square)
            both = load4(signs, WIDE * j0) * load4(signs, WIDE * (n0 + j1)) if mirrored else every
            for j2 in range(n2):
                if narrow:
                    poke(problem.coef, m + j2, item(size, j2))
                else:
                    store(problem.coef, WIDE * (m + j2), splat4(item(size, j2)) * (both * load4(signs, WIDE * (2 * n0 + j2)) if mirrored else every))
    if mirrored:
        merge(problem.at[i, k], problem.coef[i, k])
        borne = nothing
        for m in range(here, here + M):
            borne = fma(load4(problem.coef, WIDE * m), load4(problem.coef, WIDE * m), borne)
    else:
        borne = splat4(sum4(square)) * every
    store(problem.bear, WIDE * i, load4(problem.bear, WIDE * i) + borne)


@kernel(inline=True)
def balance(space, contacts, i, k, here, mirrored, seat, problem, sums, room):
    """From w~ to W; left at w~ where the nodes cannot carry it. `shift` (WIDE,): the way to the contact, as of way_to. y: 1 and a node's way in cells."""
    (spots, _, signs, rows, shift), D, h, (n0, n1, n2), row = room, directions(space), space.h, spans(space), problem.row
    line, R, out, nothing = spots[0], WIDE * n0 * n1, -1.0 if k == 0 else 1.0, splat4(0.0)
    against = contacts.against[i]
    axis = against // 2 if against < BODY and not mirrored else -1  # of a wall
    a, b, y3 = shift[0] / h, shift[1] / h, nothing
    if D > 2:
        y3 = (row_of(n2, line[2, 2]) - splat4(shift[2])) * splat4(1.0 / h)
    normal = lanes_of(D, contacts.normal[i])
    crossed, facing = splat4(2.0) * products(normal), splat4(out * contacts.normal[i, max(axis, 0)])
    W, W1, W2, m, m1, m2, m11, m12, m22 = nothing, nothing, nothing, nothing, nothing, nothing, nothing, nothing, nothing  # sums over rows of y y
    for j0 in range(n0):
        y1 = splat4(line[2, 0, j0] / h - a)
        for j1 in range(n1):
            y2, r, at = splat4((line[2, 1, j1] / h - b) if D > 1 else 0.0), WIDE * (j0 * n1 + j1), here + (j0 * n1 + j1) * n2
            before, more = load4(rows, r), nothing
            if axis >= 0:
                more = facing * leaning(sums.lean, seat, row, at, n2, axis)
            else:
                turned = splat4(out) * normal * load4(signs, WIDE * j0) * load4(signs, WIDE * (n0 + j1))
                for j2 in range(n2):
                    n = seat[row[at + j2]]
                    borne = sum4(load4(sums.diagonal, WIDE * n) * normal * normal)
                    if against >= BODY:
                        borne += sum4(load4(sums.beside, WIDE * n) * crossed)
                    if borne > 1e-12 * h ** (D - 1):
                        more = put(more, j2, sum4(turned * load4(signs, WIDE * (2 * n0 + j2)) * load4(sums.lack, WIDE * n)) / borne)
            now, mass = fma(more, load4(rows, R + r), before), gathered(problem.mass, row, at, n2)
            store(rows, r, now)
            store(rows, 2 * R + r, before)
            store(rows, 3 * R + r, mass)
            far, beside = mass * y1, mass * y2
            W, W1, W2 = W + now, fma(y1, now, W1), fma(y2, now, W2)
            m, m1, m2, m11, m12, m22 = m + mass, m1 + far, m2 + beside, fma(y1, far, m11), fma(y1, beside, m12), fma(y2, beside, m22)
    one = 1.0 / max(sum4(m), 1e-300)
    left = 1.0 - sum4(W), -sum4(W1), -sum4(W2), -sum4(W * y3)
    first = one * sum4(m1), one * sum4(m2), one * sum4(m * y3)
    second = one * sum4(m11), one * sum4(m12), one * sum4(m1 * y3), one * sum4(m22), one * sum4(m2 * y3), one * sum4(m * y3 * y3)
    fine, c0, c1, c2, c3 = spread_by_mass(D, first, second, left)
    fine = fine and sum4(m) > 1e-300
    for j0 in range(n0):
        for j1 in range(n1):
            r = WIDE * (j0 * n1 + j1)
            if fine:
                row_of_it = c0 + c1 * (line[2, 0, j0] / h - a) + (c2 * (line[2, 1, j1] / h - b) if D > 1 else 0.0)
                store(rows, r, fma(load4(rows, 3 * R + r), splat4(one) * fma(splat4(c3), y3, splat4(row_of_it)), load4(rows, r)))
            else:
                store(rows, r, load4(rows, 2 * R + r))


@kernel(inline=True)
def spread_by_mass(D, first, second, left):
    """(whether it can be solved, c) of sum_i m_i/m y y^T c = `left`, y = 1 and a node's way, by its first and second moments over the mass m."""
    (y1, y2, y3), (y11, y12, y13, y22, y23, y33) = first, second
    d1, e12, e13 = y11 - y1 * y1, y12 - y1 * y2, y13 - y1 * y3
    f12, f13 = e12 / max(d1, 1e-300), e13 / max(d1, 1e-300)
    d2, e23 = y22 - y2 * y2 - f12 * e12 if D > 1 else 1.0, y23 - y2 * y3 - f12 * e13
    f23 = e23 / max(d2, 1e-300)
    d3 = y33 - y3 * y3 - f13 * e13 - f23 * e23 if D > 2 else 1.0
    r1, r2, r3 = left[1] - y1 * left[0], left[2] - y2 * left[0], left[3] - y3 * left[0]
    r2 -= f12 * r1
    c3 = (r3 - f13 * r1 - f23 * r2) / max(d3, 1e-300)
    c2 = (r2 - e23 * c3) / max(d2, 1e-300)
    c1 = (r1 - e12 * c2 - e13 * c3) / max(d1, 1e-300)
    return d1 > 1e-12 and d2 > 1e-12 and d3 > 1e-12, left[0] - y1 * c1 - y2 * c2 - y3 * c3, c1, c2, c3


@kernel(inline=True)
def leaning(lean, seat, row, at, n, axis):
    """Component `axis` of `lean` for n nodes, whose numbers begin at row[at], as lanes."""
    found = splat4(0.0)
    for k in range(n):
        found = put(found, k, lean[np.uint64(seat[np.uint64(row[np.uint64(at + k)])]), axis])
    return found


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
