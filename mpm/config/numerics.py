"""Grid, time and method: how a scene is computed."""

from typing import Annotated, ClassVar, Literal

from mpm.config.base import Choice, Kind, Model, doc, one_of
from mpm.config.quantities import Fraction, Length, Positive, Quantity, Time, TimeOrAuto, Whole

Dimension = Annotated[Literal[0, 1, 2, "axisymmetric", 3], Choice()]
DIRECTIONS = {0: 0, 1: 1, 2: 2, "axisymmetric": 2, 3: 3}
Offset = Annotated[float, Quantity("", "offset in cells", least=-0.5, most=0.5)]


class Grid(Model):
    """The domain [0, size] and its cells."""

    dimension: Dimension = doc(description="0 (a material point), 1, 2 (plane strain), axisymmetric (r, z) or 3")
    size: tuple[Length, ...] = doc((), description="extent of the domain, one length a direction")
    cell: Length | None = doc(None, description="edge of a cell")
    basis: Annotated[Literal["linear", "quadratic", "cubic"], Choice()] = doc("quadratic", description="B-splines of the grid")

    @property
    def directions(self) -> int:
        """Number of coordinates: 2 in axisymmetric scenes."""
        return DIRECTIONS[self.dimension]


class Clock(Model):
    """When the run ends and how it steps."""

    end: Time = doc(description="time at the end")
    step: TimeOrAuto = doc("auto", description="time step; auto takes the smallest of all limits")
    safety: Positive = doc(1.0, description="multiplies the automatic step; above 1 goes past the limits")
    scale: Annotated[float, Quantity("", "time scale", least=1)] = doc(1.0, description="time scaling: rates are multiplied, eta divided by it")


class Apic(Kind):
    """Affine particle-in-cell."""

    kind: ClassVar[str] = "apic"


class Flip(Kind):
    """Increments, with a fraction of PIC."""

    kind: ClassVar[str] = "flip"
    blend: Fraction = doc(0.0, description="fraction of PIC")


class Pic(Kind):
    """Particle-in-cell: values from the grid; dissipative."""

    kind: ClassVar[str] = "pic"


class AffineFlip(Kind):
    """Increments with APIC's slopes, and a small fraction of PIC: for steps so small that APIC's own damping shows."""

    kind: ClassVar[str] = "affine_flip"
    blend: Fraction = doc(0.02, description="fraction of PIC")


class Xpic(Kind):
    """FLIP cleaned of what the grid cannot see, by extra transfers; of temperature with APIC's slopes in bodies that exchange heat."""

    kind: ClassVar[str] = "xpic"
    order: Annotated[int, Whole("order", 1, 16)] = doc(2, description="order; 1 is PIC, each further one costs a transfer to the grid and back")


class Fbar(Kind):
    """Volume changes averaged over the grid, against volumetric locking."""

    kind: ClassVar[str] = "fbar"
    own: Fraction = doc(0.02, description="share of its own volume change that a particle keeps; without any, a body that flows far comes apart")


class AutoBounds(Kind):
    """Repair in bodies that move; bodies that do not have `method.rigid`."""

    kind: ClassVar[str] = "auto"


class Repair(Kind):
    """What lies beyond the temperatures of body and surroundings is moved to particles that have room for it."""

    kind: ClassVar[str] = "repair"


class Free(Kind):
    """Temperatures are as the transfer leaves them: what it overshoots by is told."""

    kind: ClassVar[str] = "free"


class AutoHeat(Kind):
    """Whichever of the integrators suits the laws."""

    kind: ClassVar[str] = "auto"
    tolerance: Annotated[float, Quantity("", "relative tolerance", above=0, most=1)] | None = doc(None, description="relative error a step; 1e-4 unless said")


class Implicit(Kind):
    """Consistent mass and L-stable implicit steps, chosen by an error estimate."""

    kind: ClassVar[str] = "implicit"
    order: Annotated[Literal[2, 4], Choice()] = doc(4, description="order in time")
    tolerance: Annotated[float, Quantity("", "relative tolerance", above=0, most=1)] = doc(1e-4, description="relative error a step")


class Explicit(Kind):
    """Lumped mass and stabilised explicit steps."""

    kind: ClassVar[str] = "explicit"
    tolerance: Annotated[float, Quantity("", "relative tolerance", above=0, most=1)] | None = doc(None, description="relative error a step; 1e-4 unless said")


class Bounded(Kind):
    """No temperature beyond those of body and surroundings: hat functions, conductances that are never negative, implicit steps."""

    kind: ClassVar[str] = "bounded"
    tolerance: Annotated[float, Quantity("", "relative tolerance", above=0, most=1)] = doc(1e-3, description="relative error a step")


class ImplicitHeat(Kind):
    """L-stable implicit steps by conjugate gradients: any step, any beta."""

    kind: ClassVar[str] = "implicit"
    order: Annotated[Literal[1, 2], Choice()] = doc(1, description="order in time")
    tolerance: Annotated[float, Quantity("", "relative tolerance", above=0, most=1e-2)] = doc(1e-9, description="residual of the solver, of the step's change")


class ExplicitHeat(Kind):
    """Explicit steps, in as many sub-steps as stability asks for."""

    kind: ClassVar[str] = "explicit"


class StabilisedHeat(Kind):
    """Explicit steps of order 2, in as many stages as stability asks for (Runge-Kutta-Chebyshev)."""

    kind: ClassVar[str] = "stabilised"


class AutoMoving(Kind):
    """Stabilised; implicit where a step would need many stages."""

    kind: ClassVar[str] = "auto"


HEAT: tuple[type[Kind], ...] = (AutoMoving, ExplicitHeat, StabilisedHeat, ImplicitHeat)
TRANSFERS: tuple[type[Kind], ...] = (Apic, Flip, Pic, AffineFlip, Xpic)
LOCKING: tuple[type[Kind], ...] = (Fbar,)
BOUNDS: tuple[type[Kind], ...] = (AutoBounds, Repair, Free)
RIGID: tuple[type[Kind], ...] = (AutoHeat, Implicit, Explicit, Bounded)
Transfer = one_of("transfer", *TRANSFERS)


class Method(Model):
    """The numerical method."""

    transfer: Transfer = doc(Apic(), description="transfer of velocity between particles and grid")
    temperature: Transfer = doc(Apic(), description="transfer of temperature")
    gradient: Annotated[Literal["mls", "bspline"], Choice()] = doc("mls", description="gradient operator of the particles")
    frame: Annotated[Literal["auto", "updated", "total"], Choice()] = doc(
        "updated",
        description="updated: particles carry the state over the grid; total: weights of the shape at the start, for bodies that do not flow far; "
        "auto: total as long as that will do",
    )
    mechanics: Annotated[Literal["auto", "explicit", "implicit"], Choice()] = doc(
        "explicit",
        description="explicit: steps that follow every wave; implicit: Newton's method at steps of seconds; auto: implicit where it saves a hundredfold",
    )
    mechanics_tolerance: Annotated[float, Quantity("", "tolerance", above=0, most=0.1)] = doc(
        1e-4, description="error of an implicit step, of the body's largest extent"
    )
    locking: one_of("cure of locking", *LOCKING) | None = doc(None, description="for nearly incompressible bodies that move")
    bounds: one_of("way to keep bounds", *BOUNDS) = doc(AutoBounds(), description="temperatures between those of body and surroundings, for bodies that move")
    precision: Annotated[Literal["float64", "float32"], Choice()] = doc("float64", description="of the numbers that particles and grid hold")
    particles: Annotated[int, Whole("number of particles", 1, 16)] = doc(2, description="particles a cell and direction")
    heat: one_of("heat integrator", *HEAT) = doc(AutoMoving(), description="how heat steps in moving bodies")
    heat_step: TimeOrAuto = doc("auto", description="time step of heat in moving bodies")
    fracture: Annotated[Literal["warn", "fail", "surface"], Choice()] = doc(
        "warn", description="particles that come apart by more than two cells: run on, end, or run on and let the faces that opened exchange heat"
    )
    offset: tuple[Offset, ...] = doc((), description="shift of bodies and probes against the grid lines, in cells, one a direction; zero unless given")
    rigid: one_of("integrator", *RIGID) = doc(AutoHeat(), description="heat in rigid bodies")
