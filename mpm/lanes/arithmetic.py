"""Arithmetic of lanes, lane by lane, also with numbers."""

import operator

import numpy as np
from llvmlite import ir
from numba import types

from mpm.lanes.access import splat
from mpm.lanes.kinds import FLAGS, LanesType, lanes_of, one, one_or_number, operation, real, same


def named(instruction, flags=FLAGS):
    """LLVM side that calls an intrinsic of one, two or three lanes or numbers."""

    def generate(context, builder, signature, arguments):
        made = signature.return_type
        kind = made.llvm if isinstance(made, LanesType) else context.get_value_type(made)
        count = f"v{made.count}" if isinstance(made, LanesType) else ""
        name = f"llvm.{instruction}.{count}f{(made.dtype if count else made).bitwidth}"
        function = builder.module.declare_intrinsic(name, fnty=ir.FunctionType(kind, [kind] * len(arguments)))
        return builder.call(function, arguments, fastmath=flags)

    return generate


def fma(a, b, c):
    return a * b + c


def absolute(a):
    return np.abs(a)


def sqrt(a):
    return np.sqrt(a)


def floor(a):
    return np.floor(a)


operation(fma, lambda a, b, c: a if same(a, b) == same(b, c) else None, *[LanesType] * 3)(named("fmuladd"))
operation(floor, one, LanesType)(named("floor"))
for function, instruction in ((absolute, "fabs"), (sqrt, "sqrt")):
    operation(function, one_or_number, LanesType)(named(instruction))
    operation(function, one_or_number, types.Float)(named(instruction))


def widened(context, builder, signature, arguments):
    """Arguments as lanes of the result, numbers in every lane."""
    made = signature.return_type
    for kind, argument in zip(signature.args, arguments, strict=True):
        number = context.cast(builder, argument, kind, made.dtype) if not isinstance(kind, LanesType) else None
        yield argument if number is None else splat(context, builder, made(made.dtype), [number])


def arithmetic(instruction):
    return lambda context, builder, signature, arguments: getattr(builder, instruction)(*widened(context, builder, signature, arguments), flags=FLAGS)


for sign, instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv")):
    operation(sign, same, LanesType, LanesType)(arithmetic(instruction))
    operation(sign, lanes_of, LanesType, types.Float)(arithmetic(instruction))
    operation(sign, lanes_of, types.Float, LanesType)(arithmetic(instruction))
operation(operator.neg, one, LanesType)(lambda context, builder, signature, arguments: builder.fneg(*arguments, flags=FLAGS))


def like(a, x):
    return x if np.ndim(x) or not np.ndim(a) else np.full(len(a), x, a.dtype)


@operation(like, lambda a, x: a if isinstance(a, LanesType) else None, LanesType, types.Float)
def like_compiled(context, builder, signature, arguments):
    (made,) = widened(context, builder, signature.return_type(signature.args[1]), arguments[1:])
    return made


operation(like, lambda a, x: x if same(a, x) else None, LanesType, LanesType)(lambda context, builder, signature, arguments: arguments[1])
operation(like, lambda a, x: a if real(a) and real(x) else None, types.Float, types.Float)(
    lambda context, builder, signature, arguments: context.cast(builder, arguments[1], signature.args[1], signature.args[0])
)
