"""Pairs of bodies that meet."""

from pydantic import model_validator

from mpm.config.base import Model, doc, problem
from mpm.config.boundary import Spell, ended
from mpm.config.programmes import FrictionProgramme
from mpm.config.quantities import Exchange


class Nothing(Model):
    """No parameters: `stick: {}`."""


class Pair(Spell):
    """How two bodies meet. A pair that is not named slides without friction and passes heat without resistance.

    Before `from` and after `until` it slides without friction and passes no heat.
    """

    between: tuple[str, ...] = doc(description="two names under bodies", min_length=2, max_length=2)
    friction: FrictionProgramme = doc(0.0, description="coefficient of friction; .inf holds as stick does; may change over time")
    stick: Nothing | None = doc(None, description="no sliding while they touch; they may part")
    welded: Nothing | None = doc(None, description="one body to motion, for ever")
    conductance: Exchange | None = doc(
        None, description="heat that passes where they touch, by area and difference of temperature; without resistance (.inf) unless given"
    )

    @model_validator(mode="after")
    def lasts(self) -> "Pair":
        """It ends after it began."""
        return ended(self)

    @model_validator(mode="after")
    def one_kind(self) -> "Pair":
        """Friction, stick or welded."""
        given = [key for key in ("friction", "stick", "welded") if getattr(self, key) not in (None, 0.0)]
        if len(given) > 1:
            raise problem("contact", f"{given[0]} and {given[1]} say different things of one pair", "one of friction, stick, welded", at=(given[1],))
        return self
