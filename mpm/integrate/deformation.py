"""F <- (1 + dt L) F: the total deformation gradient, carried only where surfaces or loads need it; and its cofactors."""

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


@kernel(inline=True)
def cofactor(F, i, c, k, D):
    """Entry (c, k) of det F F^-T, F (D, D) the entry i: it turns an area vector of the undeformed shape into one of the present (Nanson)."""
    if D == 1:
        return 1.0
    if D == 2:
        return F[i, 1 - c, 1 - k] if c == k else -F[i, 1 - c, 1 - k]
    a, b, p, q = (c + 1) % 3, (c + 2) % 3, (k + 1) % 3, (k + 2) % 3
    return F[i, a, p] * F[i, b, q] - F[i, a, q] * F[i, b, p]
