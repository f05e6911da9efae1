"""What particles keep of an implicit step: positions, velocities, slopes, elastic strain, volume, latches, heat of deformation."""

import math

from mpm.basis import inverse_moment, stencil
from mpm.boundary import directions
from mpm.heat.local import heat_locally, latch, thermal_stress
from mpm.heat.setting import condition
from mpm.implicit.spans import average_volumes, extra_strain
from mpm.implicit.trial import increment, pushed, sign, trial
from mpm.integrate.given_source import push_at
from mpm.integrate.strain import CODE, DISSIPATED, HEATED, PARTICLE, RATE, SPEED, STRAIN, SWELL, SWELLED, WORKED
from mpm.integrate.stress_hencky import swells
from mpm.integrate.traction import Nominal, Present, share, turn, within
from mpm.jit import kernel, role
from mpm.materials import moduli, settled, tangent, warmed
from mpm.outcome import INVERTED, OVERSTRETCHED
from mpm.sources import Both, Given
from mpm.state import Axisymmetric, Line, Load, NoExchange, NoSource, Plane, Surface, Volume
from mpm.tensors import compose2, compose3


@kernel(inline=True)
def keep_b(B, i, found):
    """b - 1 to particle i; a line has no shear."""
    for k in range(min(B.shape[1], len(found))):
        B[i, k] = found[k]


@role
def compose(space, l1, l2, l3, axes):
    """The tensor of these values along these axes."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@compose.register(Line)
@compose.register(Plane)
@compose.register(Axisymmetric)
def compose_line_plane_or_axisymmetric(space, l1, l2, l3, axes):
    xx, yy, xy = compose2(l1, l2, axes[0], axes[1])
    return xx, yy, l3, xy


@compose.register(Volume)
def compose_volume(space, l1, l2, l3, axes):
    return compose3(l1, l2, l3, axes[0], axes[1], axes[2], axes[3], axes[4], axes[5])


@role
def swollen(space, b, extra):
    """b - 1 with `extra` added to each logarithmic strain."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@swollen.register(Line)
@swollen.register(Plane)
@swollen.register(Axisymmetric)
def swollen_line_plane_or_axisymmetric(space, b, extra):
    more = math.expm1(2.0 * extra)
    return b[0] + more * (1.0 + b[0]), b[1] + more * (1.0 + b[1]), b[2] + more * (1.0 + b[2]), b[3] + more * b[3]


@swollen.register(Volume)
def swollen_volume(space, b, extra):
    more = math.expm1(2.0 * extra)
    xx, yy, zz = b[0] + more * (1.0 + b[0]), b[1] + more * (1.0 + b[1]), b[2] + more * (1.0 + b[2])
    return xx, yy, zz, b[3] + more * b[3], b[4] + more * b[4], b[5] + more * b[5]


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
    for d in range(D):
        f0, f1, f2 = F[i, 0, d], F[i, min(1, D - 1), d], F[i, D - 1, d]
        for a in range(D):
            F[i, a, d] += A[D * a] * f0 + (A[D * a + 1] * f1 if D > 1 else 0.0) + (A[D * a + 2] * f2 if D > 2 else 0.0)


@role
def loads(source, body, nodes, push, dt):
    """Add tractions that do not follow the surface (mpm.implicit.following), at the end of the step, and body forces in its middle, to `push` (A, D) [N]."""
    raise TypeError(f"no implicit mechanics with {type(source).__name__}")


@role
def still_force(area, load, p, c):
    """Of the force of particle p what does not follow the surface [N]."""
    raise TypeError(f"no tractions by {type(area).__name__}")


@still_force.register(Nominal)
def still_force_nominal(area, load, p, c):
    return load.force[p, c]


@still_force.register(Present)
def still_force_present(area, load, p, c):
    return area.still[p, c] - area.press[p, c] - area.pull[p, c] - (area.hoop[p] if c == 0 else 0.0)


@role
def still_moment(area, load, p, c, a):
    """Of the moment of particle p what does not follow the surface [N m]."""
    raise TypeError(f"no tractions by {type(area).__name__}")


@still_moment.register(Nominal)
def still_moment_nominal(area, load, p, c, a):
    return load.dipole[p, c, a]


@still_moment.register(Present)
def still_moment_present(area, load, p, c, a):
    return area.moment[p, c, a] - area.press_moment[p, c, a] - area.pull_moment[p, c, a]


@loads.register(NoSource)
def loads_no_source(source, body, nodes, push, dt):
    return None


@loads.register(Load)
def loads_load(source, body, nodes, push, dt):
    D = push.shape[1]
    for p in range(nodes.w.shape[0]):
        if not source.loaded[p]:
            continue
        turn(source.area, source, p, body.particles.J[p], D)
        now = share(source.ramp, source.t[p] + dt, 1.0)
        for k in range(nodes.w.shape[1]):
            for c in range(D):
                force = still_force(source.area, source, p, c) * nodes.w[p, k]
                for d in range(D):
                    for a in range(D):
                        force += still_moment(source.area, source, p, c, a) * source.F[p, d, a] * nodes.g[p, k, d]
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


@kernel
def pull_nodes(body, nodes, push, dt):
    """`loads`, compiled: a role that Python calls is not."""
    loads(body.source, body, nodes, push, dt)


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
    average_volumes(nodes.spans, space, body, nodes, u)
    for p in range(x.shape[0]):
        A, extra = increment(space, nodes, u, x, p), extra_strain(nodes.spans, p)
        _, axes, trace, d, size, grow, sound = trial(space, particles.B, A, extra, p)
        J = particles.J[p] * (1.0 + grow)
        if not sound or not 1e-3 < J < 1e3:
            report[CODE], report[PARTICLE] = INVERTED if not sound else OVERSTRETCHED, p
            return
        theta = condition(body.setting, body.thermal, p)
        thermal = thermal_stress(body.expansion, body.thermal, p, theta)
        elastic = warmed(body.elastic, theta)
        _, pressure, part, _, _, _, lost, _ = tangent(settled(body.flow, particles.J[p]), elastic, trace, size, thermal, theta, dt)
        before = trace - math.log1p(grow)
        if lost > 0.0:
            lam, mu = moduli(elastic)
            mean = (thermal - pressure) / (3.0 * lam + 2.0 * mu)
            found = compose(space, math.expm1(2.0 * (mean + part * d[0])), math.expm1(2.0 * (mean + part * d[1])), math.expm1(2.0 * (mean + part * d[2])), axes)
            trace = 3.0 * mean
        else:
            found = pushed(space, particles.B, A, p)
            if extra != 0.0:
                found = swollen(space, found, extra)
            mean, part = trace / 3.0, 1.0
        keep_b(particles.B, p, found)
        report[STRAIN] = min(report[STRAIN], mean + part * min(d[0], d[1], d[2]))
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
        for a in A:
            report[RATE] = max(report[RATE], abs(a))
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
    one, two = stencil(space.basis, particles.x[p, 0] / h), stencil(space.basis, particles.x[p, min(1, D - 1)] / h)
    three, count = stencil(space.basis, particles.x[p, D - 1] / h), len(one[1])
    for k in range(M):
        i, j, q = (k, 0, 0) if D == 1 else (k // count, k % count, 0) if D == 2 else (k // (count * count), k // count % count, k % count)
        n, w = nodes.node[p, k], nodes.w[p, k] / dt
        for a in range(D):
            v = w * sign(nodes, p, k, a) * u[n, a]
            particles.v[p, a] += v
            particles.C[p, a, 0] += v * one[3][i] * inverse_moment(space.basis) / h
            if D > 1:
                particles.C[p, a, 1] += v * two[3][j] * inverse_moment(space.basis) / h
            if D > 2:
                particles.C[p, a, 2] += v * three[3][q] * inverse_moment(space.basis) / h
