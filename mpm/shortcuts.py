"""What Numba works out anew for every instruction of a kernel, worked out once, and instructions spared that LLVM would only remove again: both save time in
compiling (`.ci/compile_times.py` measures it).

Replacements of Numba's methods, installed by mpm.linking for the versions that it was tested with. They act while a kernel of ours is built and give what the
stock method gives, so a kernel's code, and with it every bit of its results, is the same with and without them (tests/test_linking.py).
"""

import threading
from collections import Counter
from types import BuiltinFunctionType

from llvmlite.ir import IRBuilder
from llvmlite.ir.instructions import InsertValue
from numba.core import ir
from numba.core.base import BaseContext
from numba.core.codegen import CPUCodeLibrary
from numba.core.lowering import Lower
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.runtime.context import NRTContext
from numba.core.targetconfig import TargetConfig
from numba.core.transforms import canonicalize_cfg
from numba.core.types.functions import BaseFunction


class Building(threading.local):
    """What this thread compiles: 0 nothing of ours, 1 a kernel that Python called, 2 and more its callees."""

    depth = 0
    kernel = None  # its Python function


building = Building()
stock: dict = {}  # Numba's own methods, by place, where they are replaced
sizes: dict = {}  # bytes of LLVM types, by their text
counted: dict = {}  # whether a type holds an array somewhere
PLAIN = {str, int, float, bool, type(None), type, BuiltinFunctionType, ir.Loc}  # parts of an instruction that hold no variable


def get_call_type(function, context, args, kws):
    """BaseFunction.get_call_type: each time it tries all that an operator can do with any type, and words what does not fit.

    What compiles a function of its own for the types (`overload`) is asked each time: Numba keeps one copy of that, whoever compiled last.
    """
    if not building.depth:
        return stock["BaseFunction.get_call_type"](function, context, args, kws)
    met, kinds = function.__dict__.setdefault("_met", {}), (args, tuple(kws.items()))
    if kinds not in met:
        signature = stock["BaseFunction.get_call_type"](function, context, args, kws)
        if function.get_impl_key(signature) is not function.typing_key:
            return signature
        met[kinds] = signature
    return met[kinds]


def get_abi_sizeof(context, kind):
    """BaseContext.get_abi_sizeof: it has a module parsed for every question."""
    if not building.depth:
        return stock["BaseContext.get_abi_sizeof"](context, kind)
    if (text := str(kind)) not in sizes:
        sizes[text] = stock["BaseContext.get_abi_sizeof"](context, kind)
    return sizes[text]


def optimize_functions(library, module):
    """CPUCodeLibrary._optimize_functions: one set of passes for all functions of a module, and none for those that are only declared."""
    if not building.depth:
        return stock["CPUCodeLibrary._optimize_functions"](library, module)
    module.data_layout = library._codegen._data_layout
    passes, builder = library._codegen._function_pass_manager()
    for function in module.functions:
        if not function.is_declaration:
            passes.run(function, builder)


def post_process(processor, emit_dels=False, extend_lifetimes=False):
    """PostProcessor.run: asked after most passes, of which the last alone reads when variables die. Generators and the interpreter's mode read more."""
    if not building.depth or emit_dels or processor.func_ir.is_generator:
        return stock["PostProcessor.run"](processor, emit_dels, extend_lifetimes)
    processor.func_ir.blocks = canonicalize_cfg(processor.func_ir.blocks)
    processor.func_ir.variable_lifetime = VariableLifetime(processor.func_ir.blocks)
    processor.func_ir.generator_info = None


def variables_in(instruction, part):
    """ir.Inst._rec_list_vars: most parts of an instruction are told by their type alone."""
    kind = type(part)
    if kind is not dict and kind is not tuple and kind is not list:
        return [part] if kind is ir.Var else [] if kind in PLAIN else stock["Inst._rec_list_vars"](instruction, part)
    found = []
    for one in part.values() if kind is dict else part:
        if type(one) is ir.Var:
            found.append(one)
        elif type(one) not in PLAIN:
            found += variables_in(instruction, one)
    return found


def same_flags(flags, other):
    """TargetConfig.__eq__, asked a hundred thousand times a kernel: of the options that either has set; all others have their default in both."""
    if type(flags) is not type(other):
        return stock["TargetConfig.__eq__"](flags, other)
    one, two = flags._values, other._values
    return one == two or all(getattr(flags, name) == getattr(other, name) for name in one.keys() | two.keys())


def hash_of_flags(flags):
    """TargetConfig.__hash__: of the options' names, as Numba's own (which sorts them anew each time)."""
    return hash(type(flags))


def extract_value(builder, aggregate, index, name=""):
    """IRBuilder.extract_value: what was put together here is not taken apart again. A tuple of arrays has hundreds of fields, for every call and every use."""
    if building.depth and type(index) is int:
        one = aggregate
        while type(one) is InsertValue and len(one.indices) == 1:
            if one.indices[0] == index:
                return one.value
            one = one.aggregate
    return stock["IRBuilder.extract_value"](builder, aggregate, index, name)


def get_meminfos(runtime, builder, kind, value):
    """NRTContext.get_meminfos: of the parts that hold arrays, not of every number."""
    if not building.depth:
        return stock["NRTContext.get_meminfos"](runtime, builder, kind, value)
    models = runtime._context.data_model_manager
    model = models[kind]
    found = [(kind, model.get_nrt_meminfo(builder, value))] if model.has_nrt_meminfo() else []
    for part, take in model.traverse(builder):
        if part not in counted:
            counted[part] = models[part].contains_nrt_meminfo()
        if counted[part]:
            found += get_meminfos(runtime, builder, part, take(value))
    return found


def find_singly_assigned(lowering):
    """Lower._find_singly_assigned_variable: neither are arguments, which are there from the first block on, kept in memory where no array is counted."""
    stock["Lower._find_singly_assigned_variable"](lowering)
    if not building.depth or lowering.context.enable_nrt or lowering.func_ir.func_id.is_generator:
        return
    given = [one for block in lowering.blocks.values() for one in block.body if isinstance(one, ir.Assign)]
    times = Counter(one.target.name for one in given)
    lowering._singly_assigned_vars |= {one.target.name for one in given if isinstance(one.value, ir.Arg) and times[one.target.name] == 1}


SHORTCUTS = (
    (BaseFunction, "get_call_type", get_call_type),
    (BaseContext, "get_abi_sizeof", get_abi_sizeof),
    (CPUCodeLibrary, "_optimize_functions", optimize_functions),
    (PostProcessor, "run", post_process),
    (ir.Inst, "_rec_list_vars", variables_in),
    (TargetConfig, "__eq__", same_flags),
    (TargetConfig, "__hash__", hash_of_flags),
    (IRBuilder, "extract_value", extract_value),
    (NRTContext, "get_meminfos", get_meminfos),
    (Lower, "_find_singly_assigned_variable", find_singly_assigned),
)
