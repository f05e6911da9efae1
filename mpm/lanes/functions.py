"""Exponential and logarithm over lanes, to a few ulp: polynomials after the power of two is taken off. No library is called.

logarithm(x)  normal x > 0; elsewhere no number to rely on, but NaN stays NaN
log1p(x)      x > -1 and below 2^1000 (float32: 2^120); elsewhere no number to rely on, but NaN stays NaN
expm1(x)      any x; below -700 (float32: -85) -1, above 700 (85) what that gives
exponential(x) the same, exp(x) itself precise where it is small

A number instead of lanes goes to the library. Source of the polynomial of the logarithm: fdlibm (Sun Microsystems 1993), s_log1p.c; of the exponential:
its Taylor series on |r| <= ln(2)/2.
"""

import math

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import overload

from mpm.jit import kernel
from mpm.lanes.arithmetic import absolute, floor, fma, like, named
from mpm.lanes.kinds import LanesType, one, operation
from mpm.lanes.order import below, maximum, minimum, precision

SERIES = tuple(1.0 / math.factorial(n) for n in range(13, 1, -1))
LOGARITHM = (
    1.479819860511658591e-01, 1.531383769920937332e-01, 1.818357216161805012e-01, 2.222219843214978396e-01,
    2.857142874366239149e-01, 3.999999999940941908e-01, 6.666666666666735130e-01,
)  # fmt: skip
LN2, LN2_HIGH, LN2_LOW = math.log(2.0), 6.93145751953125e-1, 1.42860682030941723212e-6  # HIGH has 11 bits: times k it is exact, in float32 too


def exponent(a):
    """k, so that a/2^k lies within 1/sqrt 2 and sqrt 2, of positive lanes."""
    k = np.frexp(a / math.sqrt(0.5))[1] - 1
    return k.astype(a.dtype)


def power(k):
    """2^k of lanes of whole numbers within the exponents of the type."""
    return np.ldexp(np.ones_like(k), k.astype(np.int64))


def bits(kind):
    """Integer lanes of the type, bits of a fraction, bias."""
    width, fraction, bias = (64, 52, 1023) if kind.dtype == types.float64 else (32, 23, 127)
    made = ir.VectorType(ir.IntType(width), kind.count)
    return made, (lambda number: ir.Constant(made, [number] * kind.count)), fraction, bias


@operation(exponent, one, LanesType)
def exponent_compiled(context, builder, signature, arguments):
    kind = signature.return_type
    made, number, fraction, _ = bits(kind)
    root = np.array(math.sqrt(0.5), np.float64 if fraction == 52 else np.float32)
    start = int(root.view(np.int64 if fraction == 52 else np.int32))
    k = builder.ashr(builder.sub(builder.bitcast(arguments[0], made), number(start)), number(fraction))
    return builder.sitofp(k, kind.llvm)


@operation(power, one, LanesType)
def power_compiled(context, builder, signature, arguments):
    kind = signature.return_type
    made, number, fraction, bias = bits(kind)
    k = builder.fptosi(arguments[0], made)
    return builder.bitcast(builder.shl(builder.add(k, number(bias)), number(fraction)), kind.llvm)


def as_written(a, b, c):
    """a b + c that LLVM may not re-associate with its neighbours."""
    return a * b + c


operation(as_written, lambda a, b, c: a if one(a) and a == b == c else None, *[LanesType] * 3)(named("fmuladd", ()))


@kernel(inline=True)
def polynomial(x, coefficients):
    """Horner's rule, the highest coefficient first."""
    y = like(x, coefficients[0])
    for c in coefficients[1:]:
        y = fma(y, x, like(x, c))
    return y


@kernel(inline=True)
def felt(x):
    """x, or zero where its square is not felt beside it: then no product falls among float32's subnormals, which are slow."""
    return x * below(0.001 * precision(x), absolute(x))


@kernel(inline=True)
def log1p_lanes(x, most):
    one = like(x, 1.0)
    k = exponent(one + x)
    shrink = power(-k)
    return from_one(k, as_written(x, shrink, as_written(shrink, one, -one)))  # (1 + x)/2^k - 1, rounded once; x itself where k = 0


@kernel(inline=True)
def logarithm_lanes(x, most):
    one = like(x, 1.0)
    k = exponent(x)
    return from_one(k, as_written(x, power(-k), -one))


@kernel(inline=True)
def from_one(k, f):
    """k ln 2 + log(1 + f) of a small f."""
    g = felt(f)
    s = g / (2.0 + g)
    z = s * s
    half = 0.5 * g * g
    return fma(k, like(k, LN2), f - (half - s * (half + z * polynomial(z, LOGARITHM))))


@kernel(inline=True)
def reduced(x):
    """k and exp(r) - 1 for x = k ln 2 + r."""
    k = floor(x * (1.0 / LN2) + 0.5)
    r = as_written(-k, like(x, LN2_LOW), as_written(-k, like(x, LN2_HIGH), x))
    g = felt(r)
    return k, fma(g * g, polynomial(r, SERIES), r)


@kernel(inline=True)
def expm1_lanes(x, most):
    x = maximum(like(x, -most), minimum(like(x, most), x))  # in this order a NaN stays
    k, p = reduced(x)
    scale = power(k)
    return fma(scale, p, scale - 1.0)


@kernel(inline=True)
def exponential_lanes(x, most):
    x = maximum(like(x, -most), minimum(like(x, most), x))  # in this order a NaN stays
    k, p = reduced(x)
    scale = power(k)
    return fma(scale, p, scale)


def logarithm(x):
    return np.log(x)


def log1p(x):
    return np.log1p(x)


def expm1(x):
    return np.expm1(x)


def exponential(x):
    return np.exp(x)


def generic(function, lanes, number, double, single):
    """Let compiled code call `function`: lanes go to our own, clamped to what the exponents of their type reach, numbers to the library."""

    @overload(function, inline="always")
    def compiled(x):
        if not isinstance(x, LanesType):
            return lambda x: number(x)  # noqa: PLW0108 - Numba wants a Python function
        most = double if x.dtype == types.float64 else single
        return lambda x: lanes(x, most)


generic(logarithm, logarithm_lanes, math.log, 2.0**1000, 2.0**120)
generic(log1p, log1p_lanes, math.log1p, 2.0**1000, 2.0**120)
generic(expm1, expm1_lanes, math.expm1, 700.0, 85.0)
generic(exponential, exponential_lanes, math.exp, 700.0, 85.0)
