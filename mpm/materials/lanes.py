"""Laws of temperature over lanes: value, primitive and its inverse, the same branches for all lanes (mpm.materials.laws has them one by one).

values(law, theta), enthalpies(law, theta), temperatures(law, h, guess): what `value`, `enthalpy` and `temperature_of` give, to a few ulp of their largest
term. A table is walked piece by piece: a lane keeps the coefficients of the last piece that begins below it, then all take one polynomial; beyond WALK
pieces bisecting lane by lane is quicker. The inverse is Newton's as in laws.settle, in a bracket of its own for every lane, until all lanes are done; in
a table it starts with the closed form of the quadratic, which is the answer where the table is linear.
Fails when   the law is not positive (as there). NaN stays NaN.
"""

from typing import Any, NamedTuple

from mpm.jit import kernel
from mpm.lanes import EIGHT, absolute, below, choose, erf, exponential, item, like, log1p, maximum, minimum, most, precision, put, sqrt
from mpm.materials.laws import LAWS, SQRT2, SQRT2PI, Bump, Constant, Logistic, Table
from mpm.materials.roles import enthalpies, enthalpy, temperature_of, temperatures, value, values

WALK = 32  # pieces


class Piece(NamedTuple):
    """The polynomial of a table that each lane is on."""

    start: Any  # [K]
    end: Any  # [K]
    h: Any  # enthalpy at the start
    c0: Any
    c1: Any
    c2: Any
    c3: Any


@kernel(inline=True)
def pieces(law, points, at):
    """The Piece of each lane: the last one with points[k] <= at, points those of temperature or of enthalpy."""
    start, end, h = like(at, law.theta[0]), like(at, law.theta[1]), like(at, law.h[0])
    c0, c1, c2, c3 = like(at, law.c[0, 0]), like(at, law.c[0, 1]), like(at, law.c[0, 2]), like(at, law.c[0, 3])
    for k in range(1, len(law.theta) - 1):
        before = below(at, like(at, points[k]))
        start, end = choose(before, start, like(at, law.theta[k])), choose(before, end, like(at, law.theta[k + 1]))
        h = choose(before, h, like(at, law.h[k]))
        c0, c1 = choose(before, c0, like(at, law.c[k, 0])), choose(before, c1, like(at, law.c[k, 1]))
        c2, c3 = choose(before, c2, like(at, law.c[k, 2])), choose(before, c3, like(at, law.c[k, 3]))
    return Piece(start, end, h, c0, c1, c2, c3)


@kernel(inline=True)
def clipped(law, theta):
    """theta within the table; NaN stays."""
    return minimum(like(theta, law.theta[-1]), maximum(like(theta, law.theta[0]), theta))


@kernel(inline=True)
def height(piece, u):
    return piece.c0 + u * (piece.c1 + u * (piece.c2 + u * piece.c3))


@kernel(inline=True)
def area(piece, u):
    return piece.h + u * (piece.c0 + u * (piece.c1 * 0.5 + u * (piece.c2 * (1.0 / 3.0) + u * (piece.c3 * 0.25))))


@values.register(Constant)
def values_constant(law, theta):
    return like(theta, law.constant)


@values.register(Bump)
@values.register(Logistic)
def values_logistic_or_bump(law, theta):
    return value(law, theta)


@values.register(Table)
def values_table(law, theta):
    if len(law.c) > WALK:
        for k in range(EIGHT):
            theta = put(theta, k, value(law, item(theta, k)))
        return theta
    inside = clipped(law, theta)
    found = pieces(law, law.theta, inside)
    return height(found, inside - found.start)


@enthalpies.register(Constant)
def enthalpies_constant(law, theta):
    return law.constant * theta


@enthalpies.register(Bump)
def enthalpies_bump(law, theta):
    return law.base * theta + 0.5 * law.heat * (1.0 + erf((theta - law.at) * (1.0 / (law.width * SQRT2))))


@enthalpies.register(Logistic)
def enthalpies_logistic(law, theta):
    z = (theta - law.at) / law.width
    return law.low * theta + (law.high - law.low) * law.width * (maximum(like(z, 0.0), z) + log1p(exponential(-absolute(z))))


@enthalpies.register(Table)
def enthalpies_table(law, theta):
    if len(law.c) > WALK:
        for k in range(EIGHT):
            theta = put(theta, k, enthalpy(law, item(theta, k)))
        return theta
    inside = clipped(law, theta)
    found = pieces(law, law.theta, inside)
    return area(found, inside - found.start) + (theta - inside) * height(found, inside - found.start)


@kernel(inline=True)
def settle(law, h, low, high, theta):
    """laws.settle, each lane in its bracket: a lane that is done keeps what it has, a NaN goes on as one."""
    half, done, few = like(h, 0.5), like(h, 0.0), maximum(like(h, 1e-11), 4.0 * precision(h))
    for n in range(200):
        excess = enthalpies(law, theta) - h
        above = below(like(h, 0.0), excess)
        low, high = choose(above, low, theta), choose(above, theta, high)
        step = excess / values(law, theta)
        new = theta - step
        close = 1.0 - below(few * absolute(theta), absolute(step))  # also of a NaN, which no more turns mend
        inside = below(low, new) * below(new, high)
        if n >= 8 and n % 2 == 0:
            inside = inside * 0.0
        theta = choose(done, theta, choose(close, new, choose(inside, new, half * (low + high))))
        done = maximum(done, close)
        if not most(1.0 - done) > 0.5:
            break
    return theta


@kernel(inline=True)
def settle_from(law, h, guess, lowest):
    """laws.settle_from."""
    reach = guess + 2.0 * (h - enthalpies(law, guess)) / lowest
    return settle(law, h, minimum(guess, reach), maximum(guess, reach), guess)


@temperatures.register(Constant)
def temperatures_constant(law, h, guess):
    return h / law.constant


@temperatures.register(Bump)
def temperatures_bump(law, h, guess):
    return settle_from(law, h, guess, law.base + 0.5 * (law.heat - abs(law.heat)) / (law.width * SQRT2PI))


@temperatures.register(Logistic)
def temperatures_logistic(law, h, guess):
    return settle_from(law, h, guess, min(law.low, law.high))


@values.register(Piece)
def values_piece(law, theta):
    return height(law, theta - law.start)


@enthalpies.register(Piece)
def enthalpies_piece(law, theta):
    return area(law, theta - law.start)


@temperatures.register(Table)
def temperatures_table(law, h, guess):
    if len(law.c) > WALK:
        for k in range(EIGHT):
            h = put(h, k, temperature_of(law, item(h, k), item(guess, k)))
        return h
    n = len(law.theta) - 1
    first, last, nought = like(h, law.h[0]), like(h, law.h[n]), like(h, 0.0)
    inside = minimum(last, maximum(first, h))
    found = pieces(law, law.h, inside)
    over = inside - found.h
    root = sqrt(maximum(nought, found.c0 * found.c0 + 2.0 * found.c1 * over))
    theta = minimum(found.end, found.start + 2.0 * over / (found.c0 + root))
    theta = settle(found, inside, found.start, found.end, theta)
    return theta + (h - inside) / values(law, theta)


def values_in_turn(law, theta):
    for k in range(EIGHT):
        theta = put(theta, k, value(law, item(theta, k)))
    return theta


def enthalpies_in_turn(law, theta):
    for k in range(EIGHT):
        theta = put(theta, k, enthalpy(law, item(theta, k)))
    return theta


def temperatures_in_turn(law, h, guess):
    for k in range(EIGHT):
        h = put(h, k, temperature_of(law, item(h, k), item(guess, k)))
    return h


for kind in LAWS:  # a law without forms over lanes is asked lane by lane
    for lanes, in_turn in ((values, values_in_turn), (enthalpies, enthalpies_in_turn), (temperatures, temperatures_in_turn)):
        if kind not in lanes.registry:
            lanes.register(kind, in_turn)
