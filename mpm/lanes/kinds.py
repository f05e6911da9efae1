"""How Numba learns of lanes (mpm.lanes): their type, and `operation`, which gives a Python function its compiled side."""

from llvmlite import ir
from numba import types
from numba.core.datamodel import models
from numba.core.imputils import lower_builtin
from numba.extending import register_model, type_callable

FLAGS = ("contract", "reassoc", "arcp", "nsz", "afn")  # of each vector operation; no "nnan", no "ninf", as mpm.jit, which has no "reassoc"


class LanesType(types.Type):
    """Numba type of `count` numbers of type `dtype`."""

    def __init__(self, dtype, count):
        self.dtype, self.count = dtype, count
        super().__init__(name=f"Lanes({dtype}, {count})")

    @property
    def llvm(self):
        return ir.VectorType({types.float32: ir.FloatType(), types.float64: ir.DoubleType()}[self.dtype], self.count)


@register_model(LanesType)
class LanesModel(models.PrimitiveModel):
    """Lives in a vector register, or in as many as it takes."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, kind.llvm)


def operation(function, made, *takes):
    """Let compiled code call `function`: `made(*types)` is the type of the result (None: not for these); decorates the LLVM side."""

    @type_callable(function)
    def result_type(context):
        return made

    return lower_builtin(function, *takes)


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
