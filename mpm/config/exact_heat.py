"""Exact solutions of heat that a run may be compared with, beside those in config.output."""

from typing import Annotated, Any, ClassVar

from pydantic import field_validator

from mpm.config.base import Kind, doc
from mpm.config.bodies import Point
from mpm.config.quantities import Length, Quantity, TemperatureDifference
from mpm.config.sources import ByFormula

Positive = Annotated[float, Quantity("", "order", above=0)]


class NafemsT3(Kind):
    """A bar, one end at the start's temperature, the other following a sine (NAFEMS T3)."""

    kind: ClassVar[str] = "nafems_t3"
    body: str | None = doc(None, description="the body that is the bar; the only one unless given")


class NafemsT4(Kind):
    """Steady plate: hot bottom, insulated left, convection right and top (NAFEMS T4)."""

    kind: ClassVar[str] = "nafems_t4"
    body: str | None = doc(None, description="the body that is the plate; the only one unless given")


class GaussianBox(Kind):
    """A Gaussian that spreads in an insulated box; the run starts from it."""

    kind: ClassVar[str] = "gaussian_box"
    centre: Point = doc(description="centre of the Gaussian")
    sigma: Length = doc(description="standard deviation at the start")
    rise: TemperatureDifference = doc(description="height at the start, above the body's temperature")
    body: str | None = doc(None, description="the body that is the box; the only one unless given")


class Stefan(Kind):
    """Melting of a half space behind a hot face, latent heat as a narrow bump of alpha (Neumann's solution)."""

    kind: ClassVar[str] = "stefan"
    body: str | None = doc(None, description="the body that melts; the only one unless given")


class LayersInContact(Kind):
    """Slabs or coaxial cylinders that touch, each of its own material (series)."""

    kind: ClassVar[str] = "layers"
    body: str | None = doc(None, description="the layer that the error is told of")


class HeatedSlab(Kind):
    """A slab heated evenly from within that cools through its faces (parabola and series)."""

    kind: ClassVar[str] = "heated_slab"
    body: str | None = doc(None, description="the body that is the slab; the only one unless given")


class Formulas(Kind):
    """A solution that the config gives by formulas, kept by its `sources`."""

    kind: ClassVar[str] = "formulas"
    body: str | None = doc(None, description="the body that the solution is about; the only one unless given")
    temperature: ByFormula | None = doc(None, description="temperature [K] over the place at the start and time; the run starts from it")
    displacement: tuple[ByFormula, ...] | None = doc(None, description="displacement [m], one formula a direction, zero at the start")
    order: Positive | None = doc(None, description="order in the cell that is to be expected, as the table of verification problems declares it")

    @field_validator("temperature", mode="before")
    @classmethod
    def text(cls, value: Any) -> Any:
        """The text alone is the formula."""
        return {"text": value} if isinstance(value, str) else unwrapped(value)

    @field_validator("displacement", mode="before")
    @classmethod
    def texts(cls, value: Any) -> Any:
        """The texts alone are the formulas."""
        return [cls.text(one) for one in value] if isinstance(value, list | tuple) else value


def unwrapped(value: Any) -> Any:
    """As a resolved config has it, under its kind."""
    return value["formula"] if isinstance(value, dict) and set(value) == {"formula"} else value


HEAT: tuple[type[Kind], ...] = (NafemsT3, NafemsT4, GaussianBox, Stefan, LayersInContact, HeatedSlab, Formulas)
