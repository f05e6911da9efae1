"""Surfaces that exchange heat, and walls of the domain."""

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import create_model, model_validator

from mpm.config.base import Choice, Kind, Model, doc, one_of, problem
from mpm.config.programmes import Beta, EmissivityProgramme, FluxProgramme, FrictionProgramme, Moment, Programme

Side = Annotated[Literal["all", "left", "right", "bottom", "top", "front", "back", "lateral", "inner", "outer"], Choice(r"edge [1-9]\d*", "edge 3")]
WALL_SIDES = {0: (), 1: ("left", "right"), 2: ("left", "right", "bottom", "top"), "axisymmetric": ("outer", "bottom", "top"),
              3: ("left", "right", "front", "back", "bottom", "top")}  # fmt: skip
SURFACE_SIDES = {0: ("all",), 1: ("all", "left", "right"), 2: ("all", "left", "right", "bottom", "top"),
                 "axisymmetric": ("all", "lateral", "inner", "outer", "bottom", "top"),
                 3: ("all", "left", "right", "front", "back", "bottom", "top", "lateral")}  # fmt: skip
RING_SIDES = ("inner", "outer")  # of a ring in the plane; those of axisymmetric bodies face the axis, or away from it
EXCHANGES = ("convection", "flux", "fixed", "radiation")


class Exchange(Model):
    """One way to exchange heat: which of its fields are rates, and which is the temperature outside, for time scaling."""

    rates: ClassVar[tuple[str, ...]]
    meets: ClassVar[str | None]


class Convection(Exchange):
    """Robin exchange: outward flux beta (T - outside)."""

    rates, meets = ("beta",), "outside"

    beta: Beta = doc(description="heat-transfer coefficient; .inf fixes the temperature of the surface; may change over time")
    outside: Programme = doc(description="temperature of the surroundings; may change over time")


class Flux(Exchange):
    """A given flux of heat."""

    rates, meets = ("q",), None

    q: FluxProgramme = doc(description="heat into the body, by area; negative cools; may change over time")


class Fixed(Exchange):
    """A given temperature of the surface: convection with infinite beta."""

    rates, meets = (), "temperature"

    temperature: Programme = doc(description="temperature of the surface; may change over time")


class Radiation(Exchange):
    """Grey radiation: outward flux sigma emissivity (T^4 - surroundings^4)."""

    rates, meets = ("emissivity",), "surroundings"

    emissivity: EmissivityProgramme = doc(description="emissivity, from 0 to 1; may change over time")
    surroundings: Programme = doc(description="temperature of what surrounds the body; may change over time")


MOMENTS: dict[str, Any] = {  # `from` is no name that a class could write
    "from": (Moment, doc(0.0, description="when it begins to act")),
    "until": (Moment | None, doc(None, description="when it ends; with the run unless given")),
}
Spell: Any = create_model("Spell", __base__=Model, __module__=__name__, **MOMENTS)


def spell(item: Any) -> tuple[float, float]:
    """When an entry begins and ends to act [s]."""
    return getattr(item, "from"), math.inf if item.until is None else item.until


def ended(item: Any) -> Any:
    """The entry, once it is known to end after it began."""
    begin, end = spell(item)
    if begin < 0:
        raise problem("spell", "a run begins at 0", "at least 0 [s]", at=("from",))
    if end <= begin:
        raise problem("spell", "it would end before it begins", f"above {begin:g} [s]", at=("until",))
    return item


class Surface(Spell):
    """Part of a body's surface, chosen by its outward normal at the start, and how it exchanges heat."""

    of: str = doc(description="a name under bodies")
    side: Side = doc("all", description="which part, by the outward normal at the start; inner or outer of a ring; edge 3 of a polygon, from its third vertex")
    name: str | None = doc(None, description="names the surface in paths: surfaces.<name>.convection.beta", pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")
    convection: Convection | None = doc(None, description="convection to the surroundings")
    flux: Flux | None = doc(None, description="a given flux of heat")
    fixed: Fixed | None = doc(None, description="a given temperature")
    radiation: Radiation | None = doc(None, description="radiation to the surroundings")

    @model_validator(mode="after")
    def lasts(self) -> "Surface":
        """It ends after it began."""
        return ended(self)

    @model_validator(mode="after")
    def exchanges(self) -> "Surface":
        """At least one exchange."""
        if all(getattr(self, key) is None for key in EXCHANGES):
            raise problem("exchange", "the surface does not say how it exchanges heat", list(EXCHANGES))
        return self


class WallHeat(Exchange):
    """A hot wall (a pan): what touches it exchanges with it, and with nothing else."""

    rates, meets = ("beta",), "temperature"

    beta: Beta = doc(description="heat-transfer coefficient of the contact; .inf holds the surface at its temperature; at 0 it insulates what touches it")
    temperature: Programme = doc(description="temperature of the wall; may change over time")


Lasting: Any = create_model("Lasting", __base__=Kind, __module__=__name__, **MOMENTS)


class Face(Lasting):
    """It acts as a mirror, `slip` or `stick`, on bodies that start at it, or as `contact`, by the true gap; what meets it feels `friction`.

    Before `from` and after `until` nothing is held along it, rubbed or heated; nothing ever passes through it.
    """

    acts: ClassVar[str]
    heat: WallHeat | None = doc(None, description="heat that the wall exchanges with what touches it")

    @model_validator(mode="after")
    def lasts(self) -> "Face":
        """It ends after it began."""
        return ended(self)


class Slip(Face):
    """No motion through the wall, free motion along it: a mirror, bonded to the bodies that start at it. Others meet it as contact without friction."""

    kind: ClassVar[str] = "slip"
    acts: ClassVar[str] = "slip"
    friction: ClassVar[float] = 0.0


class Stick(Face):
    """No motion at the wall: bonded to the bodies that start at it. Others meet it as contact without sliding."""

    kind: ClassVar[str] = "stick"
    acts: ClassVar[str] = "stick"
    friction: ClassVar[float] = math.inf


class Contact(Face):
    """A face that is touched and left: no motion into it, free motion away from it, friction along it."""

    kind: ClassVar[str] = "contact"
    acts: ClassVar[str] = "contact"
    friction: FrictionProgramme = doc(0.0, description="coefficient of friction; .inf lets nothing slide while it touches; may change over time")


WALLS: tuple[type[Kind], ...] = (Slip, Stick, Contact)
Wall = one_of("wall", *WALLS)
