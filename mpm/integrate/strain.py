"""Strains of a chunk of particles from the gathered velocity gradients, eight particles at once (docs/physics.md 4, step 5).

A = dt L;  J <- J det(1 + A);  B <- (1 + A)(1 + B)(1 + A)^T - 1.  With what a particle that cannot answer is told by: see `guard`.
"""

from mpm.jit import kernel
from mpm.lanes import EIGHT, absolute, below, least, load8, maximum, most, peek, poke, splat8, store
from mpm.outcome import INVERTED, OVERSTRETCHED
from mpm.tensors import dilation2, dilation3, push2, push3
from mpm.transfer import CHUNK

CODE, PARTICLE, STEP, SPEED, RATE, STRAIN, SWELL, HEATED, DISSIPATED, WORKED, SWELLED, SOURCED, REPORT = range(13)  # places in the report
LARGEST_INCREMENT = 0.5  # largest entry of dt grad v
GROW, JACOBIAN, HOOP = 9, 10, 11  # rows of Chunk.e: det(1 + A) - 1, J, rate of hoop strain. The trial B begins at row 0


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
    elif not largest < LARGEST_INCREMENT or not 1e-3 < J < 1e3:
        fail(report, OVERSTRETCHED, i)


@kernel(inline=True)
def largest_of(A):
    """Largest entry of an increment."""
    found = absolute(A[0])
    for entry in A[1:]:
        found = maximum(found, absolute(entry))
    return found


@kernel(inline=True)
def rest(chunk, count, K):
    """Lanes behind the last particle are at rest."""
    e, n = chunk.e, CHUNK
    for p in range(count, (count + EIGHT - 1) // EIGHT * EIGHT):
        for k in range(K):
            poke(e, k * n + p, 0.0)
        poke(e, JACOBIAN * n + p, 1.0)
        poke(e, HOOP * n + p, 0.0)
        for k in range(chunk.v.shape[0] * chunk.v.shape[0]):
            poke(chunk.L, k * n + p, 0.0)


@kernel(inline=True)
def deliver_plane(particles, chunk, first, count):
    """B of the chunk's particles from rows 0..3 of chunk.e."""
    e, B, n = chunk.e, particles.B, CHUNK
    for p in range(count):
        at = 4 * (first + p)
        poke(B, at, peek(e, p))
        poke(B, at + 1, peek(e, n + p))
        poke(B, at + 2, peek(e, 2 * n + p))
        poke(B, at + 3, peek(e, 3 * n + p))


@kernel(inline=True)
def deliver_volume(particles, chunk, first, count):
    """B of the chunk's particles from rows 0..5 of chunk.e."""
    e, B, n = chunk.e, particles.B, CHUNK
    for p in range(count):
        at = 6 * (first + p)
        poke(B, at, peek(e, p))
        poke(B, at + 1, peek(e, n + p))
        poke(B, at + 2, peek(e, 2 * n + p))
        poke(B, at + 3, peek(e, 3 * n + p))
        poke(B, at + 4, peek(e, 4 * n + p))
        poke(B, at + 5, peek(e, 5 * n + p))


@kernel(inline=True)
def admit(particles, chunk, first, count, dt, rate, swell, good, report):
    """J to the particles, extrema to the report; where one lane was not good, say which particle and why."""
    report[RATE] = max(report[RATE], most(rate))
    report[SWELL] = max(report[SWELL], most(swell))
    if least(good) < 1.0:
        for p in range(count):
            largest = abs(dt * chunk.e[HOOP, p]) if chunk.v.shape[0] == 2 else 0.0
            for c in range(chunk.v.shape[0]):
                for d in range(chunk.v.shape[0]):
                    entry = abs(dt * chunk.L[c, d, p])
                    largest = entry if not entry <= largest else largest
            guard(report, largest, chunk.e[GROW, p], chunk.e[JACOBIAN, p], 0.0, first + p)
    for p in range(count):
        poke(particles.J, first + p, peek(chunk.e, JACOBIAN * CHUNK + p))


@kernel(inline=True)
def strain_plane(particles, chunk, first, count, dt, report):
    """Trial B in rows 0..3 of chunk.e (xx yy zz xy), GROW and J; chunk.e[HOOP] holds the rate of hoop strain."""
    e, L, n, real = chunk.e, chunk.L, CHUNK, chunk.e.dtype.type
    step, one, largest_increment, smallest, greatest = splat8(real(dt)), splat8(real(1)), splat8(real(LARGEST_INCREMENT)), splat8(real(1e-3)), splat8(real(1e3))
    for p in range(count):
        at = 4 * (first + p)
        poke(e, p, peek(particles.B, at))
        poke(e, n + p, peek(particles.B, at + 1))
        poke(e, 2 * n + p, peek(particles.B, at + 2))
        poke(e, 3 * n + p, peek(particles.B, at + 3))
        poke(e, JACOBIAN * n + p, peek(particles.J, first + p))
    rest(chunk, count, 4)
    rate, swell, good = splat8(real(0)), splat8(real(0)), splat8(real(1))
    for p in range(0, count, EIGHT):
        A = (step * load8(L, p), step * load8(L, n + p), step * load8(L, 2 * n + p), step * load8(L, 3 * n + p), step * load8(e, HOOP * n + p))
        B = push2((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p)), A)
        grow, J = dilation2(A), load8(e, JACOBIAN * n + p)
        J = J + J * grow
        largest = largest_of(A)
        good = good * below(-one, grow) * below(largest, largest_increment) * below(smallest, J) * below(J, greatest)
        rate, swell = maximum(largest, rate), maximum(J, swell)
        store(e, p, B[0])
        store(e, n + p, B[1])
        store(e, 2 * n + p, B[2])
        store(e, 3 * n + p, B[3])
        store(e, GROW * n + p, grow)
        store(e, JACOBIAN * n + p, J)
    admit(particles, chunk, first, count, dt, rate, swell, good, report)


@kernel(inline=True)
def strain_volume(particles, chunk, first, count, dt, report):
    """Trial B in rows 0..5 of chunk.e (xx yy zz xy yz xz), GROW and J."""
    e, L, n, real = chunk.e, chunk.L, CHUNK, chunk.e.dtype.type
    step, one, largest_increment, smallest, greatest = splat8(real(dt)), splat8(real(1)), splat8(real(LARGEST_INCREMENT)), splat8(real(1e-3)), splat8(real(1e3))
    for p in range(count):
        at = 6 * (first + p)
        poke(e, p, peek(particles.B, at))
        poke(e, n + p, peek(particles.B, at + 1))
        poke(e, 2 * n + p, peek(particles.B, at + 2))
        poke(e, 3 * n + p, peek(particles.B, at + 3))
        poke(e, 4 * n + p, peek(particles.B, at + 4))
        poke(e, 5 * n + p, peek(particles.B, at + 5))
        poke(e, JACOBIAN * n + p, peek(particles.J, first + p))
    rest(chunk, count, 6)
    rate, swell, good = splat8(real(0)), splat8(real(0)), splat8(real(1))
    for p in range(0, count, EIGHT):
        A = (step * load8(L, p), step * load8(L, n + p), step * load8(L, 2 * n + p), step * load8(L, 3 * n + p), step * load8(L, 4 * n + p),
             step * load8(L, 5 * n + p), step * load8(L, 6 * n + p), step * load8(L, 7 * n + p), step * load8(L, 8 * n + p))  # fmt: skip
        B = push3((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p), load8(e, 4 * n + p), load8(e, 5 * n + p)), A)
        grow, J = dilation3(A), load8(e, JACOBIAN * n + p)
        J = J + J * grow
        largest = largest_of(A)
        good = good * below(-one, grow) * below(largest, largest_increment) * below(smallest, J) * below(J, greatest)
        rate, swell = maximum(largest, rate), maximum(J, swell)
        store(e, p, B[0])
        store(e, n + p, B[1])
        store(e, 2 * n + p, B[2])
        store(e, 3 * n + p, B[3])
        store(e, 4 * n + p, B[4])
        store(e, 5 * n + p, B[5])
        store(e, GROW * n + p, grow)
        store(e, JACOBIAN * n + p, J)
    admit(particles, chunk, first, count, dt, rate, swell, good, report)


@kernel(inline=True)
def increment3(L, p, dt):
    """dt L of a particle of the chunk, as tensors.push3 wants it."""
    xx, xy, xz = dt * L[0, 0, p], dt * L[0, 1, p], dt * L[0, 2, p]
    yx, yy, yz = dt * L[1, 0, p], dt * L[1, 1, p], dt * L[1, 2, p]
    zx, zy, zz = dt * L[2, 0, p], dt * L[2, 1, p], dt * L[2, 2, p]
    return xx, xy, xz, yx, yy, yz, zx, zy, zz
