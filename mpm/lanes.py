"""Explicit vectors for kernels: a few numbers of one type that a processor adds and multiplies at once.

LLVM makes vectors of simple loops by itself, but not of the nodes of a stencil, which particles share, and not of long loops over many arrays. Here
they are written down. A `Lanes` value is an LLVM vector `<n x T>`, so the same source becomes SSE, AVX2, AVX-512 or NEON, whatever the machine has.

    load4(array, at), load8(array, at)     four or eight numbers from a C-contiguous array, `at` counts its numbers
    store(array, at, a)                    the same, back
    peek(array, at), poke(array, at, x)    one number: unlike array[i, k] never a negative index, which costs a comparison each where LLVM cannot see the sign
    splat4(x), splat8(x)                   x in every lane
    four(a, b, c, d)                       lanes from numbers
    join(a, b), low(a), high(a)            two fours make an eight, and back
    fma(a, b, c)                           a b + c by `llvm.fmuladd`: one instruction where there is one, two where not (`llvm.fma` would call a library)
    a + b, a - b, a * b, a / b, -a         lane by lane; so the functions of mpm.tensors work on lanes as on numbers
    absolute(a), minimum(a, b), maximum(a, b), floor(a)
    below(a, b)                            1 where a < b, else 0, in lanes; 0 where either is NaN
    most(a), least(a)                      over the lanes of one value
    item(a, k)                             lane k

In plain Python (NUMBA_DISABLE_JIT) lanes are small numpy arrays and every function does the same.
To add    a Python function, its type, its LLVM instruction: see `operation`.
"""

import operator

import numpy as np
from llvmlite import ir
from numba import types

from mpm.lane_types import FLAGS, LanesType, halved, holds, one, operation, place, places, pointer, real, same

EIGHT = 8  # particles that pass at once


def load4(array, at):
    return array.reshape(-1)[at : at + 4].copy()


def load8(array, at):
    return array.reshape(-1)[at : at + 8].copy()


def store(array, at, value):
    array.reshape(-1)[at : at + len(value)] = value


def load(context, builder, signature, arguments):
    made = signature.return_type
    return builder.load(pointer(context, builder, signature, arguments, made), align=made.dtype.bitwidth // 8)


operation(load4, lambda array, at: LanesType(array.dtype, 4) if holds(array) else None, types.Array, types.Integer)(load)
operation(load8, lambda array, at: LanesType(array.dtype, 8) if holds(array) else None, types.Array, types.Integer)(load)


@operation(store, lambda array, at, a: types.none if holds(array) and isinstance(a, LanesType) and a.dtype == array.dtype else None,
           types.Array, types.Integer, LanesType)  # fmt: skip
def _(context, builder, signature, arguments):
    lanes = signature.args[2]
    builder.store(arguments[2], pointer(context, builder, signature, arguments, lanes), align=lanes.dtype.bitwidth // 8)
    return context.get_dummy_value()


def peek(array, at):
    return array.reshape(-1)[at]


def poke(array, at, x):
    array.reshape(-1)[at] = x


operation(peek, lambda array, at: array.dtype if holds(array) else None, types.Array, types.Integer)(lambda *around: around[1].load(place(*around)))


@operation(poke, lambda array, at, x: types.none if holds(array) and real(x) else None, types.Array, types.Integer, types.Float)
def _(context, builder, signature, arguments):
    builder.store(context.cast(builder, arguments[2], signature.args[2], signature.args[0].dtype), place(context, builder, signature, arguments))
    return context.get_dummy_value()


def splat4(x):
    return np.full(4, x)


def splat8(x):
    return np.full(8, x)


def splat(context, builder, signature, arguments):
    made = signature.return_type.llvm
    first = builder.insert_element(ir.Constant(made, ir.Undefined), arguments[0], ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, ir.Constant(made, ir.Undefined), places([0] * made.count))


operation(splat4, lambda x: LanesType(x, 4) if real(x) else None, types.Float)(splat)
operation(splat8, lambda x: LanesType(x, 8) if real(x) else None, types.Float)(splat)


def four(a, b, c, d):
    return np.array([a, b, c, d], dtype=np.result_type(a, b, c, d))


@operation(four, lambda a, b, c, d: LanesType(a, 4) if real(a) and a == b == c == d else None, *[types.Float] * 4)
def _(context, builder, signature, arguments):
    made = ir.Constant(signature.return_type.llvm, ir.Undefined)
    for k, x in enumerate(arguments):
        made = builder.insert_element(made, x, ir.Constant(ir.IntType(32), k))
    return made


def join(a, b):
    return np.concatenate((a, b))


def low(a):
    return a[: len(a) // 2]


def high(a):
    return a[len(a) // 2 :]


def shuffled(first, last):
    """LLVM side that takes the lanes first..last-1 of its arguments, one after the other; both count in halves of the first argument."""

    def generate(context, builder, signature, arguments):
        half = signature.args[0].count / 2
        other = arguments[1] if len(arguments) > 1 else ir.Constant(signature.args[0].llvm, ir.Undefined)
        return builder.shuffle_vector(arguments[0], other, places(list(range(int(first * half), int(last * half)))))

    return generate


operation(join, lambda a, b: LanesType(a.dtype, 2 * a.count) if same(a, b) else None, LanesType, LanesType)(shuffled(0, 4))
operation(low, halved, LanesType)(shuffled(0, 1))
operation(high, halved, LanesType)(shuffled(1, 2))


def item(a, k):
    return a[k]


@operation(item, lambda a, k: a.dtype if isinstance(a, LanesType) else None, LanesType, types.Integer)
def _(context, builder, signature, arguments):
    return builder.extract_element(arguments[0], context.cast(builder, arguments[1], signature.args[1], types.int32))


def named(instruction):
    """LLVM side that calls an intrinsic of one, two or three lanes."""

    def generate(context, builder, signature, arguments):
        kind = signature.return_type.llvm
        name = f"llvm.{instruction}.v{kind.count}f{signature.return_type.dtype.bitwidth}"
        function = builder.module.declare_intrinsic(name, fnty=ir.FunctionType(kind, [kind] * len(arguments)))
        return builder.call(function, arguments, fastmath=FLAGS)

    return generate


def fma(a, b, c):
    return a * b + c


def absolute(a):
    return np.abs(a)


def floor(a):
    return np.floor(a)


operation(fma, lambda a, b, c: a if same(a, b) == same(b, c) else None, *[LanesType] * 3)(named("fmuladd"))
operation(absolute, one, LanesType)(named("fabs"))
operation(floor, one, LanesType)(named("floor"))

for sign, instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv")):
    operation(sign, same, LanesType, LanesType)(
        lambda context, builder, signature, arguments, instruction=instruction: getattr(builder, instruction)(*arguments, flags=FLAGS)
    )
operation(operator.neg, one, LanesType)(lambda context, builder, signature, arguments: builder.fneg(*arguments, flags=FLAGS))


def minimum(a, b):
    return np.where(a < b, a, b)


def maximum(a, b):
    return np.where(a > b, a, b)


def below(a, b):
    return np.where(a < b, a.dtype.type(1), a.dtype.type(0))


def chosen(comparison):
    """LLVM side of `a if a ? b else b`: one instruction, and b where either is NaN."""

    def generate(context, builder, signature, arguments):
        a, b = arguments
        return builder.select(builder.fcmp_ordered(comparison, a, b), a, b)

    return generate


operation(minimum, same, LanesType, LanesType)(chosen("<"))
operation(maximum, same, LanesType, LanesType)(chosen(">"))


@operation(below, same, LanesType, LanesType)
def _(context, builder, signature, arguments):
    kind = signature.return_type.llvm
    yes, no = (ir.Constant(kind, [number] * kind.count) for number in (1.0, 0.0))
    return builder.select(builder.fcmp_ordered("<", *arguments), yes, no)


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
