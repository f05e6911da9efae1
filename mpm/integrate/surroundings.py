"""Who acts on which pieces of a moving body, and when: writes the surroundings of a heat step into its Surface.

Where nothing changes in time or place they are written once. beta is capped at PENALTY kappa/h, so beta = inf is a fixed temperature and the
answer is monotone in beta. A hot wall replaces whatever else acts on the pieces that touch it, for the share of the heat step that they touched it
(mpm.contact); at a mirror wall, which holds what it touches: within half a cell of its plane and facing it (outward normal within 60 degrees of the wall's).
Another body that touches a piece hides it from what surrounds it, for the share of the heat step that it touched it.

For heat, a mirror wall through which something is exchanged is a free surface: a mirror would make the temperature level off where a flux acts. An insulated
one stays a mirror. A slab that exchanges through its side on a stick wall, Bi = 10, Fo = 0.1, error of the mean at 16, 32, 64 cells: 5.0, 2.5, 1.2 % where that
side is mirrored, 0.34, 0.06, 0.003 % where it is free (tests/integrate/test_heat_through_walls.py).
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.boundary import CONTACT, extents
from mpm.heat.programmes import at, changes, during, turns
from mpm.state import PAD, Radiation

REACH, FACING = 0.5, 0.5  # cells; cosine
NEAR = 4.0  # cells from a particle to its pieces, at most
MIRRORED = 1.0  # cells from a mirror wall in which a particle reaches the nodes behind it, at most (cubic splines)


@dataclass(frozen=True)
class Act:
    """One entry of the config on some pieces; every value is a number or a programme (mpm.heat.programmes)."""

    pieces: np.ndarray
    beta: Any = 0.0
    outside: Any = 0.0
    flux: Any = 0.0
    emissivity: Any = 0.0
    sky: Any = 0.0

    @property
    def over_time(self) -> tuple:
        """What may change."""
        return self.beta, self.outside, self.flux, self.emissivity, self.sky


@dataclass(frozen=True)
class HotWall:
    """A wall across `axis` (side 0 lower, 1 upper), or a tool, with its own beta and temperature (number or programme)."""

    axis: int
    side: int
    beta: Any
    temperature: Any
    acts: Any = 1.0  # 0 before `from` and after `until`: then the body's surroundings act
    touched: Any = None  # (S,) time in touch since the last heat step [s]; None: a mirror
    tool: str = ""  # its name; nothing of a wall
    number: int = 0  # among all hot walls and tools of the scene (mpm.simulation.Scene.hot)


@dataclass
class Surroundings:
    """What acts on one body."""

    acts: list[Act]
    walls: list[HotWall]
    zero: float
    most: float  # PENALTY kappa/h: caps every beta [W/(m2 K)]
    written: bool = field(default=False, init=False)
    hidden: bool = field(default=False, init=False)  # whether something was covered when it was written
    betas: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)), init=False)  # (walls, S) of each wall on each piece in the heat step [W/(m2 K)]
    ends: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)), init=False)  # (walls, 2) temperatures at its ends, less zero [K]

    @property
    def steady(self) -> bool:
        """Whether one writing is enough."""
        return not self.walls and not any(changes(one) for act in self.acts for one in act.over_time)

    @property
    def turns(self) -> set[float]:
        """Times at which something jumps [s]."""
        every = [one for act in self.acts for one in act.over_time] + [one for wall in self.walls for one in (wall.beta, wall.temperature, wall.acts)]
        return {when for one in every for when in turns(one)}

    def write(self, space, body, start: float, dt: float, covered: np.ndarray | None = None) -> None:
        """Surroundings of the heat step from `start` to `start + dt`, within which nothing jumps: rates as they are in its middle.

        covered   share of the heat step for which another body lay on a piece (S,): it sees what surrounds it for the rest; None: never
        """
        if self.written and self.steady and covered is None and not self.hidden:
            return
        self.written, self.hidden = True, covered is not None
        surface = body.surface
        for array in (surface.beta, surface.outside, surface.drift, surface.flux):
            array[:] = 0.0
        radiation = surface.radiation if isinstance(surface.radiation, Radiation) else None
        if radiation is not None:
            radiation.emissivity[:] = 0.0
        for act in self.acts:
            p = act.pieces
            beta, flux, emissivity = (at(during(one, start), start + 0.5 * dt) for one in (act.beta, act.flux, act.emissivity))
            outside, sky = during(act.outside, start), during(act.sky, start)
            surface.flux[p] += flux
            if beta > 0:
                beta = self.cap(beta)
                first, last = (at(outside, t) - self.zero for t in (start, start + dt))
                share = beta / (surface.beta[p] + beta)
                surface.outside[p] += share * (first - surface.outside[p])
                surface.drift[p] += share * (last - first - surface.drift[p])
                surface.beta[p] += beta
            if emissivity > 0:
                first, last = (at(sky, t) for t in (start, start + dt))
                radiation.emissivity[p], radiation.sky[p], radiation.drift[p] = emissivity, first, last - first
        if covered is not None:
            free = 1.0 - covered[: len(surface.beta)]  # what flows in has pieces that are not there yet
            for array in (surface.beta, surface.flux, *(() if radiation is None else (radiation.emissivity,))):
                array *= free
        self.betas, self.ends = np.zeros((len(self.walls), len(surface.beta))), np.zeros((len(self.walls), 2))
        for number, wall in enumerate(self.walls):
            self.touch(number, wall, space, body, start, dt)
        for array in surface.exposure if self.walls else ():
            array[:] = 0.0

    def given(self, surface, count: int) -> np.ndarray:
        """Heat that each of the scene's `count` hot walls and tools gave in the heat step that is over (count,) [J]."""
        heat = np.zeros(count)
        if self.walls:
            area, theta, part = surface.exposure
            each = self.betas * (np.outer(self.ends[:, 0], area) + np.outer(self.ends[:, 1] - self.ends[:, 0], part) - theta)
            heat[[wall.number for wall in self.walls]] = each.sum(axis=1)
        return heat

    def cap(self, beta: float) -> float:
        """beta, at most the penalty: what is finite and below it acts as it is given."""
        return min(beta, self.most)

    def met(self, wall: HotWall, start: float, dt: float) -> tuple[float, float, float]:
        """Temperature of a wall at both ends of a heat step, less zero, and its beta."""
        temperature = during(wall.temperature, start)
        return at(temperature, start) - self.zero, at(temperature, start + dt) - self.zero, self.cap(at(during(wall.beta, start), start + 0.5 * dt))

    def mirrors(self, space, body, kinds: np.ndarray) -> np.ndarray:
        """Kinds of the walls (3, 2) for heat: CONTACT, which mirrors nothing, where a wall is hot, and where pieces that exchange something lie on it."""
        surface, found = body.surface, kinds.copy()
        for wall in self.walls:
            if not wall.tool:
                found[wall.axis, wall.side] = CONTACT
        acting = (surface.beta > 0) | (surface.flux != 0)
        if isinstance(surface.radiation, Radiation):
            acting |= surface.radiation.emissivity > 0
        for axis in range(body.particles.x.shape[1]):
            for side in range(2):
                if found[axis, side] != CONTACT and np.any(acting[facing(space, body, axis, side, MIRRORED)]):
                    found[axis, side] = CONTACT
        return found

    def touch(self, number: int, wall: HotWall, space, body, start: float, dt: float) -> None:
        """The pieces at a hot wall exchange with it alone, and with nothing where its beta is 0."""
        if during(wall.acts, start) == 0.0:
            return
        if wall.touched is not None:
            self.share(number, wall, body.surface, start, dt)
            return
        surface, here = body.surface, facing(space, body, wall.axis, wall.side, REACH)
        first, last, beta = self.met(wall, start, dt)
        surface.beta[here], surface.outside[here], surface.drift[here], surface.flux[here] = beta, first, last - first, 0.0
        if isinstance(surface.radiation, Radiation):
            surface.radiation.emissivity[here] = 0.0
        self.betas[:, here], self.betas[number, here], self.ends[number] = 0.0, beta, (first, last)

    def share(self, number: int, wall: HotWall, surface, start: float, dt: float) -> None:
        """The pieces that touched a wall for a part of the heat step exchange with it for that part, and with the rest for what is left."""
        s = np.flatnonzero(wall.touched > 0.0)
        if len(s) == 0 or dt == 0.0:
            return
        part = np.minimum(wall.touched[s] / dt, 1.0)
        first, last, beta = self.met(wall, start, dt)
        beta, free = part * beta, 1.0 - part
        both = free * surface.beta[s] + beta
        weight = beta / np.maximum(both, 1e-300)
        surface.outside[s] += weight * (first - surface.outside[s])
        surface.drift[s] += weight * (last - first - surface.drift[s])
        surface.beta[s] = both
        surface.flux[s] *= free
        if isinstance(surface.radiation, Radiation):
            surface.radiation.emissivity[s] *= free
        self.betas[:, s] *= free
        self.betas[number, s], self.ends[number] = beta, (first, last)


def jumps(surroundings, end: float, more: tuple = ()) -> np.ndarray:
    """Times before `end` at which what surrounds any body jumps, and `more`: heat steps end there."""
    every = {when for one in surroundings if one is not None for when in one.turns} | {*more}
    return np.array(sorted(when for when in every if 0 < when < end * (1 - 1e-9)))


def facing(space, body, axis: int, side: int, within: float) -> np.ndarray:
    """Numbers of the pieces at most `within` cells from a wall's plane that face it."""
    surface, x = body.surface, body.particles.x
    out, plane = (1.0, (extents(space)[axis] - 1 - 2 * PAD) * space.h) if side else (-1.0, 0.0)
    some = np.flatnonzero(out * (plane - x[surface.owner, axis]) < (within + NEAR) * space.h)
    F = surface.F[surface.row[surface.owner[some]]].astype(float)
    place = x[surface.owner[some], axis] + np.einsum("sj,sj->s", F[:, axis], surface.offset[some])
    normal = np.einsum("sji,sj->si", np.linalg.inv(F), surface.area[some])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)  # a face that is shut has no area
    return some[(out * (plane - place) < within * space.h) & (out * normal[:, axis] > FACING)]
