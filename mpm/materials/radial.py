"""Viscoplastic flow on the ellipse, radial overstress: Perzyna viscosity on pressure and shear alike (docs/physics.md 5.2).

Minimises (p - p_tr)^2/(2 K) + (q - q_tr)^2/(6 mu) + dt M^2/(2 eta) <s - 1>^2,  s = sqrt(p^2/p0^2 + q^2)/M: one implicit Euler step of
dp/dt = -K M^2/eta <s - 1> ds/dp, dq/dt = -3 mu M^2/eta <s - 1> ds/dq.
"""

import math
from typing import Any, NamedTuple

from mpm.jit import kernel
from mpm.lanes import absolute, below, choose, like, maximum, most, precision, sqrt
from mpm.materials.ellipse import SQRT6, admissible, excess, excess_lanes, invariants, pressures, slowness, strains
from mpm.materials.roles import aspects, flow, flow_lanes, moduli, tangent, value, values

MOST_STEPS = 60  # Newton steps; 13 is the most seen, in a million extreme states


class EllipseRadial(NamedTuple):
    """Ellipse p^2/p0^2 + q^2 = M^2; M, p0 and eta are laws of temperature.

    Relaxation times at held strain: eta p0^2/K in pressure, eta/(3 mu) in shear.
    Good values  p0 within 1e-3..1e3 (p0 -> inf: viscous von Mises), K dt/eta within 1e-12..1e12; eta = 0 is rate independent.
    Fails when   a law leaves M > 0, p0 > 0, eta >= 0: the map then reports ok = False.
    """

    M: Any  # von Mises stress at p = 0 [Pa]
    p0: Any  # hydrostatic yield pressure over M [-]
    eta: Any  # [Pa s]


@kernel
def overstress(a1, a2, k1, k2, x):
    """The root g >= 0 of 1/s - 1 + g x, s^2 = (a1/(1 + k1 g))^2 + (a2/(1 + k2 g))^2 > 1 at g = 0, and the number of steps (MOST_STEPS: failed).

    Increasing and concave in g, so that Newton from a lower bound climbs to the root without a safeguard. All arguments are numbers >= 0.
    """
    start = excess(a1, a2)
    s = math.sqrt(a1 * a1 + a2 * a2)
    g = max(0.0, (a1 - 1.0) / (k1 + a1 * x), (a2 - 1.0) / (k2 + a2 * x), start / (1.0 + s) / (max(k1, k2) + s * x))
    for n in range(1, MOST_STEPS):
        u1, u2 = 1.0 + k1 * g, 1.0 + k2 * g
        b1, b2 = a1 / u1, a2 / u2
        s = math.sqrt(b1 * b1 + b2 * b2)
        if start < 1.0:  # r = s^2 - 1 to round-off of its own: near the ellipse by what is taken off, which is a sum of positive terms
            r = start - (b1 * b1 * k1 * g * (2.0 + k1 * g) + b2 * b2 * k2 * g * (2.0 + k2 * g))
        elif b1 >= b2:
            r = b2 * b2 + (((a1 - 1.0) - k1 * g) / u1) * (b1 + 1.0)
        else:
            r = b1 * b1 + (((a2 - 1.0) - k2 * g) / u2) * (b2 + 1.0)
        slope = (k1 * b1 * b1 / u1 + k2 * b2 * b2 / u2) / (s * s * s) + x
        step = (r / (s * (1.0 + s)) - g * x) / slope
        g += step
        if step <= 1e-9 * g:  # quadratic: the next step would be below 1e-17
            return g, n
    return g, MOST_STEPS


@kernel
def map_radial(p_trial, q_trial, K, mu, M, p0, eta, dt):
    """Mapped invariants (p, q, p_trial - p, q_trial - q, steps); the differences are exact to round-off of their own. steps = MOST_STEPS: failed."""
    a1, a2 = float(abs(p_trial) / (p0 * M)), float(q_trial / M)
    x = slowness(K, eta, dt)
    if excess(a1, a2) <= 0.0 or x == math.inf:
        return p_trial, q_trial, 0.0 * p_trial, 0.0 * q_trial, 0
    k1, k2 = float(1.0 / (p0 * p0)), float(3.0 * mu / K)
    g, steps = overstress(a1, a2, k1, k2, x)
    p, q = p_trial / (1.0 + k1 * g), q_trial / (1.0 + k2 * g)
    return p, q, k1 * g * p, k2 * g * q, steps


@kernel
def strain_radial(e1, e2, e3, lam, mu, M, p0, eta, dt, thermal):
    """Mapped strains: (e1, e2, e3, dissipated, ok), the trial ones where nothing flows and where the map fails."""
    K = lam + 2.0 * mu / 3.0
    if not (M > 0.0 and p0 > 0.0 and eta >= 0.0):
        return e1, e2, e3, 0.0, False
    p_trial, q_trial, d1, d2, d3 = invariants(e1, e2, e3, K, mu, thermal)
    p, q, dp, dq, steps = map_radial(p_trial, q_trial, K, mu, M, p0, eta, dt)
    if steps == 0:
        return e1, e2, e3, 0.0, True
    n1, n2, n3, work = strains(p, q, dp, dq, q_trial, (d1, d2, d3), K, mu, thermal)
    if steps == MOST_STEPS or not math.isfinite(float(work / M)):
        return e1, e2, e3, 0.0, False
    return n1, n2, n3, work, True


@flow.register(EllipseRadial)
def flow_radial(law, elastic, e1, e2, e3, thermal, theta, dt):
    lam, mu = moduli(elastic)
    return strain_radial(e1, e2, e3, lam, mu, value(law.M, theta), value(law.p0, theta), value(law.eta, theta), dt, thermal)


@kernel(inline=True)
def overstress_lanes(a1, a2, k1, k2, x, start, active):
    """`overstress` over the lanes where `active` is 1, and 1 where it converged: (g, converged). start = excess of (a1, a2)."""
    one, nought = like(x, 1.0), like(x, 0.0)
    enough = 0.1 * sqrt(precision(x))  # quadratic: the next step would be below round-off
    s = sqrt(a1 * a1 + a2 * a2)
    g = maximum(maximum((a1 - 1.0) / (k1 + a1 * x), (a2 - 1.0) / (k2 + a2 * x)), start / (1.0 + s) / (maximum(k1, k2) + s * x))
    g = maximum(g, nought)
    for _ in range(1, MOST_STEPS):
        u1, u2 = 1.0 + k1 * g, 1.0 + k2 * g
        both = 1.0 / (u1 * u2)  # divisions are what this takes: one for two
        v1, v2 = u2 * both, u1 * both
        b1, b2 = a1 * v1, a2 * v2
        s = sqrt(b1 * b1 + b2 * b2)
        near = start - (b1 * b1 * k1 * g * (2.0 + k1 * g) + b2 * b2 * k2 * g * (2.0 + k2 * g))
        first = b2 * b2 + (((a1 - 1.0) - k1 * g) * v1) * (b1 + 1.0)
        second = b1 * b1 + (((a2 - 1.0) - k2 * g) * v2) * (b2 + 1.0)
        r = choose(below(start, one), near, choose(below(b1, b2), second, first))
        down = 1.0 / (s * (1.0 + s))
        less = down * (1.0 + s)  # 1/s
        slope = (k1 * b1 * b1 * v1 + k2 * b2 * b2 * v2) * (less * less * less) + x
        step = (r * down - g * x) / slope
        g = choose(active, g + step, g)
        active = active * below(enough * g, step)
        if most(active) < 0.5:
            break
    return g, one - active


@kernel(inline=True)
def radial_lanes(trace, deviator, lam, mu, M, p0, eta, dt, thermal):
    """`strain_radial` over lanes: see flow_lanes (mpm.materials.roles)."""
    good, K = admissible(M, p0, eta), lam + 2.0 / 3.0 * mu
    one, nought = like(trace, 1.0), like(trace, 0.0)
    p, q = pressures(trace, deviator, K, mu, thermal)
    a1, a2, x = absolute(p) / (p0 * M), q / M, eta / (K * dt)
    start = excess_lanes(a1, a2)
    flowed = good * below(nought, start) * below(x, like(x, 1e30))
    share, lost = one, nought
    if most(flowed) > 0.5:
        k1, k2 = choose(flowed, 1.0 / (p0 * p0), one), choose(flowed, 3.0 * mu / K, one)
        two = one + one
        g, converged = overstress_lanes(
            choose(flowed, a1, two), choose(flowed, a2, nought), k1, k2, choose(flowed, x, one), choose(flowed, start, two + one), flowed
        )
        c1, c2 = k1 * g, k2 * g
        p, share = p / (1.0 + c1), choose(flowed, 1.0 / (1.0 + c2), one)
        q = q * share
        lost = choose(flowed, p * (c1 * p) / K + q * (c2 * q) / (3.0 * mu), nought)
        good = good * converged * below(lost / M, like(lost, 1e37))
        trace = choose(flowed, (thermal - p) / K, trace)
    return trace, share, lost, flowed, good


@flow_lanes.register(EllipseRadial)
def flow_lanes_ellipse_radial(law, trace, deviator, lam, mu, thermal, theta, J, dt):
    return radial_lanes(trace, deviator, lam, mu, values(law.M, theta), aspects(law.p0, theta, J), values(law.eta, theta), dt, thermal)


@tangent.register(EllipseRadial)
def tangent_ellipse_radial(law, elastic, trace, size, thermal, theta, dt):
    """W = p p_tr/K + q q_tr/(3 mu) - p^2/(2 K) - q^2/(6 mu) - dt M^2/(2 eta) <s - 1>^2; the map is a proximal one, so W is convex."""
    lam, mu = moduli(elastic)
    K, M, p0, eta = lam + 2.0 * mu / 3.0, value(law.M, theta), value(law.p0, theta), value(law.eta, theta)
    p_trial, q_trial = thermal - K * trace, SQRT6 * mu * size
    whole = 0.5 * p_trial * p_trial / K + 0.5 * q_trial * q_trial / (3.0 * mu)
    if not (M > 0.0 and p0 > 0.0 and eta >= 0.0):
        return whole, p_trial, 1.0, 1.0, 0.0, 1.0, 0.0, False
    a1, a2, x = abs(p_trial) / (p0 * M), q_trial / M, slowness(K, eta, dt)
    if excess(a1, a2) <= 0.0 or x == math.inf:
        return whole, p_trial, 1.0, 1.0, 0.0, 1.0, 0.0, True
    k1, k2 = 1.0 / (p0 * p0), 3.0 * mu / K
    g, steps = overstress(a1, a2, k1, k2, x)
    u1, u2 = 1.0 + k1 * g, 1.0 + k2 * g
    b1, b2 = a1 / u1, a2 / u2
    s = math.sqrt(b1 * b1 + b2 * b2)
    N = k1 * b1 * b1 / u1 + k2 * b2 * b2 / u2 + s * s * s * x
    p, q = p_trial / u1, q_trial / u2
    lost = p * (k1 * g * p) / K + q * (k2 * g * q) / (3.0 * mu)
    over = M * s * g  # dt M^2/(2 eta) <s - 1>^2 = x (M s g)^2/(2 K), as s - 1 = s g x
    W = 0.5 * p * (p_trial + (p_trial - p)) / K + 0.5 * q * (q_trial + (q_trial - q)) / (3.0 * mu) - 0.5 * x * over * over / K
    c11, c22 = (1.0 - k1 * b1 * b1 / (u1 * N)) / u1, (1.0 - k2 * b2 * b2 / (u2 * N)) / u2
    c12 = -math.copysign(p0 * k1 * b1 * b2 / (u1 * u2 * N), p)
    return W, p, 1.0 / u2, c11, c12, c22, lost, steps < MOST_STEPS and math.isfinite(lost / M)
