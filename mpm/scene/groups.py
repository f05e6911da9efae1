"""The dimensionless groups of a scene: what they are, what they mean at their value, and how much dropping the term would matter.

Biot            beta V/(S kappa)                       how uneven the inside is: small, one temperature will do
Fourier         kappa t/(R0 alpha l^2)                 how far heat goes in the run
coupling        gamma^2 Theta/(R0 alpha (lam + 2 mu))  how much elastic heating stiffens a wave
elastic heating Gamma Theta tr(eps)/span               how much deformation heats, against what drives the heat
swelling        gamma span/(3 K)                       thermal strain: how far heat moves the body
Deborah         eta/(3 mu t), eta p0^2/(K t)           relaxation time over the run: small, rate-independent; large, elastic
Courant         c dt/h                                 the elastic wave's way in a step
gravity         R0 g H/E and R0 g H/M                  against stiffness (strain; where it bends, that at its clamp) and against yield (whether it flows).
                                                       Offered to be dropped where something bears it, the strain is small, and something else moves the body
impact          v/c                                    strain of a body that is stopped
Froude          (S v)^2/(g H)                          inertia that time scaling lets in
`error` is the group's own estimate of what dropping its term would change: of temperatures as a share of the driving difference, of motion as a strain.
"""

import math
from dataclasses import asdict, dataclass

from mpm.scene.scales import Scales, scales
from mpm.scene.scaling import FROUDE
from mpm.scene.weight import heaviest

SMALL, LARGE = 0.1, 10.0
LOCKS = 0.45  # Poisson's ratio


@dataclass(frozen=True)
class Group:
    """One number: what it is, what its value means, what could be dropped because of it (empty: nothing) and by which error (None: no estimate)."""

    name: str
    symbol: str
    value: float
    formula: str
    meaning: str
    body: str
    drop: str = ""
    error: float | None = None

    def told(self) -> dict:
        """As plain data."""
        return asdict(self)


def groups(experiment, step: float | None = None) -> list[Group]:
    """Every group of every body that the scene's physics gives a meaning to. `step` [s] is the explicit time step, for the Courant number."""
    found = []
    for one in scales(experiment).values():
        found += [*heat(experiment, one), *motion(experiment, one), *coupled(experiment, one)]
        if one.lam is not None and step and experiment.grid.cell:
            found.append(courant(experiment, one, step))
    return found


def grade(value: float, small: str, middling: str, large: str) -> str:
    """What a value means."""
    return small if value < SMALL else large if value > LARGE else middling


def uneven(one: Scales) -> float:
    """How far from one temperature the inside can be, as a share of the driving difference: the quasi-steady profile of a flux beta, an upper estimate.

    Even exchange heats every place alike, and beta S l^2/(2 V kappa) spans the profile, l the reach. Otherwise heat has to cross the body: beta L/(2 kappa), L
    its largest extent. Both are 2 or more times the slab's and the ball's own (series solutions).
    """
    if not one.exchanges:
        return 0.0
    if not math.isfinite(one.beta) or one.kappa[0] <= 0:
        return math.inf
    total = sum(exchange.beta * exchange.area for exchange in one.exchanges)
    even = len({(exchange.beta, exchange.low, exchange.high) for exchange in one.exchanges}) == 1 and len(set(one.extent)) == 1
    across = 0.0 if even and math.isclose(one.area, one.surface, rel_tol=1e-9) else one.beta * max(one.extent, default=0.0) / (2 * one.kappa[0])
    return max(total * one.reach**2 / (2 * one.volume * one.kappa[0]), across)


def heat(experiment, one: Scales) -> list[Group]:
    """Biot and Fourier."""
    if one.kappa is None or not one.extent:
        return []
    found = []
    if one.exchanges:
        biot = one.beta * one.length / one.kappa[0] if one.kappa[0] > 0 else math.inf
        said = grade(biot, "the inside keeps one temperature", "inside and surface both count", "the surface takes the outer temperature at once")
        drop = "the inside: a lumped body (dimension 0)" if biot < SMALL else ""
        found.append(Group("Biot", "Bi", biot, "beta V/(S kappa)", said, one.name, drop, uneven(one)))
    path = one.reach or one.length
    fourier = one.kappa[1] * experiment.time.end / (one.density * one.alpha[0] * path**2)
    said = grade(fourier, "heat stays near the surface", "heat crosses the body within the run", "the end is steady")
    drop = "conduction" if fourier < 1e-4 else ""
    found.append(Group("Fourier", "Fo", fourier, "kappa t/(R0 alpha l^2)", said, one.name, drop, math.sqrt(fourier) if fourier < 1 else None))
    return found


def strains(experiment, one: Scales) -> dict[str, float]:
    """Upper estimates of strain by cause: gravity and tractions put on at once, a stop from the starting speed, thermal expansion."""
    g = heaviest(experiment)
    return {
        "gravity": 2 * one.density * g * one.height / one.softest * one.lever,
        "impact": one.speed / math.sqrt(one.softest / one.density),
        "swelling": one.swelling,
        "traction": 2 * one.traction / one.softest,
    }


def motion(experiment, one: Scales) -> list[Group]:
    """Gravity, impact, Deborah, Froude."""
    if one.lam is None:
        return []
    found, g = [], heaviest(experiment)
    weight = one.density * g * one.height
    if weight > 0:
        sag = weight / one.softest
        said = grade(10 * sag, "it carries its weight without sagging", "it sags visibly", "it collapses under its weight unless its shape holds it")
        bent = sag * one.lever
        if one.held == "bends":
            said = f"it bends: strain {bent:.2g} where it is held, " + grade(10 * bent, "hardly to be seen", "to be seen", "far")
            said += ": method.frame: auto" if 10 * bent >= SMALL and experiment.method.frame == "updated" else ""
        alone = not (one.speed or one.traction or one.gamma or experiment.tools)  # then gravity is all that moves it
        drop = "gravity" if one.held and bent < 1e-3 and not alone else ""
        found.append(Group("gravity/stiffness", "R0gH/E", sag, "R0 g H/E", said, one.name, drop, 2 * bent))
    nu, averaged = one.lam / (2 * (one.lam + one.mu)), experiment.method.locking is not None
    if one.M is None and averaged == (nu < LOCKS) and experiment.grid.directions > 1:
        said = "it does not lock: F-bar makes what bends too soft, leave `locking` out" if averaged else "it locks as it bends: method.locking: fbar"
        found.append(Group("Poisson", "nu", nu, "lam/(2 (lam + mu))", said, one.name, "", None))
    if one.M is not None and weight > 0:
        ratio = weight / one.M[0]
        said = "it stands without flowing" if 2 * ratio * one.lever < 1 else "it may flow under its weight" if ratio < LARGE else "it flows like a liquid"
        drop = "flow" if 2 * ratio * one.lever < 1 and all(stress < 1 for stress in loads(experiment, one)) else ""
        found.append(Group("gravity/yield", "R0gH/M", ratio, "R0 g H/M", said, one.name, drop, 0.0 if drop else None))
    if one.speed > 0:
        mach = one.speed / one.wave
        said = grade(10 * mach, "a stop strains it little", "a stop strains it visibly", "a stop crushes it")
        found.append(Group("impact", "v/c", mach, "v sqrt(R0/(lam + 2 mu))", said, one.name, "", None))
    if one.eta is not None:
        end = experiment.time.end
        for name, time, formula in (("Deborah, shear", one.eta[1] / (3 * one.mu), "eta/(3 mu t)"),
                                    ("Deborah, pressure", one.eta[1] * one.p0[1] ** 2 / one.bulk, "eta p0^2/(K t)")):  # fmt: skip
            said = grade(time / end, "stress relaxes within the run: nearly rate-independent", "it relaxes as the run goes", "no time to flow: nearly elastic")
            drop = "flow" if time / end > 100 else "viscosity (eta = 0)" if time / end < 1e-3 and weight <= one.M[0] else ""
            found.append(Group(name, "De", time / end, formula, said, one.name, drop, min(time / end, end / time) if time > 0 else 0.0))
    if g > 0 and one.height > 0:
        found += froude(experiment, one, g)
    return found


def loads(experiment, one: Scales) -> tuple[float, float]:
    """Upper estimates of the stress over the yield stress: of shear over M, of pressure over p0 M. Weight and tractions act at once."""
    g = heaviest(experiment)
    stress = 2 * one.density * g * one.height * one.lever + 2 * one.traction + one.density * one.wave * one.speed + one.thermal_stress
    return 2 * stress / one.M[0], 2 * stress / (one.M[0] * one.p0[0])


def pace(experiment, one: Scales, g: float) -> float:
    """How fast the body moves by itself [m/s]: its swelling over the run, or its slump where its weight exceeds its yield stress, at most a free fall."""
    swell = one.swelling * max(one.extent) / experiment.time.end
    slump = 0.0
    if one.M is not None and one.density * g * one.height > one.M[0]:
        excess = one.density * g * one.height - one.M[0]
        slump = min(math.sqrt(2 * g * one.height), excess * one.height / max(one.eta[0], 1e-300))
    return max(swell, slump, one.speed)


def froude(experiment, one: Scales, g: float) -> list[Group]:
    """Inertia that time scaling lets in; without scaling, how far it could go."""
    speed, S = pace(experiment, one, g), experiment.time.scale
    value = (S * speed) ** 2 / (g * one.height)
    most = math.sqrt(FROUDE * g * one.height) / speed if speed > 0 else math.inf
    if S > 1:
        said = f"time.scale {S:g} lets {'little' if value <= FROUDE else 'much'} inertia in (limit {FROUDE})"
    else:
        said = f"slow: time.scale up to {most:.2g} would do" if 2 < most < math.inf else "nothing moves by itself" if most == math.inf else "inertia counts"
    drop = f"inertia: time.scale {most / 2:.2g}" if S == 1 and 4 < most < math.inf and one.speed == 0 else ""
    return [Group("Froude", "Fr", value, "(S v)^2/(g H), v estimated", said, one.name, drop, value * (most / 2) ** 2 if drop else value)]


def coupled(experiment, one: Scales) -> list[Group]:
    """Thermoelastic coupling, elastic heating, swelling."""
    if one.lam is None or one.alpha is None or one.gamma == 0:
        return []
    capacity = one.density * one.alpha[0]
    number = one.gamma**2 * one.high / (capacity * one.stiffness)
    said = grade(10 * number, "heat follows motion one way only", "elastic heating stiffens the body visibly", "heat and motion are one problem")
    heats = experiment.materials[experiment.bodies[one.name].material].heating
    found = [Group("thermoelastic coupling", "eps_c", number, "gamma^2 Theta/(R0 alpha (lam + 2 mu))", said, one.name,
                   "elastic heating (one way)" if heats is not None and number < 1e-2 else "", number)]  # fmt: skip
    if one.span > 0 and heats is not None and heats.elastic is not None:
        warmed = warming(experiment, one)
        said = grade(100 * warmed, "deformation heats next to nothing", "deformation heats visibly", "deformation heats as much as the surroundings")
        found.append(Group("elastic heating", "", warmed, "gamma Theta tr(eps)/(R0 alpha span)", said, one.name, "", warmed))
    strain = one.swelling
    said = grade(100 * strain, "heat hardly moves the body", "heat moves the body visibly", "heat changes its shape")
    drop = "motion, if only heat is asked for" if 3 * sum(strains(experiment, one).values()) < SMALL else ""
    found.append(Group("swelling", "eps_T", strain, "gamma (T - T0)/(3 K)", said, one.name, drop, 3 * sum(strains(experiment, one).values())))
    return found


def warming(experiment, one: Scales) -> float:
    """Upper estimate of what elastic volume change heats, as a share of the driving difference; infinite where nothing drives the heat."""
    if one.gamma == 0:
        return 0.0
    volumetric = 3 * sum(strains(experiment, one).values())
    return abs(one.gamma) * one.high * volumetric / (one.density * one.alpha[0] * one.span) if one.span > 0 else math.inf


def courant(experiment, one: Scales, step: float) -> Group:
    """The elastic wave's way in a step, in cells; on the fast clock where time is scaled."""
    number = one.wave * step / experiment.time.scale / experiment.grid.cell
    said = "explicit, every wave resolved" if number <= 0.5 else "near the limit" if number <= 1 else "past the limit: it will blow up"
    return Group("Courant", "Co", number, "c dt/h", said, one.name)
