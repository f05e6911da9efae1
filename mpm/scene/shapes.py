"""Shapes by formulas, the menu of all shapes, and what a grid cuts out of them (role: mpm.scene.base.Shape).

To add a shape: a frozen dataclass with `pieces` (plane), `prism` (the same at every height) or `cuts` (any other), one line in `KINDS`;
tests/scene/test_cut.py ranges over the table.
"""

from dataclasses import dataclass, replace

import numpy as np

from mpm.scene import cut as cutting
from mpm.scene.base import Shape
from mpm.scene.contents import CutCells, particles
from mpm.scene.cut import Segment
from mpm.scene.sphere import ball, circle

Point = tuple[float, ...]


def _point(values) -> Point:
    return tuple(float(v) for v in np.atleast_1d(values))


@dataclass(frozen=True)
class Box(Shape):
    """Interval, rectangle or block from `lower` to `upper`, turned by `angle` [rad] about its centre (in the plane of the first two coordinates)."""

    lower: Point
    upper: Point
    angle: float = 0.0

    def _frame(self):
        lower, upper = np.array(self.lower), np.array(self.upper)
        c, s = (np.cos(self.angle), np.sin(self.angle)) if self.angle else (1.0, 0.0)
        return (lower + upper) / 2, (upper - lower) / 2, np.array([[c, -s], [s, c]])

    def bounds(self):
        if self.angle == 0.0 or len(self.lower) == 1:
            return np.array(self.lower), np.array(self.upper)
        centre, half, turn = self._frame()
        half[:2] = np.abs(turn) @ half[:2]
        return centre - half, centre + half

    def distance(self, x):
        centre, half, turn = self._frame()
        local = np.asarray(x, dtype=float) - centre
        if self.angle:
            local = np.concatenate([local[:, :2] @ turn, local[:, 2:]], axis=1)
        q = np.abs(local) - half
        return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)

    def moved(self, shift):
        return replace(self, lower=_point(np.add(self.lower, shift)), upper=_point(np.add(self.upper, shift)))

    def pieces(self):
        (x0, y0), (x1, y1) = self.lower[:2], self.upper[:2]
        corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        if self.angle:
            centre, _, turn = self._frame()
            corners = centre[:2] + (corners - centre[:2]) @ turn.T
        return [Segment(tuple(corners[k]), tuple(corners[(k + 1) % 4]), k) for k in range(4)]

    def prism(self):
        return (Box(self.lower[:2], self.upper[:2], self.angle), self.lower[2], self.upper[2]) if len(self.lower) == 3 else None

    def cuts(self, edges, order):
        return (cutting.line(self.lower[0], self.upper[0], edges[0], order),) if len(self.lower) == 1 else super().cuts(edges, order)


@dataclass(frozen=True)
class Ball(Shape):
    """Interval, disc or sphere; in (r, z) a sphere with its centre on the axis, else a torus."""

    centre: Point
    radius: float

    def bounds(self):
        return np.array(self.centre) - self.radius, np.array(self.centre) + self.radius

    def distance(self, x):
        return np.linalg.norm(np.asarray(x, dtype=float) - self.centre, axis=1) - self.radius

    def moved(self, shift):
        return replace(self, centre=_point(np.add(self.centre, shift)))

    def pieces(self):
        return circle(self.centre, self.radius)

    def cuts(self, edges, order):
        if len(self.centre) == 1:
            return (cutting.line(self.centre[0] - self.radius, self.centre[0] + self.radius, edges[0], order),)
        return super().cuts(edges, order) if len(self.centre) == 2 else ball(self.centre, self.radius, edges, order)


@dataclass(frozen=True)
class Cylinder(Shape):
    """Round the axis in (r, z), base = (0, z); round a vertical line in (x, y, z), base = the centre of its lower face."""

    radius: float
    height: float
    base: Point

    def bounds(self):
        base = np.array(self.base)
        if len(base) == 2:
            return base, np.add(base, [self.radius, self.height])
        side = np.array([self.radius, self.radius, 0])
        return base - side, base + side + [0, 0, self.height]

    def distance(self, x):
        x = np.asarray(x, dtype=float)
        r = x[:, 0] if len(self.base) == 2 else np.hypot(x[:, 0] - self.base[0], x[:, 1] - self.base[1])
        half = self.height / 2
        q = np.stack([r - self.radius, np.abs(x[:, -1] - self.base[-1] - half) - half], axis=1)
        return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)

    def moved(self, shift):
        return replace(self, base=_point(np.add(self.base, shift)))

    def pieces(self):
        lower, upper = self.bounds()
        return Box(_point(lower), _point(upper)).pieces()[:3]  # the fourth is the axis: no surface, and vertical, so no part in areas

    def prism(self):
        return (Ball(self.base[:2], self.radius), self.base[2], self.base[2] + self.height) if len(self.base) == 3 else None


@dataclass(frozen=True)
class Ring(Shape):
    """Between two circles round `centre`."""

    centre: Point
    inner: float
    outer: float

    def bounds(self):
        return np.array(self.centre) - self.outer, np.array(self.centre) + self.outer

    def distance(self, x):
        r = np.linalg.norm(np.asarray(x, dtype=float) - self.centre, axis=1)
        return np.maximum(r - self.outer, self.inner - r)

    def moved(self, shift):
        return replace(self, centre=_point(np.add(self.centre, shift)))

    def smooth_side(self, side, plane):
        return {"outer": 0, "inner": 1}.get(side) if plane else None

    def pieces(self):
        return [*circle(self.centre, self.outer), *(replace(a, outward=-1, side=1) for a in circle(self.centre, self.inner))]


@dataclass(frozen=True)
class Polygon(Shape):
    """Simple polygon through `vertices` in either sense; each edge is a side."""

    vertices: tuple[Point, ...]

    def bounds(self):
        return np.min(self.vertices, axis=0), np.max(self.vertices, axis=0)

    def distance(self, x):
        x = np.asarray(x, dtype=float)
        a = np.array(self.vertices)
        b = np.roll(a, -1, axis=0)
        nearest, inside = np.full(len(x), np.inf), np.zeros(len(x), dtype=bool)
        for p, q in zip(a, b, strict=True):
            run = q - p
            t = np.clip((x - p) @ run / (run @ run), 0, 1)
            nearest = np.minimum(nearest, np.linalg.norm(x - p - t[:, None] * run, axis=1))
            if p[1] != q[1]:
                spans = (p[1] > x[:, 1]) != (q[1] > x[:, 1])
                inside ^= spans & (x[:, 0] < p[0] + (x[:, 1] - p[1]) / run[1] * run[0])
        return np.where(inside, -nearest, nearest)

    def moved(self, shift):
        return replace(self, vertices=tuple(_point(np.add(v, shift)) for v in self.vertices))

    def pieces(self):
        a = np.array(self.vertices)
        points = a if self.turning() > 0 else a[::-1]
        return [Segment(tuple(p), tuple(q), k) for k, (p, q) in enumerate(zip(points, np.roll(points, -1, axis=0), strict=True))]

    def smooth_side(self, side, plane):
        if not side.startswith("edge "):
            return None
        edge, count = int(side.removeprefix("edge ")) - 1, len(self.vertices)
        return edge if self.turning() > 0 else (count - 2 - edge) % count  # `pieces` goes round the other way

    def turning(self) -> float:
        """Twice the area: above 0 where the vertices go round with the inside on the left."""
        a = np.array(self.vertices)
        b = np.roll(a, -1, axis=0)
        return float(np.sum(a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]))


KINDS = {"box": Box, "ball": Ball, "cylinder": Cylinder, "ring": Ring, "polygon": Polygon}


def shape(model, dimension=None) -> Shape:
    """The shape that a config names: `{"ball": {"centre": [0, 0], "radius": 1.0}}`, a model with a `kind`, or a Shape already."""
    if isinstance(model, Shape):
        return model
    if getattr(model, "kind", "") == "mesh":
        from mpm.scene.mesh import from_config  # here, since it brings kernels

        return from_config(model)
    given = model if isinstance(model, dict) else {model.kind: model.model_dump()}
    (kind, values), *more = [(k, v) for k, v in given.items() if v is not None]
    if more or kind not in KINDS:
        raise ValueError(f"a shape is one of {', '.join(KINDS)}, not {', '.join(given)}")
    made = {k: _point(v) if np.ndim(v) == 1 else tuple(_point(p) for p in v) if np.ndim(v) == 2 else float(v) for k, v in values.items() if v is not None}
    for name in ("lower", "upper", "centre", "base"):
        if name in made and np.ndim(values[name]) == 0:
            made[name] = _point(made[name])
    result = KINDS[kind](**made)
    wanted = {"axisymmetric": 2, None: result.dimension}.get(dimension, dimension)
    if result.dimension != wanted:
        raise ValueError(f"{kind}: {result.dimension} coordinates in a scene of dimension {dimension}")
    return result


def cut_quadrature(body: Shape, edges, order: int = 4):
    """Exact (Quadrature, Surface) of a shape over the cells between `edges` (one increasing array a direction)."""
    return body.cut([np.asarray(e, dtype=float) for e in edges], order)


def cells(body: Shape, edges, radial: bool = False) -> CutCells:
    """One particle a cut cell, and its pieces of surface. `radial`: weighted with r, per radian."""
    edges = [np.asarray(e, dtype=float) for e in edges]
    return particles(body.contents(edges, radial), edges)
