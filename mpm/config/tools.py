"""Tools: rigid bodies that move as they are told, and press, hold, roll or warm the bodies that they meet."""

from typing import Annotated, Any

from pydantic import create_model, model_validator

from mpm.config.base import Model, doc, one_of, problem
from mpm.config.bodies import Ball, Box, Cylinder, Mesh, Polygon, Spin
from mpm.config.boundary import WallHeat
from mpm.config.programmes import FrictionProgramme
from mpm.config.quantities import AngularVelocity, Coordinate, Quantity, Velocity

Moment = Annotated[float, Quantity("s", "time", least=0)]
Force = Annotated[float, Quantity("N", "force")]
Mass = Annotated[float, Quantity("kg", "mass", above=0)]
SHAPES = (Box, Ball, Cylinder, Polygon, Mesh)
Shape = one_of("shape of a tool", *SHAPES)

MOMENTS: dict[str, Any] = {  # `from` is no name that a class could write
    "from": (Moment, doc(0.0, description="time of its beginning")),
    "until": (Moment | None, doc(None, description="time of its end; that of the run unless given")),
}
Spell: Any = create_model("Spell", __base__=Model, __doc__="From a time until another.", **MOMENTS)


class Path(Model):
    """Displacements from where the tool stands at the start, at increasing times; straight and steady between them."""

    time: tuple[Moment, ...] = doc(description="increasing times", min_length=1)
    displacement: tuple[tuple[Coordinate, ...], ...] = doc(description="displacement at each time, one number a direction", min_length=1)

    @model_validator(mode="after")
    def matching(self) -> "Path":
        """As many displacements as times, times increasing."""
        if len(self.time) != len(self.displacement):
            raise problem("path", f"{len(self.time)} times but {len(self.displacement)} displacements", "lists of the same length", at=("displacement",))
        for index, (low, high) in enumerate(zip(self.time, self.time[1:], strict=False)):
            if high <= low:
                raise problem("path", "times must increase: a tool does not jump", "each above the one before", at=("time", index + 1))
        return self


class Motion(Spell):
    """How a tool moves: by a velocity or a path, turning; or by a force along whose line it is guided. It stands still unless told."""

    velocity: tuple[Velocity, ...] | None = doc(None, description="steady velocity, one number a direction")
    path: Path | None = doc(None, description="displacements over time")
    spin: Annotated[float | tuple[AngularVelocity, ...], Spin()] | None = doc(None, description="about the middle of its box: a number in 2-D, three in 3-D")
    force: tuple[Force, ...] | None = doc(
        None,
        description="pushes the tool, weight and all, along its own line only, between `from` and `until`; it stands before and after; as 1-D and 2-D scenes "
        "count it, by area or depth",
    )
    mass: Mass | None = doc(None, description="of a tool that a force pushes; as 1-D and 2-D scenes count it, by area or depth")

    @model_validator(mode="after")
    def one_way(self) -> "Motion":
        """One of velocity, path, force; a mass with a force and with nothing else."""
        given = [key for key in ("velocity", "path", "force") if getattr(self, key) is not None]
        if len(given) > 1:
            raise problem("motion", f"{given[0]} and {given[1]} say different things of one motion", "one of velocity, path, force", at=(given[1],))
        if (self.force is None) != (self.mass is None):
            there, absent = ("force", "mass") if self.mass is None else ("mass", "force")
            raise problem("motion", f"a tool with a {there} needs a {absent}", f"{absent}: ...", at=(there,))
        if self.force is not None and not any(self.force):
            raise problem("motion", "a force of nothing gives no direction", "a force that is not zero", at=("force",))
        if self.until is not None and self.until <= getattr(self, "from"):
            raise problem("motion", "the motion ends before it begins", f"above {getattr(self, 'from'):g} [s]", at=("until",))
        for key in ("from", "until"):
            if self.path is not None and getattr(self, key):
                raise problem("motion", f"a path has its own times, and {key} says another", "no `from` and no `until` beside a path", at=(key,))
        return self


class Tool(Spell):
    """A rigid body that does as it is told. It exchanges heat with what touches it, and is not cooled by it."""

    shape: Shape = doc(description="what the tool fills at the start")
    motion: Motion = doc(Motion(), description="stands still unless given")
    friction: FrictionProgramme = doc(0.0, description="coefficient of friction; .inf lets nothing slide while it touches; may change over time")
    heat: WallHeat | None = doc(None, description="heat that the tool exchanges with what touches it")

    @model_validator(mode="after")
    def lasting(self) -> "Tool":
        """It is there for a while."""
        if self.until is not None and self.until <= getattr(self, "from"):
            raise problem("tool", "the tool goes before it comes", f"above {getattr(self, 'from'):g} [s]", at=("until",))
        return self
