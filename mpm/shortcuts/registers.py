"""Arrays and tuples as values: what was put together is not taken apart again, nor laid in memory to be read, and what nothing reads is not written down.

LLVM would remove all of that again, at a price: of the instructions that a cube on a floor gave it, half took tuples of arrays apart and together
(`.ci/compile_times.py`, row `text`).
"""

from llvmlite.ir import Constant, IntType, IRBuilder
from llvmlite.ir.instructions import CastInstr, ExtractValue, GEPInstr, ICMPInstr, InsertValue, Instruction, PhiInstr, SelectInstr
from numba.core import cgutils, types
from numba.core.codegen import CPUCodeLibrary
from numba.cpython import slicing
from numba.np import arrayobj

from mpm.shortcuts.building import building, stock

PURE = {InsertValue, ExtractValue, GEPInstr, CastInstr, ICMPInstr, SelectInstr}  # instructions that nobody misses whose value nobody reads
ARITHMETIC = {"add", "sub", "mul", "and", "or", "xor"}
proxies: dict = {}  # Numba's own classes of arrays that are made, by type


class Given:
    """An array that is there as a value: its fields are read from it. Numba's own class stores the array and loads each field."""

    __slots__ = ("_builder", "_context", "_datamodel", "_fe_type", "_value")  # no field can be set

    def __init__(self, context, builder, kind, value):
        self._context, self._builder, self._fe_type, self._value = context, builder, kind, value
        self._datamodel = context.data_model_manager[kind]

    def __getattr__(self, field):
        if field.startswith("_"):
            raise AttributeError(field)
        return self._builder.extract_value(self._value, self._datamodel.get_field_position(field))

    def _getvalue(self):
        return self._value

    def _getpointer(self):
        return cgutils.alloca_once_value(self._builder, self._value)

    def _get_ptr_by_name(self, field):
        return cgutils.gep_inbounds(self._builder, self._getpointer(), 0, self._datamodel.get_field_position(field))


def make_array(kind):
    """arrayobj.make_array, which writes a class for each use of an array."""
    if not building.depth or type(kind) is not types.Array:
        return stock["numba.np.arrayobj.make_array"](kind)

    def made(context, builder, value=None, ref=None):
        if value is not None and ref is None:
            return Given(context, builder, kind, value)
        if kind not in proxies:
            proxies[kind] = stock["numba.np.arrayobj.make_array"](kind)
        return proxies[kind](context, builder, value=value, ref=ref)

    return made


def extract_value(builder, aggregate, index, name=""):
    """IRBuilder.extract_value: of what was put together here, what was put in; and once a block. A tuple of arrays has hundreds of fields, for every call."""
    if type(index) is list and len(index) == 1:
        index = index[0]
    if not building.depth or type(index) is not int:
        return stock["IRBuilder.extract_value"](builder, aggregate, index, name)
    one = aggregate
    while type(one) is InsertValue and len(one.indices) == 1:
        if one.indices[0] == index:
            return one.value
        one = one.aggregate
    block = builder._block
    if builder._anchor < len(block.instructions):  # what follows may be read already
        return stock["IRBuilder.extract_value"](builder, one, index, name)
    taken = block.__dict__.setdefault("_taken", {})
    if (id(one), index) not in taken:
        taken[id(one), index] = one, stock["IRBuilder.extract_value"](builder, one, index, name)
    return taken[id(one), index][1]


def constant(value, number) -> bool:
    """Whether it is this integer."""
    return type(value) is Constant and type(value.type) is IntType and value.type.width > 1 and type(value.constant) is int and value.constant == number


def mul(builder, lhs, rhs, name="", flags=()):
    """IRBuilder.mul: not by one, as the last step of every array is."""
    if building.depth and (constant(lhs, 1) or constant(rhs, 1)):
        return rhs if constant(lhs, 1) else lhs
    return stock["IRBuilder.mul"](builder, lhs, rhs, name, flags)


def add(builder, lhs, rhs, name="", flags=()):
    """IRBuilder.add: no zero."""
    if building.depth and (constant(lhs, 0) or constant(rhs, 0)):
        return rhs if constant(lhs, 0) else lhs
    return stock["IRBuilder.add"](builder, lhs, rhs, name, flags)


def fix_index(builder, index, size):
    """slicing.fix_index: a constant's sign is known."""
    if building.depth and type(index) is Constant and type(index.constant) is int and index.constant >= 0:
        return index
    return stock["numba.cpython.slicing.fix_index"](builder, index, size)


def add_ir_module(library, module):
    """CPUCodeLibrary.add_ir_module."""
    if building.depth:
        for function in module.functions:
            leave_out_unread(function)
    stock["CPUCodeLibrary.add_ir_module"](library, module)


def leave_out_unread(function) -> None:
    """Take out what computes values that nothing reads, as the arguments that a function hands on by field."""
    read: dict = {}
    for block in function.blocks:
        for one in block.instructions:
            for part in one.operands if type(one) is not PhiInstr else [value for value, _ in one.incomings]:
                read[id(part)] = read.get(id(part), 0) + 1
    for block in reversed(function.blocks):
        kept = []
        for one in reversed(block.instructions):
            if not read.get(id(one)) and (type(one) in PURE or (type(one) is Instruction and one.opname in ARITHMETIC)):
                for part in one.operands:
                    read[id(part)] -= 1
            else:
                kept.append(one)
        block.instructions = kept[::-1]


SHORTCUTS = (
    (arrayobj, "make_array", make_array),
    (IRBuilder, "extract_value", extract_value),
    (IRBuilder, "mul", mul),
    (IRBuilder, "add", add),
    (slicing, "fix_index", fix_index),
    (CPUCodeLibrary, "add_ir_module", add_ir_module),
)
