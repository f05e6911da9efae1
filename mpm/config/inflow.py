"""Inflow: a body that comes in through a nozzle, over time."""

from pydantic import model_validator

from mpm.config.base import doc, problem
from mpm.config.boundary import Spell, ended
from mpm.config.programmes import Programme, RateProgramme, VelocityProgramme


class Inflow(Spell):
    """The body's shape is the inside of a nozzle, its face downstream the mouth: what comes in has its cross-section, and is free once past the mouth."""

    velocity: tuple[VelocityProgramme, ...] | None = doc(
        None, description="velocity in the nozzle, one entry a direction and one of them not zero; each may change over time, and none turns round"
    )
    rate: RateProgramme | None = doc(None, description="volume by time, in place of velocity, of the whole mouth; it flows along gravity; may change over time")
    temperature: Programme | None = doc(
        None, description="temperature of what passes the mouth at that time; that of the body unless given; may change over time"
    )

    @model_validator(mode="after")
    def lasts(self) -> "Inflow":
        """It ends after it began."""
        return ended(self)

    @model_validator(mode="after")
    def flows(self) -> "Inflow":
        """By one of them."""
        given = [key for key in ("velocity", "rate") if getattr(self, key) is not None]
        if len(given) != 1:
            said = f"an inflow has one of velocity and rate{', not both' if given else ''}"
            raise problem("inflow", said, ["velocity", "rate"])
        return self
