"""One LLVM module for each kernel that Python calls.

Numba optimises and emits every function that a kernel calls by itself, and once more inside each of its callers: 230 to 300 functions for a step, of which
eight are ever called from Python. Here a callee is typed and lowered only; the kernel links all that it reaches into one module, which is optimised and emitted
once. A nested call uses a table of its own, never what was compiled for Python or loaded from disk, so a kernel's module is a function of source and
types alone, and so are the last bits of its results.

This replaces methods of Numba (`REPLACED`; those of mpm.shortcuts only save time), for versions in `TESTED` only; elsewhere stock Numba compiles, slower,
with bits that may depend on what the process compiled before. Only kernels of this package are affected: functions that a user compiles take Numba's own way.
"""

import gc
import inspect
from contextlib import contextmanager

import numba
from llvmlite.binding import Linkage
from numba.core import errors, sigutils, types
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher, _FunctionCompiler

from mpm import compiling
from mpm.shortcuts import LENT, SHORTCUTS, building, stock

TESTED = (0, 66), (0, 68)  # first and last (major, minor) that passed the default tests (.ci/numba_versions.py)


class Entry:
    """Names a callee that has no machine code of its own."""


listeners = [compiling.spent.hear]  # called with a kernel and itself as it begins, with each function that was lowered for it, and with None when it is ready
subroutines: dict = {}  # what Numba's own operators compile for our kernels, apart from what they compile for others


def within_tested(version: str = numba.__version__) -> bool:
    return TESTED[0] <= tuple(int(part) for part in version.split(".")[:2]) <= TESTED[1]


def tried() -> str:
    return " to ".join(".".join(map(str, version)) for version in TESTED)


def ours(dispatcher) -> bool:
    return dispatcher.py_func.__module__.partition(".")[0] == "mpm"


@contextmanager
def kernel_under_way(dispatcher):
    """Callees are not emitted within; no collection of garbage, which finds none among the compiler's own objects and takes a sixth of the time."""
    context = dispatcher.targetctx
    collecting, others = gc.isenabled(), context.cached_internal_func
    gc.disable()
    building.depth, context.cached_internal_func = 1, subroutines
    building.kernel = dispatcher.py_func
    try:
        yield
    finally:
        building.depth, context.cached_internal_func = 0, others
        if collecting:
            gc.enable()


def compile_(dispatcher, sig):
    """Dispatcher.compile: the kernel itself as Numba does, a callee without wrappers, optimising and machine code."""
    with global_compiler_lock:  # before the depth is looked at: two threads may compile
        if building.depth:
            return compile_callee(dispatcher, sig)
        args, _ = sigutils.normalize_signature(sig)
        if not ours(dispatcher) or tuple(args) in dispatcher.overloads:
            return stock["Dispatcher.compile"](dispatcher, sig)
        with kernel_under_way(dispatcher):
            return stock["Dispatcher.compile"](dispatcher, sig)


def compile_callee(dispatcher, sig):
    args, return_type = sigutils.normalize_signature(sig)
    callees = callees_of(dispatcher)
    if tuple(args) not in callees:
        with dispatcher._compiling_counter:
            building.depth += 1
            try:
                result = dispatcher._compiler.compile(args, return_type)
            except errors.ForceLiteralArg as error:
                raise error.bind_fold_arguments(lambda args, kws: dispatcher._compiler.fold_argument_types(args, kws)[1]) from None
            finally:
                building.depth -= 1
        entry = Entry()
        dispatcher.targetctx.insert_user_function(entry, result.fndesc, [result.library])
        callees[tuple(args)] = result._replace(entry_point=entry)
        tell(dispatcher.py_func)
    return callees[tuple(args)].entry_point


def callees_of(dispatcher) -> dict:
    return dispatcher.__dict__.setdefault("_callees", {})


def tell(function) -> None:
    for listener in listeners:
        listener(building.kernel, function)


def compile_kernel(compiler, args, return_type):
    """_FunctionCompiler.compile: told of, where it is a kernel that the cache did not hold."""
    if building.depth != 1:
        return stock["_FunctionCompiler.compile"](compiler, args, return_type)
    tell(building.kernel)
    result = stock["_FunctionCompiler.compile"](compiler, args, return_type)
    tell(None)
    return result


def get_overload(dispatcher, sig):
    """Dispatcher.get_overload."""
    if not building.depth:
        return stock["Dispatcher.get_overload"](dispatcher, sig)
    args, _ = sigutils.normalize_signature(sig)
    return callees_of(dispatcher)[tuple(args)].entry_point


def nopython_signatures(dispatcher):
    """Dispatcher.nopython_signatures."""
    if not building.depth:
        return stock["Dispatcher.nopython_signatures"].fget(dispatcher)
    return [result.signature for result in callees_of(dispatcher).values()]


def get_call_template(dispatcher, args, kws):
    """Dispatcher.get_call_template: a literal True and a bool are one type to our functions, or each would be compiled twice."""
    if building.depth and ours(dispatcher):
        args = tuple(plain(kind) for kind in args)
        kws = {name: plain(kind) for name, kind in kws.items()}
    return stock["Dispatcher.get_call_template"](dispatcher, args, kws)


def plain(kind):
    return types.unliteral(kind) if isinstance(kind, types.IntegerLiteral | types.BooleanLiteral) else kind


def customize_flags(compiler, flags):
    """_FunctionCompiler._customize_flags."""
    if building.depth > 1:
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
    return stock["_FunctionCompiler._customize_flags"](compiler, flags)


def add_linking_library(library, other):
    """CPUCodeLibrary.add_linking_library: while a kernel is built, what it links may be unfinished."""
    if building.depth:
        library._linking_libraries.append(other)
    else:
        stock["CPUCodeLibrary.add_linking_library"](library, other)


def finalize(library):
    """CPUCodeLibrary.finalize: link everything that the kernel reaches, once, then optimise and emit as Numba does."""
    if not building.depth:
        return stock["CPUCodeLibrary.finalize"](library)
    library._raise_if_finalized()
    module = library._final_module
    called_from_python = {function.name for function in module.functions if not function.is_declaration}
    for other in sorted(reached(library), key=lambda one: one._finalized):  # of a finished one LLVM takes only what is asked for by then
        library._reload_init.update(other._reload_init)
        module.link_in(other._get_module_for_linking() if other._finalized else mergeable(other._final_module), preserve=True)
    for function in module.functions:
        if not function.is_declaration and function.name not in called_from_python:
            function.linkage = Linkage.internal
    library._optimize_final_module()
    module.verify()
    library._finalize_final_module()


def reached(library) -> list:
    """All that a library links, directly or through others, in the order in which it is met."""
    found, seen, stack = [], {library}, list(reversed(library._linking_libraries))
    while stack:
        one = stack.pop()
        if one not in seen:
            seen.add(one)
            found.append(one)
            if not one._finalized:  # else it holds what it links
                stack.extend(reversed(one._linking_libraries))
    return found


def mergeable(module):
    """The module, its functions such that another module may hold them too, and that LLVM keeps them until all is linked."""
    for function in module.functions:
        if not function.is_declaration and function.linkage in (Linkage.external, Linkage.linkonce_odr):
            function.linkage = Linkage.weak_odr
    return module


REPLACED = (
    (Dispatcher, "compile", compile_),
    (Dispatcher, "get_overload", get_overload),
    (Dispatcher, "get_call_template", get_call_template),
    (Dispatcher, "nopython_signatures", property(nopython_signatures)),
    (_FunctionCompiler, "compile", compile_kernel),
    (_FunctionCompiler, "_customize_flags", customize_flags),
    (CPUCodeLibrary, "add_linking_library", add_linking_library),
    (CPUCodeLibrary, "finalize", finalize),
    *SHORTCUTS,
    *LENT,
)


def install() -> bool:
    """Replace Numba's methods where its version was tested; whether they are."""
    if not stock and within_tested():
        for owner, name, new in REPLACED:
            stock[f"{owner.__name__}.{name}"] = inspect.getattr_static(owner, name)
            setattr(owner, name, new)
    return bool(stock)
