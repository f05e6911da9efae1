"""Exact solutions of heat that a run may be compared with, beside those in config.output."""

from typing import ClassVar

from mpm.config.base import Kind, doc
from mpm.config.bodies import Point
from mpm.config.quantities import Length, TemperatureDifference


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


HEAT: tuple[type[Kind], ...] = (NafemsT3, NafemsT4, GaussianBox, Stefan, LayersInContact)
