"""Viscoplastic flow on the ellipse as the source document has it, corrected: overstress in pressure only, q <= M at any rate (docs/physics.md 5.1).

Minimises (p - p_tr)^2/(2 K) + (q - q_tr)^2/(6 mu) + dt M^2/(2 eta) <|p|/(p0 sqrt(M^2 - q^2)) - 1>^2. With p = M p0 y cos(phi), q = M sin(phi)
and T = tan(phi) one equation in T is left; c, s = cos(phi), sin(phi).
"""

import math
from typing import Any, NamedTuple

from mpm.jit import kernel
from mpm.lanes import absolute, below, choose, exponential, like, logarithm, maximum, minimum, most, precision, sqrt
from mpm.materials.ellipse import admissible, excess, excess_lanes, invariants, pressures, slowness, strains
from mpm.materials.roles import aspects, flow, flow_lanes, moduli, value, values

MOST_STEPS = 200  # steps; 72 is the most seen
FAR, FARTHEST = 1e150, 1e30  # stand for T = inf, and their inverses for T = 0, where a bracket is halved


class EllipseClipped(NamedTuple):
    """Ellipse p^2/p0^2 + q^2 = M^2; M, p0 and eta are laws of temperature. Shear is clipped to M whatever eta is.

    Good values  p0 within 1e-3..1e3, K dt/eta within 1e-12..1e12; eta = 0 is rate independent and equals `radial`.
    Fails when   a law leaves M > 0, p0 > 0, eta >= 0: the map then reports ok = False. A sweep of eta moves compaction, not shear: see `radial`.
    """

    M: Any  # von Mises stress at p = 0 [Pa]
    p0: Any  # hydrostatic yield pressure over M [-]
    eta: Any  # [Pa s]


@kernel(inline=True)
def angle(T):
    """cos and sin of atan T, each to round-off of its own."""
    one = like(T, 1.0)
    flat = below(T, one)
    t = choose(flat, T, one / maximum(one, T))  # no division by 0 in plain Python; in this order a NaN stays
    near = one / sqrt(one + t * t)
    return choose(flat, near, t * near), choose(flat, t * near, near)


@kernel(inline=True)
def balance(T, P, Q, p0, omega, w1, w2):
    """The two sides a, b of the equation in T, their slopes in ln T, and c, s, y, z = P - p/M. No difference of nearly equal numbers.

    Of numbers or of lanes.
    """
    c, s = angle(T)
    steep = like(T, 0.7)
    shear = choose(below(steep, s), (Q - 1.0) + c * c / (1.0 + s), Q - s)
    press = choose(below(steep, c), p0 * ((P / p0 - 1.0) + s * s / (1.0 + c)), P - p0 * c)
    N = w1 * p0 * p0 * c * c + w2
    dN = -2.0 * w1 * p0 * p0 * c * c * s * s
    y, z = (w1 * p0 * P * c + w2) / N, w2 * press / N
    dy, dz = (-w1 * p0 * P * s * s * c - y * dN) / N, (w2 * p0 * s * s * c - z * dN) / N
    b = T * p0 * y * z
    return omega * shear, b, -omega * s * c * c, b + T * p0 * (dy * z + y * dz), c, s, y, z, shear


@kernel
def tangent(P, Q, p0, omega, w1, w2):
    """The T of a trial state outside the ellipse, 0 < P, 0 < Q, and the number of steps (MOST_STEPS: failed): Newton that a bracket keeps."""
    r = P / p0
    low = math.sqrt((1.0 - r) * (1.0 + r)) / r if r < 1.0 else 0.0
    high = Q / math.sqrt((1.0 - Q) * (1.0 + Q)) if Q < 1.0 else math.inf
    T = Q / r
    for n in range(1, MOST_STEPS):
        if not low < T < high:
            T = math.sqrt(max(low, 1.0 / FAR)) * math.sqrt(min(high, FAR))
        a, b, da, db, _, _, _, _, _ = balance(T, P, Q, p0, omega, w1, w2)
        g = a - b
        if abs(g) <= 2e-16 * (abs(a) + abs(b)):
            return T, n
        if g > 0.0:
            low = T
        else:
            high = T
        new = -1.0  # outside every bracket: halve it
        if n % 12 != 0:
            if a > 0.0 and b > 0.0 and da / a < db / b:  # Newton on ln(a/b) in ln T
                new = T * math.exp(min(max(math.log(a / b) / (db / b - da / a), -300.0), 300.0))
            if not low < new < high and da < db:
                new = T + T * (g / (db - da))
        if not low < new < high:
            new = math.sqrt(max(low, 1.0 / FAR)) * math.sqrt(min(high, FAR))
        if abs(new - T) <= 1e-14 * T:
            return new, n
        T = new
    return T, MOST_STEPS


@kernel
def map_clipped(p_trial, q_trial, K, mu, M, p0, eta, dt):
    """Mapped invariants (p, q, p_trial - p, q_trial - q, steps); the differences are exact to round-off of their own. steps = MOST_STEPS: failed."""
    P, Q, p0 = float(abs(p_trial) / M), float(q_trial / M), float(p0)
    if excess(P / p0, Q) <= 0.0:
        return p_trial, q_trial, 0.0 * p_trial, 0.0 * q_trial, 0
    x = slowness(K, eta, dt)
    if P == 0.0 or x == math.inf:
        q = min(q_trial, M)
        return p_trial, q, 0.0 * p_trial, q_trial - q, 1
    sign = 1.0 if p_trial >= 0.0 else -1.0
    w1, w2 = x / (1.0 + x), 1.0 / (1.0 + x)
    omega = float(K / (3.0 * mu))
    T, steps = tangent(P, Q, p0, omega, w1, w2) if Q > 0.0 else (0.0, 1)
    _, _, _, _, c, s, y, z, shear = balance(T, P, Q, p0, omega, w1, w2)
    return sign * M * p0 * y * c, M * s, sign * M * max(z, 0.0), M * max(shear, 0.0), steps  # below zero by round-off on the ellipse itself


@kernel
def strain_clipped(e1, e2, e3, lam, mu, M, p0, eta, dt, thermal):
    """Mapped strains: (e1, e2, e3, dissipated, ok), the trial ones where nothing flows and where the map fails."""
    K = lam + 2.0 * mu / 3.0
    if not (M > 0.0 and p0 > 0.0 and eta >= 0.0):
        return e1, e2, e3, 0.0, False
    p_trial, q_trial, d1, d2, d3 = invariants(e1, e2, e3, K, mu, thermal)
    p, q, dp, dq, steps = map_clipped(p_trial, q_trial, K, mu, M, p0, eta, dt)
    if steps == 0:
        return e1, e2, e3, 0.0, True
    n1, n2, n3, work = strains(p, q, dp, dq, q_trial, (d1, d2, d3), K, mu, thermal)
    if steps == MOST_STEPS or not math.isfinite(float(work / M)):
        return e1, e2, e3, 0.0, False
    return n1, n2, n3, work, True


@flow.register(EllipseClipped)
def flow_clipped(law, elastic, e1, e2, e3, thermal, theta, dt):
    lam, mu = moduli(elastic)
    return strain_clipped(e1, e2, e3, lam, mu, value(law.M, theta), value(law.p0, theta), value(law.eta, theta), dt, thermal)


@kernel(inline=True)
def between(low, high):
    """The middle of a bracket, by ratio, over lanes; FAR is beyond float32, FARTHEST within."""
    return sqrt(maximum(low, like(low, 1.0 / FARTHEST))) * sqrt(minimum(high, like(low, FARTHEST)))


@kernel(inline=True)
def tangent_lanes(P, Q, p0, omega, w1, w2, active):
    """`tangent` over the lanes where `active` is 1, and 1 where it converged: (T, converged)."""
    one, nought = like(P, 1.0), like(P, 0.0)
    r = P / p0
    low = choose(below(r, one), sqrt(absolute((1.0 - r) * (1.0 + r))) / r, nought)
    high = choose(below(Q, one), Q / sqrt(absolute((1.0 - Q) * (1.0 + Q))), like(P, FARTHEST))
    T = Q / r
    for n in range(1, MOST_STEPS):
        T = choose(below(low, T) * below(T, high), T, between(low, high))
        a, b, da, db, _, _, _, _, _ = balance(T, P, Q, p0, omega, w1, w2)
        g = a - b
        active = active * below(precision(T) * (absolute(a) + absolute(b)), absolute(g))
        low, high = choose(active * below(nought, g), T, low), choose(active * below(g, nought), T, high)
        new = -one  # outside every bracket: halve it
        if n % 12 != 0:
            ratio, slope = a / b, db / b - da / a
            log = logarithm(choose(below(nought, ratio), ratio, one)) / slope
            new = choose(below(nought, a) * below(nought, b) * below(nought, slope), T * exponential(log), new)  # Newton on ln(a/b) in ln T
            inside = below(low, new) * below(new, high)
            new = choose((one - inside) * below(da, db), T + T * (g / (db - da)), new)
        new = choose(below(low, new) * below(new, high), new, between(low, high))
        step = absolute(new - T)
        T = choose(active, new, T)
        active = active * below(50.0 * precision(T) * T, step)
        if most(active) < 0.5:
            break
    return T, one - active


@kernel(inline=True)
def clipped_lanes(trace, deviator, lam, mu, M, p0, eta, dt, thermal):
    """`strain_clipped` over lanes: see flow_lanes (mpm.materials.roles)."""
    good, K = admissible(M, p0, eta), lam + 2.0 / 3.0 * mu
    one, nought = like(trace, 1.0), like(trace, 0.0)
    p, q = pressures(trace, deviator, K, mu, thermal)
    P, Q, x = absolute(p) / M, q / M, eta / (K * dt)
    flowed = good * below(nought, excess_lanes(P / p0, Q))
    share, lost = one, nought
    if most(flowed) > 0.5:
        moves = flowed * below(nought, P) * below(x, like(x, FARTHEST))  # else only shear is clipped
        turns = moves * below(nought, Q)
        two = one + one
        P, Q, p0 = choose(flowed, P, two), choose(flowed, Q, two), choose(flowed, p0, one)
        x, omega = choose(moves, x, one), choose(flowed, K / (3.0 * mu), one)
        w1, w2 = x / (1.0 + x), one / (1.0 + x)
        T, converged = tangent_lanes(choose(turns, P, two), choose(turns, Q, two), p0, omega, w1, w2, turns)
        _, _, _, _, c, s, y, z, shear = balance(choose(turns, T, nought), P, Q, p0, omega, w1, w2)
        sign = choose(below(p, nought), -M, M)
        mapped = choose(moves, sign * p0 * y * c, p)
        fallen = choose(moves, sign * maximum(z, nought), nought)
        left = choose(moves, M * s, minimum(q, M))
        lost = choose(flowed, mapped * fallen / K + left * choose(moves, M * maximum(shear, nought), q - left) / (3.0 * mu), nought)
        good = good * converged * below(lost / M, like(lost, 1e37))
        trace = choose(flowed, (thermal - mapped) / K, trace)
        share = choose(flowed, choose(below(nought, q), left / q, nought), one)
    return trace, share, lost, flowed, good


@flow_lanes.register(EllipseClipped)
def flow_lanes_ellipse_clipped(law, trace, deviator, lam, mu, thermal, theta, J, dt):
    return clipped_lanes(trace, deviator, lam, mu, values(law.M, theta), aspects(law.p0, theta, J), values(law.eta, theta), dt, thermal)
