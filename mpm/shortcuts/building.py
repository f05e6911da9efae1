"""Whether a kernel of ours is being built, and what was replaced for it."""

import threading


class Building(threading.local):
    """What this thread compiles: 0 nothing of ours, 1 a kernel that Python called, 2 and more its callees."""

    depth = 0
    kernel = None  # its Python function
    lending = False  # whether what is lowered has its arrays counted elsewhere


building = Building()
stock: dict = {}  # Numba's own methods, by place, where they are replaced
counted: dict = {}  # whether a type holds an array somewhere


def counts(context, kind) -> bool:
    """Whether values of a type hold arrays, whose users are counted."""
    if kind not in counted:
        counted[kind] = context.data_model_manager[kind].contains_nrt_meminfo()
    return counted[kind]
