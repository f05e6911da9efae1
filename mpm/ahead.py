"""The large kernels of a scene that is not in the cache, compiled at once on two cores before its run begins."""

import json
import math
import os
import subprocess
import sys

from mpm import compiling
from mpm.contact.block import advance_block, push, reach
from mpm.contact.outlook import near_shares
from mpm.costs import settled
from mpm.records.provenance import cores
from mpm.scene.build import build
from mpm.simulation import Clock, work_arrays
from mpm.total.drive import advance_references, present_limits
from mpm.warming import warm_bodies

WORTH_A_PROCESS = 5.0  # s of compiling from which another process, which starts in 1 to 2 s, saves time
BESIDE = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from mpm import ahead
from mpm.config import restore
getattr(ahead, sys.argv[2])(restore(json.load(sys.stdin)))
"""


def compile_ahead(experiment) -> None:
    """Where a scene needs two large kernels, neither is in the cache and a second core idles: compile both at once.

    A process of its own compiles the step of bodies that touch, where they will and do not yet, else the heat step; this one the mechanical step. Later calls
    find both in the cache.
    """
    if not core_to_spare() or not experiment.moving or experiment.grid.dimension == 0 or compiling.expected(experiment) < WORTH_A_PROCESS:
        return
    if getattr(experiment.model, "kind", "full") == "auto" or experiment.method.mechanics != "explicit":
        return
    experiment = settled(experiment)
    scene, clock = at_start(experiment)
    heat = any(material.heat is not None for material in experiment.materials.values())
    kernel, compile_it = ("advance_touching", "compile_touching") if meets_later(scene, clock) else ("heat_chebyshev", "compile_heat")
    if kernel == "heat_chebyshev" and not heat:
        return
    beside = [sys.executable, "-P", "-c", BESIDE, json.dumps(sys.path), compile_it]
    helper = subprocess.Popen(beside, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True)
    try:
        helper.stdin.write(json.dumps(experiment.resolved()))
        helper.stdin.close()
        compile_step(scene, clock)
        compiling.spent.wait(kernel, helper)
    except OSError:  # the helper has died: its kernel is compiled when it is called
        return
    finally:
        if helper.poll() is None:
            helper.kill()
            helper.wait()


def core_to_spare() -> bool:
    """Whether a second core has had nothing to do for the last minute: compiling twice what two kernels share gains nothing where all are busy."""
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0  # Windows has none
    return busy < cores() - 1


def at_start(experiment):
    scene = build(experiment)
    return scene, Clock(scene)


def meets_later(scene, clock) -> bool:
    """Whether something falls on something during the run that is not near at its start."""
    if scene.meeting is None or scene.references or scene.meeting.near(reach(scene, clock, present_limits(scene, clock).step()), 0.0):
        return False
    return any(share > 0.0 for share, _ in near_shares(scene, float(scene.times[-1]), math.inf, True))


def compile_step(scene, clock) -> None:
    """Compile the mechanical step, by a block of no steps."""
    (advance_references if scene.references else advance_block)(scene, clock, work_arrays(scene), present_limits(scene, clock).step(), 0)


def compile_touching(experiment) -> None:
    """Compile the mechanical step of bodies that touch, by a block of no steps."""
    scene, clock = at_start(experiment)
    dt, clock.touching = present_limits(scene, clock).step(), True
    if scene.course is not None:
        scene.course.lay(scene, 0.0, dt, 0, 1.0)
    if scene.inflow is not None:
        scene.inflow.lay(0.0, 0.0)
    push(scene, clock, work_arrays(scene), dt, dt, 0, dt, clock.reports)


def compile_heat(experiment) -> None:
    """Compile the heat step, by one of the pace that a run begins with."""
    scene, clock = at_start(experiment)
    now = present_limits(scene, clock)
    warm_bodies(scene, clock, work_arrays(scene), 0.0, min(scene.heat_step or now.pace, float(scene.times[1])), now)
