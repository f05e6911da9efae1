"""What a point will cost, without running it: size, limits and which binds, seconds, bytes. Rough: within a factor of two or three."""

import math

from mpm.scene.inventory import output_bytes, physics

NS_PARTICLE_STEP = {1: 60, 2: 200, "axisymmetric": 220, 3: 450}
BYTES_PARTICLE = {1: 120, 2: 200, "axisymmetric": 200, 3: 320}


MOST_UNKNOWNS = 2_000_000
STEPS_RIGID = 100  # of a run at the default tolerance, whatever the cell


def estimate(experiment) -> dict:
    """particles, unknowns, steps, seconds, memory_bytes, output_bytes, limits {name: seconds}, binds, physics of one point."""
    if experiment.grid.dimension == 0:
        from mpm.scene import point

        return point.estimate(experiment)
    return estimate_moving(experiment) if experiment.moving else estimate_rigid(experiment)


def estimate_moving(experiment) -> dict:
    """Particles are sampled (not run) for the counts and the limits of the first step."""
    from mpm.boundary import extents
    from mpm.integrate.timestep import limits
    from mpm.scene.build import build
    from mpm.simulation import Clock

    scene = build(experiment)
    now = limits(scene.space, experiment.grid.directions, scene.bodies, Clock(scene).reports)
    particles = sum(len(body.particles.m) for body in scene.bodies)
    S = experiment.time.scale
    step = (scene.step or now.step() * scene.safety) * S
    pace = min((scene.heat_step or now.pace) * S, experiment.time.end)
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
        "limits": {name: limit * S for name, limit in (now.mechanical | now.heat | ({"heat pace": now.pace} if math.isfinite(now.pace) else {})).items()},
        "binds": "heat pace" if pace < step else binds,
        "physics": physics(experiment),
    }


def estimate_rigid(experiment) -> dict:
    """The bodies' equations are set up (milliseconds), not solved. Implicit steps have no limit of stability, so accuracy binds."""
    from mpm.rigid import Method, outlook
    from mpm.scene.build import SceneError
    from mpm.scene.rigid import rigid_bodies
    from mpm.scene.shapes import shape

    grid, unknowns = experiment.grid, 0
    for body in experiment.bodies.values():
        lower, upper = shape(body.shape, grid.dimension).bounds()
        unknowns += math.prod(math.ceil(float(extent) / grid.cell) + 2 for extent in upper - lower)
    if unknowns > MOST_UNKNOWNS:
        raise SceneError(f"{unknowns} unknowns in rigid bodies, more than {MOST_UNKNOWNS}: take a coarser grid.cell (the method is of order 2 to 3)")
    ahead = outlook(rigid_bodies(experiment), grid.dimension, grid.cell, end=experiment.time.end, method=Method(type(experiment.method.rigid).kind))
    return {
        "particles": 0,
        "unknowns": ahead["unknowns"],
        "steps": STEPS_RIGID,
        "seconds": 0.02 + ahead["seconds"],
        "memory_bytes": 180_000_000 + ahead["memory_bytes"],
        "output_bytes": output_bytes(experiment, 0),
        "limits": ahead["limits"],
        "binds": "accuracy",
        "physics": physics(experiment),
    }
