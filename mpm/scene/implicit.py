"""How a scene that asks for implicit mechanics begins (mpm.implicit)."""

import numpy as np

from mpm.boundary import directions
from mpm.integrate.strain import REPORT
from mpm.integrate.timestep import limits

FIRST = 0.01  # of a run: its first step, at most an output interval and the pace of explicit heat steps


def implicit(experiment, space, bodies, met, times):
    """The Implicit of a scene; None where its mechanics is explicit, and then nothing of it is loaded."""
    if experiment.method.mechanics != "implicit":
        return None
    from mpm.implicit.drive import Implicit

    size = float(np.max(np.ptp(bodies[0].particles.x, axis=0)))
    first = experiment.time.step
    if first == "auto":
        pace = limits(space, directions(space), bodies, np.zeros((len(bodies), REPORT))).pace
        first = float(min(FIRST * times[-1], times[1], pace))
    return Implicit(experiment.method.mechanics_tolerance, size, first, met.stops[0], met.walls[0])
