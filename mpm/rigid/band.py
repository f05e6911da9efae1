"""Cholesky factorisation of a symmetric positive band, compiled here.

Row j of `band` is column j of the lower triangle from the diagonal down (of the factor, with 1 over the diagonal), then zeros: every inner loop is one
contiguous axpy or dot of whole lanes (mpm.lanes), which may run over into the zeros. Columns go in fours: a load and a store of the rest of the band serve
four updates. LAPACK's pbtrf is as fast on one idle thread, and 20 to 500 times slower where its threads find other work on the cores (measured: 0.9 ms
alone, 28 to 700 ms beside two busy processes, for the loaf's 1 482 x 79).
"""

import numpy as np

from mpm.jit import kernel
from mpm.lanes import EIGHT, fma, high, item, load8, low, splat8, store, transposed

FOUR = 4  # columns at once
OVER = FOUR + EIGHT  # numbers that lanes may run over


def make_band(size: int, reach: int) -> np.ndarray:
    """Room for `size` columns of `reach` numbers below the diagonal (rows, width), zeros where nothing will be: whole lanes, and as many rows below."""
    width = -(-(reach + OVER) // EIGHT) * EIGHT
    return np.zeros((size + width, width))


@kernel
def fill(band, diff, a, first, b, second, idle):
    """band = first * a + second * b from stencils (n, N); one on the diagonal of idle nodes."""
    n = a.shape[1]
    band[:] = 0.0
    for o in range(len(diff)):
        for i in range(n):
            band[i, diff[o]] = first * a[o, i] + second * b[o, i]
    for i in range(n):
        if idle[i]:
            band[i, 0] = 1.0


@kernel(inline=True)
def column(band, j, over):
    """Turns column j, already updated, into a column of the factor with 1 over its pivot; false where that is not positive. over: how many numbers count."""
    if not band[j, 0] > 0.0:
        return False
    inverse, at = 1.0 / np.sqrt(band[j, 0]), j * band.shape[1]
    every = splat8(inverse)
    for i in range(0, over, EIGHT):
        store(band, at + i, load8(band, at + i) * every)
    band[j, 0] = inverse
    return True


@kernel
def factorise(band, n, b):
    """The first n columns with b numbers below the diagonal, in place; the number of the first column without a positive pivot, or -1."""
    width = band.shape[1]
    for j in range(0, n, FOUR):
        block = min(FOUR, n - j)
        for c in range(block):
            if not column(band, j + c, b + 1):
                return j + c
            one = (j + c) * width
            for k in range(1, min(block - c, b + 1)):  # the rest of the block
                f, row = splat8(-band[j + c, k]), (j + c + k) * width
                for i in range(0, b + 1 - k, EIGHT):
                    store(band, row + i, fma(f, load8(band, one + k + i), load8(band, row + i)))
        if block < FOUR:
            break
        for k in range(FOUR, b + FOUR):  # columns after the block; the first of the four reaches j + b, the last j + 3 + b
            row, at = (j + k) * width, j * width + k
            f0, f1 = splat8(-band[j, k]), splat8(-band[j + 1, k - 1])
            f2, f3 = splat8(-band[j + 2, k - 2]), splat8(-band[j + 3, k - 3])
            for i in range(0, b + FOUR - k, EIGHT):
                rest = fma(f0, load8(band, at + i), load8(band, row + i))
                rest = fma(f1, load8(band, at + width - 1 + i), rest)
                rest = fma(f2, load8(band, at + 2 * width - 2 + i), rest)
                store(band, row + i, fma(f3, load8(band, at + 3 * width - 3 + i), rest))
    return -1


@kernel(inline=True)
def sums(a, b, c, d):
    """The sum of each of four eights."""
    p, q, r, s = transposed(low(a) + high(a), low(b) + high(b), low(c) + high(c), low(d) + high(d))
    total = (p + q) + (r + s)
    return item(total, 0), item(total, 1), item(total, 2), item(total, 3)


@kernel
def back_substitute(band, b, x):
    """x <- (L L^T)^-1 x, by the factor of len(x) columns with b numbers below the diagonal."""
    n, width = len(x), band.shape[1]
    fours = n - n % FOUR
    y = np.zeros(n + width)
    for j in range(n):
        y[j] = x[j]
    for j in range(0, fours, FOUR):
        at = j * width
        y0 = y[j] * band[j, 0]
        y1 = (y[j + 1] - y0 * band[j, 1]) * band[j + 1, 0]
        y2 = (y[j + 2] - y0 * band[j, 2] - y1 * band[j + 1, 1]) * band[j + 2, 0]
        y3 = (y[j + 3] - y0 * band[j, 3] - y1 * band[j + 1, 2] - y2 * band[j + 2, 1]) * band[j + 3, 0]
        y[j], y[j + 1], y[j + 2], y[j + 3] = y0, y1, y2, y3
        f0, f1, f2, f3 = splat8(-y0), splat8(-y1), splat8(-y2), splat8(-y3)
        for k in range(FOUR, b + FOUR, EIGHT):
            rest = fma(f0, load8(band, at + k), load8(y, j + k))
            rest = fma(f1, load8(band, at + width - 1 + k), rest)
            rest = fma(f2, load8(band, at + 2 * width - 2 + k), rest)
            store(y, j + k, fma(f3, load8(band, at + 3 * width - 3 + k), rest))
    for j in range(fours, n):
        y[j] *= band[j, 0]
        for i in range(1, min(b, n - 1 - j) + 1):
            y[j + i] -= y[j] * band[j, i]
    for j in range(n - 1, fours - 1, -1):
        s = 0.0
        for i in range(1, min(b, n - 1 - j) + 1):
            s += band[j, i] * y[j + i]
        y[j] = (y[j] - s) * band[j, 0]
    for i in range(n, n + width):
        y[i] = 0.0
    none = splat8(0.0)
    for j in range(fours - FOUR, -1, -FOUR):
        at, s0, s1, s2, s3 = j * width, none, none, none, none
        for k in range(FOUR, b + FOUR, EIGHT):
            part = load8(y, j + k)
            s0, s1 = fma(load8(band, at + k), part, s0), fma(load8(band, at + width - 1 + k), part, s1)
            s2, s3 = fma(load8(band, at + 2 * width - 2 + k), part, s2), fma(load8(band, at + 3 * width - 3 + k), part, s3)
        t0, t1, t2, t3 = sums(s0, s1, s2, s3)
        y[j + 3] = (y[j + 3] - t3) * band[j + 3, 0]
        y[j + 2] = (y[j + 2] - t2 - y[j + 3] * band[j + 2, 1]) * band[j + 2, 0]
        y[j + 1] = (y[j + 1] - t1 - y[j + 2] * band[j + 1, 1] - y[j + 3] * band[j + 1, 2]) * band[j + 1, 0]
        y[j] = (y[j] - t0 - y[j + 1] * band[j, 1] - y[j + 2] * band[j, 2] - y[j + 3] * band[j, 3]) * band[j, 0]
    for j in range(n):
        x[j] = y[j]
