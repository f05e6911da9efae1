"""Bodies that come in through nozzles (docs/physics.md 20): which layers of each are there, and what came in with them.

All that will ever come in is sampled as one column when the scene is built, layer behind layer, in arrays that hold it to the end. A scene's bodies are views
of those layers that are in the nozzle or have left it, so what is still to come costs no step anything. A layer comes in at the back as the one in front has
passed the mouth; blocks of steps end at these times, which follow from the config alone.
In the nozzle particles move as they are told (integrate/nozzle.py), and their surface exchanges nothing.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mpm.diagnostics import heat_since
from mpm.follow import Carried
from mpm.heat.programmes import integral
from mpm.state import PER_PARTICLE, Exposure, Radiation, Surface, Thermal, as_heated, as_moved

SOON = 1e-6  # of the shortest time between two layers: what is so near is now


def first(part: Any, n: int, s: int) -> Any:
    """Views of the first n particles and s pieces of surface in nested named tuples."""
    if not (isinstance(part, tuple) and hasattr(part, "_fields")):
        return part
    if isinstance(part, Radiation | Exposure):
        return type(part)(*(array[:s] for array in part))
    if isinstance(part, Surface):
        kept = {name: getattr(part, name)[:s] for name in ("owner", "area", "offset", "beta", "outside", "drift", "flux")}
        return part._replace(row=part.row[:n], radiation=first(part.radiation, n, s), exposure=first(part.exposure, n, s), **kept)
    rows = PER_PARTICLE.get(type(part), ())
    return type(part)(*(value[:n] if name in rows else first(value, n, s) for name, value in zip(part._fields, part, strict=True)))


@dataclass
class Stream:
    """A body that comes in, in K layers."""

    body: int  # its number
    speed: Any  # programme, never negative [m/s]
    layer: float  # thickness of a layer [m]
    inside: int  # layers that the nozzle holds
    particles: np.ndarray  # (K + 1,) how many the first k layers have
    pieces: np.ndarray  # (K + 1,) and how many pieces of surface
    reference: float  # temperature from which the heat that comes in is counted, less zero [K]
    whole: Any = field(default=None, init=False)  # the Body with all its layers
    around: Any = field(default=None, init=False)  # its Surroundings
    outline: Any = field(default=None, init=False)
    times: np.ndarray = field(default_factory=lambda: np.zeros(0), init=False)  # (K + 1,) when k layers have passed the mouth [s]
    passed: int = field(default=0, init=False)  # layers, by now

    @property
    def layers(self) -> int:
        """All of them."""
        return len(self.particles) - 1

    @property
    def present(self) -> int:
        """Layers that are there."""
        return min(self.layers, self.passed + self.inside)

    @property
    def count(self) -> int:
        """Particles that are there."""
        return int(self.particles[self.present])

    def travel(self, t: float) -> float:
        """How far the column has moved by time t [m]."""
        return integral(self.speed, 0.0, t)

    def plan(self, end: float) -> None:
        """The times of the layers up to `end`, infinite beyond."""
        self.times, low = np.full(self.layers + 1, np.inf), 0.0
        self.times[0] = 0.0
        for k in range(1, self.layers + 1):
            far = k * self.layer * (1 - 1e-12)
            if self.travel(end) < far:
                break
            high = end
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if self.travel(middle) >= far else (middle, high)
            self.times[k] = low = high

    def view(self) -> Any:
        """The body as it is now."""
        return first(self.whole, self.count, int(self.pieces[self.present]))

    def met(self) -> Any:
        """Its surroundings: nothing acts on what is in the nozzle."""
        if self.around is None:
            return None
        seen, shown = int(self.pieces[self.passed]), int(self.pieces[self.present])
        acts = [replace(act, pieces=act.pieces[act.pieces < seen]) for act in self.around.acts]
        walls = [wall if wall.touched is None else replace(wall, touched=wall.touched[:shown]) for wall in self.around.walls]
        return replace(self.around, acts=acts, walls=walls)

    def carried(self) -> Carried:
        """Points of its surface that present particles carry, and of its end in the nozzle."""
        kept = (self.outline.owner < self.count) & (self.outline.near < self.count).all(axis=1)
        last = np.arange(self.particles[self.present - 1], self.count, dtype=np.int32) if self.present < self.layers else np.zeros(0, np.int32)
        K, back = self.outline.near.shape[1], -0.5 * self.layer * self.whole.source.way
        end = Carried(last, np.repeat(last[:, None], K, axis=1), np.zeros((len(last), K)), np.tile(back, (len(last), 1)))
        return Carried(*(np.concatenate([array[kept], more], dtype=array.dtype) for array, more in zip(self.outline, end, strict=True)))

    def place(self, begin: int, end: int, now: float) -> None:
        """Particles `begin` to `end` where they are at time `now`."""
        source, particles, way = self.whole.source, self.whole.particles, self.travel(now)
        source.behind[begin:end] -= way
        particles.x[begin:end] = source.place[begin:end] - source.behind[begin:end, None] * source.way
        particles.v[begin:end] = source.speed[0] * source.way


@dataclass
class Inflow:
    """All bodies of a scene that come in, and the sums of what did after the start."""

    streams: tuple[Stream, ...]
    mass: float = field(default=0.0, init=False)  # [kg]
    volume: float = field(default=0.0, init=False)  # undeformed [m3]
    heat: float = field(default=0.0, init=False)  # above the reference of each body [J]
    energy: float = field(default=0.0, init=False)  # kinetic, and of gravity where that stays as it is [J]

    def begin(self, scene) -> None:
        """Keep the whole bodies, and show what there is of them at the start."""
        for one in self.streams:
            b = one.body
            one.whole, one.around, one.outline = scene.bodies[b], scene.surroundings[b], scene.outlines[b]
            one.plan(float(scene.times[-1]))
            if isinstance(surface := one.whole.surface, Surface):
                still = (surface.beta, surface.flux, *((surface.radiation.emissivity,) if isinstance(surface.radiation, Radiation) else ()))
                for array in still:  # what was written of the whole when it was built
                    array[:] = 0.0
        self.show(scene)

    def memory(self) -> dict:
        """What a run that goes on needs (mpm.memory)."""
        return {"passed": [one.passed for one in self.streams], "sums": [self.mass, self.volume, self.heat, self.energy]}

    def recall(self, scene, found: dict) -> None:
        """As it was when `memory` was kept; the arrays of the bodies are put back by others."""
        self.mass, self.volume, self.heat, self.energy = found["sums"]
        for one, passed in zip(self.streams, found["passed"], strict=True):
            one.passed = passed
        self.show(scene)

    def series(self, warm: bool):
        """(dataset name, value) of what came in since the start; of heat where any body has some."""
        yield from (("mass_inflow", self.mass), ("volume_inflow", self.volume), ("energy_inflow", self.energy))
        if warm:
            yield "heat_inflow", self.heat

    def refer(self, start: dict) -> None:
        """Temperatures from which heat is counted, by body: of what comes in later those of the references."""
        for one in self.streams:
            if one.body in start:
                start[one.body][one.count :] = one.reference

    def wholes(self, scene) -> list:
        """The bodies of a scene with all that will ever come in."""
        bodies = list(scene.bodies)
        for one in self.streams:
            bodies[one.body] = one.whole
        return bodies

    def show(self, scene) -> None:
        """The scene with the layers that are there."""
        bodies, around, outlines = list(scene.bodies), list(scene.surroundings), list(scene.outlines)
        for one in self.streams:
            bodies[one.body], around[one.body], outlines[one.body] = one.view(), one.met(), one.carried()
        scene.bodies, scene.surroundings, scene.outlines = tuple(bodies), tuple(around), tuple(outlines)
        scene.for_motion, scene.for_heat = as_moved(scene.bodies), tuple(map(as_heated, scene.bodies))
        scene.order.grow(scene.bodies)
        if scene.meeting is not None:
            scene.meeting.bodies = scene.bodies

    def soon(self, one: Stream) -> float:
        """What is nearer than this is now [s]."""
        known = one.times[np.isfinite(one.times)]
        return SOON * float(np.diff(known).min(initial=np.inf)) if len(known) > 1 else 0.0

    def before(self, now: float, until: float) -> float:
        """`until`, or the next time after `now` at which a layer comes in."""
        for one in self.streams:
            if one.passed < one.layers and (then := one.times[one.passed + 1]) < until - self.soon(one):
                until = float(then)
        return until

    def enter(self, scene, now: float) -> None:
        """The layers whose time has come."""
        grown = False
        for one in self.streams:
            passed = int(np.searchsorted(one.times, now + self.soon(one), side="right")) - 1
            if passed <= one.passed:
                continue
            begin, one.passed, grown = one.count, passed, True
            one.place(begin, one.count, now)
            self.keep_books(scene, one, slice(begin, one.count))
        if grown:
            self.show(scene)

    def keep_books(self, scene, one: Stream, some: slice) -> None:
        """Of particles that come in."""
        body, p = one.whole, one.whole.particles
        m, x, v = (array[some].astype(float) for array in (p.m, p.x, p.v))
        self.mass += float(np.sum(m))
        self.volume += float(np.sum(p.V0[some], dtype=float))
        self.energy += float(0.5 * np.sum(m * np.sum(v * v, axis=1)))
        if scene.course is None or not scene.course.gravity:
            self.energy -= float(np.sum(m[:, None] * x * scene.gravity[0]))
        if isinstance(body.thermal, Thermal):
            part = body._replace(particles=p._replace(m=m), thermal=body.thermal._replace(theta=body.thermal.theta[some]))
            self.heat += heat_since(part, np.full(len(m), one.reference))

    def lay(self, start: float, span: float) -> None:
        """The speed of the nozzles in a block of steps: its mean, so what comes in is exact. A block of no steps compiles only."""
        for one in self.streams if span > 0.0 else ():
            one.whole.source.speed[0] = integral(one.speed, start, start + span) / span
