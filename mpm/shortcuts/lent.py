"""Variables that are values, and arrays that are lent.

A variable that is assigned once, before all that reads it, is its value; Numba gives it a place in memory where it is read in another block. What comes from
an argument (a field of a tuple, a view of an array) lives as long as the call, for the caller holds it: its users are not counted. Numba counts each array of
each tuple wherever it is unpacked, an atomic operation each (`.ci/compile_times.py`, row `text`).
"""

from numba.core import ir, types
from numba.core.analysis import compute_cfg_from_blocks, must_use_alloca
from numba.core.lowering import Lower
from numba.core.runtime.context import NRTContext

from mpm.shortcuts.building import building, counts, stock


def find_values(lowering):
    """Lower._find_singly_assigned_variable: all that are assigned once; sets also which of them are lent."""
    lowering._lent = set()
    if not building.depth or lowering.func_ir.func_id.is_generator or must_use_alloca(lowering.blocks):
        return stock["Lower._find_singly_assigned_variable"](lowering)
    given, times, used, early, returned = assignments(lowering.blocks)
    counting, kinds, ways, values = lowering.context.enable_nrt, lowering.fndesc.typemap, None, set()
    for name, (label, assigned) in given.items():
        if times[name] > 1 or name in early:
            continue
        elsewhere = used.get(name, set()) - {label}
        if elsewhere:
            ways = ways or compute_cfg_from_blocks(lowering.blocks).dominators()
            if not all(label in ways[one] for one in elsewhere):
                continue
        if not counting or not counts(lowering.context, kinds[name]):
            values.add(name)
        elif name not in returned and is_lent(lowering, kinds, assigned, kinds[name]):
            lowering._lent.add(name)
            values.add(name)
        elif not elsewhere:
            values.add(name)
    lowering._singly_assigned_vars, lowering._blk_local_varmap = values, {}


def assignments(blocks):
    """By variable: where and what is assigned first, how often, in which blocks it is read; those read before, in the order of lowering; those returned."""
    given, times, used, early, returned = {}, {}, {}, set(), set()
    for label in sorted(blocks):
        for one in blocks[label].body:
            if type(one) is ir.Del:
                continue
            assigns = type(one) is ir.Assign
            for part in read_by(one.value) if assigns else one.list_vars():
                if part.name not in given:
                    early.add(part.name)
                used.setdefault(part.name, set()).add(label)
            if assigns:
                times[one.target.name] = times.get(one.target.name, 0) + 1
                given.setdefault(one.target.name, (label, one.value))
            elif type(one) is ir.Return:
                returned.add(one.value.name)
    return given, times, used, early, returned


def read_by(value):
    """The variables of what is assigned."""
    return [value] if type(value) is ir.Var else value.list_vars() if isinstance(value, ir.Inst) else ()


def is_lent(lowering, kinds, value, kind) -> bool:
    """Whether a value that holds arrays is an argument, or comes from what is lent without a new array."""
    lent = lowering._lent
    if type(value) is ir.Arg:
        return True
    if type(value) is ir.Var:
        return value.name in lent
    if type(value) is not ir.Expr or not isinstance(kind, types.Array | types.BaseTuple):
        return False
    if value.op == "build_tuple":
        return all(one.name in lent or not counts(lowering.context, kinds[one.name]) for one in value.items)
    if value.op not in ("getattr", "exhaust_iter", "static_getitem", "getitem") or value.value.name not in lent:
        return False
    source = kinds[value.value.name]
    if isinstance(source, types.BaseTuple):
        return value.op != "getitem"
    if not isinstance(source, types.Array) or value.op in ("getattr", "exhaust_iter"):
        return False
    index = value.index if value.op == "getitem" else value.index_var
    return index is not None and views(kinds[index.name])


def views(index) -> bool:
    """Whether an array has a view for such an index: numbers and slices; lists of places make an array."""
    if isinstance(index, types.BaseTuple):
        return all(views(one) for one in index.types)
    return isinstance(index, types.Integer | types.SliceType | types.NoneType) or index is types.ellipsis


def lower_assign(lowering, kind, assigned):
    """Lower.lower_assign."""
    building.lending = bool(building.depth) and assigned.target.name in lowering._lent
    try:
        return stock["Lower.lower_assign"](lowering, kind, assigned)
    finally:
        building.lending = False


def incref(runtime, builder, kind, value):
    """NRTContext.incref: not of what is lent."""
    if not (building.depth and building.lending):
        stock["NRTContext.incref"](runtime, builder, kind, value)


def delvar(lowering, name):
    """Lower.delvar: nothing ends with a number or with what is lent."""
    if not building.depth or (name not in lowering._lent and lowering.context.enable_nrt and counts(lowering.context, lowering.typeof(name))):
        stock["Lower.delvar"](lowering, name)


LENT = (
    (Lower, "_find_singly_assigned_variable", find_values),
    (Lower, "lower_assign", lower_assign),
    (Lower, "delvar", delvar),
    (NRTContext, "incref", incref),
)
