"""What a run writes, and the exact solution it is compared with."""

from typing import ClassVar

from mpm.config.base import Kind, Model, doc, one_of
from mpm.config.bodies import Point
from mpm.config.exact import MOVING
from mpm.config.exact_heat import HEAT
from mpm.config.measured import Measured
from mpm.config.quantities import Time


class Snapshots(Model):
    """Fields on the grid and on particles, at times 0, every, 2 every, ..., end."""

    every: Time = doc(description="time between snapshots")
    grid: tuple[str, ...] = doc((), description="fields on the grid")
    particles: tuple[str, ...] = doc((), description="fields of the particles")


class Output(Model):
    """Cadence of the series, probes, observables and snapshots."""

    every: Time = doc(None, description="time between samples of the series; end/100 unless given", validate_default=False)  # type: ignore[assignment]  # Experiment fills it in
    probes: dict[str, Point] = doc({}, description="points that are followed, by name")
    observables: tuple[str, ...] = doc((), description="what is recorded: temperature.mean, time_to.<probe>.95_degC, ...")
    overview: tuple[str, ...] = doc((), description="observables that the overview shows, the first first")
    snapshots: Snapshots | None = doc(None, description="whole fields at some times, for pictures, movies and exports")
    measured: dict[str, Measured] = doc({}, description="measured curves by name: drawn, compared with the run (misfit_<name>), fitted by `mpm fit`")


class RobinSlab(Kind):
    """Series solution of a slab with Robin exchange."""

    kind: ClassVar[str] = "robin_slab"
    body: str | None = doc(None, description="the body that is the slab; the only one unless given")


class RobinCylinder(Kind):
    """Series solution of a cylinder with Robin exchange."""

    kind: ClassVar[str] = "robin_cylinder"
    body: str | None = doc(None, description="the body that is the cylinder; the only one unless given")


class RobinSphere(Kind):
    """Series solution of a sphere with Robin exchange."""

    kind: ClassVar[str] = "robin_sphere"
    body: str | None = doc(None, description="the body that is the sphere; the only one unless given")


class Adiabatic(Kind):
    """Adiabatic heating of a thermoelastic material point."""

    kind: ClassVar[str] = "adiabatic"
    body: str | None = doc(None, description="the material point; the only body unless given")


class ThermalExpansion(Kind):
    """Thermal expansion of a material point, each direction free or held."""

    kind: ClassVar[str] = "thermal_expansion"
    body: str | None = doc(None, description="the material point; the only body unless given")


class Relaxation(Kind):
    """Stress relaxation of a viscoplastic material point at held strain."""

    kind: ClassVar[str] = "relaxation"
    body: str | None = doc(None, description="the material point; the only body unless given")


class ShearHeating(Kind):
    """Heating of a material point by isochoric flow."""

    kind: ClassVar[str] = "shear_heating"
    body: str | None = doc(None, description="the material point; the only body unless given")


class LumpedCooling(Kind):
    """Exponential cooling of a rigid material point."""

    kind: ClassVar[str] = "lumped_cooling"
    body: str | None = doc(None, description="the material point; the only body unless given")


EXACT: tuple[type[Kind], ...] = (
    RobinSlab, RobinCylinder, RobinSphere, Adiabatic, ThermalExpansion, Relaxation, ShearHeating, LumpedCooling, *MOVING, *HEAT,
)  # fmt: skip
Exact = one_of("exact solution", *EXACT)
