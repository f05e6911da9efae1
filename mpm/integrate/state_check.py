"""What a block of steps begins from, looked at as its opening reads it: before anything is made of it, and while it is in the first-level cache.

finite     v, C, B, theta and its gradient: 0 times the sum of what is finite is 0
between    J in (LEAST_J, MOST_J), positions on the grid, squared stretches above zero
A chunk that is not sound ends the block with UNSOUND; which particle it was, and what of it, `unsound` then searches for in plain numpy.
Cost       1.2 ns a particle and block in 2-D with heat (pytest -m slow tests/test_guards.py); a pass of its own over the state took 3 to 5
"""

import math

import numpy as np

from mpm.basis import room
from mpm.boundary import extents
from mpm.jit import kernel, role
from mpm.lanes import EIGHT, below, fma, least, load8, maximum, minimum, most, peek, splat8
from mpm.outcome import INVERTED, LEFT_GRID, NON_FINITE, OVERSTRETCHED
from mpm.state import PAD, Isothermal, Thermal

LEAST_J, MOST_J, LARGEST = 1e-3, 1e3, 1e30


@kernel(inline=True)
def finite(values, begin, end):
    """Whether the numbers begin <= i < end of an array are finite. Two sums: one would wait for itself."""
    real = values.dtype.type
    nought = splat8(real(0))
    even, odd, at = nought, nought, begin
    while at + 2 * EIGHT <= end:
        even, odd = fma(load8(values, at), nought, even), fma(load8(values, at + EIGHT), nought, odd)
        at += 2 * EIGHT
    rest = real(0)
    while at < end:
        rest += peek(values, at) * real(0)
        at += 1
    return least(below(even + odd, splat8(real(1)))) > 0.0 and rest == 0.0


@kernel(inline=True)
def between(values, begin, end, low, high):
    """Whether the numbers begin <= i < end of an array lie between the two."""
    real = values.dtype.type
    bottom, top, good, fine, at = splat8(real(low)), splat8(real(high)), splat8(real(0)), splat8(real(0)), begin
    while at + 2 * EIGHT <= end:
        here, there = load8(values, at), load8(values, at + EIGHT)
        good, fine = fma(below(bottom, here), below(here, top), good), fma(below(bottom, there), below(there, top), fine)
        at += 2 * EIGHT
    ok = least(good + fine) > 2 * ((at - begin) // (2 * EIGHT)) - 0.5
    while at < end:
        ok = ok and low < peek(values, at) < high
        at += 1
    return ok


@kernel(inline=True)
def placed(space, x, first, count):
    """Whether positions are on the grid, one direction at a time where the shortest does not tell."""
    shape, inside, D = extents(space), room(space.basis), x.shape[1]
    low, shortest = (inside - PAD) * space.h, shape[0]
    for c in range(1, D):
        shortest = min(shortest, shape[c])
    if between(x, first * D, (first + count) * D, low, (shortest - 1 - PAD - inside) * space.h):
        return True
    for i in range(first, first + count):
        for c in range(D):
            if not low < peek(x, i * D + c) < (shape[c] - 1 - PAD - inside) * space.h:
                return False
    return True


@kernel(inline=True)
def strained(B, first, count):
    """Whether strains are finite, and the diagonal of B above that of nothing."""
    K = B.shape[1]
    if between(B, first * K, (first + count) * K, -1.0, LARGEST):
        return True
    for i in range(first, first + count):
        for k in range(3):
            if not peek(B, i * K + k) > -1.0:
                return False
    return finite(B, first * K, (first + count) * K)


@role(inline=True)
def tempered(thermal, first, count):
    """Whether temperatures and their gradients are finite."""
    raise TypeError(f"no heat in {type(thermal).__name__}")


@tempered.register(Isothermal)
def tempered_isothermal(thermal, first, count):
    return True


@tempered.register(Thermal)
def tempered_thermal(thermal, first, count):
    D = thermal.c.shape[1]
    return finite(thermal.theta, first, first + count) and finite(thermal.c, first * D, (first + count) * D)


@kernel(inline=True)
def sound(space, body, first, count):
    """Whether `count` particles from `first` on can begin a step."""
    p = body.particles
    D, last = p.x.shape[1], first + count
    ok = placed(space, p.x, first, count) and between(p.J, first, last, LEAST_J, MOST_J) and strained(p.B, first, count)
    return ok and finite(p.v, first * D, last * D) and finite(p.C, first * D * D, last * D * D) and tempered(body.thermal, first, count)


@kernel
def span(values):
    """(least, largest) of values (n,); NaN both where one of them is."""
    real = values.dtype.type
    nought = splat8(real(0))
    lowest, highest, wrong, at, n = splat8(real(np.inf)), splat8(real(-np.inf)), nought, 0, values.shape[0]
    while at + EIGHT <= n:
        here = load8(values, at)
        lowest, highest, wrong = minimum(here, lowest), maximum(here, highest), fma(here, nought, wrong)
        at += EIGHT
    low, high, ok = least(lowest), most(highest), least(below(wrong, splat8(real(1)))) > 0.0
    while at < n:
        here = values[at]
        low, high, ok, at = min(low, here), max(high, here), ok and np.isfinite(here), at + 1
    return (float(low), float(high)) if ok else (np.nan, np.nan)


@kernel
def outside(values, low, high):
    """How many of values (n,) are not between the two; what is not a number is not."""
    count = 0
    for i in range(values.shape[0]):
        if not (low < values[i] < high):
            count += 1
    return count


def unsound(space, body) -> tuple[int, int, str] | None:
    """(code, particle, what is wrong) where a value is not finite, a particle is off the grid or its volume is beyond what a step allows.

    Fields that spoil the others come first. Sound ones are told by `outside` alone, in one pass over each array.
    """
    p, thermal = body.particles, body.thermal
    inside, shape = room(space.basis), extents(space)
    low, high = (inside - PAD) * space.h, [(n - 1 - PAD - inside) * space.h for n in shape[: p.x.shape[1]]]
    fields = [(p.J, LEAST_J, MOST_J), (p.B, -1.0, LARGEST), (p.C, -LARGEST, LARGEST), (p.v, -LARGEST, LARGEST), (p.x, low, min(high))]
    if isinstance(thermal, Thermal):
        fields += [(thermal.theta, -LARGEST, LARGEST), (thermal.c, -LARGEST, LARGEST)]
    if not any(outside(values.ravel(), least, most) for values, least, most in fields):
        return None
    if isinstance(thermal, Thermal):
        for what, values in (("temperature", thermal.theta), ("gradient of temperature", thermal.c)):
            if not math.isfinite(values.sum()):
                return NON_FINITE, first_bad(values), what
    least, most = p.J.min(), p.J.max()
    if not (least > LEAST_J and most < MOST_J):
        if not np.isfinite(least + most):
            return NON_FINITE, first_bad(p.J), "J"
        code, i = (OVERSTRETCHED, int(np.argmax(p.J))) if most >= MOST_J else (INVERTED if least <= 0 else OVERSTRETCHED, int(np.argmin(p.J)))
        return code, i, f"J = {p.J[i]:.3g}"
    stretch = p.B[:, :3]  # the diagonal, in every dimension
    if p.B.min() <= -1.0 and stretch.min() <= -1.0:
        return INVERTED, int(np.argmin(stretch.min(axis=1))), "a squared stretch below zero"
    for what, values in (("strain", p.B), ("affine velocity", p.C), ("velocity", p.v), ("position", p.x)):
        if not math.isfinite(values.sum()):
            return NON_FINITE, first_bad(values), what
    for axis, (first, last) in enumerate(zip(p.x.min(axis=0), p.x.max(axis=0), strict=True)):
        if not float(first) > low or not float(last) < high[axis]:
            i = int(np.argmin(p.x[:, axis]) if not float(first) > low else np.argmax(p.x[:, axis]))
            return LEFT_GRID, i, f"{'xyz'[axis]} = {p.x[i, axis]:.4g} m"
    return None


def first_bad(values: np.ndarray) -> int:
    """The first particle with a value that is not finite; -1 where only their sum is not."""
    bad = ~np.isfinite(values.reshape(len(values), -1)).all(axis=1)
    return int(np.argmax(bad)) if bad.any() else -1
