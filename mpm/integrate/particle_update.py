"""How the particles of a chunk answer the gathered velocity gradient (docs/physics.md 4, steps 5 to 8), by dimension.

A = dt L;  J <- J det(1 + A);  B <- (1 + A)(1 + B)(1 + A)^T - 1;  eps_i = 1/2 log1p(B_i);  return map;  heating;  tau from eps and the new temperature.
Then what is scattered next: momentum m v, slope m C and the impulse -dt V0 tau grad(w), as S (with the MLS gradient S/(sum w d^2), a slope).
`report` (its places: strain.py) collects what guards and limits need. A particle that cannot answer ends the step with its code (mpm.outcome).
"""

import math

from mpm.basis import inverse_moment
from mpm.boundary import directions
from mpm.heat.local import heat_locally, latch, thermal_stress
from mpm.heat.setting import condition
from mpm.integrate import stress_neo_hookean  # noqa: F401 - registers the law
from mpm.integrate.strain import CODE, DISSIPATED, HEATED, HOOP, STRAIN, SWELLED, fail, guard, strain_plane, strain_volume
from mpm.integrate.stress_hencky import ACROSS, carry_surface, flows, stress_plane, stress_volume, swells
from mpm.jit import kernel, role
from mpm.lanes import EIGHT, load8, peek, poke, store
from mpm.materials import flow, settled, stress, warmed
from mpm.outcome import RETURN_MAP
from mpm.state import Axisymmetric, Line, Plane, Volume
from mpm.tensors import dilation1, push1
from mpm.transfer import CHUNK, uses_basis_gradient


@role(inline=True)
def respond(space, gradient, body, chunk, first, count, dt, next_dt, report):
    """Update B, J (F, theta) of `count` particles from chunk.L, and fill m, a, A, f, S of the chunk for the next scatter with step `next_dt`."""
    raise TypeError(f"no response for {type(space).__name__}")


@kernel(inline=True)
def load_chunk(space, gradient, particles, chunk, first, count, dt):
    """Momentum m v, its slope m C and the impulse -dt V0 tau for the next scatter; tau stands in chunk.S."""
    D, n, real = directions(space), CHUNK, chunk.m.dtype.type
    scale = real(-dt) if uses_basis_gradient(gradient) else real(-dt * inverse_moment(space.basis) / (space.h * space.h))
    weight = chunk.f[0]  # V0, until the last loop
    for p in range(count):
        poke(chunk.m, p, peek(particles.m, first + p))
        poke(weight, p, scale * peek(particles.V0, first + p))
    for p in range(0, count, EIGHT):
        m, factor = load8(chunk.m, p), load8(weight, p)
        for c in range(D):
            store(chunk.a, c * n + p, m * load8(chunk.u, c * n + p))
        for k in range(D * D):
            store(chunk.A, k * n + p, m * load8(chunk.U, k * n + p))
            store(chunk.S, k * n + p, factor * load8(chunk.S, k * n + p))
    chunk.f[:] = 0.0


@kernel(inline=True)
def answer(body, i, e1, e2, e3, grow, dt, report):
    """Return map, heating and principal Kirchhoff stresses of particle i: (e1, e2, e3, t1, t2, t3)."""
    trace_before = e1 + e2 + e3 - math.log1p(grow)
    theta = condition(body.setting, body.thermal, i)
    thermal = thermal_stress(body.expansion, body.thermal, i, theta)
    lost = 0.0
    if dt > 0.0:
        e1, e2, e3, lost, ok = flow(settled(body.flow, body.particles.J[i]), warmed(body.elastic, theta), e1, e2, e3, thermal, theta, dt)
        if not ok:
            fail(report, RETURN_MAP, i)
        density = body.particles.m[i] / body.particles.V0[i]
        stretched = e1 + e2 + e3 - trace_before
        gained = heat_locally(body.heating, body.thermal, i, density, stretched, lost)
        if swells(body.expansion):
            report[SWELLED] += body.particles.V0[i] * thermal * stretched
        report[HEATED] += body.particles.V0[i] * gained
        report[DISSIPATED] += body.particles.V0[i] * lost
        latch(body.expansion, body.thermal, i)
        theta = condition(body.setting, body.thermal, i)
        thermal = thermal_stress(body.expansion, body.thermal, i, theta)
    report[STRAIN] = min(report[STRAIN], e1, e2, e3)
    t1, t2, t3 = stress(warmed(body.elastic, theta), e1, e2, e3, thermal)
    return e1, e2, e3, t1, t2, t3


@respond.register(Line)
def respond_line(space, gradient, body, chunk, first, count, dt, next_dt, report):
    particles = body.particles
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
        chunk.S[0, 0, p] = t1
    carry_surface(body.surface, chunk, first, count, dt, 1)
    load_chunk(space, gradient, particles, chunk, first, count, next_dt)


@respond.register(Plane)
def respond_plane(space, gradient, body, chunk, first, count, dt, next_dt, report):
    strain_plane(body.particles, chunk, first, count, dt, report)
    if report[CODE] == 0.0:
        stress_plane(body.elastic, body, chunk, first, count, dt, report)
        load_chunk(space, gradient, body.particles, chunk, first, count, next_dt)


@respond.register(Axisymmetric)
def respond_axisymmetric(space, gradient, body, chunk, first, count, dt, next_dt, report):
    x, V0 = body.particles.x, body.particles.V0
    for p in range(count):
        before = x[first + p, 0] - dt * chunk.v[0, p]  # r at which the rates were gathered: the position has moved on already
        chunk.e[HOOP, p] = chunk.v[0, p] / before
    strain_plane(body.particles, chunk, first, count, dt, report)
    if report[CODE] == 0.0:
        stress_plane(body.elastic, body, chunk, first, count, dt, report)
        load_chunk(space, gradient, body.particles, chunk, first, count, next_dt)
        for p in range(count):
            chunk.f[0, p] = -next_dt * V0[first + p] * chunk.e[ACROSS, p] / x[first + p, 0]


@respond.register(Volume)
def respond_volume(space, gradient, body, chunk, first, count, dt, next_dt, report):
    strain_volume(body.particles, chunk, first, count, dt, report)
    if report[CODE] == 0.0:
        stress_volume(body.elastic, body, chunk, first, count, dt, report)
        load_chunk(space, gradient, body.particles, chunk, first, count, next_dt)
