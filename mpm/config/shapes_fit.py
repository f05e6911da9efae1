"""Whether a shape suits the dimension, lies in the domain, and holds a point."""

import math
from collections.abc import Iterator
from typing import Any

from mpm.config.bodies import Ball, Box, Cylinder, MaterialPoint, Mesh, Polygon, Ring
from mpm.config.partial import Unknown

ALL = (1, 2, "axisymmetric", 3)
WHERE: dict[Any, tuple] = {Box: ALL, Ball: ALL, Cylinder: ("axisymmetric", 3), Ring: (2,), Polygon: (2, "axisymmetric"), Mesh: (3,),
                          MaterialPoint: (0,)}  # fmt: skip
POINTS: dict[Any, tuple] = {Box: ("lower", "upper"), Ball: ("centre",), Cylinder: ("base",), Ring: ("centre",), Polygon: ("vertices",), Mesh: ("centre",),
                           MaterialPoint: ()}  # fmt: skip
ROUND_OFF = 1e-9


def misfits(shape: Any, dimension: Any, directions: int, kinds: tuple = tuple(WHERE)) -> Iterator[tuple[tuple, str, Any]]:
    """(keys below the shape, what is wrong, what is allowed); `kinds` there may be."""
    said = f"there is no {shape.kind} in dimension {dimension}"
    if dimension not in WHERE[type(shape)]:
        yield (), said, [kind.kind for kind in kinds if dimension in WHERE[kind]]
        return
    for key in POINTS[type(shape)]:
        if getattr(shape, key) is None:
            continue
        points = [((key, index), point) for index, point in enumerate(shape.vertices)] if key == "vertices" else [((key,), getattr(shape, key))]
        for at, point in points:
            if len(point) != directions:
                yield at, f"a point needs {directions} number{'s' * (directions != 1)} in dimension {dimension}, found {len(point)}", "one number a direction"
                return
    if isinstance(shape, Box) and shape.angle and dimension != 2:
        yield ("angle",), f"a box cannot be turned in dimension {dimension}", "dimension 2"
    on_axis = {"ball": "centre", "cylinder": "base"}.get(shape.kind)
    if dimension == "axisymmetric" and on_axis and getattr(shape, on_axis)[0] != 0:
        yield (on_axis, 0), f"the {on_axis} of a {shape.kind} lies on the axis r = 0", "0"


def bounds(shape: Any, dimension: Any) -> tuple[list[float], list[float]]:
    """Smallest and largest coordinates; r from 0 in axisymmetric scenes."""
    if isinstance(shape, Box):
        if not shape.angle:
            return list(shape.lower), list(shape.upper)
        centre = [(low + high) / 2 for low, high in zip(shape.lower, shape.upper, strict=True)]
        a, b = ((high - low) / 2 for low, high in zip(shape.lower, shape.upper, strict=True))
        c, s = abs(math.cos(shape.angle)), abs(math.sin(shape.angle))
        reach = [a * c + b * s, a * s + b * c]
    elif isinstance(shape, Mesh):
        vertices, _ = corners(shape)
        return vertices.min(axis=0).tolist(), vertices.max(axis=0).tolist()
    elif isinstance(shape, Polygon):
        return [min(axis) for axis in zip(*shape.vertices, strict=True)], [max(axis) for axis in zip(*shape.vertices, strict=True)]
    elif isinstance(shape, Cylinder):
        base = list(shape.base)
        around = [0.0 if dimension == "axisymmetric" else x - shape.radius for x in base[:-1]]
        return [*around, base[-1]], [*(x + shape.radius for x in base[:-1]), base[-1] + shape.height]
    else:
        centre = list(shape.centre)
        reach = [shape.outer if isinstance(shape, Ring) else shape.radius] * len(centre)
    low, high = [x - r for x, r in zip(centre, reach, strict=True)], [x + r for x, r in zip(centre, reach, strict=True)]
    return ([0.0, *low[1:]], high) if dimension == "axisymmetric" else (low, high)


def outside(shape: Any, dimension: Any, size: tuple[float, ...]) -> str:
    """In words, where a shape leaves the domain; empty if it does not."""
    if isinstance(shape, MaterialPoint) or (isinstance(shape, Mesh) and not shape.data):  # a mesh that is not read yet is looked at when it is
        return ""
    low, high = bounds(shape, dimension)
    for index, (a, b, length) in enumerate(zip(low, high, size, strict=True)):
        if a < -ROUND_OFF * length or b > length * (1 + ROUND_OFF):
            return f"the shape leaves the domain: it spans {a:.6g} to {b:.6g} m in direction {index}, the domain 0 to {length:g} m"
    return ""


def holds(shape: Any, point: tuple[float, ...], slack: float) -> bool:
    """Whether a point lies in a shape or at most `slack` [m] outside. The shape suits the dimension, the point has a number a direction."""
    if isinstance(shape, MaterialPoint) or (isinstance(shape, Mesh) and not shape.data):
        return True
    if isinstance(shape, Mesh):
        vertices, faces = corners(shape)
        return encloses(vertices, faces, point, slack)
    if isinstance(shape, Ball):
        return math.dist(point, shape.centre) <= shape.radius + slack
    if isinstance(shape, Ring):
        return shape.inner - slack <= math.dist(point, shape.centre) <= shape.outer + slack
    if isinstance(shape, Cylinder):
        return math.dist(point[:-1], shape.base[:-1]) <= shape.radius + slack and -slack <= point[-1] - shape.base[-1] <= shape.height + slack
    if isinstance(shape, Polygon):
        return within(shape.vertices, point, slack)
    if shape.angle:
        centre = [(low + high) / 2 for low, high in zip(shape.lower, shape.upper, strict=True)]
        c, s, x, y = math.cos(shape.angle), math.sin(shape.angle), point[0] - centre[0], point[1] - centre[1]
        point = (centre[0] + c * x + s * y, centre[1] - s * x + c * y)
    return all(low - slack <= x <= high + slack for low, x, high in zip(shape.lower, point, shape.upper, strict=True))


def corners(shape: Mesh) -> Any:
    """Vertices and faces of a mesh [m]."""
    from mpm.triangles import placed

    if not shape.data:
        raise Unknown  # it is read once the rest is known to be right
    return placed(shape)


def encloses(vertices: Any, faces: Any, point: tuple[float, ...], slack: float) -> bool:
    """Whether a point lies in a closed mesh, by the solid angle of its triangles (A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125)."""
    import numpy as np

    a, b, c = np.moveaxis(vertices[faces] - np.array(point), 1, 0)
    x, y, z = (np.linalg.norm(one, axis=1) for one in (a, b, c))
    below = x * y * z + np.sum(a * b, axis=1) * z + np.sum(b * c, axis=1) * x + np.sum(c * a, axis=1) * y
    turned = 2 * np.arctan2(np.einsum("fa,fa->f", a, np.cross(b, c)), below).sum() / (4 * np.pi)
    return bool(turned > 0.5 or min(x.min(), y.min(), z.min()) <= slack)


def within(vertices: Any, point: tuple[float, ...], slack: float) -> bool:
    """Whether a point lies in a simple polygon: a ray to the right crosses its edges an odd number of times, or an edge is near."""
    inside, (x, y) = False, point
    for (a, b), (c, d) in zip(vertices, (*vertices[1:], vertices[0]), strict=True):
        length = (c - a) ** 2 + (d - b) ** 2
        part = min(1.0, max(0.0, ((x - a) * (c - a) + (y - b) * (d - b)) / length)) if length else 0.0
        if math.hypot(x - a - part * (c - a), y - b - part * (d - b)) <= slack:
            return True
        inside ^= (b > y) != (d > y) and x < a + (y - b) / (d - b) * (c - a)
    return inside


def home(bodies: Any, point: tuple[float, ...], size: tuple[float, ...]) -> int | None:
    """Number of the first body that holds a point, by round-off of the domain's size at most; None where none does."""
    slack = ROUND_OFF * max(size, default=0.0)
    return next((k for k, body in enumerate(bodies.values()) if holds(body.shape, point, slack)), None)
