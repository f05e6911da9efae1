"""Surfaces that exchange heat, and walls of the domain."""

from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from mpm.config.base import Choice, Kind, Model, doc, one_of, problem
from mpm.config.quantities import Exchange, Temperature

Side = Annotated[Literal["all", "left", "right", "bottom", "top", "front", "back", "lateral"], Choice()]
WALL_SIDES = {0: (), 1: ("left", "right"), 2: ("left", "right", "bottom", "top"), "axisymmetric": ("outer", "bottom", "top"),
              3: ("left", "right", "front", "back", "bottom", "top")}  # fmt: skip
SURFACE_SIDES = {0: ("all",), 1: ("all", "left", "right"), 2: ("all", "left", "right", "bottom", "top"), "axisymmetric": ("all", "lateral", "bottom", "top"),
                 3: ("all", "left", "right", "front", "back", "bottom", "top", "lateral")}  # fmt: skip
EXCHANGES = ("convection",)


class Convection(Model):
    """Robin exchange: outward flux beta (T - outside)."""

    beta: Exchange = doc(description="heat-transfer coefficient; .inf fixes the temperature of the surface")
    outside: Temperature = doc(description="temperature of the surroundings")


class Surface(Model):
    """Part of a body's surface, chosen by its outward normal at the start, and how it exchanges heat."""

    of: str = doc(description="a name under bodies")
    side: Side = doc("all", description="which part, by the outward normal at the start")
    name: str | None = doc(None, description="names the surface in paths: surfaces.<name>.convection.beta", pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")
    convection: Convection | None = doc(None, description="convection to the surroundings")

    @model_validator(mode="after")
    def exchanges(self) -> "Surface":
        """At least one exchange."""
        if all(getattr(self, key) is None for key in EXCHANGES):
            raise problem("exchange", "the surface does not say how it exchanges heat", list(EXCHANGES))
        return self


class Slip(Kind):
    """No motion through the wall, free motion along it."""

    kind: ClassVar[str] = "slip"


class Stick(Kind):
    """No motion at the wall."""

    kind: ClassVar[str] = "stick"


class Contact(Kind):
    """Slip that lets go: no motion into the wall, free motion away from it."""

    kind: ClassVar[str] = "contact"


WALLS: tuple[type[Kind], ...] = (Slip, Stick, Contact)
Wall = one_of("wall", *WALLS)
