"""Loads: forces on the surface of a body that moves, and a drag that brings it to rest."""

from typing import Annotated

from pydantic import model_validator

from mpm.config.base import Model, doc, problem
from mpm.config.boundary import Side, Spell, ended
from mpm.config.quantities import Pressure, Quantity

Ramp = Annotated[float, Quantity("s", "ramp", least=0)]
Rate = Annotated[float, Quantity("1/s", "rate of drag", least=0)]
LOADS = ("traction", "drag")


FORMS = ("nominal", "cauchy", "pressure")


class Traction(Model):
    """A force by area: of the surface as it was (nominal), of the surface as it is (cauchy), or a pressure, which stays normal to the surface as it is."""

    nominal: tuple[Pressure, ...] | None = doc(None, description="force by area of the undeformed surface, one number a direction, which it keeps")
    cauchy: tuple[Pressure, ...] | None = doc(None, description="force by area of the present surface, one number a direction, which it keeps")
    pressure: Pressure | None = doc(None, description="force by area of the present surface, against its present outward normal; negative pulls")
    ramp: Ramp = doc(0.0, description="time to full load, of which 3 s^2 - 2 s^3 acts at s = t/ramp, t from when it begins; at once unless given")

    @model_validator(mode="after")
    def form(self) -> "Traction":
        """One form."""
        given = [key for key in FORMS if getattr(self, key) is not None]
        if len(given) != 1:
            raise problem("traction", "a traction is of one form" + (f", not {' and '.join(given)}" if given else ""), list(FORMS))
        return self


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
