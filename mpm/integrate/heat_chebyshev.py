"""One stabilised explicit heat step of a moving body: Runge-Kutta-Chebyshev of order 2 on the nodes (Sommeijer, Shampine & Verwer 1997).

The equations are those of heat_step.py; s stages reach dt = 0.653 (s^2 - 1)/lambda for Euler's 2/lambda. Temperatures go through a recurrence, and end with
a weighted sum of the fluxes of all stages: so does the heat taken in, and the ledger closes to round-off. Capacity is that of the step's start.
Why    Euler's error in the step has the sign of APIC's damping, and adds to it. Bi = 10, thrown across the grid, heat steps of 0.15 h^2, by this and by Euler:
       disc, 6, 12, 24 cells a radius         4.2e-3, 1.0e-3, 2.5e-4              7.4e-3, 1.9e-3, 4.6e-4
       slab, worst of four offsets, 8 to 64   3.7e-3, 8.6e-4, 2.0e-4, 5.6e-5      4.5e-3, 1.1e-3, 2.7e-4, 6.5e-5      (tests/integrate/test_surface_exchange.py)
Good values   heat steps of 0.15 R0 alpha h^2/(kappa J). Twice as long the disc has 2.6e-3, 6.0e-4, 1.4e-4, but the slab 3.1e-3, 7.3e-4, 2.3e-4, 1.2e-4: between
       transfers the lumped mass shows, which is of order 1 at a free surface (docs/physics.md 12).
Stages are for the nodes alone: for `stable` itself APIC particles in bad places grew 3.4-fold in a step of 3 R0 alpha h^2/kappa (five stages; 1 500 random
       clouds, mpm.benchmarks.operators.stabilised).
Fails when   the basis is linear: a node that a particle just touches has no bound between transfers (auto is implicit there); beta h/kappa is large,
       which asks for many stages: implicit then.
"""

import math

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, fold, unfold
from mpm.integrate.heat_step import conduct, gather_heat, over_nodes, reach, scatter_heat
from mpm.integrate.surface_flux import exchange, expose, place
from mpm.integrate.timestep import SUBSTEPS
from mpm.jit import kernel, role
from mpm.materials.laws import Constant
from mpm.state import Isothermal, Thermal
from mpm.transfer import CHUNK

ROWS = 7  # scratch fields
DAMPING = 2.0 / 13.0


def stages(dt: float, stable: float) -> int:
    """Stages of a step dt where an Euler step that ends in a transfer is stable up to `stable` [s]: between transfers the nodes bear SUBSTEPS of it."""
    return max(2, math.ceil(math.sqrt(1.0 + 1.54 * 2.0 * dt / (SUBSTEPS * stable)) - 1e-9))


@kernel
def heat_chebyshev(space, body, nodes, walls, dt, count, back):
    """Advance one body's temperatures by dt in `count` >= 2 stages; nodes: (ROWS, n) scratch, zero before and after. Returns the heat gained [J]."""
    return advance_stabilised(body.thermal, space, body, nodes, walls, dt, count, back)


@role
def advance_stabilised(thermal, space, body, nodes, walls, dt, count, back):
    """See heat_chebyshev."""
    raise TypeError(f"no heat for {type(thermal).__name__}")


@advance_stabilised.register(Isothermal)
def advance_stabilised_isothermal(thermal, space, body, nodes, walls, dt, count, back):
    return 0.0


@advance_stabilised.register(Thermal)
def advance_stabilised_thermal(thermal, space, body, nodes, walls, dt, count, back):
    return stabilised_by_law(thermal.alpha, thermal, space, body, nodes, walls, dt, count, back)


@role
def stabilised_by_law(alpha, thermal, space, body, nodes, walls, dt, count, back):
    """heat_chebyshev of a body with heat, by the law of its specific heat: enthalpy_steps.py where it follows temperature."""
    raise TypeError(f"{type(alpha).__name__} is no law of temperature")


@kernel
def recurrence(count):
    """Rows (mu, nu, step, lag) of the stages: y_k = mu y_k-1 + nu y_k-2 + (1 - mu - nu) y_0 + step dt f(y_k-1) - lag dt f(y_0), the first mu dt f(y_0)."""
    terms = np.zeros((count, 4))
    w0 = 1.0 + DAMPING / count**2
    t1 = w0 * w0 - 1.0
    arg = count * np.log(w0 + np.sqrt(t1))
    w1 = np.sinh(arg) * t1 / (np.cosh(arg) * count * np.sqrt(t1) - w0 * np.sinh(arg))
    b1 = 1.0 / (2.0 * w0) ** 2
    b2 = b1
    terms[0, 0] = w1 * b1
    z1, z2, dz1, dz2, d2z1, d2z2 = w0, 1.0, 1.0, 0.0, 0.0, 0.0
    for k in range(1, count):
        z = 2.0 * w0 * z1 - z2
        dz = 2.0 * w0 * dz1 - dz2 + 2.0 * z1
        d2z = 2.0 * w0 * d2z1 - d2z2 + 4.0 * dz1
        b = d2z / dz**2
        mu, nu = 2.0 * w0 * b / b1, -b / b2
        step = mu * w1 / w0
        terms[k, 0], terms[k, 1], terms[k, 2], terms[k, 3] = mu, nu, step, (1.0 - z1 * b1) * step
        b2, b1 = b1, b
        z2, z1, dz2, dz1, d2z2, d2z1 = z1, z, dz1, dz, d2z1, d2z
    return terms


@kernel
def stage_weights(terms):
    """Weights (count,) of dt f(y_0), dt f(y_1), ... in what a step of `terms` ends with; they sum to 1."""
    count = terms.shape[0]
    weights, slope = np.zeros(count), np.zeros(count)  # slope: of the end, by the sum that stage k has reached
    slope[count - 1] = 1.0
    for k in range(count - 1, 0, -1):
        weights[k] = terms[k, 2] * slope[k]
        weights[0] -= terms[k, 3] * slope[k]
        slope[k - 1] += terms[k, 0] * slope[k]
        if k > 1:
            slope[k - 2] += terms[k, 1] * slope[k]
    weights[0] += terms[0, 0] * slope[0]
    return weights


@stabilised_by_law.register(Constant)
def stabilised_by_law_constant(alpha, thermal, space, body, nodes, walls, dt, count, back):
    shape, x = extents(space), body.particles.x
    box = reach(space, x)
    capacity, start, rate, first, before, last, theta = nodes[0], nodes[1], nodes[2], nodes[3], nodes[4], nodes[5], nodes[6]
    work = np.zeros((2 + 3 * directions(space), CHUNK))
    scatter_heat(space, x, body.particles.m, thermal, capacity, theta, work)
    fold(capacity.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(theta.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(theta, capacity, start, shape, box, True)
    unfold(start.reshape(-1, 1), 0, shape, box, walls)
    pieces = place(body.surface, space, body)
    terms = recurrence(count)
    weights = stage_weights(terms)
    conduct(space, body, thermal, start, rate, dt, work)
    gained = weights[0] * exchange(body, space, pieces, thermal, start, rate, dt, 0.0, work)
    expose(body.surface, space, x, pieces, start, weights[0] * dt, 0.0, work)
    fold(rate.reshape(-1, 1), 0, shape, box, walls)
    mu = terms[0, 0]
    combine(shape, box, capacity, rate, first, (start, start, start), (0.0, 0.0, 1.0, 0.0, mu), last, True)
    t_before, t_last = 0.0, mu
    for k in range(1, count):
        mu, nu, step, lag = terms[k, 0], terms[k, 1], terms[k, 2], terms[k, 3]
        unfold(last.reshape(-1, 1), 0, shape, box, walls)
        conduct(space, body, thermal, last, rate, dt, work)
        gained += weights[k] * exchange(body, space, pieces, thermal, last, rate, dt, t_last, work)
        expose(body.surface, space, x, pieces, last, weights[k] * dt, t_last, work)
        fold(rate.reshape(-1, 1), 0, shape, box, walls)
        older = start if k == 1 else before
        combine(shape, box, capacity, rate, first, (last, older, start), (mu, nu, 1.0 - mu - nu, step, -lag), theta, False)
        before, last, theta = last, theta, before
        t_before, t_last = t_last, mu * t_last + nu * t_before + step - lag
    unfold(last.reshape(-1, 1), 0, shape, box, walls)
    gather_heat(space, x, thermal, start, last, back, work)
    for field in range(ROWS):
        used = box.copy()
        clear(nodes[field].reshape(-1, 1), shape, used)
    return gained


@kernel
def combine(shape, box, capacity, rate, first, fields, shares, out, opening):
    """out = the sum of `shares` of the three `fields`, of rate/C and of `first`, and rate is cleared; opening: first = rate/C before."""
    a, b, c = fields
    of_a, of_b, of_c, of_rate, of_first = shares
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for n in range(row + box[2, 0], row + box[2, 1]):
                change = rate[n] / capacity[n] if capacity[n] > 0.0 else 0.0
                rate[n] = 0.0
                if opening:
                    first[n] = change
                out[n] = of_a * a[n] + of_b * b[n] + of_c * c[n] + of_rate * change + of_first * first[n]
