"""Who acts on which pieces of a moving body, and when: writes the surroundings of a heat step into its Surface.

Where nothing changes in time or place they are written once. beta is capped at PENALTY kappa/h, so beta = inf is a fixed temperature and the
answer is monotone in beta. A hot wall replaces whatever else acts on the pieces that touch it: within half a cell of its plane and facing it
(outward normal within 60 degrees of the wall's).
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.boundary import extents
from mpm.heat.programmes import at
from mpm.state import PAD, Radiation

REACH, FACING = 0.5, 0.5  # cells; cosine


@dataclass(frozen=True)
class Act:
    """One entry of the config on some pieces; outside and sky are numbers or programmes [K]."""

    pieces: np.ndarray
    beta: float = 0.0
    outside: Any = 0.0
    flux: float = 0.0
    emissivity: float = 0.0
    sky: Any = 0.0


@dataclass(frozen=True)
class HotWall:
    """A wall across `axis` (side 0 lower, 1 upper) with its own beta and temperature (number or programme)."""

    axis: int
    side: int
    beta: float
    temperature: Any


@dataclass
class Surroundings:
    """What acts on one body."""

    acts: list[Act]
    walls: list[HotWall]
    zero: float
    most: float  # PENALTY kappa/h: caps every beta [W/(m2 K)]
    written: bool = field(default=False, init=False)

    @property
    def steady(self) -> bool:
        """Whether one writing is enough."""
        return not self.walls and all(isinstance(p, float | int) for act in self.acts for p in (act.outside, act.sky))

    def write(self, space, body, start: float, dt: float) -> None:
        """Surroundings of the heat step from `start` to `start + dt`."""
        if self.written and self.steady:
            return
        self.written = True
        surface = body.surface
        for array in (surface.beta, surface.outside, surface.drift, surface.flux):
            array[:] = 0.0
        radiation = surface.radiation if isinstance(surface.radiation, Radiation) else None
        if radiation is not None:
            radiation.emissivity[:] = 0.0
        for act in self.acts:
            p = act.pieces
            surface.flux[p] += act.flux
            if act.beta > 0:
                beta = self.cap(act.beta)
                first, last = (at(act.outside, t) - self.zero for t in (start, start + dt))
                share = beta / (surface.beta[p] + beta)
                surface.outside[p] += share * (first - surface.outside[p])
                surface.drift[p] += share * (last - first - surface.drift[p])
                surface.beta[p] += beta
            if act.emissivity > 0:
                first, last = (at(act.sky, t) for t in (start, start + dt))
                radiation.emissivity[p], radiation.sky[p], radiation.drift[p] = act.emissivity, first, last - first
        for wall in self.walls:
            self.touch(wall, space, body, start, dt)

    def cap(self, beta: float) -> float:
        """beta, at most the penalty: what is finite and below it acts as it is given."""
        return min(beta, self.most)

    def touch(self, wall: HotWall, space, body, start: float, dt: float) -> None:
        """The pieces at a hot wall exchange with it alone."""
        surface, x = body.surface, body.particles.x
        F = surface.F[surface.row[surface.owner]].astype(float)
        place = x[surface.owner].astype(float) + np.einsum("sij,sj->si", F, surface.offset)
        normal = np.einsum("sji,sj->si", np.linalg.inv(F), surface.area)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)  # a face that is shut has no area
        out = 1.0 if wall.side else -1.0
        plane = (extents(space)[wall.axis] - 1 - 2 * PAD) * space.h if wall.side else 0.0
        here = (out * (plane - place[:, wall.axis]) < REACH * space.h) & (out * normal[:, wall.axis] > FACING)
        first, last = (at(wall.temperature, t) - self.zero for t in (start, start + dt))
        surface.beta[here], surface.outside[here], surface.drift[here], surface.flux[here] = self.cap(wall.beta), first, last - first, 0.0
        if isinstance(surface.radiation, Radiation):
            surface.radiation.emissivity[here] = 0.0
