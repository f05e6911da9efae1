"""Cholesky factorisation of a symmetric positive band, compiled here.

Row j of `band` (N, b + 1) is column j of the lower triangle from the diagonal down, so every inner loop is one contiguous axpy or dot. Columns go in
fours: a load and a store of the rest of the band serve four updates. LAPACK's pbtrf is as fast on one idle thread, and 20 to 500 times slower where its
threads find other work on the cores (measured: 0.9 ms alone, 28 to 700 ms beside two busy processes, for the loaf's 1 482 x 79).
"""

import numpy as np

from mpm.jit import kernel


@kernel
def fill(band, diff, a, first, b, second, idle):
    """band = first * a + second * b from stencils (n, N); one on the diagonal of idle nodes."""
    band[:] = 0.0
    for o in range(len(diff)):
        for i in range(a.shape[1]):
            band[i, diff[o]] = first * a[o, i] + second * b[o, i]
    for i in range(a.shape[1]):
        if idle[i]:
            band[i, 0] = 1.0


@kernel
def column(band, j, reach):
    """Turns column j, already updated, into a column of the factor; false where the pivot is not positive."""
    if not band[j, 0] > 0.0:
        return False
    pivot = np.sqrt(band[j, 0])
    band[j, 0] = pivot
    for i in range(1, reach + 1):
        band[j, i] /= pivot
    return True


@kernel
def factorise(band):
    """In place; the number of the first column without a positive pivot, or -1."""
    n, b = band.shape[0], band.shape[1] - 1
    j = 0
    while j < n:
        fours = j + 4 + b <= n and b >= 4
        block = 4 if fours else 1
        for c in range(block):
            reach = min(b, n - 1 - j - c)
            if not column(band, j + c, reach):
                return j + c
            for k in range(1, block - c):  # the rest of the block
                f = band[j + c, k]
                for i in range(reach - k + 1):
                    band[j + c + k, i] -= f * band[j + c, k + i]
        if fours:
            for k in range(4, b + 4):  # columns after the block; the first of the four reaches j + b, the last j + 3 + b
                f0 = band[j, k] if k <= b else 0.0
                f1 = band[j + 1, k - 1] if k - 1 <= b else 0.0
                f2 = band[j + 2, k - 2] if k - 2 <= b else 0.0
                f3 = band[j + 3, k - 3]
                row = band[j + k]
                r0, r1, r2, r3 = band[j, k:], band[j + 1, k - 1 :], band[j + 2, k - 2 :], band[j + 3, k - 3 :]
                common = b - k + 1
                for i in range(common):
                    row[i] -= f0 * r0[i] + f1 * r1[i] + f2 * r2[i] + f3 * r3[i]
                for i in range(max(common, 0), min(common + 1, b + 1)):
                    if i < len(r1):
                        row[i] -= f1 * r1[i]
                for i in range(max(common, 0), min(common + 2, b + 1)):
                    if i < len(r2):
                        row[i] -= f2 * r2[i]
                for i in range(max(common, 0), min(common + 3, b + 1)):
                    if i < len(r3):
                        row[i] -= f3 * r3[i]
        else:
            reach = min(b, n - 1 - j)
            for k in range(1, reach + 1):
                f = band[j, k]
                for i in range(reach - k + 1):
                    band[j + k, i] -= f * band[j, k + i]
        j += block
    return -1


@kernel
def back_substitute(band, x):
    """x <- (L L^T)^-1 x."""
    n, b = band.shape[0], band.shape[1] - 1
    for j in range(n):
        v = x[j] / band[j, 0]
        x[j] = v
        for i in range(1, min(b, n - 1 - j) + 1):
            x[j + i] -= v * band[j, i]
    for j in range(n - 1, -1, -1):
        s = 0.0
        for i in range(1, min(b, n - 1 - j) + 1):
            s += band[j, i] * x[j + i]
        x[j] = (x[j] - s) / band[j, 0]
