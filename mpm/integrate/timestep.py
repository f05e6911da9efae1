"""How long an explicit step may be: every limit of docs/physics.md 6, and which one binds.

elastic wave      1/2 h sqrt(R0/(d lam + 2 mu)) / sqrt(1 + eps_c) / sqrt(1 + |eps_min|)      isolated particles included
advection         h/(2 |v|)                                                                  half a cell a step
velocity gradient 1/(4 |grad v|)                                                             half of the guard in particle_update.py
drag              1/(2 rate)                                                                 a quarter of the limit of an explicit drag
heat              1/(rate_conduction + rate_exchange), with
conduction        kappa J/(0.4 R0 alpha h^2)
surface exchange  2 beta/(R0 alpha h)                                                        beta in the step: large beta, small step

Safe over 1e5 random arrangements a dimension, every transfer: python -m mpm.benchmarks.operators. A heat step of several sub-steps takes SUBSTEPS of the
limit: between transfers a lone particle at the edge of a cell bears 1/3 only (APIC at 0.4 grows tenfold in eight sub-steps). Hat functions bear nothing
between transfers: there is no limit for them here, and `auto` takes implicit steps (mpm/scene/build.py).

The heat limits bound the sub-step of a heat step; heat steps themselves come at their own pace,
PACE R0 alpha h^2/(kappa J): APIC damps by the step, so fewer are better, and above 0.2 the error grows (docs/physics.md 11). Where a body sets, at most
SETTING of its shortest time constant: its laws learn of X once a heat step.
"""

import math
from dataclasses import dataclass

import numpy as np

from mpm.heat.exchange import STEFAN_BOLTZMANN
from mpm.heat.setting import conditions
from mpm.integrate.strain import RATE, SPEED, STRAIN, SWELL
from mpm.materials import Condition, Constant, HenckyWarm, moduli, value, warmed
from mpm.sources import acting
from mpm.state import Expansion, GridHeating, Heating, Load, NoExchange, Radiation, Setting, Thermal

WAVE, CONDUCTION, EXCHANGE, PACE, DRAG, SETTING = 0.5, 0.4, 2.0, 0.15, 0.5, 0.05
SUBSTEPS = 0.8


@dataclass(frozen=True)
class Limits:
    """Seconds by name, for the mechanical step and for the heat sub-step; and the pace of heat steps."""

    mechanical: dict[str, float]
    heat: dict[str, float]
    pace: float

    def step(self) -> float:
        """The largest stable mechanical step [s]."""
        return min(self.mechanical.values(), default=float("inf"))

    def substep(self) -> float:
        """The largest stable heat sub-step [s]: the rates of conduction and exchange add."""
        rate = sum(1.0 / limit for limit in self.heat.values() if limit > 0)
        return 1.0 / rate if rate > 0 else float("inf")


def keep(table: dict[str, float], name: str, seconds: float) -> None:
    """The least of what has a name; infinity is no limit."""
    if math.isfinite(seconds):
        table[name] = min(table.get(name, math.inf), seconds)


def mechanical_limits(space, D, bodies, reports) -> dict[str, float]:
    """Limits of the mechanical step in the present state, by name [s]; every block of steps asks, so numbers are Python's."""
    h, found = space.h, {}
    for body, report in zip(bodies, reports.tolist(), strict=True):
        R0 = float(body.particles.m[0] / body.particles.V0[0])
        lam, mu = stiffest(body)
        soften = (1.0 + coupling(body, lam, mu, R0)) * (1.0 + abs(min(report[STRAIN], 0.0)))
        keep(found, "elastic wave", float(WAVE * h * math.sqrt(R0 / (D * lam + 2 * mu) / soften)))
        if report[SPEED] > 0:
            keep(found, "advection", 0.5 * h / math.sqrt(report[SPEED]))
        if report[RATE] > 0:
            keep(found, "velocity gradient", 0.25 / report[RATE])
        rate = sum(load.rate for load in acting(body.source) if isinstance(load, Load))
        if rate > 0:
            keep(found, "drag", DRAG / rate)
    return found


def limits(space, D, bodies, reports) -> Limits:
    """Limits of the present state; `reports` hold speed, rate, strain and swelling of the last steps."""
    h, heat, pace = space.h, {}, math.inf
    for body, report in zip(bodies, reports, strict=True):
        if isinstance(body.thermal, Thermal):
            R0 = float(body.particles.m[0] / body.particles.V0[0])
            kappa, alpha = conductance(body.thermal)
            J = max(float(report[SWELL]), float(body.particles.J.max()))
            if kappa > 0 and J > 0:  # of a state that is not finite J may be nothing at all: the guards name it
                keep(heat, "conduction", CONDUCTION * R0 * alpha * h * h / (kappa * J))
                pace = min(pace, PACE * R0 * alpha * h * h / (kappa * J))
            if isinstance(body.setting, Setting) and (fastest := float(np.max(body.setting.k))) > 0:
                pace = min(pace, SETTING / fastest)
            beta = strongest(body.surface, body.thermal)
            if beta > 0:
                keep(heat, "surface exchange", R0 * alpha * h / (EXCHANGE * beta * max(J, 1.0)))
    return Limits(mechanical_limits(space, D, bodies, reports), heat, pace)


def stiffest(body) -> tuple[float, float]:
    """Lame constants (lam, mu) [Pa] of the stiffest of the particles."""
    if not isinstance(body.elastic, HenckyWarm):
        return moduli(body.elastic)
    at = conditions(body)
    low, high = at.min(axis=0), at.max(axis=0)
    between = np.linspace(low, high, 33)
    if isinstance(body.setting, Setting):  # linear in X: the stiffest is at one of its ends
        between = [Condition(t, X) for t, _ in between for X in (low[1], high[1])]
    return max((moduli(warmed(body.elastic, t)) for t in between), key=lambda pair: pair[1])


def strongest(surface, thermal) -> float:
    """Largest beta of the pieces, radiation's slope 4 sigma e T^3 at the hottest place included [W/(m2 K)]."""
    if isinstance(surface, NoExchange):
        return 0.0
    beta = surface.beta
    if isinstance(surface.radiation, Radiation):
        hottest = np.maximum(surface.radiation.sky + np.maximum(surface.radiation.drift, 0.0), thermal.zero + float(np.max(thermal.theta)))
        beta = beta + 4 * STEFAN_BOLTZMANN * surface.radiation.emissivity * hottest**3
    return float(beta.max(initial=0.0))


def coupling(body, lam, mu, R0) -> float:
    """Thermoelastic coupling number gamma^2 Theta/(R0 alpha (lam + 2 mu)): elastic heating stiffens the wave (docs/physics.md 0)."""
    if not (isinstance(body.expansion, Expansion) and isinstance(body.heating, Heating | GridHeating) and body.heating.gamma > 0):
        return 0.0
    theta = body.thermal.zero + float(np.max(body.thermal.theta))
    return body.expansion.gamma * body.heating.gamma * theta / (R0 * value(body.thermal.alpha, theta) * (lam + 2 * mu))


def conductance(thermal) -> tuple[float, float]:
    """Largest kappa and smallest alpha among the particles' temperatures."""
    if isinstance(thermal.kappa, Constant) and isinstance(thermal.alpha, Constant):  # every heat step asks: no need to look at temperatures
        return thermal.kappa.constant, thermal.alpha.constant
    low, high = float(np.min(thermal.theta)) + thermal.zero, float(np.max(thermal.theta)) + thermal.zero
    between = np.linspace(low, high, 33)
    return max(value(thermal.kappa, t) for t in between), min(value(thermal.alpha, t) for t in between)
