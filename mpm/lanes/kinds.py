"""How Numba learns of lanes (mpm.lanes): their type, and `operation`, which gives a Python function its compiled side."""

import functools

from llvmlite import ir
from numba import types
from numba.core.datamodel import models
from numba.core.imputils import lower_builtin
from numba.core.registry import cpu_target
from numba.extending import register_model, type_callable

FLAGS = ("contract", "reassoc", "arcp", "nsz", "afn")  # of each vector operation; no "nnan", no "ninf", as mpm.jit, which has no "reassoc"


ROW = 12  # numbers of three nodes


class LanesType(types.Type):
    """Numba type of `count` numbers of type `dtype`."""

    def __init__(self, dtype, count):
        self.dtype, self.count = dtype, count
        super().__init__(name=f"Lanes({dtype}, {count})")

    @property
    def parts(self):
        """Lanes of each vector that it lives in: a row in one of sixteen, of which four idle, or in eight and four."""
        if self.count != ROW:
            return (self.count,)
        return (16,) if self.dtype == types.float32 and sixteen() else (8, 4)

    @property
    def llvm(self):
        number = {types.float32: ir.FloatType(), types.float64: ir.DoubleType()}[self.dtype]
        vectors = [ir.VectorType(number, count) for count in self.parts]
        return vectors[0] if len(vectors) == 1 else ir.LiteralStructType(vectors)


@functools.cache
def sixteen():
    """Whether sixteen numbers of float32 are one vector of the machine that is compiled for."""
    return "+avx512vl" in cpu_target.target_context.codegen().magic_tuple()[2]


@register_model(LanesType)
class LanesModel(models.PrimitiveModel):
    """Lives in a vector register, or in as many as it takes."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, kind.llvm)


def operation(function, made, *takes, whole=False):
    """Let compiled code call `function`: `made(*types)` is the type of the result (None: not for these); decorates the LLVM side.

    Of rows, which may be several vectors, that sees one vector at a time, unless it wants the `whole`.
    """

    @type_callable(function)
    def result_type(context):
        return made

    def decorate(generate):
        lower_builtin(function, *takes)(generate if whole else by_vectors(generate))
        return generate

    return decorate


def by_vectors(generate):
    """The LLVM side of what is done lane by lane, for rows too."""

    def each(context, builder, signature, arguments):
        made = signature.return_type
        if not (isinstance(made, LanesType) and made.count == ROW):
            return generate(context, builder, signature, arguments)
        found = []
        for k, count in enumerate(made.parts):
            kinds = [LanesType(kind.dtype, count) if isinstance(kind, LanesType) else kind for kind in signature.args]
            mine = [vectors(builder, kind, a)[k] if isinstance(kind, LanesType) else a for kind, a in zip(signature.args, arguments, strict=True)]
            found.append(generate(context, builder, LanesType(made.dtype, count)(*kinds), mine))
        return row_of(builder, made, found)

    return each


def vectors(builder, kind, value):
    """The vectors that a value of lanes lives in."""
    return [value] if len(kind.parts) == 1 else [builder.extract_value(value, k) for k in range(len(kind.parts))]


def row_of(builder, kind, found):
    """The inverse of `vectors`."""
    if len(found) == 1:
        return found[0]
    made = ir.Constant(kind.llvm, ir.Undefined)
    for k, vector in enumerate(found):
        made = builder.insert_value(made, vector, k)
    return made


def one(a):
    """The type of lanes, or None."""
    return a if isinstance(a, LanesType) else None


def same(a, b):
    """The common type of lanes, or None."""
    return a if isinstance(a, LanesType) and a == b else None


def real(kind):
    return kind in (types.float32, types.float64)


def one_or_number(a):
    """The type of lanes or of a number, or None."""
    return a if isinstance(a, LanesType) or real(a) else None


def alike(a, b):
    """The common type of lanes or of numbers, or None."""
    return a if a == b and one_or_number(a) else None


def lanes_of(a, b):
    """The type of the lanes, of lanes and a number, or None."""
    return a if isinstance(a, LanesType) and real(b) else b if isinstance(b, LanesType) and real(a) else None


def holds(array):
    """Whether lanes may be read from this array."""
    return isinstance(array, types.Array) and array.layout == "C" and real(array.dtype)


def pointer(context, builder, signature, arguments, lanes):
    """Where number `at` of the array lies, as a pointer to `lanes`."""
    return builder.bitcast(place(context, builder, signature, arguments), lanes.llvm.as_pointer())


def places(numbers):
    """A constant list of lanes."""
    return ir.Constant(ir.VectorType(ir.IntType(32), len(numbers)), numbers)


def halved(a):
    return LanesType(a.dtype, a.count // 2) if isinstance(a, LanesType) else None


def place(context, builder, signature, arguments):
    """Where number `at` of the array lies."""
    array, at = signature.args[:2]
    return builder.gep(context.make_array(array)(context, builder, arguments[0]).data, [context.cast(builder, arguments[1], at, types.intp)])
