"""What particles keep of an implicit step: positions, velocities, slopes, elastic strain, volume, latches, heat of deformation."""

import math

from mpm.basis import inverse_moment, stencil
from mpm.boundary import directions
from mpm.heat.local import heat_locally, latch, thermal_stress
from mpm.heat.setting import condition
from mpm.implicit.assemble import elastic_b, increment, sign, trial
from mpm.integrate.given_source import push_at
from mpm.integrate.strain import CODE, DISSIPATED, HEATED, PARTICLE, RATE, SPEED, STRAIN, SWELL, SWELLED, WORKED
from mpm.integrate.stress_hencky import swells
from mpm.integrate.traction import share, within
from mpm.jit import kernel, role
from mpm.materials import moduli, settled, tangent, warmed
from mpm.outcome import INVERTED, OVERSTRETCHED
from mpm.sources import Both, Given
from mpm.state import Axisymmetric, Line, Load, NoExchange, NoSource, Plane, Surface
from mpm.tensors import compose2, push2


@role
def keep_b(space, B, i, xx, yy, zz, xy):
    """b - 1 to particle i."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@keep_b.register(Line)
def keep_b_line(space, B, i, xx, yy, zz, xy):
    B[i, 0], B[i, 1], B[i, 2] = xx, yy, zz


@keep_b.register(Plane)
@keep_b.register(Axisymmetric)
def keep_b_plane_or_axisymmetric(space, B, i, xx, yy, zz, xy):
    B[i, 0], B[i, 1], B[i, 2], B[i, 3] = xx, yy, zz, xy


@role
def stretch(surface, i, A, D):
    """F <- f F of particle i, where it owns pieces of surface."""
    raise TypeError(f"no surface {type(surface).__name__}")


@stretch.register(NoExchange)
def stretch_no_exchange(surface, i, A, D):
    return None


@stretch.register(Surface)
def stretch_surface(surface, i, A, D):
    if surface.row[i] >= 0:
        push_forward(surface.F, surface.row[i], A, D)


@kernel
def push_forward(F, i, A, D):
    """F_i <- (1 + A) F_i."""
    if D == 1:
        F[i, 0, 0] *= 1.0 + A[0]
        return
    for d in range(2):
        f0, f1 = F[i, 0, d], F[i, 1, d]
        F[i, 0, d], F[i, 1, d] = f0 + A[0] * f0 + A[1] * f1, f1 + A[2] * f0 + A[3] * f1


@role
def loads(source, body, nodes, push, dt):
    """Add dead loads at the end of the step, and body forces in its middle, to the nodes' forces `push` (A, D)."""
    raise TypeError(f"no implicit mechanics with {type(source).__name__}")


@loads.register(NoSource)
def loads_no_source(source, body, nodes, push, dt):
    return None


@loads.register(Load)
def loads_load(source, body, nodes, push, dt):
    D = push.shape[1]
    for p in range(nodes.w.shape[0]):
        if not source.loaded[p]:
            continue
        now = share(source.ramp, source.t[p] + dt, 1.0)
        for k in range(nodes.w.shape[1]):
            for c in range(D):
                force = source.force[p, c] * nodes.w[p, k]
                for d in range(D):
                    for a in range(D):
                        force += source.dipole[p, c, a] * source.F[p, d, a] * nodes.g[p, k, d]
                push[nodes.node[p, k], c] += now * sign(nodes, p, k, c) * force


@loads.register(Given)
def loads_given(source, body, nodes, push, dt):
    N = nodes.w.shape[0]
    push_at(source.force, source, body, 0, N, source.t[0] + 0.5 * dt)
    for p in range(N):
        for k in range(nodes.w.shape[1]):
            for c in range(push.shape[1]):
                push[nodes.node[p, k], c] += sign(nodes, p, k, c) * nodes.w[p, k] * body.particles.m[p] * source.b[p, c]


@loads.register(Both)
def loads_both(source, body, nodes, push, dt):
    loads(source.load, body, nodes, push, dt)
    loads(source.given, body, nodes, push, dt)


@role
def drag_rate(source, dt):
    """In a step of dt [1/s]."""
    raise TypeError(f"no implicit mechanics with {type(source).__name__}")


@drag_rate.register(NoSource)
@drag_rate.register(Given)
def drag_rate_no_source_or_given(source, dt):
    return 0.0


@drag_rate.register(Load)
def drag_rate_load(source, dt):
    return source.rate * within(source.ramp, source.t[0] + 0.5 * dt, 0.0)


@drag_rate.register(Both)
def drag_rate_both(source, dt):
    return drag_rate(source.load, dt) + drag_rate(source.given, dt)


@role
def pass_time(source, i, A, D, dt):
    """Time and F of a loaded particle at the end of the step."""
    raise TypeError(f"no implicit mechanics with {type(source).__name__}")


@pass_time.register(NoSource)
def pass_time_no_source(source, i, A, D, dt):
    return None


@pass_time.register(Load)
def pass_time_load(source, i, A, D, dt):
    source.t[i] += dt
    if source.loaded[i]:
        push_forward(source.F, i, A, D)


@pass_time.register(Given)
def pass_time_given(source, i, A, D, dt):
    source.t[i] += dt


@pass_time.register(Both)
def pass_time_both(source, i, A, D, dt):
    pass_time(source.load, i, A, D, dt)
    pass_time(source.given, i, A, D, dt)


@kernel
def deliver(space, body, nodes, u, dt, work, report):
    """Particles at the end of the step, from displacements u (A, D) of the nodes; `work` of loads [J]. report: mpm.integrate.strain."""
    particles, D, h = body.particles, directions(space), space.h
    x, M = particles.x, nodes.w.shape[1]
    report[WORKED] += work
    for p in range(x.shape[0]):
        A = increment(space, nodes, u, x, p)
        _, _, c, s, trace, d1, d2, d3, size, grow, sound = trial(space, particles.B, A, p)
        J = particles.J[p] * (1.0 + grow)
        if not sound or not 1e-3 < J < 1e3:
            report[CODE], report[PARTICLE] = INVERTED if not sound else OVERSTRETCHED, p
            return
        theta = condition(body.setting, body.thermal, p)
        thermal = thermal_stress(body.expansion, body.thermal, p, theta)
        law = settled(body.flow, particles.J[p])
        elastic = warmed(body.elastic, theta)
        _, pressure, part, _, _, _, lost, _ = tangent(law, elastic, trace, size, thermal, theta, dt)
        before = trace - math.log1p(grow)
        if lost > 0.0:
            lam, mu = moduli(elastic)
            mean = (thermal - pressure) / (3.0 * lam + 2.0 * mu)
            xx, yy, xy = compose2(math.expm1(2.0 * (mean + part * d1)), math.expm1(2.0 * (mean + part * d2)), c, s)
            keep_b(space, particles.B, p, xx, yy, math.expm1(2.0 * (mean + part * d3)), xy)
            trace = 3.0 * mean
        else:
            xx, yy, zz, xy = push2(elastic_b(space, particles.B, p), A)
            keep_b(space, particles.B, p, xx, yy, zz, xy)
            mean, part = trace / 3.0, 1.0
        report[STRAIN] = min(report[STRAIN], mean + part * min(d1, d2, d3))
        particles.J[p] = J
        density = particles.m[p] / particles.V0[p]
        gained = heat_locally(body.heating, body.thermal, p, density, trace - before, lost)
        if swells(body.expansion):
            report[SWELLED] += particles.V0[p] * thermal * (trace - before)
        report[HEATED] += particles.V0[p] * gained
        report[DISSIPATED] += particles.V0[p] * lost
        latch(body.expansion, body.thermal, p)
        stretch(body.surface, p, A, D)
        pass_time(body.source, p, A, D, dt)
        largest = max(abs(A[0]), abs(A[1]), abs(A[2]), abs(A[3]), abs(A[4]))
        report[RATE] = max(report[RATE], largest)
        report[SWELL] = max(report[SWELL], J)
        slopes(space, particles, nodes, u, p, dt, M, D, h)
        speed = 0.0
        for a in range(D):
            speed += particles.v[p, a] ** 2
            x[p, a] += dt * particles.v[p, a]
        report[SPEED] = max(report[SPEED], speed)


@kernel
def slopes(space, particles, nodes, u, p, dt, M, D, h):
    """v and C of particle p: the mean rate of the step, as APIC gathers it."""
    for a in range(D):
        particles.v[p, a] = 0.0
        for d in range(D):
            particles.C[p, a, d] = 0.0
    one, two = stencil(space.basis, particles.x[p, 0] / h), stencil(space.basis, particles.x[p, D - 1] / h)
    last = len(two[1]) if D == 2 else 1
    for k in range(M):
        i, j = k // last, k % last
        n, w = nodes.node[p, k], nodes.w[p, k] / dt
        for a in range(D):
            v = w * sign(nodes, p, k, a) * u[n, a]
            particles.v[p, a] += v
            particles.C[p, a, 0] += v * one[3][i] * inverse_moment(space.basis) / h
            if D == 2:
                particles.C[p, a, 1] += v * two[3][j] * inverse_moment(space.basis) / h
