"""Rules for sizes that no machine takes: a cell or a step that is wrong by powers of ten is refused when it is read, not when memory or patience ends."""

import math
from collections.abc import Iterator
from typing import Any

from mpm.config.explain import Finding
from mpm.config.rules_scene import MOST_CELLS, moves
from mpm.config.shapes_fit import bounds, misfits

MOST_UNKNOWNS = 2_000_000  # nodes of rigid bodies, whose matrices are factorised
MOST_PARTICLES = 10**9  # 200 to 800 bytes each
ON_LINE = 1e-6  # cells
MOST_STEPS = 10**12  # months at a microsecond each


def sizes(experiment: Any) -> Iterator[list[float]]:
    """Extents of every body's box that fits the grid's dimension."""
    dimension, directions = experiment.grid.dimension, experiment.grid.directions
    for body in experiment.bodies.values():
        if body.shape.kind and not list(misfits(body.shape, dimension, directions)):
            yield [max(0.0, high - low) for low, high in zip(*bounds(body.shape, dimension), strict=True)]


def cells(grid: Any) -> float:
    """Cells of the domain."""
    return math.prod(min(length / grid.cell, 1e30) for length in grid.size)


def count(experiment: Any) -> Iterator[Finding]:
    """Unknowns of rigid bodies, or particles of those that move."""
    cell, directions = experiment.grid.cell, experiment.grid.directions
    if not directions or cell is None or cells(experiment.grid) > MOST_CELLS:  # which `rules_scene.grid` tells
        return
    if moves(experiment):
        edge, more, most, what = cell / experiment.method.particles, 0, MOST_PARTICLES, "particles"
    else:
        edge, more, most, what = cell, 2, MOST_UNKNOWNS, "unknowns in rigid bodies"
    found = sum(math.prod(min(extent / edge, 1e30) + more for extent in size) for size in sizes(experiment))
    if found > most:
        enough = cell * (found / most) ** (1 / directions)
        said = f"there would be about {found:.3g} {what}, and at most {most:_} are possible".replace("_", " ")
        yield Finding(("grid", "cell"), said, f"above {enough:.2g} [m]", given=cell)


def whole(experiment: Any) -> Iterator[Finding]:
    """Walls stand on grid lines, where bodies move: so does every side of the domain."""
    cell = experiment.grid.cell
    if cell is None or not experiment.grid.size or cells(experiment.grid) > MOST_CELLS or not moves(experiment):
        return
    for index, length in enumerate(experiment.grid.size):
        n = round(length / cell)
        if n and abs(n * cell - length) > ON_LINE * cell:
            near_by = " or ".join(f"{k * cell:.6g} [m]" for k in (math.floor(length / cell), math.ceil(length / cell)) if k)
            said = f"{length:g} m is no whole number of cells of {cell:g} m, and walls stand on grid lines"
            yield Finding(("grid", "size", index), said, f"{near_by}, or a grid.cell of {length / n:.6g} [m]")


def steps(experiment: Any) -> Iterator[Finding]:
    """Steps of a given length."""
    end = experiment.time.end
    for path, step in ((("time", "step"), experiment.time.step), (("method", "heat_step"), experiment.method.heat_step)):
        if step != "auto" and end / step > MOST_STEPS:
            yield Finding(path, f"the run would take {end / step:.3g} steps", f"at least {end / MOST_STEPS:.3g} [s], or auto", given=step)
