"""F <- (1 + dt L) F: the total deformation gradient, carried only where surfaces or loads need it."""

from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, load8, peek, poke, splat8, store


@kernel
def carry_one(F, L, i, p, dt, D):
    """Of particle i, which is p of the chunk."""
    for d in range(D):
        f0, f1, f2 = F[i, 0, d], F[i, min(1, D - 1), d], F[i, D - 1, d]
        for c in range(D):
            change = L[c, 0, p] * f0
            if D > 1:
                change += L[c, 1, p] * f1
            if D > 2:
                change += L[c, 2, p] * f2
            F[i, c, d] += dt * change


@kernel(inline=True)
def carry_all(F, chunk, first, count, dt, D):
    """Of `count` particles, eight at once, in D directions (written down, so that LLVM unrolls them); overwrites rows below D^2 of chunk.e."""
    e, L, n = chunk.e, chunk.L, chunk.e.shape[1]
    step = splat8(e.dtype.type(dt))
    for p in range(count):
        at = D * D * (first + p)
        for k in range(D * D):
            poke(e, k * n + p, peek(F, at + k))
    for p in range(0, count, EIGHT):
        for d in range(D):
            f0, f1, f2 = load8(e, d * n + p), load8(e, (min(1, D - 1) * D + d) * n + p), load8(e, ((D - 1) * D + d) * n + p)
            for c in range(D):
                change = load8(L, c * D * n + p) * f0
                if D > 1:
                    change = fma(load8(L, (c * D + 1) * n + p), f1, change)
                if D > 2:
                    change = fma(load8(L, (c * D + 2) * n + p), f2, change)
                at = (c * D + d) * n + p
                store(e, at, fma(step, change, load8(e, at)))
    for p in range(count):
        at = D * D * (first + p)
        for k in range(D * D):
            poke(F, at + k, peek(e, k * n + p))
