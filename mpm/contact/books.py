"""What walls, tools and bodies do to each other, for the records: mean force, torque and area in touch since the last record, and heat since the start."""

import numpy as np

from mpm.contact.found import BODY
from mpm.state import Thermal


def series(met, axes: tuple[str, ...], since: float, span: float, time: float):
    """(dataset name, value) of every obstacle that is met; what was gathered starts anew. Since the last record impulses have acted for `since`, and bodies
    have moved for `span`, up to `time` [s]; the two differ by half a step in the first record.

        force    on bodies by a wall or tool; on the first of a pair by the second
        travel   of a tool since the start
    torque   of that force about a tool's centre, and about the origin of coordinates else
    """
    touching, B = met.touching, len(met.names)
    part, share = (1.0 / one if one > 0.0 else 0.0 for one in (since, span))
    for k, (side, tool) in enumerate([*((side, None) for side in met.sides), *((None, name) for name in met.tool_names)]):
        at = k if tool is None else BODY + B + k - len(met.sides)
        if tool is None and not (met.stops.reshape(B, 6)[:, k] >= 0).any():
            continue
        yield from obstacle_series(side or tool, axes, part * touching.pushed[:, at].sum(axis=0), part * touching.turned[:, at].sum(axis=0),
                        share * touching.spread[:, at].sum())  # fmt: skip
        if tool is not None:
            moved = met.drive.displacement(met.tool_names.index(tool), time)
            yield from ((f"travel_{tool}_{axis}", moved[k]) for k, axis in enumerate(axes))
    for a in range(B):
        for b in range(a + 1, B):
            both = f"{met.names[a]}_{met.names[b]}"
            if met.pairs[a, b] >= 0:
                area = 0.5 * share * (touching.spread[a, BODY + b] + touching.spread[b, BODY + a])
                yield from obstacle_series(both, axes, part * touching.pushed[a, BODY + b], part * touching.turned[a, BODY + b], area)
            if isinstance(met.bodies[a].thermal, Thermal) and isinstance(met.bodies[b].thermal, Thermal):
                yield f"heat_{both}", met.passed[a, b]
    for gathered in (touching.pushed, touching.turned, touching.spread, touching.deepest):
        gathered[:] = 0.0


def obstacle_series(name: str, axes, force, torque, area):
    """The series of one obstacle. There is a torque in a plane and in space; about the axis of a round body there is none."""
    for k, axis in enumerate(axes):
        yield f"force_{name}_{axis}", force[k]
    if "r" not in axes:
        for k, axis in enumerate({2: ("z",), 3: ("x", "y", "z")}.get(len(axes), ())):
            yield f"torque_{name}_{axis}", torque[2 if len(axes) == 2 else k]
    yield f"area_{name}", area


def passed(links, heat, B: int) -> np.ndarray:
    """Heat (B, B) that each body took in from each other one, from that through each link [J]."""
    found = np.zeros((B, B))
    np.add.at(found, (links.body[:, 0], links.body[:, 1]), -heat)
    np.add.at(found, (links.body[:, 1], links.body[:, 0]), heat)
    return found
