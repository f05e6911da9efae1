"""What the particles of a chunk answer their trial strains: return map, heating, stress (physics.md 4, steps 6 to 8), in principal axes or without.

eps_i = 1/2 log1p(B_i);  return map;  heating;  tau from eps and the new temperature.   Neo-Hookean: tau from B and J, no axes.
"""

import math

from mpm.heat.local import heat_locally, latch, temperature, thermal_stress
from mpm.integrate.strain import CODE, DISSIPATED, GROW, HEATED, JACOBIAN, STRAIN, deliver_plane, deliver_volume, fail
from mpm.jit import kernel, role
from mpm.lanes import EIGHT, absolute, fma, load8, maximum, most, splat8, store
from mpm.materials import FLOW, Hencky, HenckyWarm, NeoHookean, NoFlow, flow, settled, stress, warmed
from mpm.outcome import INVERTED, RETURN_MAP
from mpm.state import NoExchange, Surface
from mpm.tensors import compose2, compose3, eigen2, eigen3

ACROSS = 4  # row of Chunk.e: stress out of plane


@role
def flows(law):
    """Whether the elastic strain must be written back: a constant at compile time."""
    raise TypeError(f"no flow law {type(law).__name__}")


@flows.register(NoFlow)
def _(law):
    return False


def flows_always(law):
    return True


for kind in FLOW:
    if kind is not NoFlow:
        flows.register(kind, flows_always)


@kernel(inline=True)
def answer(body, i, e1, e2, e3, grow, dt, report):
    """Return map, heating and principal Kirchhoff stresses of particle i: (e1, e2, e3, t1, t2, t3)."""
    trace_before = e1 + e2 + e3 - math.log1p(grow)
    thermal = thermal_stress(body.expansion, body.thermal, i)
    lost = 0.0
    if dt > 0.0:
        theta = temperature(body.thermal, i)
        e1, e2, e3, lost, ok = flow(settled(body.flow, body.particles.J[i]), warmed(body.elastic, theta), e1, e2, e3, thermal, theta, dt)
        if not ok:
            fail(report, RETURN_MAP, i)
        density = body.particles.m[i] / body.particles.V0[i]
        gained = heat_locally(body.heating, body.thermal, i, density, e1 + e2 + e3 - trace_before, lost)
        report[HEATED] += body.particles.V0[i] * gained
        report[DISSIPATED] += body.particles.V0[i] * lost
        latch(body.expansion, body.thermal, i)
        thermal = thermal_stress(body.expansion, body.thermal, i)
    report[STRAIN] = min(report[STRAIN], e1, e2, e3)
    t1, t2, t3 = stress(warmed(body.elastic, temperature(body.thermal, i)), e1, e2, e3, thermal)
    return e1, e2, e3, t1, t2, t3


@role
def carry_surface(surface, chunk, i, p, dt):
    """F <- (1 + dt L) F where a surface needs it."""
    raise TypeError(f"no surface {type(surface).__name__}")


@carry_surface.register(NoExchange)
def _(surface, chunk, i, p, dt):
    return None


@carry_surface.register(Surface)
def _(surface, chunk, i, p, dt):
    D = surface.F.shape[1]
    for d in range(D):
        f0, f1, f2 = surface.F[i, 0, d], surface.F[i, min(1, D - 1), d], surface.F[i, D - 1, d]
        for c in range(D):
            change = chunk.L[c, 0, p] * f0
            if D > 1:
                change += chunk.L[c, 1, p] * f1
            if D > 2:
                change += chunk.L[c, 2, p] * f2
            surface.F[i, c, d] += dt * change


@role(inline=True)
def react_plane(elastic, body, chunk, first, count, dt, report):
    """From trial strain to the particles' B and to tau in chunk.S, out of plane in chunk.e[ACROSS], of a plane or axisymmetric body."""
    raise TypeError(f"no response of {type(elastic).__name__}")


@role(inline=True)
def react_volume(elastic, body, chunk, first, count, dt, report):
    """The same in three directions."""
    raise TypeError(f"no response of {type(elastic).__name__}")


@react_plane.register(Hencky)
@react_plane.register(HenckyWarm)
def _(elastic, body, chunk, first, count, dt, report):
    e, S = chunk.e, chunk.S
    for p in range(count):
        i = first + p
        l1, l2, c, s = eigen2(e[0, p], e[1, p], e[3, p])
        if not min(l1, l2, e[2, p]) > -1.0:
            fail(report, INVERTED, i)
            return
        e1, e2, e3 = 0.5 * math.log1p(l1), 0.5 * math.log1p(l2), 0.5 * math.log1p(e[2, p])
        e1, e2, e3, t1, t2, t3 = answer(body, i, e1, e2, e3, e[GROW, p], dt, report)
        if report[CODE] != 0.0:
            return
        if flows(body.flow):
            e[0, p], e[1, p], e[3, p] = compose2(math.expm1(2.0 * e1), math.expm1(2.0 * e2), c, s)
            e[2, p] = math.expm1(2.0 * e3)
        carry_surface(body.surface, chunk, i, p, dt)
        xx, yy, xy = compose2(t1, t2, c, s)
        S[0, 0, p], S[0, 1, p], S[1, 0, p], S[1, 1, p], e[ACROSS, p] = xx, xy, xy, yy, t3
    deliver_plane(body.particles, chunk, first, count)


@react_volume.register(Hencky)
@react_volume.register(HenckyWarm)
def _(elastic, body, chunk, first, count, dt, report):
    e, S = chunk.e, chunk.S
    if not flows(body.flow):
        deliver_volume(body.particles, chunk, first, count)
    eigen_chunk(e, count)
    for p in range(count):
        i = first + p
        if not min(e[0, p], e[1, p], e[2, p]) > -1.0:
            fail(report, INVERTED, i)
            return
        ax, ay, az, bx, by, bz = e[3, p], e[4, p], e[5, p], e[6, p], e[7, p], e[8, p]
        e1, e2, e3 = 0.5 * math.log1p(e[0, p]), 0.5 * math.log1p(e[1, p]), 0.5 * math.log1p(e[2, p])
        e1, e2, e3, t1, t2, t3 = answer(body, i, e1, e2, e3, e[GROW, p], dt, report)
        if report[CODE] != 0.0:
            return
        carry_surface(body.surface, chunk, i, p, dt)
        xx, yy, zz, xy, yz, xz = compose3(t1, t2, t3, ax, ay, az, bx, by, bz)
        S[0, 0, p], S[0, 1, p], S[0, 2, p] = xx, xy, xz
        S[1, 0, p], S[1, 1, p], S[1, 2, p] = xy, yy, yz
        S[2, 0, p], S[2, 1, p], S[2, 2, p] = xz, yz, zz
        if flows(body.flow):
            B = compose3(math.expm1(2.0 * e1), math.expm1(2.0 * e2), math.expm1(2.0 * e3), ax, ay, az, bx, by, bz)
            e[0, p], e[1, p], e[2, p], e[3, p], e[4, p], e[5, p] = B
    if flows(body.flow):
        deliver_volume(body.particles, chunk, first, count)


@react_plane.register(NeoHookean)
def _(elastic, body, chunk, first, count, dt, report):
    deliver_plane(body.particles, chunk, first, count)
    e, S, n, real = chunk.e, chunk.S, chunk.e.shape[1], chunk.e.dtype.type
    mu, lam, one, stiff = splat8(real(elastic.mu)), splat8(real(elastic.lam)), splat8(real(1)), splat8(real(0))
    for p in range(0, count, EIGHT):
        J = load8(e, JACOBIAN * n + p)
        # Gershgorin: no principal b - 1 is above the largest sum of a row of |B|.
        shear = absolute(load8(e, 3 * n + p))
        rows = maximum(maximum(load8(e, p), load8(e, n + p)) + shear, load8(e, 2 * n + p))
        stiff = maximum(lam * J * (J + J - one) + (mu + mu) * (one + rows), stiff)
        pressure = lam * J * (J - one)
        store(S, p, fma(mu, load8(e, p), pressure))
        store(S, 3 * n + p, fma(mu, load8(e, n + p), pressure))
        store(e, ACROSS * n + p, fma(mu, load8(e, 2 * n + p), pressure))
        xy = mu * load8(e, 3 * n + p)
        store(S, n + p, xy)
        store(S, 2 * n + p, xy)
    report[STRAIN] = min(report[STRAIN], 1.0 - most(stiff) / (elastic.lam + 2.0 * elastic.mu))
    for p in range(count):
        carry_surface(body.surface, chunk, first + p, p, dt)


@react_volume.register(NeoHookean)
def _(elastic, body, chunk, first, count, dt, report):
    deliver_volume(body.particles, chunk, first, count)
    e, S, n, real = chunk.e, chunk.S, chunk.e.shape[1], chunk.e.dtype.type
    mu, lam, one, stiff = splat8(real(elastic.mu)), splat8(real(elastic.lam)), splat8(real(1)), splat8(real(0))
    for p in range(0, count, EIGHT):
        J = load8(e, JACOBIAN * n + p)
        xy, yz, xz = absolute(load8(e, 3 * n + p)), absolute(load8(e, 4 * n + p)), absolute(load8(e, 5 * n + p))
        rows = maximum(maximum(load8(e, p) + xy + xz, load8(e, n + p) + xy + yz), load8(e, 2 * n + p) + xz + yz)
        stiff = maximum(lam * J * (J + J - one) + (mu + mu) * (one + rows), stiff)
        pressure = lam * J * (J - one)
        store(S, p, fma(mu, load8(e, p), pressure))
        store(S, 4 * n + p, fma(mu, load8(e, n + p), pressure))
        store(S, 8 * n + p, fma(mu, load8(e, 2 * n + p), pressure))
        xy, yz, xz = mu * load8(e, 3 * n + p), mu * load8(e, 4 * n + p), mu * load8(e, 5 * n + p)
        store(S, n + p, xy)
        store(S, 3 * n + p, xy)
        store(S, 5 * n + p, yz)
        store(S, 7 * n + p, yz)
        store(S, 2 * n + p, xz)
        store(S, 6 * n + p, xz)
    report[STRAIN] = min(report[STRAIN], 1.0 - most(stiff) / (elastic.lam + 2.0 * elastic.mu))
    for p in range(count):
        carry_surface(body.surface, chunk, first + p, p, dt)


@kernel
def eigen_chunk(e, count):
    """Values and first two axes of `count` tensors, in place: a loop of its own over contiguous components: it vectorises (65 ns a tensor, not 235)."""
    for p in range(count):
        l1, l2, l3, ax, ay, az, bx, by, bz, _, _, _ = eigen3(e[0, p], e[1, p], e[2, p], e[3, p], e[4, p], e[5, p])
        e[0, p], e[1, p], e[2, p], e[3, p], e[4, p], e[5, p], e[6, p], e[7, p], e[8, p] = l1, l2, l3, ax, ay, az, bx, by, bz
