"""One implicit heat step of a moving body: conduction and surface together, by conjugate gradients (heat_matrix.py; docs/physics.md 4, 11).

    C (theta_k - base_k) = gamma dt f(theta_k),   f = sum V q grad(w) + sum S [q - beta (theta_s - outside)] w~,   theta+ = theta + dt sum b_k f(theta_k)/C
    order 1   backward Euler: gamma = 1                    order 2   Alexander's two stages: gamma = 1 - 1/sqrt(2); both L-stable

C, kappa and radiation's secants are those of the step's start. The step ends with the fluxes at the stage temperatures:
the heat of the particles changes by exactly what the pieces exchanged, however loose the tolerance; an iterate's residual r
only moves heat between nodes, by r/C.
Mirror walls fold in the operator: ghost nodes are no unknowns. The matrix of a step is made on the nodes, and factored incompletely.
Good values  tolerance 1e-9.   Fails when: iterations pass MOST_ITERATIONS (returned, not hidden).
"""

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.boundary.walls import clear, fold, unfold
from mpm.heat.exchange import meet
from mpm.heat.lanes import specify
from mpm.integrate.heat_matrix import Rows, conjugate_gradients, matrix
from mpm.integrate.heat_step import gather_heat, over_nodes, reach, scatter_heat
from mpm.integrate.surface_flux import expose, load_piece, place, temperature_at
from mpm.jit import kernel, role
from mpm.materials.laws import Constant
from mpm.state import PAD, Isothermal, Thermal
from mpm.transfer import CHUNK, gather_scalar, scatter_scalar

GAMMA = 1.0 - 0.5**0.5


@kernel
def heat_implicit(space, body, nodes, walls, dt, order, tolerance, back):
    """Advance one body's temperatures by dt; nodes: (6 or more, n) scratch, zero before and after. Returns (heat gained [J], iterations or -1)."""
    return advance_implicit(body.thermal, space, body, nodes, walls, dt, order, tolerance, back)


@role
def advance_implicit(thermal, space, body, nodes, walls, dt, order, tolerance, back):
    """See heat_implicit."""
    raise TypeError(f"no heat for {type(thermal).__name__}")


@advance_implicit.register(Isothermal)
def advance_implicit_isothermal(thermal, space, body, nodes, walls, dt, order, tolerance, back):
    return 0.0, 0


@advance_implicit.register(Thermal)
def advance_implicit_thermal(thermal, space, body, nodes, walls, dt, order, tolerance, back):
    return implicit_by_law(thermal.alpha, thermal, space, body, nodes, walls, dt, order, tolerance, back)


@role
def implicit_by_law(alpha, thermal, space, body, nodes, walls, dt, order, tolerance, back):
    """heat_implicit of a body with heat, by the law of its specific heat: one linear solution a stage where it is constant, enthalpy_steps.py elsewhere."""
    raise TypeError(f"{type(alpha).__name__} is no law of temperature")


@implicit_by_law.register(Constant)
def implicit_by_law_constant(alpha, thermal, space, body, nodes, walls, dt, order, tolerance, back):
    shape = extents(space)
    x = body.particles.x
    box = reach(space, x)
    capacity, theta, base, total = nodes[0], nodes[1], nodes[2], nodes[3]
    stage, rate = nodes[4], nodes[5]
    work = np.zeros((2 + 3 * directions(space), CHUNK))
    scatter_heat(space, x, body.particles.m, thermal, capacity, theta, work)
    folded = box.copy()
    fold(capacity.reshape(-1, 1), 0, shape, folded, walls)
    fold(theta.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(theta, capacity, base, shape, box, True)
    unfold(theta.reshape(-1, 1), 0, shape, box, walls)
    drop_ghosts(capacity, shape, box, walls)
    flow = conductances(space, body, thermal, theta, work)
    pieces = place(body.surface, space, body)
    met = np.empty((3, pieces[0].shape[0]))  # beta, outside, q of every piece
    gained, iterations, stages = 0.0, 0, order
    gamma = 1.0 if order == 1 else GAMMA
    for k in range(stages):
        part = 1.0 if k == stages - 1 else gamma
        for s in range(met.shape[1]):
            there = temperature_at(space, x, pieces[0], pieces[2], s, theta, work)
            met[0, s], met[1, s], met[2, s] = meet(body.surface, s, there, thermal.zero, part)
        if k == 1:  # base = theta + (1 - gamma) dt f_1/C
            combine(base, theta, total, capacity, 1.0, shape, box)
        count = solve(space, x, (flow, pieces, met), (capacity, base, stage, rate), gamma * dt, tolerance, walls, box, work)
        if count < 0:
            break
        iterations += count
        weight = dt * (gamma if k == stages - 1 else 1.0 - gamma)
        unfold(stage.reshape(-1, 1), 0, shape, box, walls)
        gained += load(space, x, flow, pieces, met, stage, rate, weight, 1.0, work)
        expose(body.surface, space, x, pieces, stage, weight, part, work)
        fold(rate.reshape(-1, 1), 0, shape, box, walls)
        take(total, rate, shape, box)
    ok = count >= 0
    if ok:
        combine(stage, theta, total, capacity, 1.0, shape, box)
        unfold(stage.reshape(-1, 1), 0, shape, box, walls)
        gather_heat(space, x, thermal, theta, stage, back, work)
    for field in range(nodes.shape[0]):
        used = box.copy()
        clear(nodes[field].reshape(-1, 1), shape, used)
    return (gained, iterations) if ok else (0.0, -1)


@kernel
def drop_ghosts(capacity, shape, box, walls):
    """No capacity on the ghost planes of mirror walls: what has none is no unknown."""
    stride = (shape[1] * shape[2], shape[2], 1)
    for axis in range(3):
        if shape[axis] == 1:
            continue
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for side in range(2):
            first, last = (0, PAD) if side == 0 else (shape[axis] - PAD, shape[axis])
            if walls[axis, side] == CONTACT:
                continue
            for ghost in range(max(first, box[axis, 0]), min(last, box[axis, 1])):
                for i in range(box[a, 0], box[a, 1]):
                    for j in range(box[b, 0], box[b, 1]):
                        capacity[i * stride[a] + j * stride[b] + ghost * stride[axis]] = 0.0


@kernel
def conductances(space, body, thermal, theta, work):
    """V kappa of every particle at nodal temperatures `theta`."""
    D = directions(space)
    p = body.particles
    out = np.empty(p.x.shape[0])
    at, slope, grad = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D]
    for first in range(0, len(out), CHUNK):
        count = min(CHUNK, len(out) - first)
        gather_scalar(space, p.x, first, count, theta, at, slope, grad)
        for i in range(count):
            at[i] += thermal.zero
        specify(thermal.kappa, at, count)
        for i in range(count):
            out[first + i] = p.J[first + i] * p.V0[first + i] * at[i]
    return out


@kernel
def load(space, x, flow, pieces, met, theta, rate, dt, sources, work):
    """rate += dt f(theta); `sources` 0 leaves outside and q away: the linear operator -dt A. Returns the heat gained [J]."""
    D = directions(space)
    at, slope, grad, zero = work[0], work[2 : 2 + D], work[2 + D : 2 + 2 * D], work[2 + 2 * D : 2 + 3 * D]
    zero[:] = 0.0
    for first in range(0, x.shape[0], CHUNK):
        count = min(CHUNK, x.shape[0] - first)
        gather_scalar(space, x, first, count, theta, at, slope, grad)
        for p in range(count):
            at[p] = 0.0
            for k in range(D):
                grad[k, p] *= -dt * flow[first + p]
        scatter_scalar(space, x, first, count, at, zero, grad, rate)
    owner, area, offset = pieces
    gained = 0.0
    for s in range(owner.shape[0]):
        there = temperature_at(space, x, owner, offset, s, theta, work)
        push = dt * area[s] * (sources * met[2, s] - met[0, s] * (there - sources * met[1, s]))
        load_piece(space, x, owner, offset, s, push, rate, work)
        gained += push
    return gained


@kernel
def solve(space, x, flux, fields, dt, tolerance, walls, box, work):
    """theta with C (theta - base) = dt f(theta) on the nodes with capacity, from `base`; iterations, or -1.

    flux: conductances of particles, pieces, and what they met; fields: C, base, theta, and rate, which comes and goes as zero.
    """
    (flow, pieces, met), (capacity, base, theta, rate), shape = flux, fields, extents(space)
    each = inside(capacity, shape, box)
    ghosts = base.reshape(-1, 1)
    unfold(ghosts, 0, shape, box, walls)
    load(space, x, flow, pieces, met, base, rate, dt, 1.0, work)
    fold(rate.reshape(-1, 1), 0, shape, box, walls)
    r, weight, change = np.empty(len(each)), np.empty(len(each)), np.empty(len(each))
    for k in range(len(each)):
        r[k], weight[k] = rate[each[k]], capacity[each[k]]
    wipe(rate, shape, box)
    rows, columns, between = matrix(space, shape, x, flow, pieces, met, capacity, each, dt, walls)
    done = conjugate_gradients(Rows(rows), columns, between, weight, r, change, tolerance)
    for k in range(len(each)):
        theta[each[k]] = base[each[k]] + change[k]
    return done


@kernel
def inside(capacity, shape, box):
    """Indices of the nodes with capacity."""
    found, count = np.empty(np.prod(box[:, 1] - box[:, 0]), np.int64), 0
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                if capacity[n] > 0.0:
                    found[count] = n
                    count += 1
    return found[:count]


@kernel
def wipe(field, shape, box):
    """Zero a field in the box."""
    used = box.copy()
    clear(field.reshape(-1, 1), shape, used)


@kernel
def take(total, rate, shape, box):
    """total += rate, rate = 0."""
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                total[n] += rate[n]
                rate[n] = 0.0


@kernel
def combine(out, theta, heat, capacity, factor, shape, box):
    """out = theta + factor heat/C where there is capacity."""
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                if capacity[n] > 0.0:
                    out[n] = theta[n] + factor * heat[n] / capacity[n]
