"""What both return maps share: invariants of the trial strain, the ellipse, and the strains that belong to mapped invariants (docs/physics.md 5).

p = -tr tau/3 (compression positive), q = sqrt(3/2) |dev tau|, both of the total Kirchhoff stress, thermal part included.
Elastic where p^2/p0^2 + q^2 <= M^2. Differences of nearly equal numbers are written so that they lose nothing; the house's flags, which let LLVM
re-associate, leave that intact: tests/materials/test_extremes.py would show it (with `contract` alone the residuals and the times are the same).
"""

import math

from mpm.jit import kernel
from mpm.lanes import below, like, maximum, minimum

SQRT6 = math.sqrt(6.0)


@kernel(inline=True)
def excess(a, b):
    """a^2 + b^2 - 1 without cancellation at either axis."""
    high, low = max(a, b), min(a, b)
    return (high - 1.0) * (high + 1.0) + low * low


@kernel(inline=True)
def invariants(e1, e2, e3, K, mu, thermal):
    """p and q [Pa] of principal strains, and the deviator, exactly zero for equal strains."""
    d1, d2, d3 = ((e1 - e2) + (e1 - e3)) / 3.0, ((e2 - e1) + (e2 - e3)) / 3.0, ((e3 - e1) + (e3 - e2)) / 3.0
    return thermal - K * (e1 + e2 + e3), SQRT6 * mu * math.sqrt(d1 * d1 + d2 * d2 + d3 * d3), d1, d2, d3


@kernel(inline=True)
def slowness(K, eta, dt):
    """eta/(K dt), the inverse of chi: 0 without viscosity (even in no time), inf where no time passes."""
    if eta == 0.0:
        return 0.0
    return float(eta / (K * dt)) if dt > 0.0 else math.inf


@kernel(inline=True)
def strains(p, q, dp, dq, q_trial, deviator, K, mu, thermal):
    """Strains of mapped invariants, and the work p dp/K + q dq/(3 mu) that the map dissipates [J/m3]: exact, as dp and dq are."""
    share = q / q_trial if q_trial > 0.0 else 0.0
    mean = (thermal - p) / (3.0 * K)
    return mean + share * deviator[0], mean + share * deviator[1], mean + share * deviator[2], p * dp / K + q * dq / (3.0 * mu)


@kernel(inline=True)
def excess_lanes(a, b):
    """`excess` over lanes."""
    high, low = maximum(a, b), minimum(a, b)
    return (high - 1.0) * (high + 1.0) + low * low


@kernel(inline=True)
def pressures(trace, deviator, K, mu, thermal):
    """p and q [Pa] over lanes, of the trace of the strain and the norm of its deviator."""
    return thermal - K * trace, SQRT6 * mu * deviator


@kernel(inline=True)
def admissible(M, p0, eta):
    """1 where M > 0, p0 > 0 and eta >= 0, over lanes; 0 where one is NaN."""
    nought = like(M, 0.0)
    return below(nought, M) * below(nought, p0) * below(like(M, -1e-30), eta)
