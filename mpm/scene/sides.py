"""Sides of a surface by its outward normals."""

import numpy as np

SIDES = {1: ("left", "right"), 2: ("left", "right", "bottom", "top"), 3: ("left", "right", "front", "back", "bottom", "top")}


def on_side(normal: np.ndarray, side: str) -> np.ndarray:
    """Which outward normals (N, d) face `side`: all, a direction (its component is the largest), or lateral (any that is not bottom or top).

    Inner and outer are those that face the axis and those that face away from it, along r.
    """
    d = normal.shape[1]
    if side == "all":
        return np.ones(len(normal), dtype=bool)
    facing = np.argmax(np.abs(normal) - 1e-12 * np.arange(d), axis=1)
    if side == "lateral":
        return (facing != d - 1) if d > 1 else np.ones(len(normal), dtype=bool)
    number = SIDES[d].index({"inner": "left", "outer": "right"}.get(side, side))
    axis = number // 2
    return (facing == axis) & ((normal[np.arange(len(normal)), facing] > 0) == bool(number % 2))
