"""Materials: density and the physics that a material has. A section that is absent is physics that does not exist."""

from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from mpm.config.base import Choice, Kind, Model, doc, one_of, problem
from mpm.config.laws import law, porous, settable
from mpm.config.quantities import Density, Fraction, Modulus, PerKelvin, Pressure, Quantity, StressPerKelvin, Temperature

PoissonRatio = Annotated[float, Quantity("", "Poisson ratio", above=-1, most=0.4999)]
PAIRS = (("E", "nu"), ("lam", "mu"), ("K", "mu"))
STRENGTHS = ("coefficient", "gamma", "c")


class Hencky(Kind):
    """Hencky elasticity: Kirchhoff stress 2 mu eps + lam tr(eps), eps the logarithmic strain. Exactly one pair of moduli: E nu, lam mu, or K mu."""

    kind: ClassVar[str] = "hencky"
    E: settable("Pa", "Young's modulus", above=0) | None = doc(None, description="Young's modulus; may depend on temperature, or set")
    nu: PoissonRatio | None = doc(None, description="Poisson ratio")
    lam: Pressure | None = doc(None, description="first Lamé constant")
    mu: Modulus | None = doc(None, description="shear modulus, second Lamé constant")
    K: Modulus | None = doc(None, description="bulk modulus")

    @classmethod
    def bare(cls) -> bool:
        """A pair is needed, though no single modulus is."""
        return False

    @model_validator(mode="after")
    def pair(self) -> "Hencky":
        """One pair of moduli, no more and no less, with a positive bulk modulus."""
        given = tuple(key for key in ("E", "nu", "lam", "K", "mu") if getattr(self, key) is not None)
        if given not in PAIRS:
            raise problem("pair", f"two moduli are needed, found {' '.join(given) or 'none'}", ["E and nu", "lam and mu", "K and mu"])
        if self.lam is not None and self.mu is not None and self.lam + 2 * self.mu / 3 <= 0:
            raise problem("pair", "the bulk modulus lam + 2 mu/3 must be positive", f"lam above {-2 * self.mu / 3:g} [Pa]", at=("lam",))
        return self


class NeoHookean(Hencky):
    """Neo-Hookean elasticity: Kirchhoff stress mu (b - 1) + lam J (J - 1). Elastic only, and the cheapest. Moduli as for hencky."""

    kind: ClassVar[str] = "neo_hookean"


class Ellipse(Kind):
    """Viscoplastic flow outside the ellipse p^2/p0^2 + q^2 = M^2, with overstress viscosity eta (0: rate-independent)."""

    kind: ClassVar[str] = "ellipse"
    M: settable("Pa", "yield stress", above=0) = doc(description="von Mises stress at yield without pressure")
    p0: porous("", "aspect ratio", above=0) = doc(description="aspect ratio of the ellipse: the yield pressure is p0 M; may follow temperature or porosity")
    eta: settable("Pa*s", "viscosity", least=0) = doc(description="viscosity of the overstress")
    map: Annotated[Literal["radial", "clipped"], Choice()] = doc("radial", description="overstress that drives the flow; clipped: q <= M at any rate")


class Fourier(Kind):
    """Heat flux -kappa grad T and specific heat alpha."""

    kind: ClassVar[str] = "fourier"
    kappa: law("W/m/K", "heat conductivity", least=0) = doc(description="heat conductivity")
    alpha: law("J/kg/K", "specific heat", above=0) = doc(description="specific heat capacity")


class LinearExpansion(Kind):
    """Thermal stress from the linear expansion coefficient: gamma = 3 K coefficient."""

    kind: ClassVar[str] = "linear"
    coefficient: PerKelvin = doc(description="linear thermal expansion coefficient")
    reference: Temperature = doc(293.15, description="temperature without thermal stress")


class ModulusExpansion(Kind):
    """Thermal stress from the stress-temperature modulus gamma."""

    kind: ClassVar[str] = "modulus"
    gamma: StressPerKelvin = doc(description="stress-temperature modulus gamma")
    reference: Temperature = doc(293.15, description="temperature without thermal stress")


class SourceExpansion(Kind):
    """Thermal stress from the supplement's c: gamma = c lam."""

    kind: ClassVar[str] = "source"
    c: PerKelvin = doc(description="the supplement's coupling coefficient")
    reference: Temperature = doc(293.15, description="temperature without thermal stress")


class LatchedExpansion(Kind):
    """Thermal stress from the highest temperature so far, at most `set`: what has swollen stays as it cools. Exactly one of coefficient, gamma and c."""

    kind: ClassVar[str] = "latched"
    coefficient: PerKelvin | None = doc(None, description="linear thermal expansion coefficient: gamma = 3 K coefficient")
    gamma: StressPerKelvin | None = doc(None, description="stress-temperature modulus gamma")
    c: PerKelvin | None = doc(None, description="the supplement's coupling coefficient: gamma = c lam")
    reference: Temperature = doc(293.15, description="temperature without thermal stress")
    set: Temperature = doc(description="temperature at which the material sets: it swells no further above it")

    @model_validator(mode="after")
    def strength(self) -> "LatchedExpansion":
        """One way to say how strongly."""
        given = [key for key in STRENGTHS if getattr(self, key) is not None]
        if len(given) != 1:
            raise problem("strength", f"exactly one strength is needed, found {' '.join(given) or 'none'}", list(STRENGTHS), at=tuple(given[1:2]))
        return self


class ElasticHeating(Model):
    """Heating and cooling by elastic change of volume."""

    form: Annotated[Literal["adiabat", "grid"], Choice()] = doc(
        "adiabat", description="along the adiabat at the particle, exact in any step; or as a source of the heat equation on the grid, for comparison"
    )


class DissipationHeating(Model):
    """Heating by plastic dissipation."""

    fraction: Fraction = doc(1.0, description="part of the dissipated work that becomes heat")


class Heating(Model):
    """How deformation heats: each part is on when it is written, `elastic: {}`, `dissipation: {}`."""

    elastic: ElasticHeating | None = doc(None, description="heating and cooling by elastic change of volume")
    dissipation: DissipationHeating | None = doc(None, description="heating by work that flow dissipates")


ELASTIC: tuple[type[Kind], ...] = (Hencky, NeoHookean)
FLOW: tuple[type[Kind], ...] = (Ellipse,)
HEAT: tuple[type[Kind], ...] = (Fourier,)
EXPANSION: tuple[type[Kind], ...] = (LinearExpansion, ModulusExpansion, SourceExpansion, LatchedExpansion)


class Material(Model):
    """A material: density, and a section for each physics it has."""

    density: Density = doc(description="mass density of the undeformed material")
    elastic: one_of("elastic law", *ELASTIC) | None = doc(None, description="without it the body is rigid and does not move")
    flow: one_of("flow law", *FLOW) | None = doc(None, description="viscoplastic flow; needs elastic")
    heat: one_of("heat law", *HEAT) | None = doc(None, description="without it no heat is stored or conducted")
    expansion: one_of("expansion law", *EXPANSION) | None = doc(None, description="thermal stress; needs elastic and heat")
    heating: Heating | None = doc(None, description="heat from deformation; needs elastic and heat")
