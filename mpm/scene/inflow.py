"""Inflow of a config: the column of all that will ever come in, layer behind layer, and its Stream (mpm.inflow)."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpm.config.rules_inflow import ways
from mpm.heat.programmes import Parts, Sine, Table, at, changes, during, integral, spell, turns
from mpm.inflow import Inflow, Stream
from mpm.integrate.nozzle import Nozzle
from mpm.scene.base import Shape
from mpm.scene.contents import by_nodes
from mpm.scene.exchange import programme
from mpm.scene.outline import outline_of
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import Box, Cylinder, cells, shape

EVEN = 1e-9  # of a layer


@dataclass(frozen=True)
class Column:
    """Of one body: direction and sign of the flow, the mouth's coordinate [m], the nozzle's length, the whole column's, and its speed over time."""

    axis: int
    sign: float
    mouth: float
    nozzle: float
    length: float
    speed: Any
    outline: Shape  # of the whole column


def times(one, factor: float):
    """A programme's values by a factor."""
    if isinstance(one, Table):
        return Table(one.theta, factor * one.c, factor * one.h)
    if isinstance(one, Sine):
        return one._replace(mean=factor * one.mean, amplitude=factor * one.amplitude)
    return Parts(one.jumps, tuple(times(part, factor) for part in one.parts)) if isinstance(one, Parts) else factor * one


def column(experiment, name: str) -> Column:
    """The column of a body that flows in. SceneError where nothing comes in within the run."""
    body, grid = experiment.bodies[name], experiment.grid
    flow, nozzle = body.inflow, shape(body.shape, grid.dimension).moved(np.array(experiment.method.offset) * grid.cell)
    ((axis, sign),) = ways(experiment, body)
    lower, upper = nozzle.bounds()
    long = float(upper[axis] - lower[axis])
    if flow.velocity is not None:
        speed = times(programme(flow.velocity[axis]), sign)
    else:
        speed = times(programme(flow.rate), 1.0 / area(body.shape, grid.dimension, axis))
    end = experiment.time.end
    speed = spell(speed, getattr(flow, "from"), min(flow.until or math.inf, 2.0 * end))
    goes = integral(speed, 0.0, end)
    more = integral(speed, end, 2.0 * end)  # what is still behind the mouth at the end of the run
    if not goes > 0.0:
        raise SceneError(("bodies", name, "inflow"), f"nothing flows in before the run ends at {end:g} s: begin earlier, or end the run later")
    length = goes + min(long, more)
    low, high = np.array(lower, float), np.array(upper, float)
    mouth = float(high[axis] if sign > 0 else low[axis])
    (low if sign > 0 else high)[axis] = mouth - sign * length
    if isinstance(nozzle, Cylinder):
        return Column(axis, sign, mouth, long, length, speed, Cylinder(nozzle.radius, length, (*nozzle.base[:-1], float(low[axis]))))
    return Column(axis, sign, mouth, long, length, speed, Box(tuple(low.tolist()), tuple(high.tolist())))


def area(model, dimension, axis: int) -> float:
    """Of the mouth of a nozzle, whole [m2]."""
    if model.kind == "cylinder":
        return math.pi * model.radius**2
    if dimension == "axisymmetric":
        return math.pi * (model.upper[0] ** 2 - model.lower[0] ** 2)
    return math.prod(high - low for k, (low, high) in enumerate(zip(model.lower, model.upper, strict=True)) if k != axis)


def layers(found: Column, edge: float) -> tuple[int, float]:
    """How many layers of about `edge` a column has, and how thick they are [m]."""
    K = max(1, round(found.length / edge))
    return K, found.length / K


def sample_column(experiment, name: str, most: float = math.inf):
    """As mpm.scene.build.sample, of the whole column: particles in the order of their layers."""
    found, grid, method = column(experiment, name), experiment.grid, experiment.method
    lower, upper = found.outline.bounds()
    edge = grid.cell / method.particles
    edge *= max(1, math.ceil((math.prod((upper - lower) / edge) / most) ** (1 / len(lower))))
    edges = [np.arange(math.floor(low / edge + 1e-9), math.ceil(high / edge - 1e-9) + 1) * edge for low, high in zip(lower, upper, strict=True)]
    K, _ = layers(found, edge)
    edges[found.axis] = np.linspace(lower[found.axis], upper[found.axis], K + 1)
    radial = grid.dimension == "axisymmetric"
    cut = by_nodes(cells(found.outline, edges, radial), grid.cell)
    order = np.argsort(layer_of(found, K, cut.centroid), kind="stable")
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    cut = replace(cut, volume=cut.volume[order], centroid=cut.centroid[order], cell=cut.cell[order], owner=back[cut.owner])
    return cut, edges, outline_of(found.outline, cut, edges, radial)


def layer_of(found: Column, K: int, x: np.ndarray) -> np.ndarray:
    """Number of the layer that each place is in (N,), from the mouth on."""
    return np.clip(np.floor(found.sign * (found.mouth - x[:, found.axis]) / found.length * K).astype(int), 0, K - 1)


def by_owner(cut):
    """The cut cells with their pieces in the order of their particles, so that the pieces of the first layers are the first."""
    order = np.argsort(cut.owner, kind="stable")
    return replace(cut, **{key: getattr(cut, key)[order] for key in ("owner", "area", "point", "normal", "side")})


def nozzle(experiment, name: str, x: np.ndarray) -> Nozzle:
    """The particles of a column at x (N, D) [m] in their nozzle."""
    found = column(experiment, name)
    way = np.zeros(x.shape[1])
    way[found.axis] = found.sign
    behind = found.sign * (found.mouth - x[:, found.axis])
    return Nozzle(behind, x + behind[:, None] * way, way, np.array([at(during(found.speed, 0.0), 0.0)]))


def warmth(experiment, name: str, x: np.ndarray) -> np.ndarray:
    """Temperatures of a column's particles (N,) [K]: as they are when they pass the mouth."""
    body, found = experiment.bodies[name], column(experiment, name)
    if body.inflow.temperature is None:
        return np.full(len(x), body.temperature)
    given, end = programme(body.inflow.temperature), experiment.time.end
    if not changes(given):
        return np.full(len(x), given)
    when = np.linspace(0.0, 2.0 * end, 20001)
    gone = np.array([integral(found.speed, 0.0, t) for t in when])
    passes = np.interp(found.sign * (found.mouth - x[:, found.axis]), gone, when)
    return np.array([at(during(given, t), t) for t in passes])


def inflow(experiment, bodies) -> Inflow | None:
    """The streams of a scene; None where nothing flows in."""
    streams = []
    for b, (name, config) in enumerate(experiment.bodies.items()):
        if config.inflow is None:
            continue
        found, source, surface = column(experiment, name), bodies[b].source, bodies[b].surface
        K, thick = layers(found, experiment.grid.cell / experiment.method.particles)
        number = np.clip(np.floor(source.behind / thick).astype(int), 0, K - 1)
        particles = np.searchsorted(number, np.arange(K + 1))
        owner = getattr(surface, "owner", np.zeros(0, int))
        zero = next(iter(experiment.bodies.values())).temperature
        inside = max(1, math.floor(found.nozzle / thick + EVEN))
        streams.append(Stream(b, found.speed, thick, inside, particles, np.searchsorted(owner, particles), config.temperature - zero))
    return Inflow(tuple(streams)) if streams else None


def moments(experiment) -> tuple[float, ...]:
    """Times at which a flow begins, ends or jumps [s]."""
    return tuple(sorted({when for name, body in experiment.bodies.items() if body.inflow is not None for when in turns(column(experiment, name).speed)}))
