"""The explicit or stabilised heat step of a body in slabs, by threads: the same bits for any number of them.

The steps are those of heat_step.py and heat_chebyshev.py, and so are the kernels that go over particles and pieces: each is given the part of the body in one
slab. As in step_threaded.py even slabs come before odd ones; where particles have drifted so far since they were sorted that slabs of a kind meet, they go
one after another in that order, by one thread. What is done to the nodes, fewer than particles, is one thread's.
Laws of temperature in the specific heat, implicit steps and bodies that exchange heat by touch remain one thread's.
"""

from itertools import pairwise

import numpy as np

from mpm.boundary import directions, extents
from mpm.boundary.walls import clear, fold, unfold
from mpm.integrate.heat_chebyshev import ROWS, combine, recurrence, stage_weights
from mpm.integrate.heat_step import conduct, gather_heat, over_nodes, reach, scatter_heat
from mpm.integrate.step_threaded import Crew, wave
from mpm.integrate.surface_flux import exchange, expose, place
from mpm.jit import kernel
from mpm.materials.laws import Constant
from mpm.state import Exposure, Particles, Radiation, Surface, Thermal
from mpm.transfer import CHUNK


def shared(scene, b: int) -> bool:
    """Whether threads share the heat steps of body b."""
    thermal = scene.for_heat[b].thermal
    return scene.order.sliced and isinstance(thermal, Thermal) and isinstance(thermal.alpha, Constant)


def part_of(body, begin: int, end: int):
    """The particles from `begin` to `end` of a body and their pieces, as a body: views, but for what of the surface a heat step only reads."""
    particles, thermal, surface = Particles(*(array[begin:end] for array in body.particles)), body.thermal, body.surface
    if isinstance(surface, Surface):
        here = pieces_between(surface, begin, end)
        row, owner, radiation = surface.row[begin:end], surface.owner[here] - begin, surface.radiation
        if isinstance(radiation, Radiation):
            radiation = Radiation(*(array[here] for array in radiation))
        read = (getattr(surface, name)[here] for name in ("area", "offset", "beta", "outside", "drift", "flux"))
        exposure = Exposure(*(np.zeros(len(here)) for _ in surface.exposure)) if isinstance(surface.exposure, Exposure) else surface.exposure
        surface = Surface(surface.F, row, owner, *read, radiation, exposure)
    return body._replace(particles=particles, thermal=thermal._replace(theta=thermal.theta[begin:end], c=thermal.c[begin:end]), surface=surface)


def pieces_between(surface, begin: int, end: int) -> np.ndarray:
    """Numbers of the pieces of the particles from `begin` to `end`."""
    return np.flatnonzero((begin <= surface.owner) & (surface.owner < end))


class Parts:
    """A body's slabs at work on one set of nodes."""

    def __init__(self, space, body, starts, axis: int, nodes, crew: Crew):
        self.space, self.crew, self.order = space, crew, wave(len(starts) - 1)
        self.spans = [(int(begin), int(end)) for begin, end in pairwise(starts)]
        self.parts = [part_of(body, *span) for span in self.spans]
        self.work = [np.zeros((2 + 3 * directions(space), CHUNK)) for _ in self.parts]
        self.boxes, self.places, self.apart = np.zeros((len(self.parts), 3, 2), np.int64), [None] * len(self.parts), True
        self.each(self.look)
        low, high = self.boxes[:, axis, 0], self.boxes[:, axis, 1]
        used = np.flatnonzero(high > low)
        self.apart = all(high[s] <= low[t] for s in used for t in used if t > s and (t - s) % 2 == 0)
        self.box = np.stack([self.boxes[..., 0].min(axis=0), self.boxes[..., 1].max(axis=0)], axis=1)

    def each(self, call) -> None:
        """call(slab) of all slabs."""

        def several(which) -> None:
            for s in which.tolist():
                call(s)

        if self.apart:
            self.crew.work(self.order, several)
        else:
            several(self.order)

    def look(self, s: int) -> None:
        self.boxes[s] = reach(self.space, self.parts[s].particles.x)
        self.places[s] = places(self.space, self.parts[s])

    def scatter(self, capacity, heat) -> None:
        """Capacity and heat on to the nodes."""

        def one(s: int) -> None:
            body = self.parts[s]
            scatter_heat(self.space, body.particles.x, body.particles.m, body.thermal, capacity, heat, self.work[s])

        self.each(one)

    def flow(self, theta, rate, dt: float, part: float, weight: float) -> float:
        """Conduction and exchange in dt on to `rate`; the heat gained [J]. The step ends with `weight` of it."""
        gained = [0.0] * len(self.parts)

        def one(s: int) -> None:
            body = self.parts[s]
            conduct(self.space, body, body.thermal, theta, rate, dt, self.work[s])
            gained[s] = exchange_and_expose(self.space, body, self.places[s], theta, rate, dt, part, weight, self.work[s])

        self.each(one)
        return weight * sum(gained)

    def tell(self, surface) -> None:
        """What the parts' pieces saw, to the body's."""
        if isinstance(surface, Surface) and isinstance(surface.exposure, Exposure):
            for span, part in zip(self.spans, self.parts, strict=True):
                for whole, mine in zip(surface.exposure, part.surface.exposure, strict=True):
                    whole[pieces_between(surface, *span)] += mine

    def gather(self, start, end, back) -> None:
        """Particle temperatures from the nodes before and after."""

        def one(s: int) -> None:
            gather_heat(self.space, self.parts[s].particles.x, self.parts[s].thermal, start, end, back, self.work[s])

        self.each(one)


@kernel
def exchange_and_expose(space, body, pieces, theta, rate, dt, part, weight, work):
    """exchange, and what the pieces of a part see of it, of which the step ends with `weight`."""
    gained = exchange(body, space, pieces, body.thermal, theta, rate, dt, part, work)
    expose(body.surface, space, body.particles.x, pieces, theta, weight * dt, part, work)
    return gained


@kernel
def places(space, body):
    """Present pieces of a part: a role that Python calls would be plain Python."""
    return place(body.surface, space, body)


@kernel
def open_nodes(fields, shape, box, walls):
    """Heat of `theta` becomes temperature, also in `start`; ghost nodes of mirrors likewise. fields: capacity, start, theta. Grows the box to images."""
    capacity, start, theta = fields
    fold(capacity.reshape(-1, 1), 0, shape, box.copy(), walls)
    fold(theta.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(theta, capacity, start, shape, box, True)
    unfold(start.reshape(-1, 1), 0, shape, box, walls)
    unfold(theta.reshape(-1, 1), 0, shape, box, walls)


@kernel
def add_rate(fields, shape, box, walls):
    """theta += rate/capacity, and rate is cleared. fields: capacity, theta, rate."""
    capacity, theta, rate = fields
    fold(rate.reshape(-1, 1), 0, shape, box, walls)
    over_nodes(rate, capacity, theta, shape, box, False)
    unfold(theta.reshape(-1, 1), 0, shape, box, walls)


@kernel
def next_stage(fields, shape, box, walls, shares, opening):
    """A stage of Chebyshev's recurrence. fields: capacity, rate, first, the three that it is made of, out."""
    capacity, rate, first, a, b, c, out = fields
    fold(rate.reshape(-1, 1), 0, shape, box, walls)
    combine(shape, box, capacity, rate, first, (a, b, c), shares, out, opening)
    unfold(out.reshape(-1, 1), 0, shape, box, walls)


@kernel
def clear_nodes(nodes, shape, box):
    """All fields back to zero."""
    for field in range(nodes.shape[0]):
        clear(nodes[field].reshape(-1, 1), shape, box.copy())


def heat_in_slabs(scene, b: int, nodes, walls, dt: float, count: int, back) -> float:
    """heat_step of body b in `count` sub-steps where the scene's method is explicit, else heat_chebyshev in `count` stages: the heat gained [J]."""
    order, step = scene.order, explicit if scene.heat.kind == "explicit" else stabilised
    with Crew(min(scene.threads, order.starts.shape[1] - 1)) as crew:
        parts = Parts(scene.space, scene.for_heat[b], order.starts[b], order.axis, nodes, crew)
        gained = step(parts, nodes, extents(scene.space), walls, dt, count, back)
        clear_nodes(nodes[:ROWS], extents(scene.space), parts.box)
        parts.tell(scene.for_heat[b].surface)
    return gained


def explicit(parts: Parts, nodes, shape, walls, dt: float, substeps: int, back) -> float:
    """As heat_step.py."""
    capacity, theta, start, rate = nodes[0], nodes[1], nodes[2], nodes[3]
    parts.scatter(capacity, theta)
    open_nodes((capacity, start, theta), shape, parts.box, walls)
    gained = 0.0
    for k in range(substeps):
        gained += parts.flow(theta, rate, dt / substeps, (k + 0.5) / substeps, 1.0)
        add_rate((capacity, theta, rate), shape, parts.box, walls)
    parts.gather(start, theta, back)
    return gained


def stabilised(parts: Parts, nodes, shape, walls, dt: float, count: int, back) -> float:
    """As heat_chebyshev.py."""
    capacity, start, rate, first, before, last, theta = nodes[:ROWS]
    parts.scatter(capacity, theta)
    open_nodes((capacity, start, theta), shape, parts.box, walls)
    terms = recurrence(count)
    weights, mu = stage_weights(terms).tolist(), float(terms[0, 0])
    gained = parts.flow(start, rate, dt, 0.0, weights[0])
    next_stage((capacity, rate, first, start, start, start, last), shape, parts.box, walls, (0.0, 0.0, 1.0, 0.0, mu), True)
    t_before, t_last = 0.0, mu
    for k in range(1, count):
        mu, nu, step, lag = terms[k].tolist()
        gained += parts.flow(last, rate, dt, t_last, weights[k])
        made = (capacity, rate, first, last, start if k == 1 else before, start, theta)
        next_stage(made, shape, parts.box, walls, (mu, nu, 1.0 - mu - nu, step, -lag), False)
        before, last, theta = last, theta, before
        t_before, t_last = t_last, mu * t_last + nu * t_before + step - lag
    parts.gather(start, last, back)
    return gained
