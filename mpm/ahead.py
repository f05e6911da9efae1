"""The large kernels of a scene that is not in the cache, compiled at once on two cores before its run begins."""

import json
import os
import subprocess
import sys

from mpm import compiling
from mpm.contact.block import advance_block
from mpm.costs import settled
from mpm.outcome import COMPLETED, outcome
from mpm.records.provenance import cores
from mpm.scene.build import build
from mpm.simulation import Clock, work_arrays
from mpm.total.drive import advance_references, present_limits
from mpm.warming import warm_bodies

WORTH_A_PROCESS = 5.0  # s of compiling from which another process, which starts in 1 to 2 s, saves time
BESIDE = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from mpm.ahead import compile_heat
from mpm.config import restore
compile_heat(restore(json.load(sys.stdin)))
"""


def compile_ahead(experiment) -> None:
    """Where a scene needs two large kernels, neither is in the cache and a second core idles: compile both at once.

    A process of its own compiles the heat step, this one the mechanical step; later calls find both in the cache. The step of bodies that touch, which has
    much of the mechanical step in it, gains nothing that way: the cube took 38 s of processor for 28, and as long (`.ci/compile_times.py`, at a952445).
    """
    if not core_to_spare() or not experiment.moving or experiment.grid.dimension == 0 or compiling.expected(experiment) < WORTH_A_PROCESS:
        return
    if getattr(experiment.model, "kind", "full") == "auto" or experiment.method.mechanics == "auto":
        return
    if not any(material.heat is not None for material in experiment.materials.values()):
        return
    experiment = settled(experiment)
    beside = [sys.executable, "-P", "-c", BESIDE, json.dumps(sys.path)]
    helper = subprocess.Popen(beside, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True)
    try:
        helper.stdin.write(json.dumps(experiment.resolved()))
        helper.stdin.close()
        compile_step(experiment)
        compiling.spent.wait("heat_chebyshev", helper)
    except OSError:  # the helper has died: the heat step is compiled when it is called
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


def compile_step(experiment) -> None:
    """Compile the mechanical step, by a block of no steps; an implicit one by the first that a run tries, without heat."""
    scene, clock = at_start(experiment)
    if scene.implicit is not None:
        from mpm.implicit.drive import first_pair  # scipy, which explicit runs do without

        first_pair(scene, clock, work_arrays(scene), lambda *_: outcome(COMPLETED))
        return
    (advance_references if scene.references else advance_block)(scene, clock, work_arrays(scene), present_limits(scene, clock).step(), 0)


def compile_heat(experiment) -> None:
    """Compile the heat step, by one of the pace that a run begins with."""
    scene, clock = at_start(experiment)
    now = present_limits(scene, clock)
    warm_bodies(scene, clock, work_arrays(scene), 0.0, min(scene.heat_step or now.pace, float(scene.times[1])), now)
