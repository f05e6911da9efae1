"""Observers of a run of moving bodies: series at the output times, probes, crossings, snapshots.

A probe is a point of the material: it moves, turns and stretches with its body (mpm.follow), and is nan once its particle has left the domain.
Crossings (`time_to`) are looked for after every heat step, linear in between.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.diagnostics import (
    capacities,
    exchanging_area,
    grid_shape,
    heat_since,
    kinetic,
    radius_holding,
    stored,
    strains,
    stresses,
    thermal_pressure,
    volume_ratios,
)
from mpm.error import Errors
from mpm.fields import axis_names, cauchy, grid_fields, motion_of, particle_fields
from mpm.follow import moved, nearest, renumbered, sampled
from mpm.heat.setting import conditions
from mpm.memory import Frames, rows
from mpm.outcome import Outcome, Run
from mpm.records.variables import parts
from mpm.state import PAD, Axisymmetric, Setting, Thermal
from mpm.total import reference as moving
from mpm.total.heat import Warmth
from mpm.transfer import Apic


@dataclass
class Watch:
    """What to record. `exact(x (N, D), t) -> theta (N,)`, or the Errors of a motion (mpm.error), where a config names its solution.

    x is where a particle was at the start: a body that flies or turns takes its temperatures along.
    """

    probes: dict[str, np.ndarray] = field(default_factory=dict)
    homes: dict[str, int] = field(default_factory=dict)  # number of the body that a probe is a point of; the nearest unless given
    asked: dict[str, tuple[str, str, str]] = field(default_factory=dict)  # dataset name -> (field, probe, part) beside temperatures
    of: dict[str, tuple[str, int]] = field(default_factory=dict)  # dataset name -> (series, number of the one body that it is told of)
    bites: dict[str, tuple[str, str]] = field(default_factory=dict)  # dataset name -> (what, tool): mpm.contact.texture
    unmet: dict[str, float] = field(default_factory=dict)  # dataset name -> 0, of what walls and bodies do to each other that never meet
    thresholds: list[tuple[str, str, float]] = field(default_factory=list)  # (dataset name, probe, kelvin)
    snapshots: np.ndarray = field(default_factory=lambda: np.zeros(0))  # times [s]; a run comes to them as to its output times
    grid: tuple[str, ...] = ()
    particles: tuple[str, ...] = ()
    exact: Any = None
    shown: Callable[[float, dict, dict], tuple[float, dict, dict]] = lambda *frame: frame  # a snapshot as it leaves the run (mpm.scene.scaling.shown)


def near(times: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which of `times` is one of `others`, but for rounding; both increase."""
    at, apart = np.searchsorted(others, times), np.concatenate([[-np.inf], others, [np.inf]])
    return np.minimum(times - apart[at], apart[at + 1] - times) <= 1e-9 * times


def merged(times: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Both in order; what is in both as it is in `times`."""
    return np.sort(np.concatenate([times, others[~near(others, times)]])) if len(others) else times


def stops(times: np.ndarray, snapshots: np.ndarray) -> list[tuple[float, bool]]:
    """Times that a run comes to, and whether its series are told there."""
    every = merged(times, snapshots)
    return list(zip(every.tolist(), near(every, times).tolist(), strict=True))


class Recorder:
    """Collects a run's records and turns them into a Run."""

    def __init__(self, scene, frames: Frames | None = None):
        self.scene = scene
        warm = {b: body for b, body in enumerate(scene.wholes) if isinstance(body.thermal, Thermal)}
        self.start = {b: body.thermal.theta.astype(float) for b, body in warm.items()}
        if scene.inflow is not None:
            scene.inflow.refer(self.start)
        self.capacities = {b: capacities(body) for b, body in warm.items()}  # (N,) at the start [J/K]
        self.times: list[float] = []
        self.shot = math.nan  # when the last snapshot was taken, on the run's clock
        self.series: dict[str, list[float]] = {}
        self.frames = Frames() if frames is None else frames
        places = [body.particles.x for body in scene.wholes] if not scene.references else [reference.X for reference in scene.references]
        self.begun = [x.astype(float) for x in places] if scene.watch.particles else []  # where particles were at the start
        self.places = {name: self.place(scene, name) for name in scene.watch.probes}
        self.errors = scene.watch.exact if isinstance(scene.watch.exact, Errors) else None
        self.origin = [body.particles.x.astype(float) for body in warm.values()] if scene.watch.exact is not None and self.errors is None else []
        self.crossed = {name: math.nan for name, _, _ in scene.watch.thresholds}
        self.seen = {probe: (0.0, self.probe(probe)) for _, probe, _ in scene.watch.thresholds}

    @property
    def warm(self) -> list:
        """(number, body) of those that have heat."""
        return [(b, self.scene.bodies[b]) for b in self.start]

    @staticmethod
    def place(scene, name: str):
        """(number of the body, the point of it) where a probe is at the start."""
        x, bodies = np.asarray(scene.watch.probes[name], float), scene.bodies
        away = [float(np.min(np.sum((body.particles.x - x) ** 2, axis=1))) for body in bodies]
        home = scene.watch.homes.get(name, int(np.argmin(away)))
        return home, nearest(bodies[home].particles.x.astype(float), x)

    def probe(self, name: str) -> float:
        home, point = self.places[name]
        body = self.scene.bodies[home]
        if not isinstance(body.thermal, Thermal):
            return body.thermal.temperature
        point = renumbered(point, self.scene.order.places(home))
        here, size = body.particles.x[point.owner[0]], np.array(grid_shape(self.scene.space)) - (1 + 2 * PAD)
        if not np.all((here >= -self.scene.space.h) & (here <= (size + 1) * self.scene.space.h)):
            return math.nan
        return float(body.thermal.zero + sampled(point, body.thermal.theta, body.thermal.c)[0])

    def watch(self, scene, now: float) -> None:
        """Look for crossings since the last heat step."""
        for name, probe, kelvin in scene.watch.thresholds:
            before, was = self.seen[probe]
            value = self.probe(probe)
            if math.isnan(self.crossed[name]) and (was - kelvin) * (value - kelvin) <= 0 and value != was:
                self.crossed[name] = before + (now - before) * (kelvin - was) / (value - was)
        self.seen = {probe: (now, self.probe(probe)) for probe in self.seen}

    def record(self, scene, clock) -> None:
        """One line of every series; a frame where one is due."""
        self.times.append(clock.time)
        wrong = (self.errors.series(scene.bodies[0], clock.time) if self.errors else {}) | scene.watch.unmet
        met = scene.meeting.series(axis_names(scene.space), clock.time - clock.lag, clock.time) if scene.meeting is not None else ()
        for name, value in (*self.mechanical(scene, clock), *self.thermal(scene, clock), *self.at_probes(scene), *self.of_bodies(scene), *wrong.items(), *met):
            self.series.setdefault(name, [0.0] * (len(self.times) - 1)).append(float(value))  # what meets something late met nothing before
        self.frame(scene, clock)

    def frame(self, scene, clock) -> None:
        """A snapshot, where one is due."""
        due = scene.watch.snapshots
        for when in due[np.isclose(due, clock.time, rtol=1e-9, atol=1e-12 * scene.times[-1])]:
            self.frames.add(*scene.watch.shown(float(when), grid_fields(scene), particle_fields(scene, self.begun)))
            self.shot = clock.time

    def drop(self) -> None:
        """Take back the last record: what it shows is no good."""
        when = self.times.pop()
        for values in self.series.values():
            values.pop()
        if self.shot == when:
            self.frames.drop()

    def memory(self) -> dict:
        """What was recorded so far (mpm.memory)."""
        return {"times": rows(self.times), "series": {name: rows(values) for name, values in self.series.items()}, "frames": self.frames.memory(),
                "crossed": self.crossed, "seen": {probe: list(pair) for probe, pair in self.seen.items()},
                "sums": self.errors.sums if self.errors is not None else {}}  # fmt: skip

    def recall(self, found: dict) -> None:
        """As it was when `memory` was kept."""
        self.times, self.series = found["times"].tolist(), {name: values.tolist() for name, values in found["series"].items()}
        self.frames.recall(found["frames"])
        self.crossed, self.seen = found["crossed"], {probe: tuple(pair) for probe, pair in found["seen"].items()}
        if self.errors is not None:
            self.errors.sums = found["sums"]

    def mechanical(self, scene, clock):
        """Sums and extrema of motion."""
        yield from motion_of(scene.space, scene.bodies, scene.outlines)
        x, m, J, V = (np.concatenate([getattr(body.particles, name).astype(float) for body in scene.bodies]) for name in ("x", "m", "J", "V0"))
        V = V * J
        if isinstance(scene.space, Axisymmetric):
            for share in (95, 99):
                yield f"radius_{share}", radius_holding(0.01 * share, x[:, 0], V)
        slopes = clock.steps > 0 or bool(getattr(scene.scheme, "affine", isinstance(scene.scheme, Apic)))  # a start's slopes, which others drop at once
        motion = sum(map(moving.kinetic, scene.references)) if scene.references else sum(kinetic(scene.space, body.particles, slopes) for body in scene.bodies)
        elastic, pressure, strain = 0.0, 0.0, 0.0
        for body in scene.bodies:
            e = strains(scene.space, body.particles.B)
            elastic += stored(body.elastic, e, body.particles.V0, conditions(body))
            strain = max(strain, float(np.max(np.abs(e))))
            tau = stresses(body.elastic, e, thermal_pressure(body), conditions(body))
            pressure -= float(np.sum(body.particles.V0 * np.sum(tau, axis=1))) / 3
        yield "pressure_mean", pressure / np.sum(V)
        yield "strain_max", strain
        yield "energy_kinetic", motion
        yield "energy_elastic", elastic
        total = motion + elastic - (np.sum(m[:, None] * x * scene.gravity[0]) if scene.course is None or not scene.course.gravity else 0.0)
        yield "energy_total", total
        yield "dissipation_total", clock.dissipated
        work = clock.worked + (scene.meeting.work if scene.meeting is not None else 0.0)
        yield "work_loads", work
        rubbed = 0.0 if scene.meeting is None else scene.meeting.friction
        yield from () if scene.meeting is None else (("dissipation_friction", rubbed),)
        yield from scene.inflow.series(bool(self.warm)) if scene.inflow is not None else ()
        given = getattr(scene.inflow, "energy", 0.0) + work + clock.swelled + clock.softened
        self.gone = given - clock.dissipated - rubbed - (total - self.series.get("energy_total", [total])[0])
        yield "dissipation_transfer", self.gone

    def thermal(self, scene, clock):
        """Temperatures, the heat ledger, probes, errors."""
        if not self.warm:
            yield "energy_ledger", -self.gone
            return
        theta = np.concatenate([body.thermal.zero + body.thermal.theta.astype(float) for _, body in self.warm])
        capacity = np.concatenate([self.capacities[b][: len(body.thermal.theta)] for b, body in self.warm])
        total = sum(heat_since(body, self.start[b][: len(body.thermal.theta)]) for b, body in self.warm)
        yield "temperature_mean", np.sum(capacity * theta) / np.sum(capacity)
        yield "temperature_min", np.min(theta)
        yield "temperature_max", np.max(theta)
        yield "heat_total", total
        yield from self.setting()
        yield "area_exchanging", self.exchanging()
        yield from (("heat_exchanged", clock.exchanged), *((f"heat_{name}", heat) for name, heat in zip(scene.hot, clock.given.tolist(), strict=True)))
        made = total - clock.exchanged - clock.local - getattr(scene.inflow, "heat", 0.0)
        yield from (("heat_ledger", made), ("energy_ledger", made - self.gone))
        for name in self.places:
            yield f"temperature_{name}", self.probe(name)
        if self.origin:
            V = np.concatenate([body.particles.V0 * body.particles.J for _, body in self.warm])
            error = theta - scene.watch.exact(np.concatenate(self.origin), clock.time)
            yield "error_l2", math.sqrt(np.sum(V * error**2) / np.sum(V))
            yield "error_max", np.max(np.abs(error))

    def setting(self):
        """Degrees of setting."""
        if found := [(body.setting.X, body.particles.m) for _, body in self.warm if isinstance(body.setting, Setting)]:
            X, m = (np.concatenate(part) for part in zip(*found, strict=True))
            yield "setting_mean", np.sum(m * X) / np.sum(m)
            yield "setting_min", np.min(X)

    def of_bodies(self, scene):
        """What is asked of one body."""
        told = {}
        for b in {number for _, number in scene.watch.of.values()}:
            body = scene.bodies[b]
            told[b] = dict(motion_of(scene.space, (body,), scene.outlines[b : b + 1]))
            if isinstance(body.thermal, Thermal):
                theta, capacity = body.thermal.zero + body.thermal.theta.astype(float), self.capacities[b][: len(body.thermal.theta)]
                told[b] |= {"temperature_mean": np.sum(capacity * theta) / np.sum(capacity), "temperature_min": np.min(theta)}
                told[b] |= {"temperature_max": np.max(theta), "heat_total": heat_since(body, self.start[b][: len(theta)])}
        for name, (base, b) in scene.watch.of.items():
            yield name, told[b][base]

    def at_probes(self, scene):
        """Displacements and stresses that observables ask probes for."""
        for name, (what, probe, part) in scene.watch.asked.items():
            home, point = self.places[probe]
            body, X = scene.bodies[home], np.asarray(scene.watch.probes[probe], float)
            if what == "stress":
                sigma = cauchy(body)[:, parts("stress", self.dimension).index(part)]
                yield name, sampled(point, sigma, np.zeros((len(sigma), len(X))))[0]
            else:
                u = moving.displacement_at(scene.space, scene.references[home], X[None]) if scene.references else moved(point, body.particles.x) - X
                yield name, u[0, axis_names(scene.space).index(part)]

    @property
    def dimension(self):
        """As configs say it."""
        return "axisymmetric" if isinstance(self.scene.space, Axisymmetric) else len(grid_shape(self.scene.space))

    def exchanging(self) -> float:
        """Area that exchanges heat."""
        skins = [reference.warmth.now for reference in self.scene.references if isinstance(reference.warmth, Warmth)]
        return float(sum(map(np.sum, skins))) if self.scene.references else sum(exchanging_area(body) for _, body in self.warm)

    def run(self, scene, clock, result: Outcome, wall_time: float) -> Run:
        """The Run. Where it did not complete, the series stop at the last good record."""
        series = {name: np.array(values) for name, values in self.series.items()}
        finals = {name: float(values[-1]) for name, values in series.items()} | self.crossed
        facts = dict(scene.facts, binds=max(clock.bound, key=clock.bound.get, default=""), bound_steps=clock.bound, heat_steps=clock.heat_steps,
                     particles=sum(len(body.particles.m) for body in scene.bodies), volume_ratios=volume_ratios(scene.names, scene.bodies))  # fmt: skip
        if clock.implicit:
            facts |= {"heat_steps_implicit": clock.implicit, "heat_iterations": clock.iterations}
        if scene.repair:
            facts |= {"heat_repaired": clock.repaired, "heat_unrepaired": clock.unrepaired}
        if self.errors is not None:
            finals |= self.errors.finals(np.array(self.times), series)
        for name, (what, tool) in scene.watch.bites.items():
            finals[name] = scene.meeting.texture(tool, axis_names(scene.space), series)[what]
        finals["steps"] = float(clock.steps or clock.heat_steps)
        if scene.implicit is not None:
            finals |= scene.implicit.finals(clock.told)
        if clock.longest > 0:
            finals |= {"step_shortest": clock.shortest, "step_longest": clock.longest}
        run = Run(result, np.array(self.times), series, finals, steps=clock.steps, wall_time=wall_time, facts=facts)
        if len(times := self.frames.times):
            held, run.snapshot_times = self.frames.held, times
            if held:
                run.grid = {name: np.stack([grid[name] for _, grid, _ in held]) for name in held[0][1]}
                run.particles = [particles for _, _, particles in held]
            else:
                run.frames = self.frames
            if scene.watch.grid:
                run.axes = {name: np.arange(n - 2 * PAD) * scene.space.h for name, n in zip(axis_names(scene.space), grid_shape(scene.space), strict=True)}
        return run
