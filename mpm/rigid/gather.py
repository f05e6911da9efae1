"""What came out of rigid bodies: the traces of all groups put together, of every body and of all."""

import time
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mpm.materials.roles import enthalpy, value
from mpm.outcome import COMPLETED, MAX_PRINCIPLE, Outcome, outcome
from mpm.rigid.geometry import Geometry, evaluated
from mpm.rigid.nodes import interpolate
from mpm.rigid.system import System
from mpm.rigid.time_loop import Trace

ADVICE = "`method.rigid: bounded`, or a shorter `time.step`; below absolute zero: a given flux takes more heat than there is"


@dataclass(frozen=True)
class Seat:
    """Where a body's unknowns are: those of its own nodes, or `into` the nodes of its group."""

    shape: Any
    geometry: Geometry
    into: np.ndarray | None = None

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns and values of the splines at points x (P, d)."""
        index, spline = evaluated(self.geometry.nodes, x)
        return (index if self.into is None else self.into[index]), spline


@dataclass
class Part:
    """One group as it was run: bodies by number, their seats, what happened."""

    members: list[int]
    seats: list[Seat]
    system: System
    method: Any
    trace: Trace
    mine: np.ndarray  # numbers of the probes

    def systems(self) -> tuple[System, ...]:
        return getattr(self.system, "parts", (self.system,))


@dataclass
class RigidRun:
    """What came out. `series` holds an array over `times` for each name, `of` the same of each body (temperature.mean, .min, .max, heat, heat_exchanged),
    `passed` the heat that went from the first to the second of each pair that conducts [J]; `crossings` maps (probe, temperature) to a time, nan where never.
    """

    outcome: Outcome
    times: np.ndarray
    series: dict[str, np.ndarray]
    of: list[dict[str, np.ndarray]]
    passed: dict[tuple[int, int], np.ndarray]
    crossings: dict[tuple[str, float], float]
    steps: int
    rejected: int
    unknowns: int
    wall_time: float
    facts: dict
    limits: dict[str, float]
    snapshots: np.ndarray = field(repr=False)
    bodies: list[tuple[System, Any, np.ndarray, Seat] | None] = field(repr=False)  # None of those that an earlier one's end has kept from running
    spent: float = 0.0  # wall time before the run was cut [s]

    def sample(self, x: np.ndarray, body: int | None = None) -> np.ndarray:
        """Temperature [K] at points x (P, d) at the last time; nan outside every body, unless one is named: then its splines go on."""
        x = np.atleast_2d(np.asarray(x, dtype=float))
        out = np.full(len(x), np.nan)
        for k, ran in enumerate(self.bodies):
            if ran is None:
                continue
            system, method, state, seat = ran
            here = np.ones(len(x), dtype=bool) if body == k else (seat.shape.distance(x) <= 1e-9 * system.geometry.nodes.h) & (body is None)
            out[here] = system.zero + interpolate(*seat.at(x[here]), method.temperature(state))
        return out

    def points(self, body: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Quadrature points (Q, d) and weights (Q,) of a body, for norms of an error."""
        geometry = self.bodies[body][3].geometry
        return geometry.x, geometry.w


def content(system: System, zero: float, reference: float) -> float:
    """Heat of the body at `zero` above that at `reference` [J]."""
    return system.density * float(system.geometry.volume.sum()) * (enthalpy(system.alpha, zero) - enthalpy(system.alpha, reference))


def beyond(part: Part) -> list[float]:
    """How far each body's temperatures leave the bounds of the data, as a share of the range: beside a flux, which has no bound, of what was reached."""
    system, trace = part.system, part.trace
    (low, high), n = system.bounds, len(part.members)
    most = np.reshape(trace.most, (-1, n)).max(axis=0, initial=-np.inf)
    least = np.reshape(trace.least, (-1, n)).min(axis=0, initial=np.inf)
    worst = np.maximum(np.maximum(system.zero + most - high, low - system.zero - least), 0.0)
    span = system.span if np.isfinite(high - low) else min(system.span, max(float(most.max() - least.min()), 1e-6 * system.hottest))
    return [float(over / span) if over > 1e-9 * system.hottest else 0.0 for over in worst]


def series_of(part: Part, shown: int, reference: float | None) -> tuple[list[dict[str, np.ndarray]], list[np.ndarray]]:
    """Series of each body of a group, and the heat that passed through each of its joints."""
    n, zero = len(part.members), part.system.zero
    joints = getattr(part.system, "joints", ())
    columns = {"mean": n, "least": n, "most": n, "heat": n, "exchanged": n + len(joints)}
    found = {name: np.reshape(getattr(part.trace, name)[:shown], (shown, count)) for name, count in columns.items()}
    begin, each = np.reshape(part.method.heat(part.method.first), -1), []
    passed = [found["exchanged"][:, n + j] for j in range(len(joints))]
    for b, system in enumerate(part.systems()):
        taken, heat = found["exchanged"][:, b], found["heat"][:, b]
        inside = sum(((joint.second == b) * 1.0 - (joint.first == b)) * flow for joint, flow in zip(joints, passed, strict=True))
        each.append({
            "temperature.mean": found["mean"][:, b] + zero, "temperature.min": found["least"][:, b] + zero, "temperature.max": found["most"][:, b] + zero,
            "heat": heat + content(system, zero, system.start if reference is None else reference), "heat_exchanged": taken,
            "heat_ledger": (heat - begin[b]) - (taken + inside),
        })  # fmt: skip
    return each, passed


def gather(parts: list[Part], number: int, snapshots, times, names, thresholds, reference, start) -> RigidRun:
    """One RigidRun of all groups."""
    shown = min(len(part.trace.heat) for part in parts)
    series = {name: np.full(shown, np.nan) for name in (f"temperature.{n}" for n in names)}
    if taken := {"temperature.mean", "temperature.min", "temperature.max"}.intersection(series):
        raise ValueError(f"a probe has the name of a result: {', '.join(taken)}")
    series |= {name: np.zeros(shown) for name in ("temperature.mean", "heat", "heat_exchanged", "heat_ledger")}
    of, passed, bodies, capacity, crossings = [{} for _ in range(number)], {}, [None] * number, 0.0, {}
    for part in parts:
        trace = part.trace
        seen = np.array(trace.probes).reshape(len(trace.heat), len(part.mine))[:shown] + part.system.zero
        for column, k in enumerate(part.mine):
            series[f"temperature.{names[k]}"] = seen[:, column]
        each, flows = series_of(part, shown, reference)
        for member, one, system, seat in zip(part.members, each, part.systems(), part.seats, strict=True):
            of[member], bodies[member] = one, (part.system, part.method, trace.final, seat)
            for name in ("heat", "heat_exchanged", "heat_ledger"):
                series[name] += one[name]
            share = system.density * float(system.geometry.volume.sum()) * value(system.alpha, system.start)
            series["temperature.mean"] += share * one["temperature.mean"]
            capacity += share
        passed |= {(part.members[j.first], part.members[j.second]): flow for j, flow in zip(getattr(part.system, "joints", ()), flows, strict=True)}
        crossings |= {(name, level): t for (name, level), t in zip([x for x in thresholds if names.index(x[0]) in part.mine], trace.crossings, strict=True)}
    series["temperature.mean"] /= capacity
    ran = [one for one in of if one]
    series["temperature.min"] = np.min([one["temperature.min"] for one in ran], axis=0)
    series["temperature.max"] = np.max([one["temperature.max"] for one in ran], axis=0)
    worst = next((part.trace for part in parts if part.trace.code != COMPLETED), parts[-1].trace)
    steps, rejected = sum(p.trace.steps for p in parts), sum(p.trace.rejected for p in parts)
    over = np.zeros(number)
    for part in parts:
        over[part.members] = beyond(part)
    facts = {
        "heat_method": sorted({type(p.method).__name__ for p in parts}),
        "heat_steps": steps,
        "heat_steps_rejected": rejected,
        "smallest_step": min(p.trace.smallest for p in parts),
        "largest_step": max(p.trace.largest for p in parts),
        "beta_h_over_kappa": max(p.system.stiff for p in parts),
        "beyond": over.tolist(),
    }
    limits = {"euler": min(2 / p.method.radius for p in parts if p.method.radius > 0)} if any(p.method.radius > 0 for p in parts) else {}
    unknowns = sum(int(p.system.geometry.active.sum()) for p in parts)
    failed = worst.code != COMPLETED
    result = outcome(worst.code, time=worst.time if failed else None, step=worst.steps if failed else -1, detail=worst.found)
    if worst.code == MAX_PRINCIPLE:
        result = replace(result, advice=ADVICE)
    wall_time = time.perf_counter() - start
    return RigidRun(result, times[:shown], series, of, passed, crossings, steps, rejected, unknowns, wall_time, facts, limits, snapshots, bodies)
