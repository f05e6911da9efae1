"""What surrounds a rigid body at a time: convection and flux as a supply, radiation at the surface's quadrature points.

supply(t) = sum beta (outside(t) - zero) int N + sum q int N + int q(x, t) N        radiation: -sum_q w sigma e (T_q^4 - sky(t)^4) N(x_q)
Temperatures over time are mpm.heat.programmes; between the ends of an explicit step they are taken as linear, at the stages of an implicit one as they are.
"""

from typing import Any, NamedTuple

import numpy as np

from mpm.heat.programmes import at, longest
from mpm.jit import kernel
from mpm.sources import Code, values


class Around(NamedTuple):
    """At one time."""

    supply: np.ndarray  # (N,) [W]
    received: float  # its sum
    sky: np.ndarray  # (K,) temperatures that radiate at the body [K]


class Radiant(NamedTuple):
    """Points of the surface that radiate; none where nothing does."""

    index: np.ndarray  # (S, m) nodes of a point
    value: np.ndarray  # (S, m) their splines
    weight: np.ndarray  # (S,) area times sigma times emissivity [W/K4]
    sky: np.ndarray  # (S,) which of Around.sky
    zero: float  # [K]


class Within(NamedTuple):
    """Heat from within by a formula: int q(x, t) N over the body's quadrature points. No temperature is known to it."""

    code: Code  # [W/m3]
    x: np.ndarray  # (Q, d) points
    w: np.ndarray  # (Q,) weights
    index: np.ndarray  # (Q, m) nodes of a point
    spline: np.ndarray  # (Q, m)
    size: int  # of the supply
    longest: float  # of a step [s]

    def at(self, t: float) -> np.ndarray:
        """(N,) [W]"""
        each = (self.w * values(self.code, self.x, t))[:, None] * self.spline
        return np.bincount(self.index.ravel(), weights=each.ravel(), minlength=self.size)


class Programmes(NamedTuple):
    """Around at any time: what is constant, and what follows a programme."""

    steady: np.ndarray  # (N,) supply that never changes [W]
    forcing: tuple[tuple[Any, np.ndarray], ...]  # (programme, beta int N)
    given: tuple[tuple[Any, np.ndarray], ...]  # (programme of a flux, int N over the surface; or of heat from within, int N)
    skies: tuple[Any, ...]
    zero: float
    within: tuple[Within, ...] = ()

    @property
    def changes(self) -> bool:
        return bool(self.forcing or self.given or self.within) or not all(isinstance(sky, float) for sky in self.skies)

    @property
    def longest(self) -> float:
        """No step may be longer, or it would miss what changes [s]."""
        every = [longest(p) for p in (*(p for p, _ in (*self.forcing, *self.given)), *self.skies)]
        return min([*every, *(one.longest for one in self.within)], default=np.inf)

    def around(self, t: float) -> Around:
        supply = self.steady
        for programme, facing in self.forcing:
            supply = supply + (at(programme, t) - self.zero) * facing
        for programme, area in self.given:
            supply = supply + at(programme, t) * area
        for one in self.within:
            supply = supply + one.at(t)
        return Around(supply, float(supply.sum()), np.array([at(sky, t) for sky in self.skies], dtype=float))


@kernel
def between(first, last, part, supply, sky):
    """Linear in between, in the arrays given."""
    for i in range(len(supply)):
        supply[i] = first.supply[i] + part * (last.supply[i] - first.supply[i])
    for i in range(len(sky)):
        sky[i] = first.sky[i] + part * (last.sky[i] - first.sky[i])
    return first.received + part * (last.received - first.received)


@kernel
def radiate(radiant, sky, theta, out):
    """out_i += what node i loses; returns the heat taken in a second [W]."""
    taken = 0.0
    for q in range(len(radiant.weight)):
        T = radiant.zero
        for a in range(radiant.index.shape[1]):
            T += radiant.value[q, a] * theta[radiant.index[q, a]]
        cold = sky[radiant.sky[q]]
        lost = radiant.weight[q] * (T * T + cold * cold) * (T + cold) * (T - cold)
        taken -= lost
        for a in range(radiant.index.shape[1]):
            out[radiant.index[q, a]] += lost * radiant.value[q, a]
    return taken


@kernel
def radiate_slope(radiant, theta, dt, band):
    """band += dt times the derivative of `radiate`."""
    for q in range(len(radiant.weight)):
        T = radiant.zero
        for a in range(radiant.index.shape[1]):
            T += radiant.value[q, a] * theta[radiant.index[q, a]]
        slope = 4.0 * dt * radiant.weight[q] * T * T * T
        for a in range(radiant.index.shape[1]):
            i = radiant.index[q, a]
            for b in range(radiant.index.shape[1]):
                k = radiant.index[q, b] - i
                if k >= 0:
                    band[i, k] += slope * radiant.value[q, a] * radiant.value[q, b]
