"""Half the logarithm and the exponential of symmetric tensors over lanes, without principal axes where strains are moderate.

An isotropic function of a tensor is a polynomial in it, c0 + c1 Y + c2 Y^2, and powers above come back by Cayley and Hamilton: for a traceless Y
    Y^3 = -second Y + third,   second = -1/2 Y:Y,   third = det Y
so only numbers are summed, and no axis, root or library function is asked for. Lanes with a larger deviator take the way through the axes (tensors.eigen3).
Components   volume (xx, yy, zz, xy, yz, xz), as everywhere
Accuracy     a few ulp of the largest entry; small tensors keep their own relative precision
"""

import math

import numpy as np

from mpm.jit import kernel
from mpm.lanes import absolute, below, expm1, fma, least, like, log1p, maximum, minimum, sqrt
from mpm.tensors import compose3, eigen3


def nodes(n):
    """Gauss and Legendre's n points and weights on 0..1, in pairs: log(1 + z) = integral of z/(1 + x z)."""
    x, w = np.polynomial.legendre.leggauss(n)
    x, w = (0.5 * x + 0.5).tolist(), (0.5 * w).tolist()
    return tuple(zip(x[::2], x[1::2], w[::2], w[1::2], strict=True))


FEW, MANY = nodes(8), nodes(16)
NEAR, FAR = 0.33, 0.72  # principal deviators of B over 1 + its mean, up to which eight and sixteen points are exact to round-off
FACTORIALS = tuple(1.0 / math.factorial(n) for n in range(18, 0, -1))
EXPONENTIAL = 1.2  # largest principal deviator whose powers over 18 are below round-off
ACROSS = math.sqrt(2.0 / 3.0)  # largest principal value of a deviator of norm 1
FIRST, SECOND = 1e-17, 1e-9  # deviators below these have no square, no cube: no product falls among float32's subnormals, which are slow


@kernel(inline=True)
def largest(Y):
    """Largest sum of a row: no principal value is above."""
    xy, yz, xz = absolute(Y[3]), absolute(Y[4]), absolute(Y[5])
    return maximum(maximum(absolute(Y[0]) + xy + xz, absolute(Y[1]) + xy + yz), absolute(Y[2]) + xz + yz)


@kernel(inline=True)
def kept(Y, size, least):
    """Y, or zero where it is smaller than `least`."""
    keep = below(like(size, least), size)
    return keep * Y[0], keep * Y[1], keep * Y[2], keep * Y[3], keep * Y[4], keep * Y[5]


@kernel(inline=True)
def square(Y):
    """Y Y."""
    xx, yy, zz, xy, yz, xz = Y
    return (
        fma(xx, xx, fma(xy, xy, xz * xz)), fma(yy, yy, fma(xy, xy, yz * yz)), fma(zz, zz, fma(xz, xz, yz * yz)),
        fma(xx + yy, xy, xz * yz), fma(yy + zz, yz, xy * xz), fma(xx + zz, xz, xy * yz),
    )  # fmt: skip


@kernel(inline=True)
def determinant(Y):
    xx, yy, zz, xy, yz, xz = Y
    return fma(xx, fma(yy, zz, -(yz * yz)), fma(xy, fma(yz, xz, -(xy * zz)), xz * fma(xy, yz, -(yy * xz))))


@kernel(inline=True)
def powers(Y, size):
    """(Y^2, second, third) of a traceless Y of `largest` row sum `size`."""
    Y2 = square(kept(Y, size, FIRST))
    return Y2, -0.5 * (Y2[0] + Y2[1] + Y2[2]), determinant(kept(Y, size, SECOND))


@kernel(inline=True)
def combined(c0, c1, c2, Y, Y2):
    """c0 + c1 Y + c2 Y^2."""
    return (
        fma(c1, Y[0], fma(c2, Y2[0], c0)), fma(c1, Y[1], fma(c2, Y2[1], c0)), fma(c1, Y[2], fma(c2, Y2[2], c0)),
        fma(c1, Y[3], c2 * Y2[3]), fma(c1, Y[4], c2 * Y2[4]), fma(c1, Y[5], c2 * Y2[5]),
    )  # fmt: skip


@kernel(inline=True)
def split(B):
    """Mean of the diagonal, deviator."""
    xx, yy, zz, xy, yz, xz = B
    mean = (xx + yy + zz) * (1.0 / 3.0)
    third = 1.0 / 3.0
    return mean, (((xx - yy) + (xx - zz)) * third, ((yy - xx) + (yy - zz)) * third, ((zz - xx) + (zz - yy)) * third, xy, yz, xz)


@kernel(inline=True)
def norm(Y, size):
    """Root of Y:Y of a tensor of `largest` row sum `size`."""
    xx, yy, zz, xy, yz, xz = kept(Y, size, FIRST)
    return sqrt(fma(xx, xx, fma(yy, yy, zz * zz)) + 2.0 * fma(xy, xy, fma(yz, yz, xz * xz)))


@kernel(inline=True)
def logarithm_by_powers(mean, Y, size, points):
    """1/2 log(1 + B), B = mean + (1 + mean) Y."""
    Y2, second, third = powers(Y, size)
    one = like(mean, 1.0)
    c0, c1, c2 = like(mean, 0.0), like(mean, 0.0), like(mean, 0.0)
    for x1, x2, w1, w2 in points:
        d1 = fma(fma(third, like(mean, x1), second), like(mean, x1 * x1), one)  # det(1 + x Y)
        d2 = fma(fma(third, like(mean, x2), second), like(mean, x2 * x2), one)
        inverse = 1.0 / (d1 * d2)  # of two at once: divisions are what costs
        f1, f2 = (w1 * d2) * inverse, (w2 * d1) * inverse
        c1 = c1 + (f1 + f2)
        g1, g2 = x1 * f1, x2 * f2
        c2 = c2 - (g1 + g2)
        c0 = c0 + (x1 * g1 + x2 * g2)
    return combined(0.5 * fma(c0, third, log1p(mean)), 0.5 * c1, 0.5 * c2, Y, Y2)


@kernel(inline=True)
def logarithm3(B):
    """(1/2 log(1 + B), a number above -1 where all principal values of B are)."""
    mean, D = split(B)
    inverse = 1.0 / (1.0 + mean)
    Y = (D[0] * inverse, D[1] * inverse, D[2] * inverse, D[3] * inverse, D[4] * inverse, D[5] * inverse)
    size, sound = largest(Y), below(like(mean, -1.0), mean)
    if least(sound * below(size, like(size, NEAR))) > 0.5:
        return logarithm_by_powers(mean, Y, size, FEW), mean
    if least(sound * below(size, like(size, FAR))) > 0.5:
        return logarithm_by_powers(mean, Y, size, MANY), mean
    l1, l2, l3, ax, ay, az, bx, by, bz, _, _, _ = eigen3(B[0], B[1], B[2], B[3], B[4], B[5])
    return compose3(0.5 * log1p(l1), 0.5 * log1p(l2), 0.5 * log1p(l3), ax, ay, az, bx, by, bz), minimum(minimum(l1, l2), l3)


@kernel(inline=True)
def exponential3(mean, D):
    """exp(2 (mean + D)) - 1 of a strain with deviator D."""
    Y = (2.0 * D[0], 2.0 * D[1], 2.0 * D[2], 2.0 * D[3], 2.0 * D[4], 2.0 * D[5])
    size, grow = largest(Y), expm1(2.0 * mean)
    scale = 1.0 + grow
    if least(below(size, like(size, EXPONENTIAL))) > 0.5:
        Y2, second, third = powers(Y, size)
        a, b, c = like(mean, 0.0), like(mean, 0.0), like(mean, 0.0)
        for factor in FACTORIALS:  # (a Y^2 + b Y + c) + factor, times Y
            a, b, c = b, fma(-second, a, c + factor), third * a
        return combined(fma(scale, c, grow), scale * b, scale * a, Y, Y2)
    l1, l2, l3, ax, ay, az, bx, by, bz, _, _, _ = eigen3(D[0] + mean, D[1] + mean, D[2] + mean, D[3], D[4], D[5])
    return compose3(expm1(2.0 * l1), expm1(2.0 * l2), expm1(2.0 * l3), ax, ay, az, bx, by, bz)


@kernel(inline=True)
def lowest3(e, mean, size):
    """A lower bound of the principal values of a strain of that mean and norm of its deviator: the better of two, the other by Gershgorin's rows."""
    xy, yz, xz = absolute(e[3]), absolute(e[4]), absolute(e[5])
    return maximum(mean - ACROSS * size, minimum(minimum(e[0] - xy - xz, e[1] - xy - yz), e[2] - yz - xz))
