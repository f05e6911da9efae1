"""One body's equations: geometry, laws and surroundings gathered, before a method is chosen.

beta = inf becomes a penalty of PENALTY kappa/h: fixed temperature to within h/(PENALTY L) of the temperature difference. Temperatures are kept relative to
`zero`: the surroundings of the stiffest surface where the Biot number is above 1, so that heat through it is a small number times a large one,
not a difference of large ones; else the body's start, so that small changes keep their digits. The heat ledger needs both.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.materials.laws import Constant
from mpm.materials.roles import value
from mpm.rigid.geometry import Geometry, geometry

PENALTY = 1e5


@dataclass(frozen=True)
class RigidBody:
    """A body that does not move. `surfaces`: (side, beta >= 0 or inf [W/(m2 K)], outside [K]) each; the rest is insulated.

    shape: mpm.scene.shapes; temperature [K] at the start; density [kg/m3]; kappa [W/(m K)], alpha [J/(kg K)]: numbers or mpm.materials.laws.
    """

    shape: Any
    temperature: float
    density: float
    kappa: Any
    alpha: Any
    surfaces: tuple[tuple[str, float, float], ...] = ()


@dataclass(frozen=True)
class System:
    """What a method needs of one body."""

    geometry: Geometry
    density: float
    kappa: Any
    alpha: Any
    start: float  # [K]
    zero: float  # [K]
    exchange: np.ndarray  # (n, N) stencil of sum beta B
    facing: np.ndarray  # (N,) sum beta int N over surfaces
    supply: np.ndarray  # (N,) sum beta (outside - zero) int N
    received: float  # its sum
    span: float  # largest temperature difference in the data [K]
    coldest: float  # [K]
    hottest: float  # [K]
    stiff: float  # largest beta h/kappa


def law(given):
    return Constant(float(given)) if isinstance(given, int | float) else given


def make_system(body: RigidBody, axisymmetric: bool, h: float, origin) -> System:
    kappa, alpha = law(body.kappa), law(body.alpha)
    shaped = geometry(body.shape, axisymmetric, float(h), tuple(float(o) for o in origin), tuple(side for side, _, _ in body.surfaces))
    betas = [float(beta) for _, beta, _ in body.surfaces]
    data = [body.temperature, *(outside for _, beta, outside in body.surfaces if beta > 0)]
    conductivity = max(value(kappa, t) for t in data)
    betas = [PENALTY * conductivity / h if math.isinf(beta) else beta for beta in betas]
    depth = shaped.volume.sum() / max(sum(a.sum() for a in shaped.area), 1e-300)
    stiffest = int(np.argmax(betas)) if betas else 0
    zero = body.surfaces[stiffest][2] if betas and betas[stiffest] * depth > conductivity else body.temperature
    exchange, facing, supply = np.zeros_like(shaped.mass), np.zeros(shaped.nodes.size), np.zeros(shaped.nodes.size)
    for (_, _, outside), beta, stencil, area in zip(body.surfaces, betas, shaped.exchange, shaped.area, strict=True):
        if beta > 0:
            exchange += beta * stencil
            facing += beta * area
            supply += beta * (outside - zero) * area
    span = max(max(data) - min(data), 1e-6 * max(map(abs, data)), 1e-30)
    stiff = max(betas, default=0.0) * h / conductivity if conductivity > 0 else 0.0
    return System(
        shaped,
        float(body.density),
        kappa,
        alpha,
        float(body.temperature),
        float(zero),
        exchange,
        facing,
        supply,
        float(supply.sum()),
        span,
        min(data),
        max(data),
        stiff,
    )
