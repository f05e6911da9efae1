"""Functions of temperature that a parameter may be: constant, table, bump (latent heat), logistic step.

Every kind knows its value, its exact primitive over temperature (the specific enthalpy of a specific heat) and the inverse of that, so that
heat can be kept as enthalpy and no step jumps over latent heat (docs/physics.md 10). theta in K throughout; values are run-time arguments.
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.lanes import absolute, below, choose, exponential, like
from mpm.materials.roles import enthalpy, temperature_of, value

SQRT2 = math.sqrt(2.0)
SQRT2PI = math.sqrt(2.0 * math.pi)


class Constant(NamedTuple):
    """The same at every temperature."""

    constant: float


class Bump(NamedTuple):
    """base + heat/(width sqrt(2 pi)) exp(-(theta - at)^2/(2 width^2)): `heat` is absorbed around `at`, two thirds of it within +- width.

    Good values  width of 0.5 to 3 K for boiling water in dough; the cell and the step must resolve the front it makes, not the bump.
    Fails when   base, or with heat < 0 the lowest value, is not positive: then the inverse of its enthalpy is not unique.
    """

    base: float
    heat: float  # integral of the bump: J/kg for a specific heat
    at: float  # [K]
    width: float  # standard deviation [K]


class Logistic(NamedTuple):
    """low + (high - low)/(1 + exp(-(theta - at)/width)): `low` when cold, `high` when hot, 90 % of the change within +- 3 widths."""

    low: float
    high: float
    at: float  # [K]
    width: float  # [K]


class Table(NamedTuple):
    """Piecewise polynomial through points, flat beyond its ends. Make one with `table`."""

    theta: np.ndarray  # (n,) rising temperatures [K]
    c: np.ndarray  # (n - 1, 4) value = c0 + c1 u + c2 u^2 + c3 u^3, u = theta - theta_k
    h: np.ndarray  # (n,) primitive at the points, 0 at the first


LAWS = (Constant, Table, Bump, Logistic)


def table(temperature, value, interpolation="linear"):
    """A `Table` through (temperature [K], value): `linear`, `pchip`, which is smooth and stays between neighbouring values (Fritsch & Butland 1984), or
    `smooth`, 3 s^2 - 2 s^3 of the way from each to the next: level at the points."""
    x, y = np.array(temperature, dtype=np.float64), np.array(value, dtype=np.float64)
    if x.ndim != 1 or x.shape != y.shape or len(x) < 2:
        raise ValueError(f"a table needs as many values as temperatures, two or more: got {x.size} temperatures and {y.size} values")
    if not (np.isfinite(x).all() and np.isfinite(y).all() and (np.diff(x) > 0).all()):
        raise ValueError("the temperatures of a table must rise, and all its numbers be finite")
    if interpolation not in ("linear", "pchip", "smooth"):
        raise ValueError(f"interpolation {interpolation!r}: allowed are 'linear', 'pchip' and 'smooth'")
    w, rise = np.diff(x), np.diff(y) / np.diff(x)
    c = np.zeros((len(w), 4))
    c[:, 0], c[:, 1] = y[:-1], rise
    if interpolation == "smooth" or (interpolation == "pchip" and len(w) > 1):
        slope = np.zeros(len(x)) if interpolation == "smooth" else pchip_slopes(w, rise)
        c[:, 1] = slope[:-1]
        c[:, 2] = (3.0 * rise - 2.0 * slope[:-1] - slope[1:]) / w
        c[:, 3] = (slope[:-1] + slope[1:] - 2.0 * rise) / w**2
    pieces = w * (c[:, 0] + w * (c[:, 1] / 2 + w * (c[:, 2] / 3 + w * c[:, 3] / 4)))
    return Table(x, c, np.concatenate([[0.0], np.cumsum(pieces)]))


def pchip_slopes(w, rise):
    """Slopes at the points: weighted harmonic means inside, three-point formula kept monotone at the ends."""
    slope = np.zeros(len(w) + 1)
    same = rise[:-1] * rise[1:] > 0
    a, b = 2 * w[1:] + w[:-1], w[1:] + 2 * w[:-1]
    slope[1:-1][same] = (a + b)[same] / (a[same] / rise[:-1][same] + b[same] / rise[1:][same])
    for end, w0, w1, r0, r1 in ((0, w[0], w[1], rise[0], rise[1]), (-1, w[-1], w[-2], rise[-1], rise[-2])):
        s = ((2 * w0 + w1) * r0 - w0 * r1) / (w0 + w1)
        if s * r0 <= 0:
            s = 0.0
        elif r0 * r1 < 0 and abs(s) > 3 * abs(r0):
            s = 3 * r0
        slope[end] = s
    return slope


@kernel(inline=True)
def piece(x, at):
    """The k with x[k] <= at < x[k + 1], clipped to the first and last piece."""
    low, high = 0, len(x) - 1
    while high - low > 1:
        k = (low + high) // 2
        if x[k] <= at:
            low = k
        else:
            high = k
    return low


@value.register(Constant)
def value_constant(law, theta):
    return law.constant


@value.register(Bump)
def value_bump(law, theta):
    z = (theta - law.at) / law.width
    return law.base + law.heat / (law.width * SQRT2PI) * exponential(-0.5 * z * z)


@value.register(Logistic)
def value_logistic(law, theta):
    z = (theta - law.at) / law.width
    tail = exponential(-absolute(z))  # never overflows
    return law.low + (law.high - law.low) * (choose(below(z, like(z, 0.0)), tail, like(z, 1.0)) / (1.0 + tail))


@value.register(Table)
def value_table(law, theta):
    k = piece(law.theta, theta)
    u = min(max(theta, law.theta[0]), law.theta[-1]) - law.theta[k]
    return law.c[k, 0] + u * (law.c[k, 1] + u * (law.c[k, 2] + u * law.c[k, 3]))


@enthalpy.register(Constant)
def enthalpy_constant(law, theta):
    return law.constant * theta


@enthalpy.register(Bump)
def enthalpy_bump(law, theta):
    return law.base * theta + 0.5 * law.heat * (1.0 + math.erf((theta - law.at) / (law.width * SQRT2)))


@enthalpy.register(Logistic)
def enthalpy_logistic(law, theta):
    z = (theta - law.at) / law.width
    return law.low * theta + (law.high - law.low) * law.width * (max(z, 0.0) + math.log1p(math.exp(-abs(z))))


@enthalpy.register(Table)
def enthalpy_table(law, theta):
    k = piece(law.theta, theta)
    inside = min(max(theta, law.theta[0]), law.theta[-1])
    u = inside - law.theta[k]
    h = law.h[k] + u * (law.c[k, 0] + u * (law.c[k, 1] / 2.0 + u * (law.c[k, 2] / 3.0 + u * (law.c[k, 3] / 4.0))))
    return h + (theta - inside) * value(law, inside)


@kernel(inline=True)
def between(low, high, theta):
    """theta, or the middle where it is not inside."""
    return theta if low < theta < high else 0.5 * (low + high)


@kernel
def settle(law, h, low, high, theta):
    """Newton for enthalpy(law, theta) = h inside a bracket that every step shrinks; from the eighth step on every other one bisects."""
    for n in range(200):
        excess = enthalpy(law, theta) - h
        if excess > 0.0:
            high = theta
        else:
            low = theta
        step = excess / value(law, theta)
        if step != step:
            return step  # a NaN, for the guards to see
        if abs(step) <= 1e-11 * abs(theta):  # a few nK: Newton's next step would be below round-off
            return theta - step
        theta = 0.5 * (low + high) if n >= 8 and n % 2 == 0 else between(low, high, theta - step)
    return theta


@kernel(inline=True)
def settle_from(law, h, guess, least):
    """`settle` with the bracket that a lowest value `least` > 0 of the law gives, twice as wide: Newton's step may land on its very end."""
    reach = guess + 2.0 * (h - enthalpy(law, guess)) / least
    return settle(law, h, min(guess, reach), max(guess, reach), guess)


@temperature_of.register(Constant)
def temperature_constant(law, h, guess):
    return h / law.constant


@temperature_of.register(Bump)
def temperature_bump(law, h, guess):
    return settle_from(law, h, guess, law.base + 0.5 * (law.heat - abs(law.heat)) / (law.width * SQRT2PI))


@temperature_of.register(Logistic)
def temperature_logistic(law, h, guess):
    return settle_from(law, h, guess, min(law.low, law.high))


@temperature_of.register(Table)
def temperature_table(law, h, guess):
    n = len(law.theta) - 1
    if h <= law.h[0]:
        return law.theta[0] + (h - law.h[0]) / value(law, law.theta[0])
    if h >= law.h[n]:
        return law.theta[n] + (h - law.h[n]) / value(law, law.theta[n])
    k = piece(law.h, h)
    return settle(law, h, law.theta[k], law.theta[k + 1], between(law.theta[k], law.theta[k + 1], guess))
