"""F <- (1 + dt L) F: the total deformation gradient, carried only where surfaces or loads need it."""

from mpm.jit import kernel


@kernel(inline=True)
def carry_one(F, L, i, p, dt, D):
    """Entry i of F, by what p of the chunk gathered."""
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
def carry_owners(F, row, L, first, count, dt, D):
    """Of those among `count` particles that own pieces of surface: row (N,) says which of F (R, D, D) is a particle's, -1 that it has none."""
    for p in range(count):
        i = row[first + p]
        if i >= 0:
            carry_one(F, L, i, p, dt, D)
