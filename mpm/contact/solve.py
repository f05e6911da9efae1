"""The impulses of a step: projected Gauss-Seidel over the contacts, from those of the step before.

A = sum W_A^2/m_i + sum W_B^2/m_j, the same for every direction;   lambda_n <- max(0, lambda_n - (u_n + max(g/dt, -PUSH c))/A),
lambda_t <- lambda_t - u_t/A, cut to mu lambda_n.   Ends when a sweep over all changes no speed A lambda by more than CLOSE of the largest, or after SWEEPS.
Between two such sweeps come those over the contacts that still changed by more: they are soon few.
W/sqrt(m) and v sqrt(m) are worked with: no sweep asks for a mass. A tool that forces move adds its 1/M to A, and takes the reaction along its direction.
Overlap, where a scene has any, is pushed out at PUSH of the speed of sound c at most. Sweeps run forwards and backwards in turn, one thread's work;
of scenes in slabs: solve_threaded.py.
"""

from typing import Any, NamedTuple

import numpy as np

from mpm.boundary import directions, extents
from mpm.contact.spots import WIDE, lanes_of, new_places, places, spans
from mpm.contact.tools import carry, lightness, recoil
from mpm.jit import kernel
from mpm.lanes import fma, load4, peek, splat4, store

PUSH, CLOSE, SWEEPS = 0.01, 3e-3, 60
FAINT = 1e-9  # of the speed of sound: smaller changes are none
SURE = 0.1  # cells: closer gaps are always in the sweeps


class Problem(NamedTuple):
    """What the impulses of a step are looked for with. F fields, C contacts, M nodes of a contact, K nodes that any acts on."""

    contacts: Any
    at: np.ndarray  # (C, 2, M) their numbers among those; half as long as others, as sweeps read them from the second-level cache
    row: np.ndarray  # (C * 2 * M,) the same, in one row
    coef: np.ndarray  # (C, 2, M, 1) W/sqrt(m), or (C, 2, M, WIDE) where a mirror is in sight, which turns directions each its own way
    velocity: np.ndarray  # (K, WIDE) v sqrt(m)
    mass: np.ndarray  # (K,) m
    light: np.ndarray  # (K,) 1/sqrt(m); 0 without mass
    place: np.ndarray  # (K,) where the node is
    field: np.ndarray  # (K,) of which field
    tools: Any
    impulse: np.ndarray  # (C, D) on the A side [kg m/s]
    bear: np.ndarray  # (C, WIDE) A, a direction each, but for the tool


@kernel
def pose(space, walls, fields, contacts, count, nodes, tools, number):
    """The problem of contacts 0..count, on the nodes (F, n, columns) that they act on, its weights still to come. number (n,): -1 before and after."""
    D, shape, here, used, mirrored = directions(space), extents(space), new_places(space), 0, False
    n0, n1, n2 = spans(space)
    at = np.empty((count, 2, n0 * n1 * n2), np.int32)
    place, field, row = np.empty(at.size, np.int64), np.empty(at.size, np.int64), at.reshape(-1)
    for f in range(nodes.shape[0]):
        first = used
        for i in range(count):
            for k in range(2):
                if contacts.body[i, k] < 0 or fields[contacts.body[i, k]] != f:
                    continue
                mirrored = places(space, walls[f], contacts.home[i, k], here) or mirrored
                m = (2 * i + k) * n0 * n1 * n2
                for j0 in range(n0):
                    for j1 in range(n1):
                        for j2 in range(n2):
                            n = (here[0, j0] * shape[1] + here[1, j1]) * shape[2] + here[2, j2]
                            if number[n] < 0:
                                number[n], place[used], field[used] = used, n, f
                                used += 1
                            row[m] = number[n]
                            m += 1
        for j in range(first, used):
            number[place[j]] = -1
    velocity, mass, light = np.zeros((used, WIDE)), np.empty(used), np.zeros(used)
    for j in range(used):
        mass[j] = nodes[field[j], place[j], D]
        root = mass[j] ** 0.5
        light[j] = 1.0 / root if root > 0.0 else 0.0
        for c in range(D):
            velocity[j, c] = root * nodes[field[j], place[j], c] if root < np.inf else 0.0
    coef, bear, impulse = np.empty((count, 2, n0 * n1 * n2, WIDE if mirrored else 1)), np.zeros((count, WIDE)), np.zeros((count, D))
    return Problem(contacts, at, row, coef, velocity, mass, light, place[:used], field[:used], tools, impulse, bear)


@kernel
def settle(space, problem, nodes, force):
    """The velocities of the problem back to the nodes, and their changes to `force`, where it has rows. The largest speed."""
    most = 0.0
    for j in range(len(problem.place)):
        if problem.light[j] > 0.0:
            f, n, square = problem.field[j], problem.place[j], 0.0
            root = np.float64(nodes[f, n, directions(space)]) ** 0.5
            for c in range(directions(space)):
                change = problem.light[j] * (problem.velocity[j, c] - root * nodes[f, n, c])  # nothing where nothing was given
                if force.shape[1] > 0:
                    force[f, n, c] += change
                nodes[f, n, c] += change
                square += nodes[f, n, c] ** 2
            most = max(most, square)
    return most**0.5


@kernel
def press(space, problem, dt, sound, warm, rows):
    """The impulses of all contacts, applied to the velocities of the problem and to free tools.

    warm (P, against, D): impulses of the step before; rows (against,): where they are kept. Those of contacts far off are zero.
    """
    count, D = len(problem.impulse), directions(space)
    inverse, live, lively, u, quiet = np.zeros(count), np.empty(count, np.int64), 0, np.zeros(WIDE), np.zeros(count, np.bool_)
    ready(space, problem, (0, count), dt, warm, rows, inverse)
    for i in range(count):
        if inverse[i] > 0.0:
            live[lively] = i
            lively += 1
    for k in range(lively):
        begin(problem, live[k], D, u)
    largest, every = FAINT / CLOSE * sound, True
    for sweep in range(SWEEPS):
        worst, still = sweep_over(problem, live[:lively], sweep % 2, every, D, dt, sound, inverse, u, quiet, largest)
        largest = still if every else max(largest, still)
        if every and worst <= CLOSE * largest:
            break
        every = worst <= CLOSE * largest


@kernel(inline=True)
def sweep_over(problem, some, back, every, D, dt, sound, inverse, u, quiet, scale):
    """Relax the contacts `some`, from the last on where `back`, only those not `quiet` where not `every`. The largest change of a speed, and speed."""
    worst, largest = 0.0, FAINT / CLOSE * sound
    for k in range(len(some)):
        i = some[len(some) - 1 - k if back == 1 else k]
        if every or not quiet[i]:
            changed, given = one(problem, i, D, dt, sound, inverse, u)
            worst, largest = max(worst, changed), max(largest, given)
            quiet[i] = changed <= CLOSE * max(scale, largest)
    return worst, largest


@kernel(inline=True)
def apart(gap, dt, sound):
    """How fast what overlaps is pushed apart [m/s]; 0 of a gap."""
    return min(max(-gap, 0.0) / dt, PUSH * sound)


@kernel
def ready(space, problem, some, dt, warm, rows, inverse):
    """1/A of the contacts some[0] <= i < some[1] that bore an impulse, or are so near that they might; the others' stays zero."""
    contacts, D, u = problem.contacts, directions(space), np.zeros(WIDE)
    for i in range(some[0], some[1]):
        most = lightness(problem.tools, contacts.free[i]) + max(problem.bear[i, 0], problem.bear[i, 1], problem.bear[i, 2])
        if not most > 0.0:
            continue
        before, live = 0.0, contacts.gap[i] < SURE * space.h
        for c in range(D):
            problem.impulse[i, c] = remembered(contacts, i, c, warm, rows)
            before += problem.impulse[i, c] * contacts.normal[i, c]
        if not (live or before > 0.0):
            speed_of(problem, i, D, u)
            closing = 0.0
            for c in range(D):
                closing += min(u[c] * contacts.normal[i, c], 0.0)
            live = contacts.gap[i] + 1.5 * dt * closing < SURE * space.h
        if live or before > 0.0:
            inverse[i] = 1.0 / most
            continue
        for c in range(D):
            problem.impulse[i, c] = 0.0


@kernel(inline=True)
def remembered(contacts, i, c, warm, rows):
    """Component c of the impulse that the pieces of contact i bore in the step before."""
    total, s, more, row = 0.0, contacts.piece[i], contacts.mates[i], rows[contacts.against[i]]
    while s >= 0:
        total += warm[s, row, c]
        s, more = more, contacts.after[more] if more >= 0 else -1
    return total


@kernel(inline=True)
def node(problem, m):
    """Number m of all nodes of all contacts. An unsigned index is never looked at for being negative, which costs as much as what is done with it."""
    return problem.row[np.uint64(m)]


@kernel(inline=True)
def weight(problem, m, narrow):
    """W/sqrt(m) there, of each direction."""
    return splat4(peek(problem.coef, m)) if narrow else load4(problem.coef, WIDE * m)


@kernel(inline=True)
def through(problem, i, k):
    """sum W v of side k of contact i: three sums at once, as each waits for its last product."""
    M, narrow = problem.at.shape[2], problem.coef.shape[3] == 1
    here, one, two, three = (2 * i + k) * M, splat4(0.0), splat4(0.0), splat4(0.0)
    for m in range(here, here + M - 2, 3):
        one = fma(weight(problem, m, narrow), load4(problem.velocity, WIDE * node(problem, m)), one)
        two = fma(weight(problem, m + 1, narrow), load4(problem.velocity, WIDE * node(problem, m + 1)), two)
        three = fma(weight(problem, m + 2, narrow), load4(problem.velocity, WIDE * node(problem, m + 2)), three)
    for m in range(here + M - M % 3, here + M):
        one = fma(weight(problem, m, narrow), load4(problem.velocity, WIDE * node(problem, m)), one)
    return one + two + three


@kernel(inline=True)
def speed(problem, i, D, u):
    """u of contact i."""
    contacts, total = problem.contacts, splat4(0.0)
    for k in range(2):
        if contacts.body[i, k] >= 0:
            side = through(problem, i, k)
            total = total + side if k == 0 else total - side
    store(u, 0, total)
    for c in range(D):
        u[c] -= contacts.given[i, c]
    carry(problem.tools, contacts.free[i], u[:D])


@kernel
def speed_of(problem, i, D, u):
    """The same, compiled once for those who ask seldom."""
    speed(problem, i, D, u)


@kernel(inline=True)
def push(problem, i, D, change):
    """Put a change of impulse on both sides."""
    contacts, M, size, narrow = problem.contacts, problem.at.shape[2], lanes_of(D, change), problem.coef.shape[3] == 1
    for k in range(2):
        if contacts.body[i, k] < 0:
            continue
        way = size if k == 0 else -size
        for m in range((2 * i + k) * M, (2 * i + k + 1) * M):
            n = node(problem, m)
            store(problem.velocity, WIDE * n, fma(weight(problem, m, narrow), way, load4(problem.velocity, WIDE * n)))
    recoil(problem.tools, contacts.free[i], change[:D])


@kernel(inline=True)
def begin(problem, i, D, change):
    """The impulse of the step before, within the cone of this one."""
    contacts, along, square = problem.contacts, 0.0, 0.0
    for c in range(D):
        change[c] = problem.impulse[i, c]
        along += change[c] * contacts.normal[i, c]
    share, most = 0.0, contacts.mu[i] * along
    for c in range(D):
        change[c] -= along * contacts.normal[i, c]
        square += change[c] ** 2
    if along > 0.0:
        share = 1.0 if square <= most * most else most / square**0.5
    for c in range(D):
        change[c] = share * change[c] + max(along, 0.0) * contacts.normal[i, c]
        problem.impulse[i, c] = change[c]
    if along > 0.0:
        push(problem, i, D, change)


@kernel(inline=True)
def one(problem, i, D, dt, sound, inverse, u):
    """Relax one contact; by how much its speed changed, and all that the contact gives."""
    contacts, impulse = problem.contacts, problem.impulse
    n, mu = contacts.normal[i], contacts.mu[i]
    speed(problem, i, D, u)
    along, un = 0.0, 0.0
    for c in range(D):
        along += impulse[i, c] * n[c]
        un += u[c] * n[c]
    pressed = max(0.0, along - (un + max(contacts.gap[i] / dt, -PUSH * sound)) * inverse[i])
    square = 0.0
    for c in range(D):  # u becomes the new impulse, then its change
        u[c] = impulse[i, c] - along * n[c] - (u[c] - un * n[c]) * inverse[i]
        square += u[c] ** 2
    share = 0.0
    if pressed > 0.0 and mu > 0.0 and square > 0.0:
        share = 1.0 if mu == np.inf or square <= (mu * pressed) ** 2 else mu * pressed / square**0.5
    changed, given = 0.0, 0.0
    for c in range(D):
        new = share * u[c] + pressed * n[c]
        u[c] = new - impulse[i, c]
        impulse[i, c] = new
        changed, given = max(changed, abs(u[c])), max(given, abs(new))
    if changed > 0.0:
        push(problem, i, D, u)
    return changed / inverse[i], given / inverse[i]
