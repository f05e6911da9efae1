"""Bodies: a shape filled with a material, with its state at the start."""

from typing import Annotated, Any, ClassVar

from pydantic import model_validator
from pydantic_core import core_schema

from mpm.config.base import Kind, Model, doc, one_of, problem
from mpm.config.inflow import Inflow
from mpm.config.loading import Strains
from mpm.config.quantities import Angle, AngularVelocity, Coordinate, Length, PerLength, Quantity, Temperature, Velocity

Point = tuple[Coordinate, ...]


def turn(a: Point, b: Point, c: Point) -> float:
    """Above 0 where c lies to the left of the way from a to b, below 0 to the right."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def crossing(edges: list[tuple[Point, Point]]) -> tuple[int, int] | None:
    """Numbers of the first two edges that cross, each with its ends on both sides of the other."""
    begins = sorted((min(a[0], b[0]), k) for k, (a, b) in enumerate(edges))
    near: list[int] = []
    for low, k in begins:
        a, b = edges[k]
        near = [m for m in near if max(edges[m][0][0], edges[m][1][0]) > low]
        for m in near:
            c, d = edges[m]
            if turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
                return min(k, m), max(k, m)
        near.append(k)
    return None


class Box(Kind):
    """Interval, rectangle or block between two corners; in two dimensions it may be turned about its centre."""

    kind: ClassVar[str] = "box"
    lower: Point = doc(description="corner with the smallest coordinates")
    upper: Point = doc(description="corner with the largest coordinates")
    angle: Angle = doc(0.0, description="rotation about the centre, counter-clockwise (two dimensions only)")

    @model_validator(mode="after")
    def order(self) -> "Box":
        """Upper above lower in every direction."""
        for index, (low, high) in enumerate(zip(self.lower, self.upper, strict=False)):
            if high <= low:
                raise problem("box", "the upper corner must lie above the lower one in every direction", f"above {low:g} [m]", at=("upper", index))
        return self


class Ball(Kind):
    """Interval in 1-D, disc in 2-D, sphere in axisymmetric (centre on the axis) and 3-D."""

    kind: ClassVar[str] = "ball"
    centre: Point = doc(description="centre")
    radius: Length = doc(description="radius")


class Cylinder(Kind):
    """Cylinder about the axis (axisymmetric, base [0, z]) or about the last coordinate (3-D, base = centre of the lower face)."""

    kind: ClassVar[str] = "cylinder"
    radius: Length = doc(description="radius")
    height: Length = doc(description="height")
    base: Point = doc(description="centre of the lower face")


class Ring(Kind):
    """Two-dimensional ring between two radii."""

    kind: ClassVar[str] = "ring"
    centre: Point = doc(description="centre")
    inner: Length = doc(description="inner radius")
    outer: Length = doc(description="outer radius")

    @model_validator(mode="after")
    def order(self) -> "Ring":
        """Outer radius above the inner one."""
        if self.outer <= self.inner:
            raise problem("ring", "the outer radius must exceed the inner one", f"above {self.inner:g} [m]", at=("outer",))
        return self


class Polygon(Kind):
    """Polygon in two dimensions or in the (r, z) plane, without crossings; either orientation."""

    kind: ClassVar[str] = "polygon"
    vertices: tuple[Point, ...] = doc(min_length=3, description="corners in order; the last is joined to the first")

    @model_validator(mode="after")
    def simple(self) -> "Polygon":
        """It has an inside: no corner twice in a row, no edge across another."""
        if any(len(corner) != 2 for corner in self.vertices):
            return self  # shapes_fit.py tells
        edges = list(zip(self.vertices, (*self.vertices[1:], self.vertices[0]), strict=True))
        for index, (one, other) in enumerate(edges):
            if one == other:
                raise problem("polygon", "the same corner twice in a row", "each corner once; the last is joined to the first", at=("vertices", index))
        if (found := crossing(edges)) is not None:
            first, second = found
            said = f"edge {second + 1} crosses edge {first + 1}, so it has no inside"
            raise problem("polygon", said, "corners in their order round the outline", at=("vertices", second))
        if all(turn(*edges[0], corner) == 0 for corner in self.vertices):
            raise problem("polygon", "its corners lie on one line", "at least three that do not", at=("vertices",))
        return self


class Mesh(Kind):
    """Closed mesh of triangles from a file, in three dimensions."""

    kind: ClassVar[str] = "mesh"
    file: str = doc(description="STL, OBJ, PLY or OFF file, relative to the config")
    unit: Length = doc(1.0, description="what a unit of the file is: 1 mm")
    centre: Point | None = doc(None, description="where the middle of its box is; where the file has it unless given")
    data: str = doc("", description="its triangles; filled in from the file when the config is read")

    @model_validator(mode="after")
    def whole(self) -> "Mesh":
        """What was filled in is there in full."""
        from mpm.triangles import unpacked

        try:
            if self.data:
                unpacked(self.data)
        except ValueError as error:
            raise problem("mesh", str(error), "a file, and no data", at=("data",)) from None
        return self


class MaterialPoint(Kind):
    """No extent: one state, carried along `loading`, exchanging heat as a lumped body (dimension 0)."""

    kind: ClassVar[str] = "point"
    surface_to_volume: PerLength | None = doc(None, description="area of the surface over the volume, where it exchanges heat: 6 over the edge of a cube")
    strain: Strains = doc(Strains(), description="elastic strain at the start")


class Spin:
    """Annotation of an angular velocity: one number about the origin of the plane, three in 3-D."""

    quantity = Quantity("rad/s", "angular velocity")

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        number = self.quantity.__get_pydantic_json_schema__(schema, handler)
        return {**number, "anyOf": [*number["anyOf"], {"type": "array", "items": number}]}

    def validate(self, value: Any) -> float | tuple[float, ...]:
        """A float, or a tuple of floats."""
        return tuple(map(self.quantity.validate, value)) if isinstance(value, list | tuple) else self.quantity.validate(value)


SHAPES: tuple[type[Kind], ...] = (Box, Ball, Cylinder, Ring, Polygon, Mesh, MaterialPoint)


class Body(Model):
    """A shape of one material, with temperature and velocity at the start."""

    shape: one_of("shape", *SHAPES) = doc(description="what the body fills at the start")
    material: str = doc(description="a name under materials")
    temperature: Temperature = doc(293.15, description="temperature at the start")
    velocity: tuple[Velocity, ...] | None = doc(None, description="velocity at the start, one number a direction; zero unless given")
    angular_velocity: Annotated[float | tuple[AngularVelocity, ...], Spin()] | None = doc(
        None, description="rotation about the body's centre of mass at the start: a number in two dimensions, three in 3-D"
    )
    inflow: Inflow | None = doc(None, description="the body comes in through a nozzle, whose inside is its shape; it is there from the start unless given")
