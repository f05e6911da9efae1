"""What nodes take up where alpha follows temperature: through the enthalpies of their particles, so no step jumps over latent heat.

With H the primitive of alpha, and e_ip = b (theta_i - theta_p - c_p d_ip) the part b (`blend`) of what a transfer gives a particle from a node:
    taken up    E_i(u) = sum_p m w_ip [H(theta_p + e_ip + u) - H(theta_p)]                      rises with u; E_i(0) = 0 says what theta_i is
    step        E_i(u_i) = heat that flows to node i at nodal temperatures theta + u            enthalpy_steps.py
    particle    h_p += sum_i w_ip [H(theta_p + e_ip + u_i) - H(theta_p)],  theta_p = theta(h_p)
The particles take up what the nodes did, and none goes beyond theta_p + e_ip + u_i of its nodes. With constant alpha this is heat_step.py's lumped mass.
What `settle` leaves over is handed out by mass: the ledger closes to round-off.
Source  the enthalpy method (Voller & Cross 1981), in a form for particles and their transfers.
Fails when: a transfer keeps increments alone (FLIP): a particle on the other side of the bump than its nodes is moved as far as they are.
"""

from typing import NamedTuple

import numpy as np

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, fold, unfold
from mpm.heat.local import rise
from mpm.integrate.heat_implicit import drop_ghosts, inside
from mpm.integrate.heat_matrix import flat, nodes_of
from mpm.integrate.heat_step import over_nodes, reach, scatter_heat
from mpm.jit import kernel
from mpm.lanes import EIGHT, item, peek, put, splat8
from mpm.materials import enthalpies, values
from mpm.materials.laws import enthalpy
from mpm.transfer import CHUNK, gather_scalar

SWEEPS = 100
CLOSE = 1e-11  # of the absolute temperature, as in mpm.materials.laws.settle


class Pairs(NamedTuple):
    """Every particle with every node it reaches, M of them, for one heat step."""

    node: np.ndarray  # (N, M) number of the node, -1 where it has no capacity
    mass: np.ndarray  # (N, M) m w [kg]
    seen: np.ndarray  # (N, M) theta_p + e_ip, absolute [K]
    own: np.ndarray  # (N,) H(theta_p) [J/kg]


class HotNodes(NamedTuple):
    """The K nodes with capacity, as a heat step finds them."""

    walls: np.ndarray  # (3, 2) kinds
    shape: tuple  # of the grid
    box: np.ndarray  # (3, 2) nodes that the body touches
    each: np.ndarray  # (K,) their places among all nodes
    weight: np.ndarray  # (K,) capacity [J/K]
    base: np.ndarray  # (K,) temperature less zero [K]
    pairs: Pairs
    close: float  # what counts as the same temperature [K]
    ok: bool  # whether a temperature was found for each


class Taken(NamedTuple):
    """What the nodes have taken up since."""

    change: np.ndarray  # (K,) u [K]
    held: np.ndarray  # (K,) E(u) [J]
    slope: np.ndarray  # (K,) dE/du [J/K]


@kernel
def pair(space, x, m, thermal, walls, shape, number, base, blend):
    """The pairs at nodal temperatures `base` less zero."""
    D = directions(space)
    _, one, _, _, _ = stencil(space.basis, x[0, 0] / space.h)
    N, M = x.shape[0], len(one) ** D
    at, w, g, d = np.zeros((D, M), np.int64), np.zeros(M), np.zeros((D, M)), np.zeros((D, M))
    node, mass, seen, own = np.empty((N, M), np.int32), np.zeros((N, M)), np.zeros((N, M)), np.empty(N)
    for p in range(N):
        nodes_of(space, x, p, walls, at, w, g, d)
        theta = float(thermal.theta[p])
        own[p] = enthalpy(thermal.alpha, thermal.zero + theta)
        for a in range(M):
            k = number[flat(shape, at, a)] if w[a] > 0.0 else -1
            node[p, a] = k
            if k >= 0:
                gap = base[k] - theta
                for i in range(D):
                    gap -= thermal.c[p, i] * d[i, a]
                mass[p, a], seen[p, a] = m[p] * w[a], thermal.zero + theta + blend * gap
    return Pairs(node, mass, seen, own)


@kernel
def contents(alpha, pairs, change, going, held, slope):
    """E and dE/du of the nodes `going` at u = change, eight pairs at once."""
    (N, M), node, p, a = pairs.node.shape, pairs.node.reshape(-1), 0, 0
    for k in range(len(held)):
        if going[k]:
            held[k], slope[k] = 0.0, 0.0
    for first in range(0, N * M, EIGHT):
        there, left = splat8(pairs.seen[p, a]), 0
        for q in range(min(EIGHT, N * M - first)):
            k = node[first + q]
            if k >= 0 and going[k]:
                there, left = put(there, q, peek(pairs.seen, first + q) + change[k]), left + 1
        heat, capacity = (enthalpies(alpha, there), values(alpha, there)) if left > 0 else (there, there)
        for q in range(min(EIGHT, N * M - first)):
            k = node[first + q]
            if k >= 0 and going[k]:
                mass = peek(pairs.mass, first + q)
                held[k] += mass * (item(heat, q) - pairs.own[p])
                slope[k] += mass * item(capacity, q)
            a += 1
            if a == M:
                p, a = p + 1, 0


@kernel
def settle(alpha, pairs, close, target, change, held, slope):
    """change with E(change) = target, from the guess that stands there, to `close` [K], and E and dE/du at it. False where a node does not settle."""
    K = len(target)
    low, high, going = np.full(K, -np.inf), np.full(K, np.inf), np.full(K, True)
    for sweep in range(SWEEPS):
        contents(alpha, pairs, change, going, held, slope)
        left = 0
        for k in range(K):
            if not going[k]:
                continue
            over = held[k] - target[k]
            if over > 0.0:
                high[k] = change[k]
            else:
                low[k] = change[k]
            step = over / slope[k]
            if abs(step) <= close:
                going[k] = False
                continue
            left += 1
            trial = change[k] - step
            bracketed = low[k] > -np.inf and high[k] < np.inf
            if bracketed and ((sweep >= 8 and sweep % 2 == 0) or not low[k] < trial < high[k]):
                trial = 0.5 * (low[k] + high[k])
            change[k] = trial
        if left == 0:
            return True
    return False


@kernel
def level(alpha, pairs, close, blend, base):
    """Move `base`, and what the particles see of it, to where nothing has been taken up: E(0) = 0."""
    K = len(base)
    change = np.zeros(K)
    if not settle(alpha, pairs, close, np.zeros(K), change, np.empty(K), np.empty(K)):
        return False
    base += change / blend
    for p in range(pairs.node.shape[0]):
        for a in range(pairs.node.shape[1]):
            if pairs.node[p, a] >= 0:
                pairs.seen[p, a] += change[pairs.node[p, a]]
    return True


@kernel
def hand_out(alpha, pairs, m, thermal, change, rest):
    """Enthalpy from the nodes to the particles; rest: what the nodes got beyond E [J]."""
    N, M = pairs.node.shape
    mass = np.zeros(len(rest))
    for p in range(N):
        for a in range(M):
            if pairs.node[p, a] >= 0:
                mass[pairs.node[p, a]] += pairs.mass[p, a]
    for p in range(N):
        gain = 0.0
        for a in range(M):
            k = pairs.node[p, a]
            if k >= 0:
                gain += pairs.mass[p, a] * (enthalpy(alpha, pairs.seen[p, a] + change[k]) - pairs.own[p] + rest[k] / mass[k])
        thermal.theta[p] += rise(alpha, thermal.zero + thermal.theta[p], gain / m[p])


@kernel
def incline(space, x, thermal, theta, affine, work):
    """Slopes of the particles' temperatures from the nodes."""
    D = directions(space)
    at, slope, grad = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D]
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        gather_scalar(space, x, first, count, theta, at, slope, grad)
        for p in range(count):
            for k in range(D):
                thermal.c[first + p, k] = affine * slope[k, p]


@kernel
def numbered(each, n):
    """Number of every node in `each`, or -1."""
    number = np.full(n, -1)
    for k in range(len(each)):
        number[each[k]] = k
    return number


@kernel
def spread(each, values, field):
    """field[each] = values."""
    for k in range(len(each)):
        field[each[k]] = values[k]


@kernel
def opened(space, body, thermal, capacity, theta, scratch, walls, blend, work):
    """The nodes with capacity as a heat step finds them, and their temperatures in `theta`."""
    shape, x, m = extents(space), body.particles.x, body.particles.m
    box = reach(space, x)
    scatter_heat(space, x, m, thermal, capacity, theta, work)
    fold(capacity.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(theta.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(theta, capacity, scratch, shape, box, True)
    drop_ghosts(capacity, shape, box, walls)
    each = inside(capacity, shape, box)
    weight, base = capacity[each], theta[each]
    close = CLOSE * (thermal.zero + np.max(np.abs(base)))
    pairs = pair(space, x, m, thermal, walls, shape, numbered(each, len(capacity)), base, blend)
    ok = blend == 0.0 or level(thermal.alpha, pairs, close, blend, base)
    spread(each, base, theta)
    unfold(theta.reshape(-1, 1), 0, shape, box, walls)
    return HotNodes(walls, shape, box, each, weight, base, pairs, close, ok)


@kernel
def guess(on):
    """Nothing taken up yet."""
    K = len(on.each)
    return Taken(np.zeros(K), np.zeros(K), np.zeros(K))


@kernel
def show(on, taken, field):
    """Nodal temperatures, mirrored at walls."""
    spread(on.each, on.base + taken.change, field)
    unfold(field.reshape(-1, 1), 0, on.shape, on.box, on.walls)


@kernel
def closed(space, body, thermal, on, heat, taken, stage, affine, work):
    """Hand out `heat`, from the guess `taken`; `stage` is left with the nodal temperatures of the end. False where a node does not settle."""
    if not settle(thermal.alpha, on.pairs, on.close, heat, taken.change, taken.held, taken.slope):
        return False
    show(on, taken, stage)
    hand_out(thermal.alpha, on.pairs, body.particles.m, thermal, taken.change, heat - taken.held)
    incline(space, body.particles.x, thermal, stage, affine, work)
    return True


@kernel
def wiped(on, nodes):
    """Every field of `nodes` is zero again."""
    for field in range(nodes.shape[0]):
        used = on.box.copy()
        clear(nodes[field].reshape(-1, 1), on.shape, used)
