"""Lanes from arrays and numbers, and back."""

import numpy as np
from llvmlite import ir
from numba import types

from mpm.lanes.kinds import ROW, LanesType, halved, holds, operation, place, places, pointer, real, row_of, same, vectors


def aligned(shape, dtype):
    """Zeros whose first number begins a cache line (64 bytes): lanes then cross as few lines as can be."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    raw = np.zeros(size + 64, np.uint8)
    start = -raw.ctypes.data % 64
    return raw[start : start + size].view(dtype).reshape(shape)


def load4(array, at):
    return array.reshape(-1)[at : at + 4].copy()


def load8(array, at):
    return array.reshape(-1)[at : at + 8].copy()


def load_row(array, at):
    return array.reshape(-1)[at : at + ROW].copy()


def store(array, at, value):
    array.reshape(-1)[at : at + len(value)] = value


def load(context, builder, signature, arguments):
    made = signature.return_type
    return builder.load(pointer(context, builder, signature, arguments, made), align=made.dtype.bitwidth // 8)


operation(load4, lambda array, at: LanesType(array.dtype, 4) if holds(array) else None, types.Array, types.Integer)(load)
operation(load8, lambda array, at: LanesType(array.dtype, 8) if holds(array) else None, types.Array, types.Integer)(load)


@operation(load_row, lambda array, at: LanesType(array.dtype, ROW) if holds(array) else None, types.Array, types.Integer, whole=True)
def load_row_compiled(context, builder, signature, arguments):
    made, start = signature.return_type, place(context, builder, signature, arguments)
    if len(made.parts) == 1:
        return masked(builder, made, start)
    found = []
    for first, count in ((0, 8), (8, 4)):
        part = LanesType(made.dtype, count)
        at = builder.bitcast(builder.gep(start, [ir.Constant(ir.IntType(64), first)]), part.llvm.as_pointer())
        found.append(builder.load(at, align=made.dtype.bitwidth // 8))
    return row_of(builder, made, found)


def masked(builder, made, start):
    """The first numbers of a vector from memory, nothing in its idle lanes: what lies behind is not touched."""
    width, size = made.llvm.count, made.dtype.bitwidth
    mask = ir.VectorType(ir.IntType(1), width)
    at = builder.bitcast(start, made.llvm.as_pointer())
    kind = ir.FunctionType(made.llvm, [at.type, ir.IntType(32), mask, made.llvm])
    load = builder.module.declare_intrinsic(f"llvm.masked.load.v{width}f{size}.p0", fnty=kind)
    kept = ir.Constant(mask, [int(k < made.count) for k in range(width)])
    return builder.call(load, [at, ir.Constant(ir.IntType(32), size // 8), kept, ir.Constant(made.llvm, None)])


def row_from(builder, made, eight, rest):
    """A row from its first two nodes and the third."""
    if len(made.parts) > 1:
        return row_of(builder, made, [eight, rest])
    nothing = ir.Constant(rest.type, ir.Undefined)
    return builder.shuffle_vector(eight, builder.shuffle_vector(rest, nothing, places([0, 1, 2, 3, 4, 4, 4, 4])), places(list(range(16))))


def nodes_of(builder, kind, row):
    """The inverse: first two nodes, the third."""
    if len(kind.parts) > 1:
        return vectors(builder, kind, row)
    return [builder.shuffle_vector(row, row, places(list(range(first, last)))) for first, last in ((0, 8), (8, 12))]


@operation(store, lambda array, at, a: types.none if holds(array) and isinstance(a, LanesType) and a.dtype == array.dtype else None,
           types.Array, types.Integer, LanesType)  # fmt: skip
def store_compiled(context, builder, signature, arguments):
    lanes, start = signature.args[2], place(context, builder, signature, arguments)
    for vector in nodes_of(builder, lanes, arguments[2]) if lanes.count == ROW else [arguments[2]]:
        builder.store(vector, builder.bitcast(start, vector.type.as_pointer()), align=lanes.dtype.bitwidth // 8)
        start = builder.gep(start, [ir.Constant(ir.IntType(64), vector.type.count)])
    return context.get_dummy_value()


def peek(array, at):
    return array.reshape(-1)[at]


def poke(array, at, x):
    array.reshape(-1)[at] = x


operation(peek, lambda array, at: array.dtype if holds(array) else None, types.Array, types.Integer)(lambda *around: around[1].load(place(*around)))


@operation(poke, lambda array, at, x: types.none if holds(array) and real(x) else None, types.Array, types.Integer, types.Float)
def poke_compiled(context, builder, signature, arguments):
    builder.store(context.cast(builder, arguments[2], signature.args[2], signature.args[0].dtype), place(context, builder, signature, arguments))
    return context.get_dummy_value()


def fetch_ahead(array, at):
    """Nothing: what is asked for comes from memory by itself."""


@operation(fetch_ahead, lambda array, at: types.none if holds(array) else None, types.Array, types.Integer)
def fetch_ahead_compiled(context, builder, signature, arguments):
    start = place(context, builder, signature, arguments)
    whole = ir.IntType(32)
    kind = ir.FunctionType(ir.VoidType(), [start.type, whole, whole, whole])
    ask = builder.module.declare_intrinsic("llvm.prefetch.p0", fnty=kind)
    builder.call(ask, [start, ir.Constant(whole, 1), ir.Constant(whole, 3), ir.Constant(whole, 1)])  # to write, to be kept near, data
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
def four_compiled(context, builder, signature, arguments):
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


def three(a, b, c):
    return np.concatenate((a, b, c))


@operation(three, lambda a, b, c: LanesType(a.dtype, ROW) if same(a, b) == c == a and a.count == 4 else None, *[LanesType] * 3, whole=True)
def three_compiled(context, builder, signature, arguments):
    a, b, c = arguments
    return row_from(builder, signature.return_type, builder.shuffle_vector(a, b, places(list(range(8)))), c)


def thirds(row):
    return row[:4], row[4:8], row[8:]


@operation(thirds, lambda row: types.UniTuple(LanesType(row.dtype, 4), 3) if isinstance(row, LanesType) and row.count == ROW else None, LanesType, whole=True)
def thirds_compiled(context, builder, signature, arguments):
    eight, third = nodes_of(builder, signature.args[0], arguments[0])
    first, second = (builder.shuffle_vector(eight, eight, places(list(range(start, start + 4)))) for start in (0, 4))
    return context.make_tuple(builder, signature.return_type, [first, second, third])


def item(a, k):
    return a[k]


@operation(item, lambda a, k: a.dtype if isinstance(a, LanesType) else None, LanesType, types.Integer)
def item_compiled(context, builder, signature, arguments):
    return builder.extract_element(arguments[0], context.cast(builder, arguments[1], signature.args[1], types.int32))


def put(a, k, x):
    made = a.copy()
    made[k] = x
    return made


@operation(put, lambda a, k, x: a if isinstance(a, LanesType) else None, LanesType, types.Integer, types.Float)
def put_compiled(context, builder, signature, arguments):
    lanes, k, x = signature.args
    number = context.cast(builder, arguments[2], x, lanes.dtype)
    return builder.insert_element(arguments[0], number, context.cast(builder, arguments[1], k, types.int32))


def transposed(a, b, c, d):
    groups = np.stack((a, b, c, d), axis=1).reshape(-1, 4, 4)  # four by four
    return tuple(groups[:, k].reshape(-1) for k in range(4))


@operation(transposed, lambda a, b, c, d: types.UniTuple(a, 4) if same(a, b) == same(c, d) == a and a.count in (4, 8) else None, *[LanesType] * 4)
def transposed_compiled(context, builder, signature, arguments):
    """In two rounds of four shuffles, each one instruction where lanes cross no more of a register than it allows: 128 bits."""
    (a, b, c, d), n = arguments, signature.args[0].count
    pairs = ([0, 0, 1, 1], [2, 2, 3, 3]) if signature.args[0].dtype == types.float32 else ([0, 0, 2, 2], [1, 1, 3, 3])

    def mixed(x, y, lanes, second):
        order = [g + lane + n * other for g in range(0, n, 4) for lane, other in zip(lanes, second, strict=True)]
        return builder.shuffle_vector(x, y, places(order))

    halves = []
    for lanes in pairs:
        x, y = mixed(a, b, lanes, [0, 1, 0, 1]), mixed(c, d, lanes, [0, 1, 0, 1])
        halves.append([mixed(x, y, [0, 1, 0, 1], [0, 0, 1, 1]), mixed(x, y, [2, 3, 2, 3], [0, 0, 1, 1])])
    (p, q), (r, s) = halves
    made = [p, q, r, s] if signature.args[0].dtype == types.float32 else [p, r, q, s]
    return context.make_tuple(builder, signature.return_type, made)
