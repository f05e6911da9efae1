"""One implicit heat step of bodies that touch: their matrices side by side, and the links between them (integrate/heat_implicit.py for the scheme).

    C (theta_k - base_k) = gamma dt [f(theta_k) - sum_links rate (t_A . theta_A - t_B . theta_B) (t_A; -t_B)]

Links are symmetric and their rows sum to nothing: what leaves A comes to B, whatever the conductance and the tolerance. Conjugate gradients go over all bodies
at once; the incomplete factor is made of each body's own block, the link's share of it included.
Good values  H up to 100 kappa/h; a stiffer link changes the result by less than the cell's error and takes more iterations.
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.walls import fold, unfold
from mpm.contact.spots import seen
from mpm.heat.exchange import meet
from mpm.integrate.heat_implicit import GAMMA, combine, conductances, drop_ghosts, inside, load, take, wipe
from mpm.integrate.heat_matrix import blocks, conjugate_gradients, matrix, product, times
from mpm.integrate.heat_step import gather_heat, over_nodes, reach, scatter_heat
from mpm.integrate.surface_flux import expose, place, temperature_at
from mpm.jit import kernel
from mpm.transfer import CHUNK

FIELDS = 6  # of nodes, each body's own: capacity, theta, base, total, stage, rate


@kernel
def opened(space, body, nodes, walls):
    """The fields of one body at the start: its box of nodes, V kappa of its particles, its unknowns."""
    shape, x, thermal = extents(space), body.particles.x, body.thermal
    box, work = reach(space, x), np.zeros((2 + 3 * directions(space), CHUNK))
    scatter_heat(space, x, body.particles.m, thermal, nodes[0], nodes[1], work)
    folded = box.copy()
    fold(nodes[0].reshape(-1, 1), 0, shape, folded, walls)
    fold(nodes[1].reshape(-1, 1), 0, shape, box, walls)
    over_nodes(nodes[1], nodes[0], nodes[2], shape, box, True)
    unfold(nodes[1].reshape(-1, 1), 0, shape, box, walls)
    drop_ghosts(nodes[0], shape, box, walls)
    return box, conductances(space, body, thermal, nodes[1], work), inside(nodes[0], shape, box)


@kernel
def stage_matrix(space, body, nodes, walls, box, flow, each, part, first, dt):
    """(rows, columns, between, r, met) of a stage of one body, links apart. `first`: no base of its own yet. dt is that of the stage."""
    shape, x, work = extents(space), body.particles.x, np.zeros((2 + 3 * directions(space), CHUNK))
    pieces = place(body.surface, space, body)
    met = np.empty((3, pieces[0].shape[0]))
    for s in range(met.shape[1]):
        there = temperature_at(space, x, pieces[0], pieces[2], s, nodes[1], work)
        met[0, s], met[1, s], met[2, s] = meet(body.surface, s, there, body.thermal.zero, part)
    if not first:
        combine(nodes[2], nodes[1], nodes[3], nodes[0], 1.0, shape, box)
    unfold(nodes[2].reshape(-1, 1), 0, shape, box, walls)
    load(space, x, flow, pieces, met, nodes[2], nodes[5], dt, 1.0, work)
    fold(nodes[5].reshape(-1, 1), 0, shape, box, walls)
    r = nodes[5][each]
    wipe(nodes[5], shape, box)
    rows, columns, between = matrix(space, shape, x, flow, pieces, met, nodes[0], each, dt, walls)
    return rows, columns, between, r, met


@kernel
def stage_loads(space, body, nodes, walls, box, flow, met, dt, part):
    """What the stage temperatures load in dt, `part` of the heat step gone, on to nodes[5], folded; the heat gained through surfaces [J]."""
    shape, work, pieces = extents(space), np.zeros((2 + 3 * directions(space), CHUNK)), place(body.surface, space, body)
    unfold(nodes[4].reshape(-1, 1), 0, shape, box, walls)
    gained = load(space, body.particles.x, flow, pieces, met, nodes[4], nodes[5], dt, 1.0, work)
    expose(body.surface, space, body.particles.x, pieces, nodes[4], dt, part, work)
    fold(nodes[5].reshape(-1, 1), 0, shape, box, walls)
    return gained


@kernel
def closed(space, body, nodes, walls, box, back):
    """The particles' temperatures from the fields at the end, which are cleared."""
    shape, work = extents(space), np.zeros((2 + 3 * directions(space), CHUNK))
    combine(nodes[4], nodes[1], nodes[3], nodes[0], 1.0, shape, box)
    unfold(nodes[4].reshape(-1, 1), 0, shape, box, walls)
    gather_heat(space, body.particles.x, body.thermal, nodes[1], nodes[4], back, work)
    clean(space, nodes, box)


@kernel
def clean(space, nodes, box):
    """Zero the fields."""
    for field in range(nodes.shape[0]):
        wipe(nodes[field], extents(space), box)


@kernel
def settle(space, nodes, box):
    """total += rate, rate = 0."""
    take(nodes[3], nodes[5], extents(space), box)


@kernel
def own_blocks(space, rows, at, t, number, rate, dt):
    """One body's share of its links on to the rows: dt rate t t^T. at and t (L, M) of its side, number (nodes,) of its unknowns, -1 for none."""
    D, shape, width = directions(space), extents(space), 2 * seen(space) - 1
    place_a, place_b = np.zeros(3, np.int64), np.zeros(3, np.int64)
    for e in range(len(rate)):
        for a in range(at.shape[1]):
            row = number[at[e, a]]
            if row < 0:
                continue
            apart(shape, at[e, a], place_a)
            for b in range(at.shape[1]):
                if number[at[e, b]] >= row:
                    apart(shape, at[e, b], place_b)
                    where = 0
                    for k in range(D):
                        where = where * width + place_b[k] - place_a[k]
                    rows[row, where] += dt * rate[e] * t[e, a] * t[e, b]


@kernel(inline=True)
def apart(shape, n, out):
    """(i, j, k) of a flat node."""
    out[0], rest = n // (shape[1] * shape[2]), n % (shape[1] * shape[2])
    out[1], out[2] = rest // shape[2], rest % shape[2]


@kernel
def drops(at, t, x):
    """t_A . x_A - t_B . x_B of every link; at (L, 2, M) numbers of unknowns, -1 for none."""
    out = np.zeros(at.shape[0])
    for e in range(at.shape[0]):
        for k in range(2):
            for m in range(at.shape[2]):
                if at[e, k, m] >= 0:
                    out[e] += (1.0 if k == 0 else -1.0) * t[e, k, m] * x[at[e, k, m]]
    return out


@kernel
def push(at, t, flow, y):
    """y += (t_A; -t_B) flow."""
    for e in range(at.shape[0]):
        for k in range(2):
            for m in range(at.shape[2]):
                if at[e, k, m] >= 0:
                    y[at[e, k, m]] += (1.0 if k == 0 else -1.0) * t[e, k, m] * flow[e]


class Linked(NamedTuple):
    """C + dt A of bodies side by side, and their links."""

    rows: np.ndarray  # (K, m) without them
    whole: np.ndarray  # (K, m) with each block's own share, for the factor
    at: np.ndarray  # (L, 2, M) numbers of unknowns
    t: np.ndarray  # (L, 2, M)
    conductance: np.ndarray  # (L,) times the step [J/K]


@times.register(Linked)
def times_linked(operator, columns, x, y):
    product(operator.rows, columns, x, y)
    push(operator.at, operator.t, operator.conductance * drops(operator.at, operator.t, x), y)


@blocks.register(Linked)
def blocks_linked(operator):
    return operator.whole


@kernel
def solve_linked(operator, columns, between, weight, r, change, tolerance):
    """conjugate_gradients of this room: a kernel is kept by the room that it is called from, with all that it holds (mpm.fingerprint)."""
    return conjugate_gradients(operator, columns, between, weight, r, change, tolerance)


def conduct_together(space, bodies, which, nodes, walls, links, dt: float, order: int, tolerance: float, back):
    """Advance the temperatures of the bodies numbered `which` by dt; nodes (B, FIELDS, n) zero before and after, walls (B, 3, 2).

    Returns (heat gained through surfaces [J], heat through each link from A to B (L,) [J], iterations or -1).
    """
    n = nodes.shape[2]
    one = {b: opened(space, bodies[b], nodes[b], walls[b]) for b in which}
    ends = np.cumsum([0, *(len(one[b][2]) for b in which)])
    number = np.full((len(bodies), n), -1)
    for b, first in zip(which, ends, strict=False):
        number[b, one[b][2]] = first + np.arange(len(one[b][2]))
    at = np.stack([number[links.body[:, k, None], links.at[:, k]] for k in range(2)], axis=1)
    weight = np.concatenate([nodes[b, 0, one[b][2]] for b in which])
    gained, passed, iterations, gamma = 0.0, np.zeros(len(links.rate)), 0, 1.0 if order == 1 else GAMMA
    for k in range(order):
        last, step = k == order - 1, gamma * dt
        gone = 1.0 if last else gamma
        made = [stage_matrix(space, bodies[b], nodes[b], walls[b], *one[b], gone, k == 0, step) for b in which]
        rows, r = np.concatenate([m[0] for m in made]), np.concatenate([m[3] for m in made])
        columns = np.concatenate([np.where(m[1] >= 0, m[1] + first, -1) for m, first in zip(made, ends, strict=False)])
        whole = rows.copy()
        for b in which:
            for side in range(2):
                mine = links.body[:, side] == b
                own_blocks(space, whole, links.at[mine, side], links.t[mine, side], number[b], links.rate[mine], step)
        base = np.concatenate([nodes[b, 2, one[b][2]] for b in which])
        push(at, links.t, -step * links.rate * drops(at, links.t, base), r)
        change = np.empty(len(r))
        count = solve_linked(Linked(rows, whole, at, links.t, step * links.rate), columns, made[0][2], weight, r, change, tolerance)
        if count < 0:
            for b in which:
                clean(space, nodes[b], one[b][0])
            return 0.0, passed, -1
        iterations += count
        share = dt * (gamma if last else 1.0 - gamma)
        heat = share * links.rate * drops(at, links.t, base + change)
        passed += heat
        moved = np.zeros(len(r))
        push(at, links.t, -heat, moved)
        for b, first, m in zip(which, ends, made, strict=False):
            each = one[b][2]
            mine = slice(first, first + len(each))
            nodes[b, 4, each] = base[mine] + change[mine]
            gained += stage_loads(space, bodies[b], nodes[b], walls[b], one[b][0], one[b][1], m[4], share, gone)
            nodes[b, 5, each] += moved[mine]
            settle(space, nodes[b], one[b][0])
    for b in which:
        closed(space, bodies[b], nodes[b], walls[b], one[b][0], back)
    return gained, passed, iterations
