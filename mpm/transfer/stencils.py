"""Stencils of a chunk of particles for quadratic B-splines, eight particles at once; basis/quadratic.py has the formulas.

Rows of `s`, by direction: three weights, three gradients [1/m], place f within the middle cell, -1/2..1/2 [cells], offset of the first node [m], its index.
"""

from mpm.jit import kernel
from mpm.lanes import EIGHT, floor, least, load8, maximum, minimum, most, splat8, store
from mpm.state import PAD

CHUNK = 64  # particles that pass together: their scratch (45 kB in 3-D float64) stays close to the first-level cache
W, G, WITHIN, OFFSET, FIRST, ROWS = 0, 3, 6, 7, 8, 9


@kernel(inline=True)
def stencil_chunk(space, place, count, s):
    """Fill s (D, ROWS, n) from place (D, n), the positions of a chunk."""
    real, n = place.dtype.type, CHUNK
    h, inverse = splat8(real(space.h)), splat8(real(1.0 / space.h))
    half, three_quarters, one, two, pad = splat8(real(0.5)), splat8(real(0.75)), splat8(real(1)), splat8(real(2)), splat8(real(PAD - 1))
    for d in range(place.shape[0]):
        row = d * ROWS * n
        for p in range(0, count, EIGHT):
            at = load8(place, d * n + p) * inverse
            nearest = floor(at + half)
            f = at - nearest
            left, right = half - f, half + f
            w0, w1, w2 = half * left * left, three_quarters - f * f, half * right * right
            store(s, row + W * n + p, w0)
            store(s, row + (W + 1) * n + p, w1)
            store(s, row + (W + 2) * n + p, w2)
            store(s, row + WITHIN * n + p, f)
            store(s, row + G * n + p, -inverse * left)
            store(s, row + (G + 1) * n + p, -two * inverse * f)
            store(s, row + (G + 2) * n + p, inverse * right)
            store(s, row + OFFSET * n + p, -h * (one + f))
            store(s, row + FIRST * n + p, nearest + pad)


@kernel(inline=True)
def widen(s, count, box):
    """`box` (D, 2) grows to the nodes that the stencils of a chunk touch."""
    for d in range(s.shape[0]):
        row = (d * ROWS + FIRST) * CHUNK
        leftmost = rightmost = load8(s, row)
        for p in range(EIGHT, count, EIGHT):
            first = load8(s, row + p)
            leftmost, rightmost = minimum(first, leftmost), maximum(first, rightmost)
        box[d, 0], box[d, 1] = min(box[d, 0], int(least(leftmost))), max(box[d, 1], int(most(rightmost)) + 3)
