"""How the particles of a chunk answer the gathered velocity gradient (physics.md 4, steps 5 to 8), by dimension.

A = dt L;  J <- J det(1 + A);  B <- (1 + A)(1 + B)(1 + A)^T - 1;  eps_i = 1/2 log1p(B_i);  return map;  heating;  tau from eps and the new temperature.
Then what is scattered next: momentum m v, slope m C and the impulse -dt V0 tau grad(w), as S (with the MLS gradient S/(sum w d^2), a slope).
`report` collects what guards and limits need. A particle that cannot answer ends the step with its code (mpm.outcome).
"""

import math

from mpm.basis import inverse_moment
from mpm.heat.local import heat_locally, latch, temperature, thermal_stress
from mpm.jit import kernel, role
from mpm.materials import FLOW, NoFlow, flow, settled, stress, warmed
from mpm.outcome import INVERTED, OVERSTRETCHED, RETURN_MAP
from mpm.state import Axisymmetric, Line, NoExchange, Plane, Surface, Volume
from mpm.tensors import compose2, compose3, dilation1, dilation2, dilation3, eigen2, eigen3, push1, push2, push3
from mpm.transfer import uses_basis_gradient

CODE, PARTICLE, STEP, SPEED, RATE, STRAIN, SWELL, HEATED, DISSIPATED, REPORT = range(10)  # places in the report
MOST = 0.5  # largest entry of dt grad v


@role
def respond(space, gradient, body, chunk, first, count, dt, next_dt, report):
    """Update B, J (F, theta) of `count` particles from chunk.L, and fill m, a, A, f, S of the chunk for the next scatter with step `next_dt`."""
    raise TypeError(f"no response for {type(space).__name__}")


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


@kernel(inline=True)
def fail(report, code, i):
    """Keep the first failure."""
    if report[CODE] == 0.0:
        report[CODE], report[PARTICLE] = code, i


@kernel(inline=True)
def guard(report, largest, grow, J, least, i):
    """Refuse what no smaller model explains: NaN falls through every comparison here, hence the `not`."""
    report[RATE] = max(report[RATE], largest)
    report[SWELL] = max(report[SWELL], J)
    if not grow > -1.0 or not least > -1.0:
        fail(report, INVERTED, i)
    elif not largest < MOST or not 1e-3 < J < 1e3:
        fail(report, OVERSTRETCHED, i)


@kernel(inline=True)
def load(particles, chunk, i, p, D, factor):
    """Momentum, its slope, and the impulse `factor` tau of particle i for the next scatter; tau stands in chunk.S."""
    m = particles.m[i]
    chunk.m[p] = m
    for c in range(D):
        chunk.a[c, p] = m * particles.v[i, c]
        chunk.f[c, p] = 0.0
        for d in range(D):
            chunk.A[c, d, p] = m * particles.C[i, c, d]
            chunk.S[c, d, p] *= factor


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


@respond.register(Line)
def _(space, gradient, body, chunk, first, count, dt, next_dt, report):
    particles = body.particles
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / (space.h * space.h)
    for p in range(count):
        i = first + p
        A = (dt * chunk.L[0, 0, p],)
        grow = dilation1(A)
        B = push1((particles.B[i, 0], particles.B[i, 1], particles.B[i, 2]), A)
        J = particles.J[i] + particles.J[i] * grow
        guard(report, abs(A[0]), grow, J, B[0], i)
        if report[CODE] != 0.0:
            return
        particles.J[i] = J
        e1, e2, e3 = 0.5 * math.log1p(B[0]), 0.5 * math.log1p(B[1]), 0.5 * math.log1p(B[2])
        e1, e2, e3, t1, _, _ = answer(body, i, e1, e2, e3, grow, dt, report)
        if flows(body.flow):
            B = (math.expm1(2.0 * e1), math.expm1(2.0 * e2), math.expm1(2.0 * e3))
        particles.B[i, 0], particles.B[i, 1], particles.B[i, 2] = B
        carry_surface(body.surface, chunk, i, p, dt)
        chunk.S[0, 0, p] = t1
        load(particles, chunk, i, p, 1, -next_dt * particles.V0[i] * scale)


@kernel(inline=True)
def respond_plane(space, gradient, body, chunk, i, p, hoop, dt, next_dt, report):
    """One particle of a plane or axisymmetric body; `hoop` is the rate v_r/r. Returns V0 tau_zz (out of plane, hoop)."""
    particles = body.particles
    A = (dt * chunk.L[0, 0, p], dt * chunk.L[0, 1, p], dt * chunk.L[1, 0, p], dt * chunk.L[1, 1, p], dt * hoop)
    grow = dilation2(A)
    B = push2((particles.B[i, 0], particles.B[i, 1], particles.B[i, 2], particles.B[i, 3]), A)
    l1, l2, c, s = eigen2(B[0], B[1], B[3])
    J = particles.J[i] + particles.J[i] * grow
    guard(report, max(abs(A[0]), abs(A[1]), abs(A[2]), abs(A[3]), abs(A[4])), grow, J, min(l1, l2, B[2]), i)
    if report[CODE] != 0.0:
        return 0.0
    particles.J[i] = J
    e1, e2, e3 = 0.5 * math.log1p(l1), 0.5 * math.log1p(l2), 0.5 * math.log1p(B[2])
    e1, e2, e3, t1, t2, t3 = answer(body, i, e1, e2, e3, grow, dt, report)
    if flows(body.flow):
        xx, yy, xy = compose2(math.expm1(2.0 * e1), math.expm1(2.0 * e2), c, s)
        B = (xx, yy, math.expm1(2.0 * e3), xy)
    particles.B[i, 0], particles.B[i, 1], particles.B[i, 2], particles.B[i, 3] = B
    carry_surface(body.surface, chunk, i, p, dt)
    xx, yy, xy = compose2(t1, t2, c, s)
    chunk.S[0, 0, p], chunk.S[0, 1, p], chunk.S[1, 0, p], chunk.S[1, 1, p] = xx, xy, xy, yy
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / (space.h * space.h)
    load(particles, chunk, i, p, 2, -next_dt * particles.V0[i] * scale)
    return particles.V0[i] * t3


@respond.register(Plane)
def _(space, gradient, body, chunk, first, count, dt, next_dt, report):
    for p in range(count):
        respond_plane(space, gradient, body, chunk, first + p, p, 0.0, dt, next_dt, report)
        if report[CODE] != 0.0:
            return


@respond.register(Axisymmetric)
def _(space, gradient, body, chunk, first, count, dt, next_dt, report):
    x = body.particles.x
    for p in range(count):
        i = first + p
        before = x[i, 0] - dt * chunk.v[0, p]  # r at which the rates were gathered: the position has moved on already
        pull = respond_plane(space, gradient, body, chunk, i, p, chunk.v[0, p] / before, dt, next_dt, report)
        if report[CODE] != 0.0:
            return
        chunk.f[0, p] = -next_dt * pull / x[i, 0]


@respond.register(Volume)
def _(space, gradient, body, chunk, first, count, dt, next_dt, report):
    particles = body.particles
    e, L, b = chunk.e, chunk.L, particles.B
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / (space.h * space.h)
    for p in range(count):
        i = first + p
        A = increment3(L, p, dt)
        e[0, p], e[1, p], e[2, p], e[3, p], e[4, p], e[5, p] = push3((b[i, 0], b[i, 1], b[i, 2], b[i, 3], b[i, 4], b[i, 5]), A)
    eigen_chunk(e, count)
    for p in range(count):
        i = first + p
        A = increment3(L, p, dt)
        grow = dilation3(A)
        J = particles.J[i] + particles.J[i] * grow
        largest = max(abs(A[0]), abs(A[1]), abs(A[2]), abs(A[3]), abs(A[4]), abs(A[5]), abs(A[6]), abs(A[7]), abs(A[8]))
        guard(report, largest, grow, J, min(e[0, p], e[1, p], e[2, p]), i)
        if report[CODE] != 0.0:
            return
        particles.J[i] = J
        ax, ay, az, bx, by, bz = e[3, p], e[4, p], e[5, p], e[6, p], e[7, p], e[8, p]
        e1, e2, e3 = 0.5 * math.log1p(e[0, p]), 0.5 * math.log1p(e[1, p]), 0.5 * math.log1p(e[2, p])
        e1, e2, e3, t1, t2, t3 = answer(body, i, e1, e2, e3, grow, dt, report)
        if flows(body.flow):
            B = compose3(math.expm1(2.0 * e1), math.expm1(2.0 * e2), math.expm1(2.0 * e3), ax, ay, az, bx, by, bz)
        else:
            B = push3((b[i, 0], b[i, 1], b[i, 2], b[i, 3], b[i, 4], b[i, 5]), A)
        b[i, 0], b[i, 1], b[i, 2], b[i, 3], b[i, 4], b[i, 5] = B
        carry_surface(body.surface, chunk, i, p, dt)
        xx, yy, zz, xy, yz, xz = compose3(t1, t2, t3, ax, ay, az, bx, by, bz)
        S = chunk.S
        S[0, 0, p], S[0, 1, p], S[0, 2, p] = xx, xy, xz
        S[1, 0, p], S[1, 1, p], S[1, 2, p] = xy, yy, yz
        S[2, 0, p], S[2, 1, p], S[2, 2, p] = xz, yz, zz
        load(particles, chunk, i, p, 3, -next_dt * particles.V0[i] * scale)


@kernel(inline=True)
def increment3(L, p, dt):
    """dt L of a particle of the chunk, as tensors.push3 wants it."""
    xx, xy, xz = dt * L[0, 0, p], dt * L[0, 1, p], dt * L[0, 2, p]
    yx, yy, yz = dt * L[1, 0, p], dt * L[1, 1, p], dt * L[1, 2, p]
    zx, zy, zz = dt * L[2, 0, p], dt * L[2, 1, p], dt * L[2, 2, p]
    return xx, xy, xz, yx, yy, yz, zx, zy, zz


@kernel
def eigen_chunk(e, count):
    """Values and first two axes of `count` tensors, in place: a loop of its own over contiguous components: it vectorises (65 ns a tensor, not 235)."""
    for p in range(count):
        l1, l2, l3, ax, ay, az, bx, by, bz, _, _, _ = eigen3(e[0, p], e[1, p], e[2, p], e[3, p], e[4, p], e[5, p])
        e[0, p], e[1, p], e[2, p], e[3, p], e[4, p], e[5, p], e[6, p], e[7, p], e[8, p] = l1, l2, l3, ax, ay, az, bx, by, bz
