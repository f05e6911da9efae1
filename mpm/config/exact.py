"""Exact solutions of moving bodies, and of the ring: kinds of `exact`. They set what a config has no word for, such as a field of velocity at the start."""

from typing import ClassVar

from mpm.config.base import Kind, doc
from mpm.config.quantities import AngularVelocity, Length, TemperatureDifference, Velocity

BODY = "the body that the solution is about; the only one unless given"


class RobinRing(Kind):
    """Series solution of a hollow cylinder with Robin exchange inside and outside."""

    kind: ClassVar[str] = "robin_ring"
    body: str | None = doc(None, description=BODY)


class HenckyBar(Kind):
    """A bar in uniaxial strain that swings in its first mode, held at both walls or free at its upper end."""

    kind: ClassVar[str] = "hencky_bar"
    body: str | None = doc(None, description=BODY)
    amplitude: Velocity = doc(description="largest speed of the first mode at the start")


class StandingWave(Kind):
    """A linear thermoelastic wave between two insulated walls: frequency and damping."""

    kind: ClassVar[str] = "standing_wave"
    body: str | None = doc(None, description=BODY)
    amplitude: Velocity = doc(description="largest speed at the start; small, for the solution is linear")


class RigidRotation(Kind):
    """Steady rotation and translation without strain."""

    kind: ClassVar[str] = "rigid_rotation"
    body: str | None = doc(None, description=BODY)


class FreeFall(Kind):
    """Flight under gravity."""

    kind: ClassVar[str] = "free_fall"
    body: str | None = doc(None, description=BODY)


class HydrostaticColumn(Kind):
    """A column that stands under its own weight, started in its equilibrium."""

    kind: ClassVar[str] = "hydrostatic_column"
    body: str | None = doc(None, description=BODY)


class Manufactured(Kind):
    """A manufactured thermoelastic motion, kept by its body force and heat source."""

    kind: ClassVar[str] = "manufactured"
    body: str | None = doc(None, description=BODY)
    displacement: Length = doc(description="amplitude of the displacement")
    temperature: TemperatureDifference = doc(description="amplitude of the temperature")
    rate: AngularVelocity = doc(3.0, description="angular frequency of the displacement")
    thermal_rate: AngularVelocity = doc(2.0, description="angular frequency of the temperature")


class CooksMembrane(Kind):
    """The static deflection of a tapered panel under a shear load, nearly incompressible: volumetric locking."""

    kind: ClassVar[str] = "cooks_membrane"
    body: str | None = doc(None, description=BODY)


class Cantilever(Kind):
    """A beam held at one end, at rest under its own weight, by finite elements of the same law: however far it bends."""

    kind: ClassVar[str] = "cantilever"
    body: str | None = doc(None, description=BODY)


class TractionBar(Kind):
    """A bar in uniaxial strain, pulled at its end until it rests: uniform stress."""

    kind: ClassVar[str] = "traction_bar"
    body: str | None = doc(None, description=BODY)


class ThermalShock(Kind):
    """A slab that is cooled at one face at once, free along and held across: thermal stress in uniaxial strain."""

    kind: ClassVar[str] = "thermal_shock"
    body: str | None = doc(None, description=BODY)


class ThermalCylinder(Kind):
    """A long thick cylinder between two temperatures, at rest: Lamé's thermal stress in plane strain."""

    kind: ClassVar[str] = "thermal_cylinder"
    body: str | None = doc(None, description=BODY)


class Hertz(Kind):
    """The force on a ball between a floor and a plate: Hertz's law with the compression of the whole ball."""

    kind: ClassVar[str] = "hertz"
    body: str | None = doc(None, description=BODY)


class PressedCylinder(Kind):
    """A long thick cylinder under pressures inside and outside, at rest: Lamé's stress, and its continuation to large strains."""

    kind: ClassVar[str] = "pressed_cylinder"
    body: str | None = doc(None, description=BODY)


class SpinningDisc(Kind):
    """An elastic disc in plane strain that is set turning without strain: it widens, and breathes about where it would rest (series)."""

    kind: ClassVar[str] = "spinning_disc"
    body: str | None = doc(None, description=BODY)


MOVING: tuple[type[Kind], ...] = (
    RobinRing, HenckyBar, StandingWave, RigidRotation, FreeFall, HydrostaticColumn, Manufactured, CooksMembrane, Cantilever, TractionBar, ThermalShock,
    ThermalCylinder, Hertz, PressedCylinder, SpinningDisc,
)  # fmt: skip
