"""`mpm bench CONFIG`: where the time of a particle-step goes, what each physics costs, and how far the machine's own limits are.

Phases are timed on the config's own particles after some steps, each over and over by itself, so their sum is not quite the step: what one phase leaves in
the cache helps the next. With and without: the same config with a section taken out, timed in turn with the whole, medians. Limits, and how the operations
of a step are counted: mpm.study.limits.
"""

import contextlib
from typing import Any

import numpy as np

from mpm.boundary import directions
from mpm.config import ConfigError, load
from mpm.costs import estimate
from mpm.integrate.explicit import move
from mpm.integrate.particle_update import respond
from mpm.integrate.strain import REPORT
from mpm.integrate.timestep import limits
from mpm.jit import kernel
from mpm.runner import run_point
from mpm.scene.build import build
from mpm.simulation import BLOCK, BLOCK_WORK, Clock, advance_block, work_arrays
from mpm.study.limits import operations, peaks, seconds
from mpm.sweep.cases import plan
from mpm.transfer import CHUNK, collect, lay_down, new_chunk, spread
from mpm.warming import warm_bodies

WITHOUT = {"heat": ("heat", "expansion", "heating"), "flow": ("flow",), "expansion": ("expansion", "heating"), "heating": ("heating",)}


@kernel
def gathers(scheme, space, gradient, body, chunk, nodes, force, times):
    """Particles gather from the grid, so many times over."""
    x = body.particles.x
    for _ in range(times):
        for first in range(0, x.shape[0], CHUNK):
            lay_down(space, x, first, min(CHUNK, x.shape[0] - first), chunk)
            collect(scheme, space, gradient, x, first, chunk, min(CHUNK, x.shape[0] - first), nodes, force)


@kernel
def moves(space, body, chunk, dt, report, times):
    """Particles move, so many times over."""
    x = body.particles.x
    for _ in range(times):
        for first in range(0, x.shape[0], CHUNK):
            lay_down(space, x, first, min(CHUNK, x.shape[0] - first), chunk)
            move(space, x, chunk, first, min(CHUNK, x.shape[0] - first), dt, 0.0, report)


@kernel
def responds(space, gradient, body, chunk, dt, report, times):
    """Particles respond to their strain, so many times over."""
    x = body.particles.x
    for _ in range(times):
        for first in range(0, x.shape[0], CHUNK):
            respond(space, gradient, body, chunk, first, min(CHUNK, x.shape[0] - first), dt, dt, report)


@kernel
def spreads(scheme, space, gradient, body, chunk, nodes, force, box, times):
    """Particles spread to the grid, so many times over."""
    x = body.particles.x
    for _ in range(times):
        for first in range(0, x.shape[0], CHUNK):
            lay_down(space, x, first, min(CHUNK, x.shape[0] - first), chunk)
            spread(scheme, space, gradient, x, first, chunk, min(CHUNK, x.shape[0] - first), nodes, force, box)


class Bench:
    """A scene that can be stepped and taken apart."""

    def __init__(self, experiment: Any, threads: int = 1):
        self.scene = build(experiment)
        self.scene.threads = threads
        self.clock, self.work = Clock(self.scene), work_arrays(self.scene)
        self.now = limits(self.scene.space, directions(self.scene.space), self.scene.bodies, self.clock.reports)
        self.dt = (self.scene.step or self.now.step() * self.scene.safety) / 4
        self.particles = sum(len(body.particles.m) for body in self.scene.bodies)
        self.block = max(1, min(BLOCK, BLOCK_WORK // self.particles))  # as a run has them: the first step of a block scatters twice

    def steps(self) -> None:
        """A block of steps."""
        advance_block(self.scene, self.clock, self.work, self.dt, self.block)

    def heat(self) -> None:
        """A heat step of every body."""
        warm_bodies(self.scene, self.clock, self.work, self.clock.time, 1e-3 * min(self.now.pace, 1.0), self.now)

    def step_ns(self) -> float:
        """ns a particle and mechanical step."""
        return 1e9 * seconds(self.steps) / self.block / self.particles

    def phases(self) -> dict[str, float]:
        """ns a particle of each phase, on the first body."""
        scene, (nodes, force, _, _) = self.scene, self.work.buffers
        body, D, report = scene.bodies[0], directions(scene.space), np.zeros(REPORT)
        kind, space, gradient, count = scene.scheme, scene.space, scene.gradient, len(scene.bodies[0].particles.m)
        chunk = new_chunk(D, nodes, True, True)
        box, tiny, times = np.array([[10**9, -1]] * 3), 1e-9 * self.dt, max(1, 200_000 // count)
        calls = {
            "gather": lambda: gathers(kind, space, gradient, body, chunk, nodes[0], force[0], times),
            "move": lambda: moves(space, body, chunk, tiny, report, times),
            "respond": lambda: responds(space, gradient, body, chunk, tiny, report, times),
            "scatter": lambda: spreads(kind, space, gradient, body, chunk, nodes[1], force[1], box, times),
        }
        found = {name: 1e9 * seconds(call) / count / times for name, call in calls.items()}
        nodes[:], force[:] = 0.0, 0.0
        return found


def without(experiment: Any, sections: tuple[str, ...]) -> Any:
    """The experiment less those sections of every material and what needs them, or None where that is no experiment or the same one."""
    data, missing = experiment.resolved() | {"formulas": {}}, False
    for material in data["materials"].values():
        for section in sections:
            missing = missing or material.get(section) is not None
            material[section] = None
    if not missing:
        return None
    if "heat" in sections:
        data["surfaces"] = []
        data["output"]["probes"] = {}
        data["method"]["heat_step"] = "auto"
    data["output"]["observables"] = []
    data["exact"] = None
    for part in ("chart", "stability"):
        data.pop(part, None)
    try:
        return load(data)
    except ConfigError:
        return None


def phases(experiment: Any, threads: int = 1) -> dict:
    """Figures of one point of a config that moves; whole steps by so many threads where it is large enough, phases by one."""
    experiment = plan(experiment).cases[0].experiment
    if experiment.grid.dimension == 0 or not experiment.moving:
        return rigid(experiment)
    whole = Bench(experiment, threads)
    found: dict[str, Any] = {"particles": whole.particles, "step_ns": whole.step_ns(), "phases_ns": whole.phases(), "without_ns": {}}
    found["precision"], found["peaks"] = whole.work.buffers.nodes.dtype.name, peaks(whole.work.buffers.nodes.dtype)
    if whole.now.heat:
        found["heat_step_ns"] = 1e9 * seconds(whole.heat) / whole.particles
    for name, sections in WITHOUT.items():
        less = without(experiment, sections)
        if less is not None and less.moving:
            found["without_ns"][name] = Bench(less, threads).step_ns()
    found["threads"] = threads if whole.scene.order.shared else 1
    state = sum(array.nbytes for body in whole.scene.bodies for array in body.particles)
    found["state_bytes"] = state / whole.particles
    found["operations"] = operations(whole.scene)
    found["fma_share"] = found["operations"] / found["step_ns"] / found["peaks"]["gflops"] / found["threads"]
    found["bandwidth_share"] = 2 * found["state_bytes"] / found["step_ns"] / found["peaks"]["gbytes"]
    return found


def rigid(experiment: Any) -> dict:
    """Of a point without particles: its time, how much of it sets up, its steps, and what it takes without its surfaces."""
    runs = []
    whole = seconds(lambda: runs.append(run_point(experiment, compare=False)))
    stepping, steps = float(np.median([run.wall_time for run in runs])), runs[0].steps
    unknowns = estimate(experiment).get("unknowns", 0)
    found = {"point_s": whole, "setup_s": max(0.0, whole - stepping), "steps": steps, "unknowns": unknowns, "without_s": {}, "peaks": peaks()}
    found["unknown_step_ns"] = 1e9 * stepping / max(1, steps * unknowns)
    data = experiment.resolved() | {"formulas": {}}
    if data["surfaces"]:
        data |= {"surfaces": [], "exact": None, "output": data["output"] | {"observables": [], "measured": {}}}
        with contextlib.suppress(ConfigError):  # a scene that is nothing without them
            less = load(data)
            found["without_s"]["exchange"] = seconds(lambda: run_point(less, compare=False))
    return found


def table(found: dict) -> str:
    """The figures in words."""
    if "point_s" in found:
        each = f"{found['steps']} steps of {found['unknowns']} unknowns, {found['unknown_step_ns']:.3g} ns an unknown and step"
        said = f"{1e3 * found['setup_s']:.3g} ms to set up, {each}"
        less = [f"  without {name}: {1e3 * took:.3g} ms" for name, took in found["without_s"].items()]
        return "\n".join([f"{1e3 * found['point_s']:.3g} ms a point (no particles): {said}", *less])
    by = f", {found['threads']} threads" if found["threads"] > 1 else ""
    lines = [f"{found['particles']} particles{by}, {found['step_ns']:.1f} ns a particle-step, {found['state_bytes']:.0f} B of state a particle"]
    lines += [f"  {name:8} {value:7.1f} ns" for name, value in found["phases_ns"].items()]
    if "heat_step_ns" in found:
        lines.append(f"  heat     {found['heat_step_ns']:7.1f} ns a particle and heat step, at its own pace")
    lines += [f"  without {name}: {value:.1f} ns a particle-step" for name, value in found["without_ns"].items()]
    lines.append(f"one core here: {found['peaks']['gflops']:.0f} GFLOP/s of multiply-adds ({found['precision']}), {found['peaks']['gbytes']:.1f} GB/s;")
    lines.append(f"the {found['operations']} operations of transfer and elastic law that it wants make {100 * found['fma_share']:.0f} % of the")
    lines.append(f"multiply-adds, reading and writing the state takes {100 * found['bandwidth_share']:.0f} % of the bandwidth")
    return "\n".join(lines)
