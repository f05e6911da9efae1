"""Order and choice over lanes and numbers: comparisons that a NaN never wins."""

import numpy as np
from llvmlite import ir
from numba import types

from mpm.lanes.arithmetic import like
from mpm.lanes.kinds import LanesType, alike, one_or_number, operation, places


def precision(a):
    return like(a, float(np.finfo(np.asarray(a).dtype).eps))


def constant(context, kind, number):
    """A number as lanes, or as a number, of a type."""
    return ir.Constant(kind.llvm, [number] * kind.count) if isinstance(kind, LanesType) else ir.Constant(context.get_value_type(kind), number)


@operation(precision, one_or_number, LanesType)
@operation(precision, one_or_number, types.Float)
def precision_compiled(context, builder, signature, arguments):
    kind = signature.return_type
    return constant(context, kind, float(np.finfo(str(kind.dtype if isinstance(kind, LanesType) else kind)).eps))


def minimum(a, b):
    return np.where(a < b, a, b)[()]


def maximum(a, b):
    return np.where(a > b, a, b)[()]


def below(a, b):
    return np.where(a < b, np.ones_like(a), np.zeros_like(a))[()]


def choose(c, a, b):
    return np.where(c > 0.5, a, b)[()]


def chosen(comparison):
    """LLVM side of `a if a ? b else b`: one instruction, and b where either is NaN."""

    def generate(context, builder, signature, arguments):
        a, b = arguments
        return builder.select(builder.fcmp_ordered(comparison, a, b), a, b)

    return generate


def smaller(context, builder, signature, arguments):
    made = signature.return_type
    return builder.select(builder.fcmp_ordered("<", *arguments), constant(context, made, 1.0), constant(context, made, 0.0))


def chooses(context, builder, signature, arguments):
    return builder.select(builder.fcmp_ordered(">", arguments[0], constant(context, signature.return_type, 0.5)), *arguments[1:])


for kind in (LanesType, types.Float):
    operation(minimum, alike, kind, kind)(chosen("<"))
    operation(maximum, alike, kind, kind)(chosen(">"))
    operation(below, alike, kind, kind)(smaller)
    operation(choose, lambda c, a, b: alike(a, b) if alike(c, a) else None, kind, kind, kind)(chooses)


def least(a):
    return a.min()


def most(a):
    return a.max()


def over_lanes(comparison):
    """LLVM side of a reduction by halves."""

    def generate(context, builder, signature, arguments):
        a, count = arguments[0], signature.args[0].count
        while count > 1:
            count //= 2
            halves = [builder.shuffle_vector(a, a, places(list(range(start, start + count)))) for start in (0, count)]
            a = builder.select(builder.fcmp_ordered(comparison, *halves), *halves)
        return builder.extract_element(a, ir.Constant(ir.IntType(32), 0))

    return generate


operation(least, lambda a: a.dtype if isinstance(a, LanesType) else None, LanesType)(over_lanes("<"))
operation(most, lambda a: a.dtype if isinstance(a, LanesType) else None, LanesType)(over_lanes(">"))
