"""Body force and heat source of a manufactured thermoelastic motion: formulae and names as in mpm.verification.manufactured (docs/physics.md 7, problem 9)."""

import math
from typing import NamedTuple

from mpm.jit import kernel
from mpm.sources.roles import heat, push


class Made(NamedTuple):
    """Material and motion."""

    mu: float
    lam: float
    gamma: float
    density: float
    alpha: float
    kappa: float
    zero: float  # Theta_0 [K]
    A: float
    B: float
    omega: float
    nu: float
    k: float


@kernel(inline=True)
def grown(law, X, i, c, t):
    """(F_c, its slope along c, its rate)."""
    sign = 1.0 if c == 0 else -1.0
    kX, swing = law.k * X[i, c], sign * law.A * law.k
    now = swing * math.sin(law.omega * t)
    return 1.0 + now * math.cos(kX), -now * law.k * math.sin(kX), swing * law.omega * math.cos(law.omega * t) * math.cos(kX)


@kernel(inline=True)
def warmth(law, X, i, c, t):
    """(theta, its slope along c, its time rate)."""
    value, along = law.B, math.cos(law.k * X[i, c])
    for d in range(X.shape[1]):
        if d != c:
            value *= math.cos(law.k * X[i, d])
    at, turn = math.cos(law.nu * t), math.sin(law.nu * t)
    return value * along * at, -law.k * value * math.sin(law.k * X[i, c]) * at, -law.nu * value * along * turn


@kernel(inline=True)
def log_volume(law, X, i, t):
    """ln J and its rate."""
    value, rate = 0.0, 0.0
    for d in range(X.shape[1]):
        F, _, swell = grown(law, X, i, d, t)
        value += math.log(F)
        rate += swell / F
    return value, rate


@push.register(Made)
def push_made(law, X, i, c, t):
    F, slope, _ = grown(law, X, i, c, t)
    theta, steep, _ = warmth(law, X, i, c, t)
    volume, _ = log_volume(law, X, i, t)
    P = (2.0 * law.mu * math.log(F) + law.lam * volume - law.gamma * theta) / F
    rise = ((2.0 * law.mu + law.lam) * slope / F - law.gamma * steep) / F - P * slope / F
    sign = 1.0 if c == 0 else -1.0
    return -sign * law.A * law.omega**2 * math.sin(law.k * X[i, c]) * math.sin(law.omega * t) - rise / law.density


@heat.register(Made)
def heat_made(law, X, i, t):
    volume, swelling = log_volume(law, X, i, t)
    theta, _, rate = warmth(law, X, i, 0, t)
    flow = 0.0
    for c in range(X.shape[1]):
        F, slope, _ = grown(law, X, i, c, t)
        _, steep, _ = warmth(law, X, i, c, t)
        flow += law.kappa * math.exp(volume) / F**2 * (-slope / F * steep - law.k**2 * theta)
    return law.alpha * rate + (law.gamma * (law.zero + theta) * swelling - flow) / law.density
