"""Scenes of contact in any dimension: blocks that stand along the last direction, on the wall that is left in 1-D and bottom elsewhere."""

import numpy as np

DIMENSIONS = (1, 2, "axisymmetric", 3)


def count(dimension) -> int:
    return 2 if dimension == "axisymmetric" else dimension


def up(dimension) -> str:
    return "xyz"[count(dimension) - 1] if dimension != "axisymmetric" else "z"


def floor(dimension) -> str:
    return "left" if dimension == 1 else "bottom"


def along(dimension, value: float) -> list[float]:
    return [0.0] * (count(dimension) - 1) + [value]


def block(dimension, low: float, width: float, base: float, height: float) -> dict:
    """From `low` on sideways; about the axis with that diameter in a round scene."""
    if dimension == "axisymmetric":
        return {"cylinder": {"radius": width / 2, "height": height, "base": [0.0, base]}}
    sides = count(dimension) - 1
    return {"box": {"lower": [low] * sides + [base], "upper": [low + width] * sides + [base + height]}}


def grid(dimension, cell: float, side: float, height: float) -> dict:
    return {"dimension": dimension, "size": [side] * (count(dimension) - 1) + [height], "cell": cell}


def dropped(dimension, gap, offset=0.0, cells=2, cell=0.125, E=300.0, drag=12.0, end=1.0, **more) -> dict:
    """A block of some cells that falls on to the floor from `gap` cells, `offset` cells beside the grid's lines."""
    wide = cells * cell if dimension != "axisymmetric" else 2 * (cells + offset) * cell
    return {
        "grid": grid(dimension, cell, (cells + 4) * cell, (cells + 4) * cell),
        "bodies": {"block": {"shape": block(dimension, (2 + offset) * cell, wide, gap * cell, cells * cell), "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": E, "nu": 0.3}}}},
        "walls": {floor(dimension): "contact"}, "gravity": along(dimension, -1.0),
        "loads": [{"of": "block", "drag": {"rate": drag}}] if drag else [],
        "time": {"end": end}, "output": {"every": end / 20},
    } | more  # fmt: skip


def pressed(dimension, offset=0.0, F=0.9, n=8, wide=2, end=20.0, **more) -> dict:
    """A bar of one metre and nu = 0, `offset` cells above the wall on a tool that stands, pressed to F by another."""
    h, low = 1 / n, offset / n
    plate = lambda a, b: {"box": {"lower": along(dimension, a), "upper": [(wide + 4) * h] * (count(dimension) - 1) + [b]}}  # noqa: E731
    way = {"time": [0, 0.6 * end], "displacement": [along(dimension, 0.0), along(dimension, F - 1)]}
    tools = {"press": {"shape": plate(1 + low, 1 + low + 3 * h), "motion": {"path": way}}}
    if offset:
        tools["anvil"] = {"shape": plate(low - 2 * h, low)}
    return {
        "grid": grid(dimension, h, (wide + 4) * h, 1.0 + 8 * h),
        "bodies": {"bar": {"shape": block(dimension, 2 * h, wide * h * (2 if dimension == "axisymmetric" else 1), low, 1.0), "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.0}}}},
        "tools": tools, "walls": {floor(dimension): "contact"}, "loads": [{"of": "bar", "drag": {"rate": 1.0}}],
        "time": {"end": end}, "output": {"every": end / 10},
    } | more  # fmt: skip


def bars(dimension, n=16, wide=2, speed=0.01, gap=0.3, ratio=1.0, end=4.4, every=0.1) -> dict:
    """A bar that flies into another, nu = 0: the second `ratio` times as dense and stiff."""
    h = 1 / n
    materials = {name: {"density": k, "elastic": {"hencky": {"E": k, "nu": 0.0}}} for name, k in (("m", 1.0), ("k", ratio))}
    width = wide * h * (2 if dimension == "axisymmetric" else 1)
    return {
        "grid": grid(dimension, h, (wide + 4) * h, 4.0),
        "bodies": {"a": {"shape": block(dimension, 2 * h, width, 0.3, 1.0), "material": "m", "velocity": along(dimension, speed)},
                   "b": {"shape": block(dimension, 2 * h, width, 1.3 + gap * h, 1.0), "material": "k"}},
        "materials": materials, "time": {"end": end}, "output": {"every": every},
    }  # fmt: skip


def conducting(dimension, n, conductance=None, end=0.05, base=0.0) -> dict:
    """Two blocks of half a metre at 400 and 300 K, one on the other, insulated else."""
    h = 1 / n
    wide = 2 * h * (2 if dimension == "axisymmetric" else 1)
    scene = {
        "grid": grid(dimension, h, 6 * h, 1.0 + 4 * h),
        "bodies": {name: {"shape": block(dimension, 2 * h, wide, low + base * h, 0.5), "material": "m", "temperature": T}
                   for name, low, T in (("hot", 0.0, 400), ("cold", 0.5, 300))},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}},
        "time": {"end": end}, "output": {"every": end / 5},
    }  # fmt: skip
    if conductance is not None:
        scene["contacts"] = [{"between": ["hot", "cold"], "conductance": conductance}]
    return scene


def volume(dimension, run) -> float:
    return float(np.asarray(run["series"]["volume_total"])[0])
