"""`method.frame: auto`: total where a body keeps its neighbours, updated where it flows, meets or tears.

choice     before a run, from the config alone: what the total frame refuses, or whether the body may flow (upper estimates of stress against yield)
the run    begins in the total frame. Where the body outgrows it (mpm.guards: MODERATE strain, a wall on which it did not lie) the run goes over to the updated
           frame and on (mpm.scene.over); where it cannot, or ends early, the point is run again from its start there
Fails when: a body that lies on a wall would lift off it: the total frame holds it there (docs/frames.md).
"""

from typing import Any

from mpm.config.rules_frame import hindered, named
from mpm.scene.groups import loads
from mpm.scene.scales import scales

CALM = "nothing in the config makes it flow or meet"


def choice(experiment: Any) -> tuple[str, str]:
    """(total or updated, why)."""
    if why := hindered(experiment):
        return "updated", why
    may = [one.name for one in scales(experiment).values() if one.M is not None and max(loads(experiment, one)) >= 1]
    return ("updated", f"{may[0]} may flow") if may else ("total", CALM)


def in_likely_frame(experiment: Any) -> Any:
    """The experiment in the frame that `auto` begins with; as it is where the config names one."""
    return named(experiment, choice(experiment)[0]) if experiment.method.frame == "auto" else experiment
