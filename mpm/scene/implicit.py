"""How a scene that asks for implicit mechanics begins (mpm.implicit)."""

import numpy as np

from mpm.boundary import directions
from mpm.integrate.strain import REPORT
from mpm.integrate.timestep import limits

FIRST = 0.01  # of a run: its first step, at most an output interval and the pace of explicit heat steps


def kinks(experiment, met) -> tuple[float, ...]:
    """Times at which a tool goes another way, comes or leaves: a step of seconds ends there. Explicit ones pass over, but where a force sets in or ends."""
    if met is None or met.drive is None:
        return ()
    told = met.drive.told if experiment.method.mechanics == "implicit" else [one for one in met.drive.told if one.light]
    return tuple(sorted({float(when) for one in told for when in (*one.times, *one.turning, *one.there) if 0 < when < experiment.time.end}))


def implicit(experiment, space, bodies, references, met, times):
    """The Implicit of a scene; None where its mechanics is explicit, and then nothing of it is loaded."""
    if experiment.method.mechanics != "implicit":
        return None
    from mpm.implicit.drive import Implicit

    size = float(np.max(np.ptp(bodies[0].particles.x, axis=0)))
    first = min(experiment.time.step, times[1]) if experiment.time.step != "auto" else None
    if first is None:
        pace = limits(space, directions(space), bodies, np.zeros((len(bodies), REPORT))).pace
        first = min(FIRST * times[-1], times[1], pace)
    return Implicit(experiment.method.mechanics_tolerance, size, float(first), references[0].walls if references else met.walls[0])
