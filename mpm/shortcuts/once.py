"""What Numba works out anew for every instruction of a kernel, worked out once."""

from types import BuiltinFunctionType

from numba.core import base, ir
from numba.core.base import BaseContext
from numba.core.codegen import CPUCodeLibrary
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.runtime.context import NRTContext
from numba.core.targetconfig import TargetConfig
from numba.core.transforms import canonicalize_cfg
from numba.core.types.functions import BaseFunction

from mpm.shortcuts.building import building, counts, stock

sizes: dict = {}  # bytes of LLVM types, by their text
located: dict = {}  # whether what lowers an instruction asks where it stands, by its code
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


def get_meminfos(runtime, builder, kind, value):
    """NRTContext.get_meminfos: of the parts that hold arrays, not of every number."""
    if not building.depth:
        return stock["NRTContext.get_meminfos"](runtime, builder, kind, value)
    models = runtime._context.data_model_manager
    model = models[kind]
    found = [(kind, model.get_nrt_meminfo(builder, value))] if model.has_nrt_meminfo() else []
    for part, take in model.traverse(builder):
        if counts(runtime._context, part):
            found += get_meminfos(runtime, builder, part, take(value))
    return found


def has_loc(function):
    """numba.core.base._has_loc: by the signature of each function that lowers an instruction, for each instruction."""
    code = getattr(function, "__code__", None)
    if code is None or hasattr(function, "__wrapped__"):
        return stock["numba.core.base._has_loc"](function)
    if code not in located:
        located[code] = stock["numba.core.base._has_loc"](function)
    return located[code]


SHORTCUTS = (
    (BaseFunction, "get_call_type", get_call_type),
    (BaseContext, "get_abi_sizeof", get_abi_sizeof),
    (CPUCodeLibrary, "_optimize_functions", optimize_functions),
    (PostProcessor, "run", post_process),
    (ir.Inst, "_rec_list_vars", variables_in),
    (TargetConfig, "__eq__", same_flags),
    (TargetConfig, "__hash__", hash_of_flags),
    (NRTContext, "get_meminfos", get_meminfos),
    (base, "_has_loc", has_loc),
)
