"""Strain and stress of a chunk of particles in the total frame, eight at once where there is more than one direction.

trial   B = F (1 + plastic) F^T - 1 with F = 1 + H, H = sum u grad_X w;  hoop F_33 = 1 + u_r/R;  J = det F;  grown = J/J_before - 1
then    return map, heating, tau: mpm.integrate.stress_hencky, as in the updated frame
last    plastic <- F^-1 (1 + B) F^-T - 1 where it flowed;  P = tau F^-T;  the impulse -V0 P on grad_X w, hoop -V0 tau_33/(R F_33) on w
An elastic body remembers nothing: its stress is a function of u, so steps and paths leave no trace.
"""

import math

from mpm.integrate.particle_update import answer
from mpm.integrate.strain import CODE, GROW, HOOP, JACOBIAN, SWELL, fail, rest
from mpm.integrate.stress_hencky import ACROSS, flows, stress_plane, stress_volume, swells, warms
from mpm.isotropic import largest, lowest3, norm, split
from mpm.jit import kernel, role
from mpm.lanes import EIGHT, absolute, below, item, least, load8, maximum, minimum, most, peek, poke, splat8, sqrt, store
from mpm.outcome import INVERTED, OVERSTRETCHED
from mpm.state import Axisymmetric, Line, Plane, Volume
from mpm.tensors import dilation2, dilation3, push1, push2, push3
from mpm.total.forces import relax_volume, restore

LEAST_J, MOST_J = 1e-3, 1e3
FLAT = 1e-4  # smallest squared stretch that the limit of the step looks at


@role(inline=True)
def answer_all(space, body, reference, chunk, first, count, dt, report):
    """From displacement (chunk.v) and its gradient (chunk.L) to impulses by unit time (chunk.G on grad w, chunk.a on w), through the particles' B and J.

    Returns 1 over the smallest squared stretch: what shortens the largest stable step.
    """
    raise TypeError(f"no strain for {type(space).__name__}")


@kernel(inline=True)
def begin(particles, reference, flowing, chunk, first, count, K):
    """Rows of chunk.e: what flow has left, where something flows, and J before."""
    e, n = chunk.e, chunk.e.shape[1]
    for p in range(count):
        if flowing:
            for k in range(K):
                poke(e, k * n + p, peek(reference.plastic, K * (first + p) + k))
        poke(e, JACOBIAN * n + p, peek(particles.J, first + p))
    rest(chunk, count, K)


@kernel(inline=True)
def admit(particles, chunk, first, count, swell, good, report):
    """J to the particles; where one is not good, say which."""
    report[SWELL] = max(report[SWELL], most(swell))
    if least(good) < 1.0:
        for p in range(count):
            J = chunk.e[JACOBIAN, p]
            if not J > 0.0:
                fail(report, INVERTED, first + p)
            elif not LEAST_J < J < MOST_J:
                fail(report, OVERSTRETCHED, first + p)
    for p in range(count):
        poke(particles.J, first + p, peek(chunk.e, JACOBIAN * chunk.e.shape[1] + p))


@kernel(inline=True)
def keep_trial(chunk, count, K):
    """A copy of the trial strains in chunk.C, which nothing else needs here."""
    n = chunk.e.shape[1]
    for k in range(K):
        for p in range(0, count, EIGHT):
            store(chunk.C, k * n + p, load8(chunk.e, k * n + p))


@kernel(inline=True)
def flowed_here(chunk, p, K):
    """1 in lanes whose strain is not the trial one, else 0."""
    n = chunk.e.shape[1]
    moved = absolute(load8(chunk.e, p) - load8(chunk.C, p))
    for k in range(1, K):
        moved = maximum(moved, absolute(load8(chunk.e, k * n + p) - load8(chunk.C, k * n + p)))
    return below(splat8(chunk.e.dtype.type(0)), moved)


@kernel(inline=True)
def remember(reference, chunk, first, p, count, flowed, B):
    """B, pulled back, to the plastic metric of those of eight particles that flowed."""
    n, K = chunk.C.shape[2], reference.plastic.shape[1]
    for k in range(len(B)):
        store(chunk.C, k * n + p, B[k])
    for q in range(p, min(p + EIGHT, count)):
        if item(flowed, q - p) > 0.5:
            for k in range(K):
                poke(reference.plastic, K * (first + q) + k, peek(chunk.C, k * n + q))


@kernel(inline=True)
def grown(body, chunk, p, J):
    """Eight J to their row of chunk.e, and J/J_before - 1 where something asks for it."""
    e, n = chunk.e, chunk.e.shape[1]
    if warms(body.heating) or swells(body.expansion):
        before = load8(e, JACOBIAN * n + p)
        store(e, GROW * n + p, (J - before) / before)
    store(e, JACOBIAN * n + p, J)


@kernel(inline=True)
def weigh(particles, chunk, first, count):
    """-V0 of the chunk's particles, as lanes."""
    for p in range(count):
        poke(chunk.f, p, -peek(particles.V0, first + p))


@answer_all.register(Line)
def answer_all_line(space, body, reference, chunk, first, count, dt, report):
    particles, squeeze = body.particles, 1.0
    relax_volume(body.locking, space, reference.X, first, chunk, count)
    for p in range(count):
        i, H = first + p, chunk.L[0, 0, p]
        before, J = particles.J[i], 1.0 + H
        if not LEAST_J < J < MOST_J:
            fail(report, OVERSTRETCHED if J > 0.0 else INVERTED, i)
            return squeeze
        if flows(body.flow):
            B = push1((reference.plastic[i, 0], reference.plastic[i, 1], reference.plastic[i, 2]), (H,))
        else:
            B = (H + H + H * H, 0.0, 0.0)
        report[SWELL] = max(report[SWELL], J)
        particles.J[i] = J
        e1, e2, e3 = 0.5 * math.log1p(B[0]), 0.5 * math.log1p(B[1]), 0.5 * math.log1p(B[2])
        n1, n2, n3, t1, _, _ = answer(body, i, e1, e2, e3, J / before - 1.0, dt, report)
        if flows(body.flow) and (n1 != e1 or n2 != e2 or n3 != e3):
            B = (math.expm1(2.0 * n1), math.expm1(2.0 * n2), math.expm1(2.0 * n3))
            reference.plastic[i, 0] = (1.0 + B[0]) / (J * J) - 1.0
            reference.plastic[i, 1], reference.plastic[i, 2] = B[1], B[2]
        particles.B[i, 0], particles.B[i, 1], particles.B[i, 2] = B
        squeeze = max(squeeze, 1.0 / (J * J))
        chunk.G[0, 0, p] = t1
    restore(body.locking, chunk, count)
    for p in range(count):
        chunk.G[0, 0, p] *= -particles.V0[first + p] / (1.0 + chunk.L[0, 0, p])
    return squeeze


@kernel(inline=True)
def plane_strain(space, body, reference, chunk, first, count, dt, report):
    """What Plane and Axisymmetric share; chunk.e[HOOP] holds F_33 - 1. Returns the squeeze."""
    e, L, n, real = chunk.e, chunk.L, chunk.e.shape[1], chunk.e.dtype.type
    one, low, high, half = splat8(real(1)), splat8(real(LEAST_J)), splat8(real(MOST_J)), real(0.5)
    swell, good, lowest = splat8(real(0)), one, splat8(real(0))
    begin(body.particles, reference, flows(body.flow), chunk, first, count, 4)
    for p in range(0, count, EIGHT):
        xx, xy, yx, yy, zz = load8(L, p), load8(L, n + p), load8(L, 2 * n + p), load8(L, 3 * n + p), load8(e, HOOP * n + p)
        J = one + dilation2((xx, xy, yx, yy, zz))
        good = good * below(low, J) * below(J, high)
        swell = maximum(J, swell)
        B = a, b, across, c = xx + xx + (xx * xx + xy * xy), yy + yy + (yx * yx + yy * yy), zz + zz + zz * zz, xy + yx + (xx * yx + xy * yy)
        d = half * (a - b)
        lowest = minimum(minimum(half * (a + b) - sqrt(d * d + c * c), across), lowest)
        if flows(body.flow):
            B = push2((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p)), (xx, xy, yx, yy, zz))
        store(e, p, B[0])
        store(e, n + p, B[1])
        store(e, 2 * n + p, B[2])
        store(e, 3 * n + p, B[3])
        grown(body, chunk, p, J)
    admit(body.particles, chunk, first, count, swell, good, report)
    if flows(body.flow):
        keep_trial(chunk, count, 4)
    return 1.0 / max(1.0 + least(lowest), FLAT)


@kernel(inline=True)
def plane_stress(body, reference, chunk, first, count):
    """The plastic metric where it flowed, and G = -V0 P from tau in chunk.S."""
    e, L, S, G, n, real = chunk.e, chunk.L, chunk.S, chunk.G, chunk.e.shape[1], chunk.e.dtype.type
    one = splat8(real(1))
    weigh(body.particles, chunk, first, count)
    for p in range(0, count, EIGHT):
        xx, xy, yx, yy, zz = load8(L, p), load8(L, n + p), load8(L, 2 * n + p), load8(L, 3 * n + p), load8(e, HOOP * n + p)
        inverse = one / (one + (xx + yy + (xx * yy - xy * yx)))
        fxx, fyy = inverse * (one + xx), inverse * (one + yy)
        fxy, fyx = inverse * xy, inverse * yx
        V = load8(chunk.f, p)
        txx, txy, tyy = V * load8(S, p), V * load8(S, n + p), V * load8(S, 3 * n + p)
        store(G, p, txx * fyy - txy * fxy)
        store(G, n + p, txy * fxx - txx * fyx)
        store(G, 2 * n + p, txy * fyy - tyy * fxy)
        store(G, 3 * n + p, tyy * fxx - txy * fyx)
        if flows(body.flow):
            flowed = flowed_here(chunk, p, 4)
            if most(flowed) > 0.5:
                back = (fxy * yx - fyy * xx, -fxy, -fyx, fyx * xy - fxx * yy, -zz / (one + zz))  # F^-1 - 1, without cancellation
                B = push2((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p)), back)
                remember(reference, chunk, first, p, count, flowed, B)


@answer_all.register(Plane)
def answer_all_plane(space, body, reference, chunk, first, count, dt, report):
    for p in range(count):
        chunk.e[HOOP, p] = 0.0
    relax_volume(body.locking, space, reference.X, first, chunk, count)
    squeeze = plane_strain(space, body, reference, chunk, first, count, dt, report)
    restore(body.locking, chunk, count)
    if report[CODE] == 0.0:
        stress_plane(body.elastic, body, chunk, first, count, dt, report)
        plane_stress(body, reference, chunk, first, count)
    return squeeze


@answer_all.register(Axisymmetric)
def answer_all_axisymmetric(space, body, reference, chunk, first, count, dt, report):
    X, V0 = reference.X, body.particles.V0
    for p in range(count):
        chunk.e[HOOP, p] = chunk.v[0, p] / X[first + p, 0]
    relax_volume(body.locking, space, reference.X, first, chunk, count)
    squeeze = plane_strain(space, body, reference, chunk, first, count, dt, report)
    restore(body.locking, chunk, count)
    if report[CODE] == 0.0:
        stress_plane(body.elastic, body, chunk, first, count, dt, report)
        plane_stress(body, reference, chunk, first, count)
        for p in range(count):
            chunk.a[0, p] = -V0[first + p] * chunk.e[ACROSS, p] / (X[first + p, 0] * (1.0 + chunk.e[HOOP, p]))
    return squeeze


@answer_all.register(Volume)
def answer_all_volume(space, body, reference, chunk, first, count, dt, report):
    e, L, n, real = chunk.e, chunk.L, chunk.e.shape[1], chunk.e.dtype.type
    one, low, high = splat8(real(1)), splat8(real(LEAST_J)), splat8(real(MOST_J))
    swell, good, lowest = splat8(real(0)), one, splat8(real(0))
    relax_volume(body.locking, space, reference.X, first, chunk, count)
    begin(body.particles, reference, flows(body.flow), chunk, first, count, 6)
    for p in range(0, count, EIGHT):
        xx, xy, xz = load8(L, p), load8(L, n + p), load8(L, 2 * n + p)
        yx, yy, yz = load8(L, 3 * n + p), load8(L, 4 * n + p), load8(L, 5 * n + p)
        zx, zy, zz = load8(L, 6 * n + p), load8(L, 7 * n + p), load8(L, 8 * n + p)
        H = (xx, xy, xz, yx, yy, yz, zx, zy, zz)
        J = one + dilation3(H)
        good = good * below(low, J) * below(J, high)
        swell = maximum(J, swell)
        B = (xx + xx + (xx * xx + xy * xy + xz * xz), yy + yy + (yx * yx + yy * yy + yz * yz), zz + zz + (zx * zx + zy * zy + zz * zz),
             xy + yx + (xx * yx + xy * yy + xz * yz), yz + zy + (yx * zx + yy * zy + yz * zz), xz + zx + (xx * zx + xy * zy + xz * zz))  # fmt: skip
        mean, dev = split(B)
        lowest = minimum(lowest3(B, mean, norm(dev, largest(dev))), lowest)
        if flows(body.flow):
            B = push3((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p), load8(e, 4 * n + p), load8(e, 5 * n + p)), H)
        for k in range(6):
            store(e, k * n + p, B[k])
        grown(body, chunk, p, J)
    admit(body.particles, chunk, first, count, swell, good, report)
    if flows(body.flow):
        keep_trial(chunk, count, 6)
    restore(body.locking, chunk, count)
    if report[CODE] == 0.0:
        stress_volume(body.elastic, body, chunk, first, count, dt, report)
        volume_stress(body, reference, chunk, first, count)
    return 1.0 / max(1.0 + least(lowest), FLAT)


@kernel(inline=True)
def volume_stress(body, reference, chunk, first, count):
    """As plane_stress, in three directions."""
    e, L, S, G, n, real = chunk.e, chunk.L, chunk.S, chunk.G, chunk.e.shape[1], chunk.e.dtype.type
    one = splat8(real(1))
    weigh(body.particles, chunk, first, count)
    for p in range(0, count, EIGHT):
        xx, xy, xz = one + load8(L, p), load8(L, n + p), load8(L, 2 * n + p)
        yx, yy, yz = load8(L, 3 * n + p), one + load8(L, 4 * n + p), load8(L, 5 * n + p)
        zx, zy, zz = load8(L, 6 * n + p), load8(L, 7 * n + p), one + load8(L, 8 * n + p)
        a0, a1, a2 = yy * zz - yz * zy, yz * zx - yx * zz, yx * zy - yy * zx  # cofactors, row by row: F^-T = cof F/J
        inverse, V = one / (xx * a0 + xy * a1 + xz * a2), load8(chunk.f, p)
        a0, a1, a2 = inverse * a0, inverse * a1, inverse * a2
        b0, b1, b2 = inverse * (xz * zy - xy * zz), inverse * (xx * zz - xz * zx), inverse * (xy * zx - xx * zy)
        c0, c1, c2 = inverse * (xy * yz - xz * yy), inverse * (xz * yx - xx * yz), inverse * (xx * yy - xy * yx)
        for k in range(3):
            tx, ty, tz = V * load8(S, 3 * k * n + p), V * load8(S, (3 * k + 1) * n + p), V * load8(S, (3 * k + 2) * n + p)
            store(G, 3 * k * n + p, tx * a0 + ty * b0 + tz * c0)
            store(G, (3 * k + 1) * n + p, tx * a1 + ty * b1 + tz * c1)
            store(G, (3 * k + 2) * n + p, tx * a2 + ty * b2 + tz * c2)
        if flows(body.flow):
            flowed = flowed_here(chunk, p, 6)
            if most(flowed) > 0.5:
                back = (a0 - one, b0, c0, a1, b1 - one, c1, a2, b2, c2 - one)  # F^-1 - 1, the transpose of F^-T
                B = push3((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p), load8(e, 4 * n + p), load8(e, 5 * n + p)), back)
                remember(reference, chunk, first, p, count, flowed, B)
