"""Coordinates of a dataset: the planned values of what varies, and scalars for the parameters that do not."""

import json
import math
from collections import Counter
from typing import Any

import numpy as np

from mpm.records.netcdf import Array
from mpm.records.variables import VARIABLES


def storable(values: Any) -> np.ndarray:
    """Values as numbers or text: a law or another kind on an axis becomes JSON, truth 0 or 1."""
    array = np.asarray(values)
    if array.dtype.kind == "b":
        return array.astype(np.int8)
    if array.dtype.kind in "fiuUS":
        return array
    flat = [value if isinstance(value, str) else json.dumps(value, ensure_ascii=False) for value in np.asarray(values, dtype=object).ravel().tolist()]
    return np.array(flat, dtype=object).reshape(array.shape)


def planned(plan: Any) -> dict[str, Array]:
    """Coordinates along the swept dimensions, and what follows from them."""
    found = {}
    for dim in plan.dims:
        for row in dim.coords:
            found[row.name] = Array((dim.name,), storable(row.values), {"units": row.units or "1", "long_name": row.long_name, "config_path": row.config_path})
    for dims, row in plan.derived:
        found[row.name] = Array(dims, storable(row.values), {"units": row.units or "1", "long_name": row.long_name, "config_path": row.config_path})
    return found


def fixed(plan: Any, swept: list[str], taken: set[str]) -> dict[str, Array]:
    """Scalar coordinates: every quantity of the config that does not vary, by its last word where that is unique, else by its path."""
    from mpm.config.names import Names

    if not plan.cases:
        return {}
    experiment = plan.cases[0].experiment
    names, resolved, rows = Names(experiment), experiment.resolved(), {}
    for path, slot in names.slots.items():
        name, value = names.spoken[path], at(resolved, path)
        varies = any(name == one or name.startswith(one + ".") for one in swept)
        if slot.quantity and path[0] != "output" and isinstance(value, int | float | str) and not varies:
            number = math.inf if value == ".inf" else value
            if isinstance(number, int | float) and not isinstance(path[-1], int):
                rows[name] = (float(number), slot.quantity, slot.description)
    words = Counter(name.rsplit(".", 1)[-1] for name in (*rows, *swept))
    blocked = taken | set(VARIABLES) | {dim.name for dim in plan.dims}
    found = {}
    for name, (number, quantity, said) in rows.items():
        word = name.rsplit(".", 1)[-1]
        attrs = {"units": quantity.units, "long_name": said or quantity.name, "config_path": name}
        found[word if words[word] == 1 and word not in blocked else name] = Array((), number, attrs)
    return found


def at(tree: Any, path: tuple) -> Any:
    """The value at a path of plain containers; None where there is none (a law written as a number has nothing below it)."""
    for key in path:
        try:
            tree = tree[key]
        except (KeyError, IndexError, TypeError):
            return None
    return tree
