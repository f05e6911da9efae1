"""Formulas of place, time and temperature as compiled code reads them: operations in reverse Polish order on a stack, over a chunk of points at once.

One compiled reader serves every formula, so none is compiled anew. What a formula may hold is checked where the config is read (mpm.config.condition);
mpm.scene.sources turns its tree into `Code`.
Good values  a few dozen operations: each costs about a nanosecond a point.
Fails when   it has no value (a root of a negative number): NaN, which the guards of a run see.
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel

NUMBER, PLACE, TIME, TEMPERATURE, TABLE, AFTER, NEGATE, ADD, SUBTRACT, MULTIPLY, DIVIDE, POWER, LEAST, MOST = range(14)
UNARY = ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "atan", "floor", "ceil", "abs")  # from FIRST on
FIRST = 14


class Code(NamedTuple):
    """A formula."""

    does: np.ndarray  # (K,) what to do
    number: np.ndarray  # (K,) of a NUMBER its value, of PLACE its direction, of AFTER its time [s]
    rows: np.ndarray  # (K, 2) of a TABLE: its rows
    table: np.ndarray  # (R, 5) points where a piece begins, and its c0, c1, c2, c3
    depth: int  # of the stack
    feels: bool  # whether temperature is in it

    @property
    def lasting(self) -> bool:
        """Whether time is not in it."""
        return not np.any(self.does == TIME)


@kernel(inline=True)
def unary(what, a):
    """One of UNARY."""
    if what == 0:
        return np.sqrt(a)
    if what == 1:
        return np.exp(a)
    if what == 2:
        return np.log(a)
    if what == 3:
        return np.log10(a)
    if what == 4:
        return np.sin(a)
    if what == 5:
        return np.cos(a)
    if what == 6:
        return np.tan(a)
    if what == 7:
        return np.arctan(a)
    if what == 8:
        return np.floor(a)
    if what == 9:
        return np.ceil(a)
    return abs(a)


@kernel(inline=True)
def looked_up(table, low, high, at):
    """A table over time, flat beyond its ends; its last row only says where it ends."""
    k, begin, end = low, table[low, 0], table[high - 1, 0]
    at = min(max(at, begin), end)
    while k + 2 < high and table[k + 1, 0] <= at:
        k += 1
    u = at - table[k, 0]
    return table[k, 1] + u * (table[k, 2] + u * (table[k, 3] + u * table[k, 4]))


@kernel
def evaluate(code, X, first, count, t, theta, stack):
    """The formula at points `first` to first + count of X (N, D), at time t and temperatures theta (N,) [K], to stack[0]; stack (depth, N)."""
    top, last = -1, first + count
    for k in range(len(code.does)):
        what, number = code.does[k], code.number[k]
        if what <= TEMPERATURE:
            top += 1
            for p in range(first, last):
                if what == NUMBER:
                    stack[top, p] = number
                elif what == PLACE:
                    stack[top, p] = X[p, int(number)]
                elif what == TIME:
                    stack[top, p] = t
                else:
                    stack[top, p] = theta[p]
        elif what == TABLE:
            for p in range(first, last):
                stack[top, p] = looked_up(code.table, code.rows[k, 0], code.rows[k, 1], stack[top, p])
        elif what == AFTER:
            for p in range(first, last):
                stack[top, p] = 1.0 if stack[top, p] >= number * (1.0 - 1e-9) else 0.0
        elif what == NEGATE:
            for p in range(first, last):
                stack[top, p] = -stack[top, p]
        elif what >= FIRST:
            for p in range(first, last):
                stack[top, p] = unary(what - FIRST, stack[top, p])
        else:
            top -= 1
            for p in range(first, last):
                a, b = stack[top, p], stack[top + 1, p]
                if what == ADD:
                    a += b
                elif what == SUBTRACT:
                    a -= b
                elif what == MULTIPLY:
                    a *= b
                elif what == DIVIDE:
                    a /= b
                elif what == POWER:
                    a = a**b
                elif what == LEAST:
                    a = min(a, b)
                else:
                    a = max(a, b)
                stack[top, p] = a


def values(code: Code, X: np.ndarray, t: float, theta: np.ndarray | None = None) -> np.ndarray:
    """The formula at points X (N, D): (N,)."""
    stack, theta = np.empty((code.depth, len(X))), np.zeros(len(X)) if theta is None else theta
    with np.errstate(all="ignore"):  # where nothing is compiled
        evaluate(code, np.ascontiguousarray(X, dtype=float), 0, len(X), float(t), theta, stack)
    return stack[0].copy()
