"""Heat steps of moving bodies whose alpha follows temperature: heat_step.py, heat_chebyshev.py and heat_implicit.py with enthalpy_nodes.py's nodes.

Explicit and stabilised steps carry the heat of the nodes, and look up their temperatures at every stage: E(u) = heat.
Implicit ones end with E(u) = dt f(theta + u): Newton on (dE/du + dt A) du = -residual, then dE = dE/du du, then u from E node by node; a step that does not
lower the residual is halved. As in mpm.rigid.newton, a step ends with the fluxes at the last iterate: the ledger closes to round-off.
A slab of 2 cooled by 100 K at Bi = 50 through 100 times the heat of a kelvin (bump of 2 K), APIC, mean temperature against a rigid body of 128 cells, 8, 16 and
32 cells a half: implicit of order 2 in steps of 0.02 s 0.42, 0.097, 0.019 K; at the automatic step (up to 70 times shorter: more transfers, more damping)
1.2, 0.54, 0.20 K by any way. Capacities of the step's start left the bounds by 41 to 359 K there. (tests/integrate/test_implicit_heat.py)
Iterations: 2 to 5 of Newton a step, one while no bump is near.
Good values  order 2, tolerance 1e-9; a bump as narrow as one likes.   Fails when: ITERATIONS of Newton pass (returned, not hidden).
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.boundary.walls import fold
from mpm.heat.exchange import meet
from mpm.integrate.enthalpy_nodes import closed, contents, guess, opened, settle, show, spread, wiped
from mpm.integrate.heat_chebyshev import recurrence, stabilised_by_law, stage_weights
from mpm.integrate.heat_implicit import GAMMA, conductances, implicit_by_law, load, wipe
from mpm.integrate.heat_matrix import Rows, conjugate_gradients, matrix
from mpm.integrate.heat_step import conduct, explicit_by_law
from mpm.integrate.surface_flux import exchange, expose, place, temperature_at
from mpm.jit import kernel
from mpm.materials import LAWS
from mpm.materials.laws import Constant
from mpm.transfer import CHUNK

ITERATIONS, HALVINGS = 60, 12
INNER = 1e-4  # of conjugate gradients: Newton repeats them
STALLED = 1e-6  # of the heat that moves: where round-off ends the iteration above its tolerance


class Flux(NamedTuple):
    """f(theta) of a step: conduction, and exchange at the surface."""

    flow: np.ndarray  # (N,) V kappa of the particles
    pieces: tuple  # owner, area, offset of the surface's pieces
    met: np.ndarray  # (3, pieces) beta, outside, q


class Scratch(NamedTuple):
    """Fields over all nodes, and of a chunk."""

    diagonal: np.ndarray
    stage: np.ndarray  # temperatures
    rate: np.ndarray  # dt f; comes and goes as zero
    work: np.ndarray


@kernel
def miss(space, x, flux, on, taken, total, dt, scratch, out):
    """out = E - total - dt f(theta + u); its norm squared, weighted as temperature."""
    show(on, taken, scratch.stage)
    load(space, x, flux.flow, flux.pieces, flux.met, scratch.stage, scratch.rate, dt, 1.0, scratch.work)
    fold(scratch.rate.reshape(-1, 1), 0, on.shape, on.box, on.walls)
    size = 0.0
    for k in range(len(on.each)):
        out[k] = taken.held[k] - total[k] - scratch.rate[on.each[k]]
    for k in range(len(on.each)):  # a sum apart from stores keeps its bits, whichever arrays are neighbours
        size += out[k] * out[k] / on.weight[k]
    wipe(scratch.rate, on.shape, on.box)
    return size


@kernel
def newton(space, x, alpha, flux, on, taken, total, dt, tolerance, scratch):
    """u with E(u) = total + dt f(theta + u), from the guess in `taken`; iterations of conjugate gradients, at least one a Newton step, or -1."""
    K, count = len(on.each), 0
    change, held, slope = taken.change, taken.held, taken.slope
    short, step = np.empty(K), np.empty(K)
    contents(alpha, on.pairs, change, np.full(K, True), held, slope)
    size = miss(space, x, flux, on, taken, total, dt, scratch, short)
    spread(on.each, slope, scratch.diagonal)
    rows, columns, between = matrix(space, on.shape, x, flux.flow, flux.pieces, flux.met, scratch.diagonal, on.each, dt, on.walls)
    others = rows[:, 0] - slope
    for _ in range(ITERATIONS):
        moved = np.sum(held * held / on.weight)
        if size <= tolerance * tolerance * moved or size == 0.0:
            return count
        for k in range(K):  # numpy's own way to fill an array compiles the words of its errors
            rows[k, 0] = others[k] + slope[k]
        done = conjugate_gradients(Rows(rows), columns, between, slope, -short, step, max(tolerance, INNER))
        if done < 0:
            return -1
        count += max(done, 1)
        before, was, linear = change.copy(), held.copy(), slope * step
        share, better = 1.0, False
        for _ in range(HALVINGS):
            for k in range(K):
                change[k] = before[k] + share * step[k]
            if not settle(alpha, on.pairs, on.close, was + share * linear, change, held, slope):
                return -1
            new = miss(space, x, flux, on, taken, total, dt, scratch, short)
            if new < size:
                better = True
                break
            share *= 0.5
        if not better:
            return count if size <= STALLED * STALLED * moved else -1
        size = new
    return -1


def implicit_through_enthalpy(alpha, thermal, space, body, nodes, walls, dt, order, tolerance, back):
    x, capacity, theta, diagonal, stage, rate = body.particles.x, nodes[0], nodes[1], nodes[2], nodes[4], nodes[5]
    work = np.zeros((2 + 3 * directions(space), CHUNK))
    on = opened(space, body, thermal, capacity, theta, diagonal, walls, back.blend, work)
    total, taken, scratch, ok = np.zeros(len(on.each)), guess(on), Scratch(diagonal, stage, rate, work), on.ok
    flow = conductances(space, body, thermal, theta, work)
    pieces = place(body.surface, space, body)
    met = np.empty((3, pieces[0].shape[0]))
    flux = Flux(flow, pieces, met)
    gained, iterations = 0.0, 0
    gamma = 1.0 if order == 1 else GAMMA
    for k in range(order):
        if not ok:
            break
        last = k == order - 1
        for s in range(met.shape[1]):
            there = temperature_at(space, x, pieces[0], pieces[2], s, theta, work)
            met[0, s], met[1, s], met[2, s] = meet(body.surface, s, there, thermal.zero, 1.0 if last else gamma)
        count = newton(space, x, alpha, flux, on, taken, total, gamma * dt, tolerance, scratch)
        ok = count >= 0
        iterations += count
        share = gamma if last else 1.0 - gamma
        gained += load(space, x, flow, pieces, met, stage, rate, share * dt, 1.0, work)
        expose(body.surface, space, x, pieces, stage, share * dt, 1.0 if last else gamma, work)
        collect(rate, on, total)
    ok = ok and closed(space, body, thermal, on, total, taken, stage, back.affine, work)
    wiped(on, nodes)
    return (gained, iterations) if ok else (0.0, -1)


@kernel
def collect(rate, on, heat):
    """heat += rate, rate = 0."""
    fold(rate.reshape(-1, 1), 0, on.shape, on.box, on.walls)
    for k in range(len(on.each)):
        heat[k] += rate[on.each[k]]
    wipe(rate, on.shape, on.box)


@kernel
def look_up(alpha, on, heat, taken, stage):
    """Nodal temperatures in `stage` of nodes that have taken up `heat`; NaN, which the guards tell of, where one does not settle."""
    if not settle(alpha, on.pairs, on.close, heat, taken.change, taken.held, taken.slope):
        taken.change[:] = np.nan
    show(on, taken, stage)


def explicit_through_enthalpy(alpha, thermal, space, body, nodes, walls, dt, substeps, back):
    x, capacity, theta, stage, rate = body.particles.x, nodes[0], nodes[1], nodes[2], nodes[3]
    work = np.zeros((2 + 3 * directions(space), CHUNK))
    on = opened(space, body, thermal, capacity, theta, stage, walls, back.blend, work)
    heat, taken = np.zeros(len(on.each)), guess(on)
    gained, pieces = 0.0, place(body.surface, space, body)
    for k in range(substeps):
        look_up(alpha, on, heat, taken, stage)
        conduct(space, body, thermal, stage, rate, dt / substeps, work)
        gained += exchange(body, space, pieces, thermal, stage, rate, dt / substeps, (k + 0.5) / substeps, work)
        expose(body.surface, space, x, pieces, stage, dt / substeps, (k + 0.5) / substeps, work)
        collect(rate, on, heat)
    if not closed(space, body, thermal, on, heat, taken, stage, back.affine, work):
        thermal.theta[:] = np.nan
    wiped(on, nodes)
    return gained


def stabilised_through_enthalpy(alpha, thermal, space, body, nodes, walls, dt, count, back):
    x, capacity, theta, stage, rate = body.particles.x, nodes[0], nodes[1], nodes[2], nodes[3]
    work = np.zeros((2 + 3 * directions(space), CHUNK))
    on = opened(space, body, thermal, capacity, theta, stage, walls, back.blend, work)
    K = len(on.each)
    taken, first = guess(on), np.zeros(K)
    pieces = place(body.surface, space, body)
    terms = recurrence(count)
    weights = stage_weights(terms)
    conduct(space, body, thermal, theta, rate, dt, work)
    gained = weights[0] * exchange(body, space, pieces, thermal, theta, rate, dt, 0.0, work)
    expose(body.surface, space, x, pieces, theta, weights[0] * dt, 0.0, work)
    collect(rate, on, first)
    before, last = np.zeros(K), terms[0, 0] * first
    t_before, t_last = 0.0, terms[0, 0]
    for k in range(1, count):
        mu, nu, step, lag = terms[k, 0], terms[k, 1], terms[k, 2], terms[k, 3]
        look_up(alpha, on, last, taken, stage)
        conduct(space, body, thermal, stage, rate, dt, work)
        gained += weights[k] * exchange(body, space, pieces, thermal, stage, rate, dt, t_last, work)
        expose(body.surface, space, x, pieces, stage, weights[k] * dt, t_last, work)
        flown = np.zeros(K)
        collect(rate, on, flown)
        before, last = last, mu * last + nu * before + step * flown - lag * first
        t_before, t_last = t_last, mu * t_last + nu * t_before + step - lag
    if not closed(space, body, thermal, on, last, taken, stage, back.affine, work):
        thermal.theta[:] = np.nan
    wiped(on, nodes)
    return gained


for law in LAWS:
    if law is not Constant:  # one by one: compiled code does not see the function that a role falls back to
        implicit_by_law.register(law, implicit_through_enthalpy)
        explicit_by_law.register(law, explicit_through_enthalpy)
        stabilised_by_law.register(law, stabilised_through_enthalpy)
