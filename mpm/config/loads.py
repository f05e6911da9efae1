"""Loads: forces on the surface of a body that moves, and a drag that brings it to rest."""

from typing import Annotated

from pydantic import model_validator

from mpm.config.base import Model, doc, problem
from mpm.config.boundary import Side, Spell, ended
from mpm.config.quantities import Pressure, Quantity

Ramp = Annotated[float, Quantity("s", "ramp", least=0)]
Rate = Annotated[float, Quantity("1/s", "rate of drag", least=0)]
LOADS = ("traction", "drag")


class Traction(Model):
    """A force by area of the undeformed surface, that keeps its direction as the body deforms."""

    nominal: tuple[Pressure, ...] = doc(description="force by reference area, one number a direction")
    ramp: Ramp = doc(0.0, description="time to full load, of which 3 s^2 - 2 s^3 acts at s = t/ramp, t from when it begins; at once unless given")


class Drag(Model):
    """A force against the motion of every particle: -rate m v. Brings a loaded body to its static equilibrium."""

    rate: Rate = doc(description="rate at which free motion dies out; twice the slowest frequency is critical")


class Load(Spell):
    """What acts on a body, or on a part of its surface chosen by its outward normal at the start."""

    of: str = doc(description="a name under bodies")
    side: Side = doc("all", description="where the traction acts, by the outward normal at the start; inner or outer of a ring; edge 3 of a polygon")
    traction: Traction | None = doc(None, description="force by reference area")
    drag: Drag | None = doc(None, description="force against the motion of the whole body")

    @model_validator(mode="after")
    def lasts(self) -> "Load":
        """It ends after it began."""
        return ended(self)

    @model_validator(mode="after")
    def loads(self) -> "Load":
        """At least one load."""
        if all(getattr(self, key) is None for key in LOADS):
            raise problem("load", "the entry does not say what acts", list(LOADS))
        return self
