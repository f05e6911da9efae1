"""What a point will cost, without running it: size, limits and which binds, seconds, bytes. Rough: within a factor of two or three."""

import math

from mpm.runner import physics

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

