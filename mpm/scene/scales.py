"""The scales of a scene's bodies, from the config alone: lengths, laws over the temperatures that can occur, stiffness, exchange. Nothing is sampled or run.

A length of heat is V/S, volume over exchanging surface; `reach` is how far the inside lies from it. Laws of temperature are looked at between the lowest
and the highest temperature that the config names (starts, surroundings, hot walls); a given flux adds what it could heat the body by.
"""

import math
from dataclasses import dataclass

import numpy as np

from mpm.heat.exchange import STEFAN_BOLTZMANN
from mpm.heat.programmes import bounds
from mpm.materials import HenckyWarm, value
from mpm.materials.porous import aspect
from mpm.scene.bearing import bearing
from mpm.scene.exchange import most, programme, rates, robin
from mpm.scene.law import elastic_law, law, stress_temperature_modulus
from mpm.scene.menus import acting
from mpm.scene.shapes import cut_quadrature, shape
from mpm.scene.weight import strongest

LATTICE = 4  # cells a direction of the quadrature that measures a body
SAMPLES = 65  # temperatures at which a law is looked at


@dataclass(frozen=True)
class Exchanging:
    """One exchange of a body: coefficient [W/(m2 K)] (radiation's slope included; inf: held), area [m2], lowest and highest temperature outside [K]."""

    side: str
    beta: float
    area: float
    low: float
    high: float
    constant: bool


@dataclass(frozen=True)
class Scales:
    """One body. Pairs are (smallest, largest) over its temperatures; None where the config names no such law."""

    name: str
    volume: float  # [m3], of one metre or square metre where the scene has fewer directions
    surface: float  # all of it [m2]
    extent: tuple[float, ...]  # [m]
    held: str  # what bears its weight: `stands` on a side of the domain, `bends` from sides that hold it, or nothing
    lever: float  # strain under its weight over that of a column: 1, or by bending more
    reach: float  # largest distance of the inside from the exchanging surface [m]
    height: float  # extent along gravity, the largest without gravity [m]
    speed: float  # of the start [m/s]
    low: float
    high: float  # temperatures [K]
    density: float
    exchanges: tuple[Exchanging, ...] = ()
    kappa: tuple[float, float] | None = None
    alpha: tuple[float, float] | None = None
    lam: float | None = None  # where E follows temperature: at its softest
    mu: float | None = None
    stiffening: float = 1.0  # largest over smallest E
    traction: float = 0.0  # largest force by area [Pa]
    gamma: float = 0.0
    reference: float = math.nan
    set: float = math.inf  # temperature above which it swells no further [K]
    M: tuple[float, float] | None = None
    p0: tuple[float, float] | None = None
    eta: tuple[float, float] | None = None

    @property
    def area(self) -> float:
        """Exchanging surface [m2]."""
        return sum(one.area for one in self.exchanges)

    @property
    def length(self) -> float:
        """V/S over the exchanging surface; the largest extent where nothing exchanges [m]."""
        return self.volume / self.area if self.area > 0 else max(self.extent, default=math.inf)

    @property
    def span(self) -> float:
        """The driving difference of temperature [K]."""
        return self.high - self.low

    @property
    def bulk(self) -> float:
        """K = lam + 2 mu/3 [Pa]."""
        return self.lam + 2 * self.mu / 3

    @property
    def stiffness(self) -> float:
        """lam + 2 mu [Pa]."""
        return self.lam + 2 * self.mu

    @property
    def wave(self) -> float:
        """Largest elastic wave speed [m/s]."""
        return math.sqrt(self.stiffening * self.stiffness / self.density)

    @property
    def softest(self) -> float:
        """Young's modulus, the stiffness of a body that is free at its sides [Pa]."""
        return self.mu * (3 * self.lam + 2 * self.mu) / (self.lam + self.mu) if self.lam + self.mu > 0 else self.mu

    @property
    def beta(self) -> float:
        """The strongest exchange [W/(m2 K)]."""
        return max((one.beta for one in self.exchanges), default=0.0)

    @property
    def swelling(self) -> float:
        """Largest thermal strain of a direction, gamma (T - T0)/(3 K) [-]."""
        if self.gamma == 0:
            return 0.0
        return abs(self.gamma) * max(abs(min(t, self.set) - self.reference) for t in (self.low, self.high)) / (3 * self.bulk)

    @property
    def thermal_stress(self) -> float:
        """Largest gamma (T - T0) [Pa]."""
        return 3 * self.bulk * self.swelling * self.stiffening if self.gamma else 0.0


def scales(experiment) -> dict[str, Scales]:
    """Scales of every body, by name."""
    return {name: of_body(experiment, name) for name in experiment.bodies}


def span(experiment) -> float:
    """The largest difference between temperatures that the config names [K]; 0 where there is none."""
    found = [pair for name in experiment.bodies for pair in temperatures(experiment, name)]
    return max(high for _, high in found) - min(low for low, _ in found)


def temperatures(experiment, name: str) -> list[tuple[float, float]]:
    """(lowest, highest) of the start, of all that surrounds the body and of the other bodies [K]."""
    found = [(body.temperature,) * 2 for body in experiment.bodies.values()]
    for entry in experiment.surfaces:
        if entry.of == name:
            found += [bounds(outside) for beta, outside in robin(entry) if most(beta) > 0]
            found += [bounds(programme(part.outside)) for part in acting(entry, "grey")]
    found += [bounds(programme(wall.heat.temperature)) for wall in experiment.walls.values() if wall.heat is not None]
    found += [(stage.temperature,) * 2 for stage in experiment.loading if stage.temperature is not None]
    return found


def measured(outline, axisymmetric: bool):
    """Volumes of points of the inside; points of the surface (mpm.scene.cut.Surface) and their areas. Axisymmetric bodies are measured all round."""
    lower, upper = outline.bounds()
    if axisymmetric:
        lower = np.maximum(lower, [0.0, -np.inf])
    inside, rim = cut_quadrature(outline, [np.linspace(a, b, LATTICE + 1) for a, b in zip(lower, upper, strict=True)], 2)
    around = (2 * np.pi * inside.x[:, 0], 2 * np.pi * rim.x[:, 0]) if axisymmetric else (1.0, 1.0)
    return inside.w * around[0], rim, rim.w * around[1]


def lattice(outline) -> np.ndarray:
    """Evenly spread points of the inside, its middle among them (N, d)."""
    axes = [np.linspace(a, b, 2 * LATTICE + 1) for a, b in zip(*outline.bounds(), strict=True)]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)
    return points[outline.distance(points) < 0]


def of_body(experiment, name: str) -> Scales:
    """Scales of one body."""
    body, zero = experiment.bodies[name], experiment.grid.dimension == 0
    found = temperatures(experiment, name)
    low, high = min(a for a, _ in found), max(b for _, b in found)
    if zero:
        volume, surface, extent, reach, height = 1.0, body.shape.surface_to_volume or 0.0, (), 0.0, 0.0
        exchanges = tuple(exchange for entry in experiment.surfaces for exchange in exchanging(entry, surface, high))
    else:
        volume, surface, extent, reach, exchanges = shaped(experiment, name, high)
        height = along(experiment, extent)
    material = experiment.materials[body.material]
    rise = sum(most(flux) for entry in experiment.surfaces if entry.of == name for flux, _ in rates(entry, "flux")) * surface * experiment.time.end
    if rise and material.heat is not None:
        alpha = ends(material.heat.alpha, low, high)[0]
        low, high = low - rise / (volume * material.density * alpha), high + rise / (volume * material.density * alpha)
    speed = math.hypot(*body.velocity) if body.velocity is not None else 0.0
    if body.inflow is not None:
        from mpm.scene.inflow import column

        speed = most(column(experiment, name).speed)
    spin = body.angular_velocity
    speed += (math.hypot(*spin) if isinstance(spin, tuple) else abs(spin or 0.0)) * math.hypot(*extent) / 2
    pull = sum(largest(entry.traction) for entry in experiment.loads if entry.of == name and entry.traction is not None)
    found = laws(material, max(low, 1.0), high) | {"traction": pull}
    return Scales(name, volume, surface, extent, *bearing(experiment, name), reach, height, speed, low, high, material.density, exchanges, **found)


def largest(traction) -> float:
    """Force by area of a traction [Pa]."""
    return abs(traction.pressure) if traction.pressure is not None else math.hypot(*(traction.nominal or traction.cauchy))


def shaped(experiment, name: str, high: float):
    """Volume, surface, extent, reach and exchanges of a body with a shape."""
    axisymmetric = experiment.grid.dimension == "axisymmetric"
    outline = shape(experiment.bodies[name].shape, experiment.grid.dimension)
    w, rim, area = measured(outline, axisymmetric)
    lower, upper = outline.bounds()
    exchanges, seen = [], np.zeros(len(area), dtype=bool)
    for entry in experiment.surfaces:
        if entry.of == name:
            here = outline.faces(rim, entry.side, experiment.grid.dimension == 2)
            exchanges += exchanging(entry, float(area[here].sum()), high)
            seen |= here | (area <= 0)  # the axis is no surface
    return float(w.sum()), float(area.sum()), tuple(float(e) for e in upper - lower), depth(outline, rim.x, seen) if exchanges else 0.0, tuple(exchanges)


def depth(outline, rim: np.ndarray, seen: np.ndarray) -> float:
    """The largest distance of the inside from the exchanging (`seen`) points of its surface [m]: slightly too large where a part does."""
    from scipy.spatial import cKDTree

    x = lattice(outline)
    if seen.all():
        return float(-outline.distance(x).min())
    return float(cKDTree(rim[seen]).query(x)[0].max()) if seen.any() else 0.0


def exchanging(entry, area: float, high: float) -> list[Exchanging]:
    """What one surface entry exchanges by; a flux has no coefficient."""
    found = [Exchanging(entry.side, most(beta), area, *bounds(outside), isinstance(outside, float) and isinstance(beta, float))
             for beta, outside in robin(entry) if most(beta) > 0 and area > 0]  # fmt: skip
    for emissivity, sky in rates(entry, "grey") if area > 0 else ():
        low, hottest = bounds(sky)
        slope = 4 * STEFAN_BOLTZMANN * most(emissivity) * max(high, hottest) ** 3
        found += [Exchanging(entry.side, slope, area, low, hottest, False)] if most(emissivity) > 0 else []
    return found


def along(experiment, extent: tuple[float, ...]) -> float:
    """Extent along gravity, the largest extent where there is none."""
    gravity = strongest(experiment)
    return extent[int(np.argmax(np.abs(gravity)))] if gravity is not None and any(gravity) else max(extent)


def ends(model, low: float, high: float) -> tuple[float, float]:
    """Smallest and largest value of a law between two temperatures."""
    if type(model).kind == "set":
        raw, baked = ends(model.raw, low, high), ends(model.baked, low, high)
        return min(*raw, *baked), max(*raw, *baked)
    run = law(model)
    if type(model).kind == "porosity":  # it follows the volume: from a tenth more open than at the start to pores closed
        return aspect(run.solid / 1.1, run.exponent), aspect(1.0, run.exponent)
    found = [float(value(run, t)) for t in ({low, high} if type(model).kind == "constant" else np.linspace(low, high, SAMPLES))]
    return min(found), max(found)


def laws(material, low: float, high: float) -> dict:
    """What a material names, over the temperatures that can occur."""
    found: dict = {}
    if material.heat is not None:
        found |= {"kappa": ends(material.heat.kappa, low, high), "alpha": ends(material.heat.alpha, low, high)}
    if material.elastic is not None:
        elastic = elastic_law(material.elastic)
        if isinstance(elastic, HenckyWarm):
            soft, stiff = ends(material.elastic.E, low, high)
            elastic = elastic.one._replace(mu=elastic.one.mu * soft, lam=elastic.one.lam * soft)
            found["stiffening"] = stiff / soft
        found |= {"lam": elastic.lam, "mu": elastic.mu}
        if material.expansion is not None:
            found |= {"gamma": stress_temperature_modulus(material.expansion, elastic), "reference": material.expansion.reference}
            found["set"] = getattr(material.expansion, "set", math.inf)
    if material.flow is not None:
        found |= {name: ends(getattr(material.flow, name), low, high) for name in ("M", "p0", "eta")}
    return found
