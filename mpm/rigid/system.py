"""One body's equations: geometry, laws and surroundings gathered, before a method is chosen.

beta = inf becomes a penalty of PENALTY kappa/h: fixed temperature to within h/(PENALTY L) of the temperature difference. Temperatures are kept relative to
`zero`: the surroundings of the stiffest surface where the Biot number is above 1, so that heat through it is a small number times a large one,
not a difference of large ones; else the body's start, so that small changes keep their digits. The heat ledger needs both.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.heat.exchange import STEFAN_BOLTZMANN
from mpm.heat.programmes import SAME, at, bounds, during, turns
from mpm.materials.laws import Constant
from mpm.materials.roles import value
from mpm.rigid.geometry import Geometry, evaluated, geometry
from mpm.rigid.hats import hat_geometry, over_depth
from mpm.rigid.surroundings import Programmes, Radiant, Within
from mpm.sources import Code, values

PENALTY = 1e5
LOOKS = 100  # times a run at which a formula over time is looked at, at least


@dataclass(frozen=True)
class RigidBody:
    """A body that does not move. `surfaces`: (side, beta >= 0 or inf [W/(m2 K)], outside [K]) each; the rest is insulated.

    fluxes: (side, q into the body [W/m2]); radiation: (side, emissivity, surroundings [K]). All are numbers or mpm.heat.programmes, but that beta and
    emissivity do not change between jumps.
    sources: heat from within, (what, factor, begin, end [s]) each: factor [W/m3] times a number, a programme or a mpm.sources.Code.
    field: temperatures at the start at points (P, d) -> (P,), where they are not the same everywhere.

    shape: mpm.scene.shapes; temperature [K] at the start; density [kg/m3]; kappa [W/(m K)], alpha [J/(kg K)]: numbers or mpm.materials.laws.
    """

    shape: Any
    temperature: float
    density: float
    kappa: Any
    alpha: Any
    surfaces: tuple[tuple[str, Any, Any], ...] = ()
    fluxes: tuple[tuple[str, Any], ...] = ()
    radiation: tuple[tuple[str, Any, Any], ...] = ()
    sources: tuple[tuple[Any, float, float, float], ...] = ()
    field: Any = None

    @property
    def turns(self) -> set[float]:
        """Times at which something jumps [s]."""
        around = {when for entry in (*self.surfaces, *self.fluxes, *self.radiation) for one in entry[1:] for when in turns(one)}
        return around | {when for one, _, begin, end in self.sources for when in (begin, end, *turns(one))}


@dataclass(frozen=True)
class System:
    """What a method needs of one body."""

    geometry: Geometry
    density: float
    kappa: Any
    alpha: Any
    start: float  # [K]
    field: Any  # theta(x) at the start, or None
    zero: float  # [K]
    exchange: np.ndarray  # (n, N) stencil of sum beta B
    facing: np.ndarray  # (N,) sum beta int N over surfaces
    programmes: Programmes  # what surrounds the body, over time
    radiant: Radiant
    hot: np.ndarray  # (n, N) stencil of radiation's slope at the hottest; (0, 0) where nothing radiates
    span: float  # largest temperature difference in the data [K]
    coldest: float  # [K]
    hottest: float  # [K]
    stiff: float  # largest beta h/kappa
    bounds: tuple[float, float]  # that no temperature may pass: infinite on the side of a flux [K]
    firm: float  # largest beta h/kappa of the whole run: what `zero` goes by, as the state of a run is relative to it from one jump to the next


def law(given):
    return Constant(float(given)) if isinstance(given, int | float) else given


def make_system(body: RigidBody, axisymmetric: bool, h: float, origin, end: float = 0.0, hats: bool = False, others: tuple = (), moment: float = 0.0) -> System:
    """`end`: how long fluxes act, for the range of temperatures [s]; `hats`: for BoundedSteps; `others`: shapes that touch it; `moment`: of the
    run [s], for what jumps. The range of temperatures and `zero` are those of the whole run."""
    kappa, alpha = law(body.kappa), law(body.alpha)
    sides = tuple(entry[0] for entry in (*body.surfaces, *body.fluxes, *body.radiation))
    shaped = (hat_geometry if hats else geometry)(body.shape, axisymmetric, float(h), tuple(float(o) for o in origin), sides, others)
    data = temperatures(body, shaped)
    conductivity = max(value(kappa, t) for t in data)
    betas, most, zero = coefficients(body, conductivity, h, moment)
    exchange, facing, steady, forcing = convection(body, shaped, betas, zero, conductivity if hats else None, moment)
    steady, given, data, bounded = fluxes(body, shaped, steady, data, alpha, conductivity, end, moment)
    through = 0.0 if any(turns(beta) for _, beta, _ in body.surfaces) else float(facing.sum())
    heated, grown, sunk = sources_of(body, shaped, conductivity, through, min(value(alpha, t) for t in data), end, moment)
    steady, given, data = steady + heated.steady, [*given, *heated.given], [*data, max(data) + grown, max(min(data) - sunk, 0.5 * min(data))]
    bounded = -math.inf if sunk > 0 else bounded[0], math.inf if grown > 0 else bounded[1]
    radiant, hot = radiating(body, shaped, zero, len(body.surfaces) + len(body.fluxes), max(data), moment)
    span = max(max(data) - min(data), 1e-6 * max(map(abs, data)), 1e-30)
    stiff, firm = (max(each, default=0.0) * h / conductivity if conductivity > 0 else 0.0 for each in (betas, most))
    skies = tuple(float(sky) if isinstance(sky, int | float) else sky for sky in (during(sky, moment) for _, _, sky in body.radiation))
    programmes = Programmes(steady, tuple(forcing), tuple(given), skies, zero, heated.within)
    return System(
        shaped, float(body.density), kappa, alpha, float(body.temperature), body.field, zero, exchange, facing, programmes, radiant, hot, span, min(data),
        max(data), stiff, bounded, firm,
    )  # fmt: skip


def temperatures(body: RigidBody, shaped: Geometry) -> list[float]:
    """Temperatures that the body starts at and that its surroundings take at any time [K]; not of what exchanges nothing."""
    around = [outside for _, beta, outside in body.surfaces if bounds(beta)[1] > 0]
    around += [sky for _, emissivity, sky in body.radiation if bounds(emissivity)[1] > 0]
    data = [float(t) for t in (body.temperature, *(t for one in around for t in bounds(one)))]
    if body.field is not None:
        field = body.field(shaped.x)
        data += [float(np.min(field)), float(np.max(field))]
    return data


def coefficients(body: RigidBody, conductivity: float, h: float, moment: float) -> tuple[list[float], list[float], float]:
    """(beta of each surface at a moment, and the largest of the run, numbers where they are infinite [W/(m2 K)]; the temperature that others are relative
    to [K], which is the same at all moments, whatever touches the body)."""
    finite = PENALTY * conductivity / h
    most = [finite if math.isinf(beta) else beta for beta in (float(bounds(beta)[1]) for _, beta, _ in body.surfaces)]
    betas = [finite if math.isinf(beta) else beta for beta in (during(beta, moment) for _, beta, _ in body.surfaces)]
    depth = 0.5 * float(np.min(np.subtract(*body.shape.bounds()[::-1])))
    stiffest = int(np.argmax(most)) if most else 0
    zero = float(at(body.surfaces[stiffest][2], 0.0)) if most and most[stiffest] * depth > conductivity else float(body.temperature)
    return betas, most, zero


def convection(
    body: RigidBody, shaped: Geometry, betas: list[float], zero: float, conductivity: float | None, moment: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list]:
    """(stencil of sum beta B, sum beta int N, heat from surroundings that stay [W], what changes). conductivity: of hats, else None."""
    exchange, facing, steady, forcing = np.zeros_like(shaped.mass), np.zeros(shaped.nodes.size), np.zeros(shaped.nodes.size), []
    for k, ((_, _, outside), beta, stencil, area) in enumerate(zip(body.surfaces, betas, shaped.exchange, shaped.area, strict=False)):
        if beta == 0:
            continue
        outside = during(outside, moment)
        beta = beta if conductivity is None else over_depth(beta, shaped.depth[k], conductivity)
        exchange += beta * stencil
        facing += beta * area
        if isinstance(outside, int | float):
            steady += beta * (outside - zero) * area
        else:
            forcing.append((outside, beta * area))
    return exchange, facing, steady, forcing


def fluxes(
    body: RigidBody, shaped: Geometry, steady: np.ndarray, data: list[float], alpha: Any, conductivity: float, end: float, moment: float
) -> tuple[np.ndarray, list, list[float], tuple[float, float]]:
    """(heat that is steady with that of fluxes [W], fluxes that change, temperatures that they may reach [K], bounds that no temperature may pass [K])."""
    data, given, ends = list(data), [], [bounds(q) for _, q in body.fluxes]
    bounded = -math.inf if any(least < 0 for least, _ in ends) else min(data), math.inf if any(greatest > 0 for _, greatest in ends) else max(data)
    capacity = body.density * float(shaped.volume.sum())
    for (_, q), (least, greatest), area in zip(body.fluxes, ends, shaped.area[len(body.surfaces) :], strict=False):
        now = during(q, moment)
        if isinstance(now, int | float):
            steady += now * area
        else:
            given.append((now, area))
        for extreme in {least, greatest} - {0.0}:
            rise = abs(extreme) * float(area.sum()) * end / (capacity * min(value(alpha, t) for t in data))
            steep = abs(extreme) * float(np.ptp(shaped.x, axis=0).max()) / max(conductivity, 1e-300)
            data += [max(data) + min(rise, 1e4) + min(steep, 1e4)] if extreme > 0 else [max(min(data) - rise - steep, 0.5 * min(data))]
    return steady, given, data, bounded


def sources_of(
    body: RigidBody, shaped: Geometry, conductivity: float, through: float, alpha: float, end: float, moment: float
) -> tuple[Programmes, float, float]:
    """(heat from within: steady, given, within; at most how much warmer and colder it makes the body [K], of which `through` [W/K] loses it)."""
    steady, given, within, least, greatest = np.zeros(shaped.nodes.size), [], [], 0.0, 0.0
    nodes = evaluated(shaped.nodes, shaped.x) if any(isinstance(one, Code) for one, *_ in body.sources) else ()
    for one, factor, begin, stop in body.sources:
        acts = begin <= moment * (1 + SAME) and moment < stop * (1 - SAME)
        if isinstance(one, Code):
            found = Within(one, shaped.x, factor * shaped.w, *nodes, shaped.nodes.size, math.inf if one.lasting else end / LOOKS)
            ends = [factor * values(one, shaped.x, t) for t in ((0.0,) if one.lasting else np.linspace(max(begin, 0.0), min(stop, end), LOOKS))]
            least, greatest = least + min(0.0, *map(np.min, ends)), greatest + max(0.0, *map(np.max, ends))
            if acts and one.lasting:
                steady += found.at(0.0)
            elif acts:
                within.append(found)
            continue
        low, high = (factor * bound for bound in bounds(one))
        least, greatest = least + min(low, 0.0), greatest + max(high, 0.0)
        now = during(one, moment)
        if isinstance(now, int | float):
            steady += now * factor * shaped.volume
        else:
            given.append((now, factor * shaped.volume))
    depth, whole = float(np.ptp(shaped.x, axis=0).max()), float(shaped.volume.sum())
    level = depth**2 / max(conductivity, 1e-300) + whole / through if through > 0 else math.inf
    warmer, colder = (min(size * min(end / (body.density * alpha), level), 1e4) if size > 0 else 0.0 for size in (greatest, -least))
    return Programmes(steady, (), tuple(given), (), 0.0, tuple(within)), warmer, colder


def radiating(body: RigidBody, shaped: Geometry, zero: float, first: int, hottest: float, moment: float) -> tuple[Radiant, np.ndarray]:
    """Points that radiate, and the stencil of their slope at the hottest temperature; `first`: number of the first radiating surface."""
    splines = len(shaped.nodes.local)
    parts = [(np.zeros((0, splines), dtype=np.int64), np.zeros((0, splines)), np.zeros(0), np.zeros(0, dtype=np.int64))]
    hot = np.zeros_like(shaped.mass) if body.radiation else np.zeros((0, 0))
    for k, (_, emissivity, _) in enumerate(body.radiation):
        emissivity = during(emissivity, moment)
        x, w = shaped.faces[first + k]
        index, spline = evaluated(shaped.nodes, x)
        parts.append((index, spline, STEFAN_BOLTZMANN * emissivity * w, np.full(len(w), k)))
        hot += 4 * STEFAN_BOLTZMANN * emissivity * hottest**3 * shaped.exchange[first + k]
    return Radiant(*(np.ascontiguousarray(np.concatenate(p)) for p in zip(*parts, strict=True)), float(zero)), hot
