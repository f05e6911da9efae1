"""Solve the heat equation in rigid bodies: choose a method, run each body, put the pieces together."""

import functools
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpm.heat.programmes import SAME
from mpm.materials.laws import Constant
from mpm.outcome import COMPLETED, MAX_PRINCIPLE
from mpm.rigid.bounded import BoundedSteps
from mpm.rigid.chebyshev import ChebyshevSteps
from mpm.rigid.gather import Part, Seat, beyond, gather
from mpm.rigid.group import Group, groups, make_group
from mpm.rigid.joined import JoinedLinear, JoinedNewton
from mpm.rigid.linear import LinearSteps
from mpm.rigid.newton import NewtonSteps
from mpm.rigid.system import RigidBody, System, law, make_system
from mpm.rigid.time_loop import Shares, Trace, Watch, Whole, drive

STEPS, FACTORS, LINEAR = 150, 500, 20  # of a run at the default tolerance: explicit steps, factorisations of Newton and of constant laws
LARGE, LESS = 2e10, 5e8  # multiply-adds of one factorisation that nobody waits for (3 s), and above which conjugate gradients are quicker, unless STIFF
SEVERAL = 4e9  # the latter for bodies that conduct into one another, whose iterations cost more
STIFF, SOLUTIONS, TURNS = 100.0, 150, (6, 200)  # beta h/kappa; solutions a run, iterations each below and above STIFF


@dataclass(frozen=True)
class Method:
    """`kind` auto, implicit, explicit or bounded; implicit: order 4 or 2, tolerance (relative error a step); `step` [s] fixes the size of implicit steps."""

    kind: str = "auto"
    order: int = 4
    tolerance: float = 1e-4
    step: float | None = None


NOTICEABLE, CORNERS, REFUSED = 0.005, 0.05, 0.5  # of the range of the data: told; an automatic method is changed for `bounded` (see `ways`); the run fails
EVALUATION, PIVOT = 4e-10, 1.5e-10  # s a node and stencil entry (with its share of look-ups), s a multiply-add of the factorisation: measured


def iterates(system: System) -> bool:
    """Whether constant laws are solved by conjugate gradients rather than by a factorisation."""
    nodes = system.geometry.nodes
    return float(nodes.size) * float(nodes.diff[-1]) ** 2 > (LARGE if system.stiff > STIFF else SEVERAL if isinstance(system, Group) else LESS)


def _costs(system: System, linear: bool, explicit: ChebyshevSteps | None, end: float) -> tuple[float, float]:
    """Seconds that a run would take: (explicit, implicit)."""
    diff, nodes = system.geometry.nodes.diff, float(system.geometry.nodes.size)
    band = float(diff[-1]) + 1
    evaluations = 0.0 if explicit is None else STEPS * np.sqrt(1 + 1.54 * explicit.radius * end / STEPS)
    if linear and iterates(system):
        return evaluations * nodes * (2 * len(diff) + 20) * EVALUATION, SOLUTIONS * TURNS[system.stiff > STIFF] * nodes * 4 * len(diff) * EVALUATION
    return evaluations * nodes * (2 * len(diff) + 20) * EVALUATION, (LINEAR if linear else FACTORS) * nodes * band * (band + 40) * PIVOT


def is_linear(system: System) -> bool:
    """Whether nothing that a body does depends on its temperature but in proportion."""
    parts = system.parts if isinstance(system, Group) else (system,)
    return all(isinstance(one.kappa, Constant) and isinstance(one.alpha, Constant) and len(one.hot) == 0 for one in parts)


def choose(system: System, method: Method, end: float):
    """The method's object for one body. `auto`: implicit where kappa and alpha are constant, else what costs less."""
    if method.kind == "bounded":
        return BoundedSteps(system, method.tolerance)
    linear = is_linear(system)
    if isinstance(system, Group):
        checked = method.step is None
        return JoinedLinear(system, method.tolerance, method.order, iterates(system), checked) if linear else JoinedNewton(system, method.tolerance, 2)
    if linear and method.kind != "explicit":
        return LinearSteps(system, method.tolerance, method.order, iterates(system), checked=method.step is None)
    if method.kind == "implicit":
        return NewtonSteps(system, method.tolerance, method.order)
    explicit = ChebyshevSteps(system, method.tolerance)
    cost, rival = _costs(system, linear, explicit, end)
    return explicit if method.kind == "explicit" or cost < rival else NewtonSteps(system, method.tolerance, method.order)


def ways(bodies: list[RigidBody], method: Method) -> list[Method]:
    """What to try, one after the other while temperatures leave their data: `auto` ends with `bounded`, and begins with it where nothing is conducted.

    Bodies that conduct into one another take implicit steps on splines.
    """
    if len(bodies) > 1 and method.kind in ("explicit", "bounded"):
        raise ValueError(f"bodies that conduct into one another take implicit steps, not {method.kind} ones")
    if method.kind != "auto" or len(bodies) > 1:
        return [method]
    last, kappa = Method("bounded", tolerance=1e-3, step=method.step), law(bodies[0].kappa)
    return [last] if isinstance(kappa, Constant) and kappa.constant == 0 else [method, last]


def share(steps, fixed: bool) -> float:
    """Of the range, beyond the data, that an attempt may come to where there is another: CORNERS where steps of constant laws are chosen by their error
    (then only the consistent mass overshoots, at corners in the first moments), else NOTICEABLE.
    """
    return CORNERS if isinstance(steps, LinearSteps) and not fixed else NOTICEABLE


def limits(system: System, steps, fixed: bool, last: bool) -> tuple[float, float]:
    """Temperatures less zero that end an attempt: REFUSED of the range beyond the data and absolute zero; `share` of it in one that is not the last."""
    slack = max((REFUSED if last else share(steps, fixed)) * system.span, 1e-9 * system.hottest)
    low, high = (bound - system.zero for bound in system.bounds)
    ground = -system.zero if system.bounds[0] != 0.0 else -np.inf  # data without a unit, from 1 to 0, say nothing of absolute zero
    return max(low - slack, ground), high + slack


def outlook(bodies, space, h, origin=None, end=1.0, method=None, joints=()) -> dict:
    """What `solve` would do, without doing it: unknowns, methods, limits [s], a guess at seconds, bytes of the matrices."""
    method, axisymmetric = method or Method(), space == "axisymmetric"
    dimension = 2 if axisymmetric else int(space)
    origin = np.zeros(dimension) if origin is None else np.broadcast_to(np.asarray(origin, dtype=float), dimension)
    found = {"unknowns": 0, "methods": [], "limits": {}, "seconds": 0.0, "memory_bytes": 0}
    for members in groups(len(bodies), joints):
        way = ways([bodies[b] for b in members], method)[0]
        system, _ = system_of(bodies, members, joints, axisymmetric, h, origin, float(end), way.kind == "bounded")
        steps = choose(system, way, float(end))
        explicit = isinstance(steps, ChebyshevSteps)
        linear = isinstance(steps, LinearSteps)
        shaped = system.geometry
        found["unknowns"] += int(shaped.active.sum())
        found["methods"].append(type(steps).__name__)
        found["seconds"] += _costs(system, linear, steps if explicit else None, float(end))[0 if explicit else 1]
        extra = 2 * shaped.mass.size if linear and iterates(system) else shaped.nodes.size * shaped.nodes.diff[-1]
        found["memory_bytes"] += 8 * int(shaped.mass.size * (5 + len(shaped.exchange)) + (0 if explicit else extra))
        if explicit and steps.radius > 0:
            found["limits"]["euler"] = min(found["limits"].get("euler", np.inf), 2 / steps.radius)
    return found


def solve(
    bodies, space, h, origin=None, end=1.0, times=(), probes=None, thresholds=(), method=None, stop=None, reference=None, snapshots=None, keeper=None, joints=()
):
    """Heat in rigid bodies from 0 to `end` [s]: a RigidRun.

    bodies      RigidBody each, on nodes of its own
    space       1, 2, "axisymmetric" or 3;  h: cell [m];  origin: place of node 0 (default zero): shift it to shift the grid against the bodies
    times       output times [s], any; probes {name: x}, thresholds [(probe name, temperature [K])]
    method      Method; stop(fraction, time) -> True ends the run with outcome `budget`
    snapshots   (times (S,), points (P, d)): temperatures there in `RigidRun.snapshots`, nan outside the bodies
    reference   temperature at which heat content counts as zero [K]; each body's start unless given
    keeper      mpm.memory: the run goes on where it was cut, with the same bits
    joints      mpm.rigid.group.Joint of every pair that touches; those that conduct are solved together
    Heat is in J (per m2 in 1-D, per m in 2-D, per radian axisymmetric; mpm.runner makes the latter whole).
    """
    start = time.perf_counter()
    before = (keeper.found if keeper is not None else None) or {"done": [], "drive": None, "again": 0, "spent": 0.0}
    method, probes, thresholds = method or Method(), probes or {}, list(thresholds)
    axisymmetric = space == "axisymmetric"
    dimension = 2 if axisymmetric else int(space)
    origin = np.zeros(dimension) if origin is None else np.broadcast_to(np.asarray(origin, dtype=float), dimension)
    times = np.asarray(times, dtype=float)
    places = np.array([np.atleast_1d(x) for x in probes.values()], dtype=float).reshape(-1, dimension)
    owner = np.argmin([body.shape.distance(places) for body in bodies], axis=0) if len(places) else np.zeros(0, dtype=int)
    names, parts = list(probes), []
    shot_times, points = (np.asarray(a, dtype=float) for a in snapshots or (np.zeros(0), np.zeros((0, dimension))))
    seen, inside = np.full((len(shot_times), len(points)), np.nan), [body.shape.distance(points) <= 1e-9 * h for body in bodies]
    plan = groups(len(bodies), joints)
    for k, members in enumerate(plan):
        beat = None if stop is None else (lambda part, t, k=k: stop((k + part) / len(plan), t))
        done = Trace.recalled(before["done"][k]) if k < len(before["done"]) else None
        cut = before["drive"] if k == len(before["done"]) else None
        tries = ways([bodies[b] for b in members], method)
        for again in range(done.again if done is not None else before["again"] if cut is not None else 0, len(tries)):
            way, last = tries[again], again == len(tries) - 1
            jumps = turns_of(bodies, members, joints, float(end))
            make = functools.partial(system_of, bodies, members, joints, axisymmetric, h, origin, float(end), way.kind == "bounded")
            system, seats = make()
            steps = choose(system, way, float(end))
            mine, levels, rows = [], [], []
            for b, seat in zip(members, seats, strict=True):
                mine += (here := np.flatnonzero(owner == b)).tolist()
                rows.append(seat.at(places[here]))
            levels = [(mine.index(names.index(name)), level - system.zero) for name, level in thresholds if names.index(name) in mine]
            shots = (shot_times, *joined(seat.at(points[inside[b]]) for b, seat in zip(members, seats, strict=True)))
            inner = None if keeper is None else Within(keeper, [part.trace for part in parts], again, before["spent"], start)
            reach = limits(system, steps, way.step is not None, last)
            told = Whole() if len(members) == 1 else shares(system)
            enter = functools.partial(entered, make, way, (0.0, *jumps), float(end))
            watch = Watch(times, joined(rows), levels, system.geometry.sight, shots, beat, inner, reach, told, jumps, enter)
            trace = done or drive(steps, watch, float(end), system.geometry.volume, way.step, cut)
            trace.again, cut = again, None
            part = Part(members, seats, system, steps, trace, np.array(mine, dtype=int))
            if trace.code != MAX_PRINCIPLE and (last or trace.code != COMPLETED or max(beyond(part)) <= share(steps, way.step is not None)):
                break
        parts.append(part)
        at = np.concatenate([np.flatnonzero(inside[b]) for b in members])
        seen[: len(trace.shots), at] = system.zero + np.array(trace.shots).reshape(len(trace.shots), len(at))
        if trace.code != COMPLETED:
            break
    run = gather(parts, len(bodies), seen, times, names, thresholds, reference, start)
    run.spent = before["spent"]
    return run


def joined(rows) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and values of points, one after another."""
    index, value = zip(*rows, strict=True)
    return np.concatenate(index), np.concatenate(value)


def shares(system: Group) -> Shares:
    """What is told of each body of a group."""
    return Shares(system.sums, np.cumsum([0, *(len(part.geometry.sight[0]) for part in system.parts[:-1])]))


def turns_of(bodies, members, joints, end: float) -> tuple[float, ...]:
    """Times within the run at which something about these bodies jumps [s]."""
    every = {when for b in members for when in bodies[b].turns}
    every |= {when for j in joints if {j.first, j.second} & {*members} for when in (j.begin, j.end)}
    return tuple(sorted(when for when in every if 0 < when < end * (1 - SAME)))


def entered(make, way: Method, moments, end: float, turn: int, before):
    """The method from a turn on, with what `before` had reached."""
    steps = choose(make(moment=moments[turn])[0], way, end)
    for name in ("state", "q", "now"):
        setattr(steps, name, getattr(before, name))
    if isinstance(steps, ChebyshevSteps):
        steps.restart()
    return steps


def system_of(bodies, members, joints, axisymmetric: bool, h: float, origin, end: float, hats: bool = False, moment: float = 0.0) -> tuple[System, list[Seat]]:
    """The equations from a moment on of one body, or of a group that conduct into one another, and where each body's unknowns are."""
    touching = [j for j in joints if j.acts(moment)]
    beside = {b: tuple(bodies[j.second if j.first == b else j.first].shape for j in touching if b in (j.first, j.second)) for b in members}
    if len(members) == 1:
        (b,) = members
        system = make_system(bodies[b], axisymmetric, h, origin, end, hats, beside[b], moment)
        return system, [Seat(bodies[b].shape, system.geometry)]
    within = [replace(j, first=members.index(j.first), second=members.index(j.second)) for j in joints if j.first in members and j.second in members]
    system = make_group([bodies[b] for b in members], [beside[b] for b in members], within, axisymmetric, h, origin, end, moment)
    seats = [Seat(bodies[b].shape, part.geometry, into) for b, part, into in zip(members, system.parts, system.into, strict=True)]
    return system, seats


@dataclass(frozen=True)
class Within:
    """The keeper of one body's steps: with them it keeps the bodies that are done."""

    keeper: Any
    done: list[Trace]
    again: int
    spent: float
    start: float

    def due(self, stop: bool) -> bool:
        return self.keeper.due(stop)

    def save(self, memory: dict) -> None:
        spent = self.spent + time.perf_counter() - self.start
        self.keeper.save({"done": [trace.memory() for trace in self.done], "drive": memory, "again": self.again, "spent": spent})
