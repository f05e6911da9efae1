"""One step of a material point: the order of docs/physics.md 4, steps 3 to 8, without a grid.

exchange or prescribed temperature -> strain -> return map -> local heating along the adiabat and of dissipation -> stress at the new temperature.
Where a direction has its stress prescribed, the strain that gives it is found by Newton's method on this whole step: the end of the step has the
stress to round-off. Slopes by differences, so that every law and coupling is served; a step that does not bring the residual down is halved.
"""

import math

from mpm.heat.local import heat_locally, latch, thermal_stress
from mpm.heat.setting import condition, set_one
from mpm.jit import kernel, role
from mpm.materials import EllipseClipped, EllipseRadial, NoFlow, energy, flow, moduli, settled, stress, value, warmed
from mpm.point.heat import put, time_constant
from mpm.point.state import STRESS, Rigid

EPS = 2.3e-16
RELAXATION, YIELD, CONSTANT, RAMP = 100.0, 20.0, 100.0, 1.0  # steps a relaxation time, a yield strain, a time constant; kelvin a step


@stress.register(Rigid)
def stress_rigid(law, e1, e2, e3, thermal):
    return 0.0, 0.0, 0.0


@energy.register(Rigid)
def energy_rigid(law, e1, e2, e3):
    return 0.0


@moduli.register(Rigid)
def moduli_rigid(law):
    return math.inf, math.inf


@warmed.register(Rigid)
def warmed_rigid(law, theta):
    return law


@role
def relaxation(law, elastic, theta):
    """Shortest relaxation time at held strain [s] and smallest yield strain [-] of a flow law."""
    raise TypeError(f"no flow {type(law).__name__}")


@relaxation.register(NoFlow)
def relaxation_no_flow(law, elastic, theta):
    return math.inf, math.inf


def relaxation_ellipse(law, elastic, theta):
    lam, mu = moduli(warmed(elastic, theta))
    K, M, p0, eta = lam + 2.0 * mu / 3.0, value(law.M, theta), value(law.p0, theta), value(law.eta, theta)
    return min(eta / (3.0 * mu), eta * p0 * p0 / K), M * min(1.0 / (3.0 * mu), p0 / K)


relaxation.register(EllipseRadial, relaxation_ellipse)
relaxation.register(EllipseClipped, relaxation_ellipse)


@kernel
def shares(matter, speed, ramp):
    """Automatic limits of the step [s]: fractions of the relaxation time, of the time to strain by the yield strain at the rate `speed` [1/s], of a kelvin at
    the rate `ramp` [K/s] of a prescribed temperature (laws of temperature follow it), and of the time constant of exchange. Without viscosity: no relaxation.
    """
    total = matter.strain
    law = settled(matter.flow, math.exp(total[0] + total[1] + total[2]))
    time, strain = relaxation(law, matter.elastic, condition(matter.setting, matter.thermal, 0))
    relax = time / RELAXATION if time > 0.0 else math.inf
    bend = strain / (YIELD * speed) if speed > 0.0 else math.inf
    warm = RAMP / ramp if ramp > 0.0 and strain < math.inf else math.inf
    return relax, bend, warm, time_constant(matter.exchange, matter.thermal, matter.density) / CONSTANT


@kernel
def answer(matter, e, d, base, held, dt):
    """Elastic strains and Kirchhoff stresses at the end of a step: (e1, e2, e3, t1, t2, t3, dissipated, heated, ok) [-, Pa, J/m3].

    e: elastic strains before, d: increments of total strain, base: temperature less its zero before local heating [K]; `held` keeps it there.
    Depends on nothing else; leaves the temperature of the end of the step in `matter.thermal`.
    """
    put(matter.thermal, base)
    theta, total = condition(matter.setting, matter.thermal, 0), matter.strain
    thermal = thermal_stress(matter.expansion, matter.thermal, 0, theta)
    law = settled(matter.flow, math.exp((total[0] + d[0]) + (total[1] + d[1]) + (total[2] + d[2])))
    e1, e2, e3, lost, ok = flow(law, warmed(matter.elastic, theta), e[0] + d[0], e[1] + d[1], e[2] + d[2], thermal, theta, dt)
    gained = heat_locally(matter.heating, matter.thermal, 0, matter.density, (e1 - e[0]) + (e2 - e[1]) + (e3 - e[2]), lost)
    if held:
        put(matter.thermal, base)
    theta = condition(matter.setting, matter.thermal, 0)
    t1, t2, t3 = stress(warmed(matter.elastic, theta), e1, e2, e3, thermal_stress(matter.expansion, matter.thermal, 0, theta))
    return e1, e2, e3, t1, t2, t3, lost, gained, ok


@kernel(inline=True)
def residual(matter, e, d, total, kind, target, base, held, dt, r):
    """r_k = tau_k - J sigma_k where the stress is prescribed, 0 elsewhere; returns (largest |r|, ok)."""
    _, _, _, t1, t2, t3, _, _, ok = answer(matter, e, d, base, held, dt)
    J = math.exp((total[0] + d[0]) + (total[1] + d[1]) + (total[2] + d[2]))
    r[0] = t1 - J * target[0] if kind[0] == STRESS else 0.0
    r[1] = t2 - J * target[1] if kind[1] == STRESS else 0.0
    r[2] = t3 - J * target[2] if kind[2] == STRESS else 0.0
    return max(abs(r[0]), abs(r[1]), abs(r[2])), ok and math.isfinite(r[0] + r[1] + r[2])


@kernel
def solve3(A, r, x):
    """x = A^-1 r by elimination with row pivots; A and r are used up. False where A is singular."""
    for k in range(3):
        best = k
        for i in range(k + 1, 3):
            if abs(A[i, k]) > abs(A[best, k]):
                best = i
        if not abs(A[best, k]) > 0.0:
            return False
        for j in range(3):
            A[k, j], A[best, j] = A[best, j], A[k, j]
        r[k], r[best] = r[best], r[k]
        for i in range(k + 1, 3):
            share = A[i, k] / A[k, k]
            for j in range(k, 3):
                A[i, j] -= share * A[k, j]
            r[i] -= share * r[k]
    for i in range(2, -1, -1):
        s = r[i]
        for j in range(i + 1, 3):
            s -= A[i, j] * x[j]
        x[i] = s / A[i, i]
    return True


@kernel
def equilibrate(matter, e, d, total, kind, target, base, held, dt, work):
    """Find the increments d[k] of the directions whose stress is prescribed, from a first guess in d. work (8, 3). False: no equilibrium was found."""
    A, r, x, near, trial = work[0:3], work[3], work[4], work[5], work[6]
    lam, mu = moduli(warmed(matter.elastic, condition(matter.setting, matter.thermal, 0)))
    stiff = lam + 2.0 * mu
    worst, ok = residual(matter, e, d, total, kind, target, base, held, dt, r)
    if not ok:
        for k in range(3):
            d[k] = 0.0 if kind[k] == STRESS else d[k]
        worst, ok = residual(matter, e, d, total, kind, target, base, held, dt, r)
    for _ in range(60):
        size = max(abs(e[0]) + abs(d[0]), abs(e[1]) + abs(d[1]), abs(e[2]) + abs(d[2]))
        put(matter.thermal, base)
        thermal = thermal_stress(matter.expansion, matter.thermal, 0, condition(matter.setting, matter.thermal, 0))
        scale = stiff * size + abs(thermal) + max(abs(target[0]), abs(target[1]), abs(target[2]))
        if not ok:
            return False
        if worst <= 4.0 * EPS * scale:
            return True
        h = 1e-7 * scale / stiff
        for k in range(3):
            for i in range(3):
                A[i, k] = 1.0 if i == k else 0.0
            if kind[k] == STRESS:
                kept = d[k]
                d[k] = kept + h
                actual = d[k] - kept
                residual(matter, e, d, total, kind, target, base, held, dt, near)
                d[k] = kept
                for i in range(3):
                    if kind[i] == STRESS:
                        A[i, k] = (near[i] - r[i]) / actual
        for k in range(3):
            near[k] = r[k]
        if not solve3(A, r, x) or not x[0] * near[0] + x[1] * near[1] + x[2] * near[2] > 0.0:
            return False  # more load would strain it backwards: past a limit load there are roots that no loading reaches
        share, better = 1.0, False
        for _ in range(40):
            for k in range(3):
                trial[k] = d[k] - share * x[k] if kind[k] == STRESS else d[k]
            now, ok = residual(matter, e, trial, total, kind, target, base, held, dt, near)
            if ok and now < worst:
                better = True
                break
            share *= 0.5
        if not better:  # round-off, or no way down
            return worst <= 1e-12 * scale
        for k in range(3):
            d[k] = trial[k]
            r[k] = near[k]
        if now <= 1e-13 * scale and now > 0.25 * worst:
            return True  # as far down as round-off lets it
        worst = now
    return False


@kernel
def step(matter, e, total, d, kind, target, base, held, dt, work):
    """Carry the point through one step from temperature `base`: fills d where the stress is prescribed, updates e and total.

    Returns (dissipated, heated, ok) [J/m3].
    """
    put(matter.thermal, base)
    set_one(matter.setting, matter.thermal, 0, dt)
    if kind[0] == STRESS or kind[1] == STRESS or kind[2] == STRESS:
        if not equilibrate(matter, e, d, total, kind, target, base, held, dt, work):
            return 0.0, 0.0, False
    e1, e2, e3, _, _, _, lost, gained, ok = answer(matter, e, d, base, held, dt)
    latch(matter.expansion, matter.thermal, 0)
    e[0], e[1], e[2] = e1, e2, e3
    for k in range(3):
        total[k] += d[k]
    return lost, gained, ok
