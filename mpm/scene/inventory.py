"""What a config holds, from the config alone: the physics that is compiled and what is absent, the bytes that a point writes."""

import math
from collections.abc import Iterator
from itertools import combinations

from mpm.config.boundary import EXCHANGES
from mpm.config.laws import sets
from mpm.config.loads import LOADS
from mpm.config.sources import KINDS as SOURCES

MANY = 10  # pairs of bodies that are told one by one


def physics(experiment) -> dict[str, list[str]]:
    """What is compiled for this config, and what is absent."""
    present: set[str] = set()
    for material in experiment.materials.values():
        for part in ("elastic", "flow", "heat", "expansion"):
            law = getattr(material, part)
            if law is not None:
                present.add(f"{part}: {type(law).kind}")
        if setting := sets(material):
            present.add(f"setting: {', '.join(name for *_, name in setting)}")
        if material.heating is not None:
            present |= {f"heating: {part}" for part in ("elastic", "dissipation") if getattr(material.heating, part) is not None}
    present |= {f"exchange: {kind}" for kind in EXCHANGES for entry in experiment.surfaces if getattr(entry, kind) is not None}
    present |= {"exchange: hot wall"} if any(wall.heat is not None for wall in experiment.walls.values()) else set()
    present |= {f"load: {kind}" for kind in LOADS for entry in experiment.loads if getattr(entry, kind) is not None}
    present |= {f"source: {kind}" for kind in SOURCES for entry in experiment.sources if getattr(entry, kind) is not None}
    present |= {f"inflow: {name}" for name, body in experiment.bodies.items() if body.inflow is not None}
    steady = all(isinstance(one, float) for one in experiment.gravity or ())
    present |= {"gravity" if steady else "gravity: over time"} if experiment.gravity is not None else set()
    far = apart(experiment)
    present |= set(pairs(experiment, far)) | {f"tool: {name}, {tool_in_words(tool)}" for name, tool in experiment.tools.items()}
    said = {text.split(":")[0] for text in present}
    parts = ("elastic", "flow", "heat", "expansion", "heating", "exchange", "source", "load", "gravity")
    never = [f"contact of {one} and {other}, which nothing brings together" for one, other in far]
    never = never if len(never) <= MANY else [f"contact of {len(never)} pairs that nothing brings together"]
    return {"compiled": sorted(present), "absent": [part for part in parts if part not in said] + never}


def tool_in_words(tool) -> str:
    """How a tool moves."""
    motion = tool.motion
    ways = [key for key in ("velocity", "path", "force", "spin") if getattr(motion, key) is not None]
    return f"{tool.shape.kind}, {'moves by ' + ' and '.join(ways) if ways else 'stands'}{', exchanges heat' if tool.heat is not None else ''}"


def pairs(experiment, far: list[tuple[str, str]]) -> list[str]:
    """How every two bodies meet where any moves, but those `far` off, or touch where none does; their number where they are more than MANY."""
    known = {frozenset(pair.between): pair for pair in experiment.contacts}
    moving = [name for name, body in experiment.bodies.items() if experiment.materials[body.material].elastic is not None]
    found = []
    for two in combinations(experiment.bodies if moving else (), 2):
        if two in far:
            continue
        pair, warm = known.get(frozenset(two)), all(experiment.materials[experiment.bodies[name].material].heat is not None for name in two)
        rubs = "slide" if not pair or not pair.friction else f"rub ({pair.friction:g})" if isinstance(pair.friction, float) else "rub (over time)"
        slides = "are welded" if pair and pair.welded else "do not slide" if pair and pair.stick else rubs
        free = pair is None or pair.conductance in (None, math.inf)
        passes = "and pass heat freely" if free else f"and pass heat ({pair.conductance:g} W/m2K)" if pair.conductance else "without heat"
        one, other = (name if name in moving else f"{name} (stands still)" for name in two)
        found.append(f"contact: {one} and {other} {slides}{' ' + passes if warm else ''}{'' if pair else ' (not named)'}")
    if not moving and len(experiment.bodies) > 1 and experiment.grid.dimension != 0:
        found = at_rest(experiment, known)
    return found if len(found) <= MANY else [f"contact: {len(found)} pairs of bodies, {len(known)} of them named"]


def apart(experiment) -> list[tuple[str, str]]:
    """The pairs of bodies that move, or of which one does, and that nothing brings near each other within the run."""
    names, bodies = list(experiment.bodies), experiment.bodies.values()
    if len(names) < 2 or not experiment.moving or all(experiment.materials[body.material].elastic is None for body in bodies):
        return []
    from mpm.scene.meeting import out_of_reach, reaches  # needs numba

    _, boxes, travels = reaches(experiment)
    return [(names[b], names[c]) for b, c in combinations(range(len(names)), 2)
            if out_of_reach((boxes[b], boxes[c]), (travels[b], travels[c]), experiment.grid.cell)]  # fmt: skip


def at_rest(experiment, known) -> list[str]:
    """What passes between bodies that do not move and touch."""
    from mpm.scene.still import joints

    names, found = list(experiment.bodies), []
    for joint in joints(experiment):
        two, H = (names[joint.first], names[joint.second]), joint.conductance
        passes = "pass heat freely" if math.isinf(H) else f"pass heat ({H:g} W/m2K)" if H else "pass no heat"
        found.append(f"contact: {two[0]} and {two[1]} touch and {passes}{'' if frozenset(two) in known else ' (not named)'}")
    return found


def swollen(experiment, name: str) -> float:
    """How many times the volume of its shape a body comes to."""
    if experiment.bodies[name].inflow is None:
        return 1.0
    from mpm.scene.inflow import column  # needs numba

    found = column(experiment, name)
    return found.length / found.nozzle


def layers(experiment) -> int:
    """Of all that flows in: steps end where one comes in."""
    from mpm.scene.inflow import column

    flowing = (column(experiment, name) for name, body in experiment.bodies.items() if body.inflow is not None)
    return sum(round(found.length * experiment.method.particles / experiment.grid.cell) for found in flowing)


def beginnings(experiment) -> Iterator[tuple[str, float]]:
    """(path in the config, time from which it acts [s])."""
    for section in ("surfaces", "contacts", "sources", "loads"):
        yield from ((f"{section}.{index}", getattr(entry, "from")) for index, entry in enumerate(getattr(experiment, section)))
    yield from ((f"walls.{side}", getattr(wall, "from")) for side, wall in experiment.walls.items())
    for name, tool in experiment.tools.items():
        yield from ((f"tools.{name}", getattr(tool, "from")), (f"tools.{name}.motion", getattr(tool.motion, "from")))
    yield from ((f"bodies.{name}.inflow", getattr(body.inflow, "from")) for name, body in experiment.bodies.items() if body.inflow is not None)
    yield from ((f"loading.{index + 1}", stage.until) for index, stage in enumerate(experiment.loading[:-1]))


def ticks(end: float, every: float) -> int:
    """How many times are 0, every, 2 every, ..., end."""
    return max(1, math.ceil(end / every * (1 - 1e-9))) + 1


def output_bytes(experiment, particles: int) -> int:
    """Bytes of a point's file: series in float64, snapshots in float32 (grid) and float64 (particles), before compression."""
    samples = ticks(experiment.time.end, experiment.output.every)
    size = 4_000 + samples * 8 * (28 + len(experiment.output.probes))
    snapshots = experiment.output.snapshots
    if snapshots is not None:
        frames = ticks(experiment.time.end, snapshots.every)
        nodes = math.prod(round(s / experiment.grid.cell) + 1 for s in experiment.grid.size)
        numbered = 8 if snapshots.particles else 0  # body and id
        size += frames * (4 * nodes * len(snapshots.grid) + particles * (16 * len(snapshots.particles) + numbered))
    return size
