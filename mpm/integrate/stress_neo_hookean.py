"""Neo-Hookean response, eight particles at once: tau = mu B + lam J (J - 1) 1, straight from B and J (mpm.materials.neo_hookean)."""

from mpm.integrate.strain import JACOBIAN, STRAIN, deliver_plane, deliver_volume
from mpm.integrate.stress_hencky import ACROSS, carry_surface, stress_plane, stress_volume
from mpm.lanes import EIGHT, absolute, fma, load8, maximum, most, splat8, store
from mpm.materials import NeoHookean
from mpm.transfer import CHUNK


@stress_plane.register(NeoHookean)
def stress_plane_neo_hookean(elastic, body, chunk, first, count, dt, report):
    deliver_plane(body.particles, chunk, first, count)
    e, S, n, real = chunk.e, chunk.S, CHUNK, chunk.e.dtype.type
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
    carry_surface(body.surface, chunk, first, count, dt, 2)


@stress_volume.register(NeoHookean)
def stress_volume_neo_hookean(elastic, body, chunk, first, count, dt, report):
    deliver_volume(body.particles, chunk, first, count)
    e, S, n, real = chunk.e, chunk.S, CHUNK, chunk.e.dtype.type
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
    carry_surface(body.surface, chunk, first, count, dt, 3)
