"""Loading: what is prescribed to a material point (grid.dimension 0), stage by stage, along its principal directions x, y, z."""

from typing import Annotated

from pydantic import model_validator

from mpm.config.base import Model, doc, problem
from mpm.config.quantities import Number, Pressure, Quantity, Temperature, Time

Rate = Annotated[float, Quantity("1/s", "strain rate")]
DIRECTIONS = ("xx", "yy", "zz")


class Rates(Model):
    """A rate in some of the directions; positive in extension."""

    xx: Rate | None = doc(None, description="rate along x")
    yy: Rate | None = doc(None, description="rate along y")
    zz: Rate | None = doc(None, description="rate along z")


class Stresses(Model):
    """A Cauchy stress in some of the directions; positive in tension."""

    xx: Pressure | None = doc(None, description="stress along x")
    yy: Pressure | None = doc(None, description="stress along y")
    zz: Pressure | None = doc(None, description="stress along z")


class Strains(Model):
    """Elastic Hencky (logarithmic) strains."""

    xx: Number = doc(0.0, description="strain along x")
    yy: Number = doc(0.0, description="strain along y")
    zz: Number = doc(0.0, description="strain along z")


class Stage(Model):
    """What is prescribed until a time. A direction that no key names is held: it does not strain."""

    until: Time | None = doc(None, description="time at which the stage ends; only the last stage may leave it out, and then lasts to time.end")
    strain_rate: Rates = doc(Rates(), description="rate of the logarithmic strain")
    stretch_rate: Rates = doc(Rates(), description="rate of the stretch: constant for platens of constant speed, speed over the height at the start")
    stress: Stresses = doc(Stresses(), description="Cauchy stress: the strain follows")
    temperature: Temperature | None = doc(None, description="reached at the end of the stage, linearly; unless given, adiabatic or by the surfaces")

    @model_validator(mode="after")
    def once(self) -> "Stage":
        """One prescription a direction."""
        for name in DIRECTIONS:
            said = [key for key in ("strain_rate", "stretch_rate", "stress") if getattr(getattr(self, key), name) is not None]
            if len(said) > 1:
                raise problem("twice", f"{name} has its {' and its '.join(said)} prescribed", "one of them", at=(said[1], name))
        return self

    @property
    def strains(self) -> bool:
        """Whether anything mechanical is prescribed."""
        return any(getattr(getattr(self, key), name) is not None for key in ("strain_rate", "stretch_rate", "stress") for name in DIRECTIONS)
