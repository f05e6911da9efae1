"""What a point will cost, without running it: size, limits and which binds, seconds, bytes.

Seconds of bodies that move   set-up, and what each step, block of steps, heat step and output takes, alone and a particle (`moving`)
        of rigid ones         what factorisations, solutions and evaluations take (mpm.rigid.outlook), the interpreter's part of a run and an output each
Within a factor of two of the runs of `python -m mpm.benchmarks.costs`.
Fails when: a scene stiffens or speeds up, so that its steps are not those of its start; threads share it.
"""

import math

from mpm.config.rules_frame import named
from mpm.config.rules_size import MOST_STEPS, MOST_UNKNOWNS
from mpm.records.frames import SPILL
from mpm.scene.inventory import layers, output_bytes, physics, swollen, ticks
from mpm.scene.refusal import SceneError, placed

# Fitted to the table of `python -m mpm.benchmarks.costs`, with LEAST the left ends of docs/chart_robin_slab.png and docs/chart_hencky_bar.png
LEAST = {"rigid": 1.5e-3, "moving": 1.5e-3}  # s of the smallest run, set-up and record included
STEP = {1: 25e-9, 2: 35e-9, "axisymmetric": 45e-9, 3: 65e-9}  # s a particle: elastic, without heat
INCREMENTS = 0.8  # of STEP more with FLIP, whose increments go over the grid beside velocities: slump.yaml takes 0.61 s with APIC, 0.8 with affine FLIP
SKIN = 60e-9  # s a piece of surface and step near something: its place, and what it is before
MET = 1e-6  # s a piece that meets something and step: gap, weights, impulses (mpm.contact); in space 0.5 to 1.0 of this beside runs that meet nothing
LOCKING = 1.0  # of STEP more with F-bar, whose averages go over the grid and back
WARM, FLOW = 15e-9, {"radial": 35e-9, "clipped": 150e-9}  # s a particle more where deformation and temperature meet, and where it flows
ALONE = {"step": 3e-6, "block": 50e-6, "heat": 80e-6, "output": 230e-6, "near": 30e-6, "synced": 0.7e-3}  # s, whatever the number of particles
HEAT, OUTPUT = {1: 0.5e-6, 2: 1.2e-6, "axisymmetric": 1.2e-6, 3: 1.2e-6}, 500e-9  # s a particle and heat step, and output
# s of the interpreter in a run, by method
RIGID = {"LinearSteps": 0.25e-3, "NewtonSteps": 25e-3, "ChebyshevSteps": 6e-3, "BoundedSteps": 3e-3, "JoinedLinear": 0.1, "JoinedNewton": 0.5}
SHOWN = 60e-6  # s an output of rigid bodies
COMPONENTS = {1: 3, 2: 4, 3: 6}  # of a strain, by directions
BYTES_PROCESS = {"point": 195_000_000, "moving": 203_000_000, "rigid": 222_000_000}  # interpreter, packages, kernels from the cache
LATTICE = 30_000  # places a body that tell how much of its bounding box it fills
LOOKED = 50_000  # particles of a scene that are all made to see its limits
IMPLICIT = {1: 45e-6, 2: 45e-6, 3: 200e-6}  # s a particle and implicit step, heat included, by directions
IMPLICIT_STEPS, WORTH = 40, 100.0  # steps at tolerance 1e-4; see by_mechanics
STEPS_RIGID = 100  # of a run at the default tolerance, whatever the cell


@placed
def estimate(experiment) -> dict:
    """particles (of many, three digits), unknowns, steps, seconds, memory_bytes, output_bytes, limits {name: seconds}, binds, physics of one point."""
    if experiment.grid.dimension == 0:
        from mpm.scene import point

        return point.estimate(experiment)
    if not experiment.moving:
        return estimate_rigid(experiment)
    if experiment.method.frame != "auto":
        return estimate_moving(experiment)
    from mpm.scene.framing import choice  # needs numba, which the parent of a sweep does without

    frame, why = choice(mechanics_settled(experiment))
    try:
        return estimate_moving(named(experiment, frame)) | {"frame": f"{frame}: {why}"}
    except SceneError as error:
        if frame == "updated":
            raise
        return estimate_moving(named(experiment, "updated")) | {"frame": f"updated: {error.message}"}


def refuse_endless(experiment, step: float) -> None:
    """SceneError where explicit steps of this length [s] would not come to the end in months."""
    if experiment.method.mechanics == "explicit" and experiment.time.end / step > MOST_STEPS:
        said = f"the run would take {experiment.time.end / step:.3g} steps of {step:.3g} s, and no more than {MOST_STEPS:.0e} end within months"
        raise SceneError(("time", "end"), f"{said}: at most {MOST_STEPS * step:.3g} s, larger cells or softer materials")


def memory(experiment) -> int:
    """Bytes of a process that runs the point, at its peak, kernels in the cache: within 20 % (tests/faults/test_memory.py). Particles are counted, not made."""
    if experiment.grid.dimension == 0:
        return BYTES_PROCESS["point"]
    particles, nodes = counted(experiment)
    fields = 3 * held_bytes(experiment, particles)  # as they are collected, joined and packed
    if not experiment.moving:
        return estimate_rigid(experiment)["memory_bytes"] + fields
    body = particles * bytes_particle(experiment) + nodes * bytes_node(experiment) + bytes_implicit(experiment, particles, nodes)
    return BYTES_PROCESS["moving"] + body + fields


def bytes_implicit(experiment, particles: int, nodes: int) -> int:
    """Weights, and in three directions blocks of nodes (mpm.implicit.matrix); a band is small beside them."""
    D = experiment.grid.directions
    return (particles * 3**D * (25 + 8 * D) + nodes * (131 * 80 if D == 3 else 0)) * (experiment.method.mechanics == "implicit")


def held_bytes(experiment, particles: int) -> int:
    """Bytes of output that a run holds: all that is no snapshot of particles, and of these SPILL and one (mpm.records.frames)."""
    everything, rest = output_bytes(experiment, particles), output_bytes(experiment, 0)
    snapshots = experiment.output.snapshots
    one = (everything - rest) / ticks(experiment.time.end, snapshots.every) if snapshots is not None else 0
    return round(min(everything, rest + SPILL + one))


def bytes_particle(experiment) -> int:
    """At the peak of a run, the state, and what a record adds to it: v and C that it goes on from, and the state again with v and C of two steps that
    move nothing (mpm.contact.insync), or where motion is summed up (mpm.observe) x, v, m, J, V0, squares of v and C. Total and implicit: the sums alone."""
    D, real = experiment.grid.directions, 4 if experiment.method.precision == "float32" else 8
    state = real * (2 * D + D * D + COMPONENTS[D] + 3)  # x, v, C, B, J, m, V0
    if any(material.heat is not None for material in experiment.materials.values()):
        state += real * (1 + D) + 8  # theta and its gradient; theta at the start
    if experiment.sources:
        state += 8 * (2 * D + 3 + 8)  # place at the start, force, time, rest, temperature, and a formula eight deep
    if experiment.loads:
        state += 8 * (2 + D + 2 * D * D)  # forces, their moments, F, time
    if experiment.method.frame == "total":  # places in the reference shape, what flow left
        state += real * (D + COMPONENTS[D] * any(material.flow is not None for material in experiment.materials.values()))
    sums, apart, lags = 8 * (D * D + 4 * D + 4), real * (D + D * D), experiment.method.frame == "updated" and experiment.method.mechanics == "explicit"
    return state + apart + max(sums, (state + 2 * apart) * lags)


def bytes_node(experiment) -> int:
    """Of the nodes that bodies reach: two buffers of momentum and mass, or the total frame's fields, shares of neighbours, numbers; fields of a heat step."""
    real = 4 if experiment.method.precision == "float32" else 8
    warm = any(material.heat is not None for material in experiment.materials.values())
    total = (18 + 2 * experiment.grid.directions) * real + 16
    return (total if experiment.method.frame == "total" else 2 * 4 * real) + (7 * 8 if warm else 0)


def memory_at_most(experiment) -> int:
    """A bound on `memory` from the domain alone, in microseconds: where it fits, nothing needs to be counted."""
    grid = experiment.grid
    if grid.dimension == 0:
        return BYTES_PROCESS["point"]
    cells = [math.ceil(size / grid.cell) + 5 for size in grid.size]
    if experiment.moving:
        count = math.prod(cells) * experiment.method.particles**grid.directions
        body = BYTES_PROCESS["moving"] + len(experiment.bodies) * count * bytes_particle(experiment) + math.prod(cells) * bytes_node(experiment)
        body += bytes_implicit(experiment, count, math.prod(cells))
    else:
        count = math.prod(cells)
        body = BYTES_PROCESS["rigid"] + 8 * count * (3 * count // max(cells) + 5**grid.directions * 6)  # matrices, and a band of the smaller sides
    return body + 3 * held_bytes(experiment, count if experiment.moving else 0)


def count_particles(experiment) -> int:
    """Particles of all bodies, about."""
    return counted(experiment)[0]


def counted(experiment) -> tuple[int, int]:
    """About how many particles all bodies have, and how many nodes they reach.

    Particles: cells of the sampling, LATTICE of them a body, whose centre lies in it or within half a cell of it. Nodes: twice those of the boxes
    round the bodies, as they move, at most all.
    """
    import numpy as np

    from mpm.scene.shapes import shape

    if not experiment.moving:
        return 0, 0
    edge, particles, nodes = experiment.grid.cell / experiment.method.particles, 0.0, 0.0
    for name, body in experiment.bodies.items():
        outline = shape(body.shape, experiment.grid.dimension).moved(np.array(experiment.method.offset) * experiment.grid.cell)
        lower, upper = outline.bounds()
        first, last = np.floor(np.maximum(lower, 0.0) / edge + 1e-9), np.ceil(upper / edge - 1e-9)  # as in mpm.scene.build.sample
        sides = np.maximum(1, last - first)
        some = np.minimum(sides, round(LATTICE ** (1 / len(sides)))).astype(int)
        places = np.meshgrid(*(low + np.floor((np.arange(n) + 0.5) * side / n) + 0.5 for low, side, n in zip(first, sides, some, strict=True)), indexing="ij")
        inside = outline.distance(edge * np.stack([axis.ravel() for axis in places], axis=1)) < edge / 2
        particles += float(np.mean(inside)) * math.prod(sides.tolist()) * swollen(experiment, name)
        nodes += 2 * math.prod((sides / experiment.method.particles + 3).tolist())
    return round(particles), round(min(nodes, math.prod(math.ceil(size / experiment.grid.cell) + 5 for size in experiment.grid.size)))


def outputs(experiment) -> int:
    """How often a point is recorded, its start included."""
    return math.ceil(experiment.time.end / experiment.output.every * (1 - 1e-9)) + 1


def moving(experiment, particles: int, steps: int, heat_steps: int) -> float:
    """Seconds of a run of moving bodies; of materials of several kinds the dearest."""
    from mpm.simulation import BLOCK

    parts = [experiment.materials[body.material] for body in experiment.bodies.values()]
    each = STEP[experiment.grid.dimension] * (1.0 if experiment.method.transfer.kind in ("apic", "pic") else 1.0 + INCREMENTS)
    each += WARM if any(part.heat is not None and (part.expansion is not None or part.heating is not None) for part in parts) else 0.0
    each += STEP[experiment.grid.dimension] * LOCKING * (experiment.method.locking is not None)
    each += max((FLOW[part.flow.map] for part in parts if part.flow is not None), default=0.0)
    intervals = max(heat_steps, outputs(experiment) - 1)  # each is cut into blocks of its own
    alone = steps * ALONE["step"] + (intervals + steps // BLOCK) * ALONE["block"] + heat_steps * ALONE["heat"] + outputs(experiment) * ALONE["output"]
    return LEAST["moving"] + alone + particles * (steps * each + heat_steps * HEAT[experiment.grid.dimension] + outputs(experiment) * OUTPUT)


def meeting(experiment, scene, particles: int, steps: int, sound: float) -> float:
    """Seconds of contact: all pieces of surface in steps near something, two more a record, called alone (mpm.contact.insync); more for what meets."""
    from mpm.contact.outlook import near_shares

    parts = [experiment.materials[body.material] for body in experiment.bodies.values()]
    settles = any(part.flow is not None for part in parts) or any(load.drag is not None for load in experiment.loads)
    found = list(near_shares(scene, experiment.time.end / experiment.time.scale, sound, settles))
    if not (share := max((part for part, _ in found), default=0.0)):
        return 0.0
    finer = (particles / sum(len(body.particles.m) for body in scene.wholes)) ** (1 - 1 / experiment.grid.directions)
    pieces, met = finer * int(scene.meeting.touching.first[-1]), finer * sum(part * some for part, some in found)
    each = share * (ALONE["near"] + pieces * SKIN) + met * MET
    return (steps + 2 * outputs(experiment)) * each + outputs(experiment) * share * ALONE["synced"]


def estimate_moving(experiment) -> dict:
    """Particles are sampled (not run) for the limits of the first step: LOOKED of each body at most, as the limits do not depend on how many there are.

    But the fastest particle of a body that turns: it lies up to half a larger cell nearer to the axis.
    """
    from mpm.boundary import extents
    from mpm.integrate.timestep import WAVE
    from mpm.scene.build import build
    from mpm.simulation import Clock
    from mpm.total.drive import present_limits

    particles = count_particles(experiment)
    scene = build(experiment, most=math.inf if particles <= LOOKED else LOOKED)
    now = present_limits(scene, Clock(scene))
    particles = sum(len(body.particles.m) for body in scene.wholes) if particles <= LOOKED else int(float(f"{particles:.3g}"))
    S = experiment.time.scale
    step = (scene.step or now.step() * scene.safety) * S
    refuse_endless(experiment, step)
    pace = min((scene.heat_step or now.pace) * S, experiment.time.end)
    sound = WAVE * scene.space.h / now.mechanical["elastic wave"]
    binds = "time.step" if scene.step else min(now.mechanical, key=now.mechanical.get)
    steps = math.ceil(experiment.time.end / min(step, pace))
    intervals = outputs(experiment) - 1
    heat_steps = intervals * math.ceil(experiment.time.end / intervals / pace * (1 - 1e-9)) if now.heat else 0
    found = {
        "particles": particles,
        "unknowns": math.prod(extents(scene.space)),
        "steps": steps,
        "seconds": moving(experiment, particles, steps, heat_steps) + meeting(experiment, scene, particles, steps, sound),
        "memory_bytes": memory(experiment),
        "output_bytes": output_bytes(experiment, particles),
        "limits": {name: limit * S for name, limit in (now.mechanical | now.heat | ({"heat pace": now.pace} if math.isfinite(now.pace) else {})).items()},
        "binds": "heat pace" if pace < step else binds,
        "physics": physics(experiment),
    }
    return found if experiment.method.mechanics == "explicit" else by_mechanics(experiment, found)


def by_mechanics(experiment, found: dict) -> dict:
    """The estimate by the mechanics that the config names or `auto` takes: implicit where explicit steps would cost WORTH times as much. And why."""
    from mpm.config.rules_mechanics import hindered

    end, step, tolerance = experiment.time.end, experiment.time.step, experiment.method.mechanics_tolerance
    steps = max(outputs(experiment) - 1, math.ceil(IMPLICIT_STEPS * (1e-4 / tolerance) ** 0.5)) if step == "auto" else math.ceil(end / step)
    steps += layers(experiment)
    seconds = LEAST["moving"] + found["particles"] * steps * IMPLICIT[experiment.grid.directions] + outputs(experiment) * ALONE["output"]
    cost, why = f"explicit {found['seconds']:.2g} s in {found['steps']} steps, implicit {seconds:.2g} s in about {steps}", ""
    if experiment.method.mechanics == "auto":
        why = hindered(experiment) or ("" if found["seconds"] > WORTH * seconds else f"explicit steps cost less than {WORTH:g} times as much")
    if why:
        return found | {"mechanics": f"explicit: {why} ({cost})"}
    named = "named" if experiment.method.mechanics == "implicit" else f"explicit steps cost more than {WORTH:g} times as much"
    binds = "error of the step" if step == "auto" else "time.step"
    return found | {"steps": steps, "seconds": seconds, "binds": binds, "mechanics": f"implicit: {named} ({cost})"}


def settled(experiment):
    """The experiment with explicit or implicit mechanics in place of `auto`, and in the frame that `method.frame: auto` begins with."""
    if not experiment.moving or experiment.grid.dimension == 0:
        return experiment
    from mpm.scene.framing import in_likely_frame

    return in_likely_frame(mechanics_settled(experiment))


def mechanics_settled(experiment):
    """The experiment with explicit or implicit mechanics in place of `auto`."""
    if experiment.method.mechanics != "auto":
        return experiment
    from mpm.config.rules_mechanics import named as in_steps

    return in_steps(experiment, estimate_moving(experiment)["mechanics"].partition(":")[0])


def estimate_rigid(experiment) -> dict:
    """The bodies' equations are set up (milliseconds), not solved. Implicit steps have no limit of stability, so accuracy binds."""
    from mpm.rigid import Method, outlook
    from mpm.scene.rigid import rigid_bodies
    from mpm.scene.shapes import shape
    from mpm.scene.still import joints

    grid, unknowns = experiment.grid, 0
    for body in experiment.bodies.values():
        lower, upper = shape(body.shape, grid.dimension).bounds()
        unknowns += math.prod(math.ceil(float(extent) / grid.cell) + 2 for extent in upper - lower)
    if unknowns > MOST_UNKNOWNS:
        said = f"{unknowns} unknowns in rigid bodies, more than {MOST_UNKNOWNS}: take a coarser grid.cell (the method is of order 2 to 3)"
        raise SceneError(("grid", "cell"), said)
    bodies, method = rigid_bodies(experiment), Method(type(experiment.method.rigid).kind)
    ahead = outlook(bodies, grid.dimension, grid.cell, end=experiment.time.end, method=method, joints=joints(experiment))
    return {
        "particles": 0,
        "unknowns": ahead["unknowns"],
        "steps": STEPS_RIGID,
        "seconds": LEAST["rigid"] + ahead["seconds"] + sum(RIGID[name] for name in ahead["methods"]) + outputs(experiment) * SHOWN,
        "memory_bytes": BYTES_PROCESS["rigid"] + ahead["memory_bytes"],
        "output_bytes": output_bytes(experiment, 0),
        "limits": ahead["limits"],
        "binds": "accuracy",
        "physics": physics(experiment),
    }
