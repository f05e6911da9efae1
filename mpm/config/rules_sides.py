"""Rules for sides: by the outward normal, and those that a shape has of itself (inner and outer of a ring in the plane, edges of a polygon)."""

from collections.abc import Iterator
from typing import Any

from mpm.config.boundary import RING_SIDES, SURFACE_SIDES
from mpm.config.explain import Finding
from mpm.config.problems import near


def is_of_shape(side: str, dimension: Any) -> bool:
    """Whether the shape has it of itself, whatever its normals."""
    return side.startswith("edge ") or (dimension == 2 and side in RING_SIDES)


def of_shape(shape: Any, dimension: Any) -> tuple[str, ...]:
    """Sides that a shape has beside those of its dimension; none of one that is missing or wrong."""
    kind = getattr(type(shape), "kind", "")
    if kind == "ring" and dimension == 2:
        return RING_SIDES
    return tuple(f"edge {k + 1}" for k in range(len(shape.vertices))) if kind == "polygon" else ()


def known_side(experiment: Any, path: tuple, item: Any) -> Iterator[Finding]:
    """The body that a surface or a load is `of` has such a side."""
    dimension, body = experiment.grid.dimension, experiment.bodies.get(item.of)
    if body is None or dimension == 0:
        more: tuple[str, ...] = ()
    else:
        more = of_shape(body.shape, dimension)
    if item.side not in (*SURFACE_SIDES[dimension], *more):
        shown = [*SURFACE_SIDES[dimension], *more]
        edge = item.side.startswith("edge ") and not more
        said = "only a polygon has edges" if edge else f"there is no such side in dimension {dimension}" if not more else "the body has no such side"
        yield Finding(path, said, shown, near(item.side, shown), given=item.side)
