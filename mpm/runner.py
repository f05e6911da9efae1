"""One point of a sweep: from a validated experiment to a Run. The shell, the workers and `mpm.run` all come through here.

run_point(experiment, beat) -> Run      estimate(experiment) -> what it will cost      warm(experiment): compile what it needs
Bodies without `elastic` do not move: heat alone, on the nodes of an immersed Galerkin problem (mpm.rigid). Otherwise particles (mpm.simulation).
"""

import math
import time

import numpy as np

from mpm.state import Run


def run_point(experiment, beat=None) -> Run:
    """Run one point (no sweep). A failure of the model is the Run's outcome; SceneError says that no method here can run the config."""
    if experiment.moving:
        from mpm.scene.build import build
        from mpm.simulation import simulate
        from mpm.verification import exact_solution

        scene = build(experiment, exact_solution(experiment))
        scene.facts["physics"] = physics(experiment)
        return simulate(scene, beat)
    return run_rigid(experiment, beat)


def rigid_bodies(experiment) -> list:
    """The bodies of a rigid scene; SceneError for one that has nothing to do."""
    from mpm.rigid import RigidBody
    from mpm.scene.build import SceneError, law
    from mpm.scene.shapes import shape

    bodies = []
    for name, body in experiment.bodies.items():
        material = experiment.materials[body.material]
        if material.heat is None:
            raise SceneError(f"materials.{body.material} has neither `elastic` nor `heat`: nothing would happen in {name}")
        surfaces = tuple((s.side, s.convection.beta, s.convection.outside) for s in experiment.surfaces if s.of == name and s.convection is not None)
        outline = shape(body.shape, experiment.grid.dimension)
        bodies.append(RigidBody(outline, body.temperature, material.density, law(material.heat.kappa), law(material.heat.alpha), surfaces))
    return bodies


def run_rigid(experiment, beat=None) -> Run:
    """Heat alone, bodies that do not move."""
    from mpm.records.variables import dataset_name, threshold
    from mpm.rigid import solve
    from mpm.rigid.run import Method
    from mpm.scene.build import output_times
    from mpm.verification import exact_solution

    began = time.perf_counter()
    exact = exact_solution(experiment)
    found = {dataset_name(name): threshold(name) for name in experiment.output.observables if threshold(name) is not None}
    times, grid = output_times(experiment), experiment.grid
    kind = type(experiment.method.rigid).kind
    options = {"order": experiment.method.rigid.order, "tolerance": experiment.method.rigid.tolerance} if kind == "implicit" else {}
    method = Method(kind, step=None if experiment.time.step == "auto" else experiment.time.step, **options)
    origin = -np.array(experiment.method.offset) * grid.cell
    levels = [(at.probe, at.kelvin) for at in found.values()]
    solved = solve(rigid_bodies(experiment), grid.dimension, grid.cell, origin, experiment.time.end, times, experiment.output.probes, levels, method, beat)
    series = {dataset_name(name): values for name, values in solved.series.items()}
    series["heat_total"] = series.pop("heat")
    finals = {name: float(values[-1]) for name, values in series.items()}
    finals |= {name: solved.crossings[at.probe, at.kelvin] for name, at in found.items()}
    finals["steps"] = float(solved.steps)
    facts = solved.facts | {"unknowns": solved.unknowns, "rejected": solved.rejected, "physics": physics(experiment)}
    run = Run(solved.outcome, solved.times, series, finals, steps=solved.steps, facts=facts)
    if exact is not None:
        rigid_errors(experiment, solved, exact, run)
    run.wall_time = time.perf_counter() - began
    return run


def rigid_errors(experiment, solved, exact, run: Run) -> None:
    """Error against the exact solution at the quadrature points, at the end."""
    x, w = solved.points()
    if experiment.grid.dimension == "axisymmetric":
        w = w * x[:, 0]
    error = solved.sample(x, 0) - exact(x + np.array(experiment.method.offset) * experiment.grid.cell, float(solved.times[-1]))
    run.finals["error_l2"] = math.sqrt(float(np.sum(w * error**2) / np.sum(w)))
    run.finals["error_max"] = float(np.max(np.abs(error)))


def physics(experiment) -> dict[str, list[str]]:
    """What is compiled for this config, and what is absent."""
    present: set[str] = set()
    for material in experiment.materials.values():
        for part in ("elastic", "flow", "heat", "expansion"):
            law = getattr(material, part)
            if law is not None:
                present.add(f"{part}: {type(law).kind}")
        if material.heating is not None:
            present |= {f"heating: {part}" for part in ("elastic", "dissipation") if getattr(material.heating, part) is not None}
    present |= {"exchange: convection"} if any(s.convection is not None for s in experiment.surfaces) else set()
    present |= {"gravity"} if experiment.gravity is not None else set()
    said = {text.split(":")[0] for text in present}
    parts = ("elastic", "flow", "heat", "expansion", "heating", "exchange", "gravity")
    return {"compiled": sorted(present), "absent": [part for part in parts if part not in said]}


def warm(experiment) -> None:
    """Compile (or load from the cache) what the experiment needs, by a run of one output interval of its smallest steps."""
    from mpm.config import load

    short = experiment.resolved()
    if experiment.moving:
        from mpm.integrate.timestep import limits
        from mpm.scene.build import build
        from mpm.simulation import Clock

        scene = build(experiment)
        step = limits(scene.space, experiment.grid.directions, scene.bodies, Clock(scene).reports).step()
        short["time"]["end"] = min(experiment.time.end, step)
    else:
        short["time"]["end"] = experiment.time.end * 1e-3
    short["output"]["every"] = short["time"]["end"]
    short["sweep"] = None
    run_point(load(short))


def estimate(experiment) -> dict:
    """Size, limits and cost of one point, without running it: seconds and bytes are rough (factor two)."""
    return estimate_moving(experiment) if experiment.moving else estimate_rigid(experiment)


NS_PARTICLE_STEP = {1: 60, 2: 200, "axisymmetric": 220, 3: 450}
BYTES_PARTICLE = {1: 120, 2: 200, "axisymmetric": 200, 3: 320}


def estimate_moving(experiment) -> dict:
    """Particles are sampled (not run) for the counts and the limits of the first step."""
    from mpm.boundary import extents
    from mpm.integrate.timestep import limits
    from mpm.scene.build import build
    from mpm.simulation import Clock

    scene = build(experiment)
    now = limits(scene.space, experiment.grid.directions, scene.bodies, Clock(scene).reports)
    particles = sum(len(body.particles.m) for body in scene.bodies)
    step = scene.step or now.step() * scene.safety
    pace = min(scene.heat_step or now.pace, experiment.time.end)
    binds = "time.step" if scene.step else min(now.mechanical, key=now.mechanical.get)
    steps = math.ceil(experiment.time.end / min(step, pace))
    dimension = experiment.grid.dimension
    return {
        "particles": particles,
        "unknowns": math.prod(extents(scene.space)),
        "steps": steps,
        "seconds": steps * particles * NS_PARTICLE_STEP[dimension] * 1e-9,
        "memory_bytes": 150_000_000 + particles * BYTES_PARTICLE[dimension] + math.prod(extents(scene.space)) * 80,
        "output_bytes": output_bytes(experiment, particles),
        "limits": now.mechanical | now.heat | ({"heat pace": now.pace} if math.isfinite(now.pace) else {}),
        "binds": "heat pace" if pace < step else binds,
        "physics": physics(experiment),
    }


def estimate_rigid(experiment) -> dict:
    """Unknowns from the bodies' extents; implicit steps have no limit of stability, so accuracy binds."""
    from mpm.scene.build import SceneError
    from mpm.scene.shapes import shape

    unknowns = 0
    for body in experiment.bodies.values():
        lower, upper = shape(body.shape, experiment.grid.dimension).bounds()
        unknowns += math.prod(math.ceil(float(extent) / experiment.grid.cell) + 2 for extent in upper - lower)
    if unknowns > 5_000_000:
        raise SceneError(f"{unknowns} unknowns in a rigid body: a coarser grid.cell gives the same answer (the method is of order 3)")
    curved = any(type(m.heat.alpha).kind != "constant" or type(m.heat.kappa).kind != "constant" for m in experiment.materials.values() if m.heat)
    steps = 1000 if curved else 60
    band = unknowns ** (0.5 if experiment.grid.directions == 2 else 0.66 if experiment.grid.directions == 3 else 0.0)
    return {
        "particles": 0,
        "unknowns": unknowns,
        "steps": steps,
        "seconds": 0.02 + steps * unknowns * (30e-9 if curved else 20e-9 * (1 + band)),
        "memory_bytes": 180_000_000 + int(unknowns * 8 * (100 + 4 * band)),
        "output_bytes": output_bytes(experiment, 0),
        "limits": {},
        "binds": "accuracy",
        "physics": physics(experiment),
    }


def output_bytes(experiment, particles: int) -> int:
    """Bytes of a point's file: series in float64, snapshots in float32 (grid) and float64 (particles), before compression."""
    samples = math.ceil(experiment.time.end / experiment.output.every) + 1
    size = 20_000 + samples * 8 * (25 + len(experiment.output.probes))
    snapshots = experiment.output.snapshots
    if snapshots is not None:
        frames = math.ceil(experiment.time.end / snapshots.every) + 1
        nodes = math.prod(round(s / experiment.grid.cell) + 1 for s in experiment.grid.size)
        size += frames * (4 * nodes * len(snapshots.grid) + 8 * particles * len(snapshots.particles) * 2)
    return size

