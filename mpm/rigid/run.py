"""Solve the heat equation in rigid bodies: choose a method, run each body, put the pieces together."""

import time
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mpm.materials.laws import Constant
from mpm.materials.roles import enthalpy, value
from mpm.outcome import COMPLETED, MAX_PRINCIPLE, Outcome, outcome
from mpm.rigid.bounded import BoundedSteps
from mpm.rigid.chebyshev import ChebyshevSteps
from mpm.rigid.geometry import evaluated
from mpm.rigid.linear import LinearSteps
from mpm.rigid.newton import NewtonSteps
from mpm.rigid.nodes import interpolate
from mpm.rigid.system import RigidBody, System, law, make_system
from mpm.rigid.time_loop import Trace, Watch, drive

STEPS, FACTORS, LINEAR = 150, 500, 20  # of a run at the default tolerance: explicit steps, factorisations of Newton and of constant laws
LARGE, LESS = 2e10, 5e8  # multiply-adds of one factorisation that nobody waits for (3 s), and above which conjugate gradients are quicker, unless STIFF
STIFF, SOLUTIONS, TURNS = 100.0, 150, (6, 200)  # beta h/kappa; solutions a run, iterations each below and above STIFF


@dataclass(frozen=True)
class Method:
    """`kind` auto, implicit, explicit or bounded; implicit: order 4 or 2, tolerance (relative error a step); `step` [s] fixes the size of implicit steps."""

    kind: str = "auto"
    order: int = 4
    tolerance: float = 1e-4
    step: float | None = None


@dataclass
class RigidRun:
    """What came out. `series` holds an array over `times` for each name; `crossings` maps (probe, temperature) to a time, nan where never reached."""

    outcome: Outcome
    times: np.ndarray
    series: dict[str, np.ndarray]
    crossings: dict[tuple[str, float], float]
    steps: int
    rejected: int
    unknowns: int
    wall_time: float
    facts: dict
    limits: dict[str, float]
    snapshots: np.ndarray = field(repr=False)
    bodies: list[tuple[System, Any, tuple]] = field(repr=False)
    spent: float = 0.0  # wall time before the run was cut [s]

    def sample(self, x: np.ndarray, body: int | None = None) -> np.ndarray:
        """Temperature [K] at points x (P, d) at the last time; nan outside every body, unless one is named: then its splines go on."""
        x = np.atleast_2d(np.asarray(x, dtype=float))
        out = np.full(len(x), np.nan)
        for k, (system, method, shape_state) in enumerate(self.bodies):
            shape, state = shape_state
            here = np.ones(len(x), dtype=bool) if body == k else (shape.distance(x) <= 1e-9 * system.geometry.nodes.h) & (body is None)
            out[here] = system.zero + interpolate(*evaluated(system.geometry.nodes, x[here]), method.temperature(state))
        return out

    def points(self, body: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Quadrature points (Q, d) and weights (Q,) of a body, for norms of an error."""
        geometry = self.bodies[body][0].geometry
        return geometry.x, geometry.w


NOTICEABLE, CORNERS, MOST = 0.005, 0.05, 0.5  # of the range of the data: told; an automatic method is changed for `bounded` (see `ways`); the run fails
ADVICE = "`method.rigid: bounded`, or a shorter `time.step`; below absolute zero: a given flux takes more heat than there is"
EVALUATION, PIVOT = 4e-10, 1.5e-10  # s a node and stencil entry (with its share of look-ups), s a multiply-add of the factorisation: measured


def iterates(system: System) -> bool:
    """Whether constant laws are solved by conjugate gradients rather than by a factorisation."""
    nodes = system.geometry.nodes
    return float(nodes.size) * float(nodes.diff[-1]) ** 2 > (LARGE if system.stiff > STIFF else LESS)


def _costs(system: System, linear: bool, explicit: ChebyshevSteps | None, end: float) -> tuple[float, float]:
    """Seconds that a run would take: (explicit, implicit)."""
    diff, nodes = system.geometry.nodes.diff, float(system.geometry.nodes.size)
    band = float(diff[-1]) + 1
    evaluations = 0.0 if explicit is None else STEPS * np.sqrt(1 + 1.54 * explicit.radius * end / STEPS)
    if linear and iterates(system):
        return evaluations * nodes * (2 * len(diff) + 20) * EVALUATION, SOLUTIONS * TURNS[system.stiff > STIFF] * nodes * 4 * len(diff) * EVALUATION
    return evaluations * nodes * (2 * len(diff) + 20) * EVALUATION, (LINEAR if linear else FACTORS) * nodes * band * (band + 40) * PIVOT


def choose(system: System, method: Method, end: float):
    """The method's object for one body. `auto`: implicit where kappa and alpha are constant, else what costs less."""
    if method.kind == "bounded":
        return BoundedSteps(system, method.tolerance)
    linear = isinstance(system.kappa, Constant) and isinstance(system.alpha, Constant) and len(system.hot) == 0
    if linear and method.kind != "explicit":
        return LinearSteps(system, method.tolerance, method.order, iterates(system), checked=method.step is None)
    if method.kind == "implicit":
        return NewtonSteps(system, method.tolerance, method.order)
    explicit = ChebyshevSteps(system, method.tolerance)
    cost, rival = _costs(system, linear, explicit, end)
    return explicit if method.kind == "explicit" or cost < rival else NewtonSteps(system, method.tolerance, method.order)


def ways(body: RigidBody, method: Method) -> list[Method]:
    """What to try, one after the other while temperatures leave their data: `auto` ends with `bounded`, and begins with it where nothing is conducted."""
    if method.kind != "auto":
        return [method]
    last, kappa = Method("bounded", tolerance=1e-3, step=method.step), law(body.kappa)
    return [last] if isinstance(kappa, Constant) and kappa.constant == 0 else [method, last]


def limits(system: System, steps, fixed: bool, last: bool) -> tuple[float, float]:
    """Temperatures less zero that end an attempt: MOST of the range beyond the data and absolute zero; in an attempt that is not the last one CORNERS where
    steps of constant laws are chosen by their error (then only the consistent mass overshoots, at corners in the first moments), else NOTICEABLE.
    """
    share = MOST if last else CORNERS if isinstance(steps, LinearSteps) and not fixed else NOTICEABLE
    slack = max(share * system.span, 1e-9 * system.hottest)
    low, high = (bound - system.zero for bound in system.bounds)
    ground = -system.zero if system.bounds[0] != 0.0 else -np.inf  # data without a unit, from 1 to 0, say nothing of absolute zero
    return max(low - slack, ground), high + slack


def outlook(bodies, space, h, origin=None, end=1.0, method=None) -> dict:
    """What `solve` would do, without doing it: unknowns, methods, limits [s], a guess at seconds, bytes of the matrices."""
    method, axisymmetric = method or Method(), space == "axisymmetric"
    dimension = 2 if axisymmetric else int(space)
    origin = np.zeros(dimension) if origin is None else np.broadcast_to(np.asarray(origin, dtype=float), dimension)
    found = {"unknowns": 0, "methods": [], "limits": {}, "seconds": 0.0, "memory_bytes": 0}
    for body in bodies:
        way = ways(body, method)[0]
        system = make_system(body, axisymmetric, h, origin, float(end), way.kind == "bounded")
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


def solve(bodies, space, h, origin=None, end=1.0, times=(), probes=None, thresholds=(), method=None, stop=None, reference=None, snapshots=None, keeper=None):
    """Heat in rigid bodies from 0 to `end` [s]: a RigidRun.

    bodies      RigidBody each; they do not touch, and each has its own nodes
    space       1, 2, "axisymmetric" or 3;  h: cell [m];  origin: place of node 0 (default zero): shift it to shift the grid against the bodies
    times       output times [s], any; probes {name: x}, thresholds [(probe name, temperature [K])]
    method      Method; stop(fraction, time) -> True ends the run with outcome `budget`
    snapshots   (times (S,), points (P, d)): temperatures there in `RigidRun.snapshots`, nan outside the bodies
    reference   temperature at which heat content counts as zero [K]; the first body's start unless given
    keeper      mpm.memory: the run goes on where it was cut, with the same bits
    Heat is in J (per m2 in 1-D, per m in 2-D, per radian axisymmetric; mpm.runner makes the latter whole).
    """
    start = time.perf_counter()
    before = (keeper.found if keeper is not None else None) or {"done": [], "drive": None, "again": 0, "spent": 0.0}
    method, probes, thresholds = method or Method(), probes or {}, list(thresholds)
    axisymmetric = space == "axisymmetric"
    dimension = 2 if axisymmetric else int(space)
    origin = np.zeros(dimension) if origin is None else np.broadcast_to(np.asarray(origin, dtype=float), dimension)
    reference = bodies[0].temperature if reference is None else reference
    times = np.asarray(times, dtype=float)
    places = np.array([np.atleast_1d(x) for x in probes.values()], dtype=float).reshape(-1, dimension)
    owner = np.argmin([body.shape.distance(places) for body in bodies], axis=0) if len(places) else np.zeros(0, dtype=int)
    names, parts, run_bodies = list(probes), [], []
    shot_times, points = (np.asarray(a, dtype=float) for a in snapshots or (np.zeros(0), np.zeros((0, dimension))))
    seen = np.full((len(shot_times), len(points)), np.nan)
    for k, body in enumerate(bodies):
        mine = np.flatnonzero(owner == k)
        here = np.flatnonzero(body.shape.distance(points) <= 1e-9 * h)
        beat = None if stop is None else (lambda part, t, k=k: stop((k + part) / len(bodies), t))
        done = Trace.recalled(before["done"][k]) if k < len(before["done"]) else None
        cut = before["drive"] if k == len(before["done"]) else None
        tries = ways(body, method)
        for again in range(done.again if done is not None else before["again"] if cut is not None else 0, len(tries)):
            way, last = tries[again], again == len(tries) - 1
            system = make_system(body, axisymmetric, h, origin, float(end), way.kind == "bounded")
            steps = choose(system, way, float(end))
            levels = [(int(np.flatnonzero(mine == names.index(name))[0]), level - system.zero) for name, level in thresholds if names.index(name) in mine]
            shots = (shot_times, *evaluated(system.geometry.nodes, points[here]))
            inner = None if keeper is None else Within(keeper, [trace for _, _, trace, _ in parts], again, before["spent"], start)
            reach = limits(system, steps, way.step is not None, last)
            watch = Watch(times, evaluated(system.geometry.nodes, places[mine]), levels, system.geometry.sight, shots, beat, inner, reach)
            trace = done or drive(steps, watch, float(end), system.geometry.volume, way.step, cut)
            trace.again, cut = again, None
            if trace.code != MAX_PRINCIPLE:
                break
        parts.append((system, steps, trace, mine))
        seen[: len(trace.shots), here] = system.zero + np.array(trace.shots).reshape(len(trace.shots), len(here))
        run_bodies.append((system, steps, (body.shape, trace.final)))
        if trace.code != COMPLETED:
            break
    run = _gather(parts, run_bodies, seen, times, names, thresholds, reference, start)
    run.spent = before["spent"]
    return run


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


def _content(system: System, reference: float) -> float:
    """Heat of the body at `zero` above that at `reference` [J]."""
    return system.density * float(system.geometry.volume.sum()) * (enthalpy(system.alpha, system.zero) - enthalpy(system.alpha, reference))


def beyond(system: System, trace: Trace) -> float:
    """How far a body's temperatures leave the bounds of their data, as a share of the range."""
    low, high = system.bounds
    worst = max(system.zero + max(trace.most, default=-np.inf) - high, low - system.zero - min(trace.least, default=np.inf), 0.0)
    return float(worst / system.span) if worst > 1e-9 * system.hottest else 0.0


def _gather(parts, run_bodies, snapshots, times, names, thresholds, reference, start) -> RigidRun:
    shown = min(len(trace.heat) for _, _, trace, _ in parts)
    series = {name: np.full(shown, np.nan) for name in (f"temperature.{n}" for n in names)}
    if taken := {"temperature.mean", "temperature.min", "temperature.max"}.intersection(series):
        raise ValueError(f"a probe has the name of a result: {', '.join(taken)}")
    series |= {name: np.zeros(shown) for name in ("temperature.mean", "heat", "heat_exchanged", "heat_ledger")}
    least, most, capacity, crossings = [], [], 0.0, {}
    for system, steps, trace, mine in parts:
        seen = np.array(trace.probes).reshape(len(trace.heat), len(mine))[:shown] + system.zero
        for column, k in enumerate(mine):
            series[f"temperature.{names[k]}"] = seen[:, column]
        begin = steps.heat(steps.first)
        heat, exchanged = np.array(trace.heat)[:shown], np.array(trace.exchanged)[:shown]
        series["heat"] += heat + _content(system, reference)
        series["heat_exchanged"] += exchanged
        series["heat_ledger"] += (heat - begin) - exchanged
        share = system.density * float(system.geometry.volume.sum()) * value(system.alpha, system.start)
        series["temperature.mean"] += share * (np.array(trace.mean)[:shown] + system.zero)
        capacity += share
        least.append(np.array(trace.least)[:shown] + system.zero)
        most.append(np.array(trace.most)[:shown] + system.zero)
        crossings |= {(name, level): t for (name, level), t in zip([x for x in thresholds if names.index(x[0]) in mine], trace.crossings, strict=True)}
    series["temperature.mean"] /= capacity
    series["temperature.min"], series["temperature.max"] = np.min(least, axis=0), np.max(most, axis=0)
    worst = next((trace for _, _, trace, _ in parts if trace.code != COMPLETED), parts[-1][2])
    steps, rejected = sum(p[2].steps for p in parts), sum(p[2].rejected for p in parts)
    facts = {
        "heat_method": sorted({type(p[1]).__name__ for p in parts}),
        "heat_steps": steps,
        "heat_steps_rejected": rejected,
        "smallest_step": min(p[2].smallest for p in parts),
        "largest_step": max(p[2].largest for p in parts),
        "beta_h_over_kappa": max(p[0].stiff for p in parts),
        "beyond": [beyond(system, trace) for system, _, trace, _ in parts],
    }
    limits = {"euler": min(2 / p[1].radius for p in parts if p[1].radius > 0)} if any(p[1].radius > 0 for p in parts) else {}
    unknowns = sum(int(p[0].geometry.active.sum()) for p in parts)
    failed = worst.code != COMPLETED
    result = outcome(worst.code, time=worst.time if failed else None, step=worst.steps if failed else -1, detail=worst.found)
    if worst.code == MAX_PRINCIPLE:
        result = replace(result, advice=ADVICE)
    return RigidRun(result, times[:shown], series, crossings, steps, rejected, unknowns, time.perf_counter() - start, facts, limits, snapshots, run_bodies)
