"""One step of dt and two of half of it, both of order 1, make one of order 2: y = 2 y_2 - y_1 (L. F. Richardson, Phil. Trans. R. Soc. A 210 (1911) 307).

Of all that particles carry: positions, velocities and slopes, elastic strain, volume, F, temperatures by their enthalpy (so the heat ledger stays exact
through latent heat; what passes the bounds of its data is moved to its neighbours), latches and degrees of setting within their bounds; and of the run's sums.
Fails when   what is extrapolated is inverted: its error is infinite, and the step is cut.
"""

import numpy as np

from mpm.contact.tools import Tools
from mpm.implicit.lasting import recover
from mpm.integrate.bounds import bounds_of, keep_between
from mpm.jit import kernel
from mpm.materials import enthalpy, temperature_of
from mpm.memory import arrays
from mpm.state import Setting, Softening

CARRIED = ("x", "v", "C", "B", "J", "c", "F", "X", "k", "most")
ON_NODES = ("u", "v", "plastic", "T")  # in the total frame
SUMS = ("exchanged", "given", "local", "dissipated", "repaired", "unrepaired", "worked", "swelled", "softened")
BOOKS = ("pushed", "turned", "spread", "worked", "rubbed")  # of what walls and tools do (mpm.contact.step.Touching)
STILL = 1e-3  # K: a span of temperatures below which nothing is warmer than anything
WARMER = 0.1  # weight of the error of temperature, over the span of temperatures so far, beside that of shape over the body's size


@kernel
def hotter(alpha, theta, once, zero):
    """theta <- that of twice its enthalpy less that of `once`, less zero [K]."""
    for i in range(theta.shape[0]):
        h = 2.0 * enthalpy(alpha, zero + theta[i]) - enthalpy(alpha, zero + once[i])
        theta[i] = temperature_of(alpha, h, zero + theta[i]) - zero


def latched(expansion):
    """The Latched of an expansion that has one."""
    return expansion.inner if isinstance(expansion, Softening) else expansion


def upright(body) -> bool:
    """Whether no particle is inverted: J > 0, and b positive."""
    B = np.zeros((len(body.particles.J), 6))
    B[:, : body.particles.B.shape[1]] = body.particles.B
    B[:, :3] += 1.0
    b1, b2, b3, xy, yz, xz = B.T
    plane = b1 * b2 - xy * xy
    whole = b3 * plane - b1 * yz * yz - b2 * xz * xz + 2 * xy * yz * xz
    return bool(min(map(np.min, (body.particles.J, b1, b2, b3, plane, whole))) > 0)


def everything(scene) -> dict[str, np.ndarray]:
    """Every array that a step may change: of bodies, and of their nodes in the total frame."""
    return arrays(scene.bodies) | arrays(scene.references, "nodes")


def extrapolate(scene, clock, work, once: tuple, start: tuple) -> float:
    """The state after two half steps becomes that of order 2, with `once` after one whole step and `start` before both; returns the error of the step."""
    (first, past, met), (before, *_), body, now = once, start, scene.bodies[0], everything(scene)
    theta, bounds, gap = now.get("0.thermal.theta"), None, now["0.particles.x"] - first["0.particles.x"]
    error = float(np.sqrt(np.mean(np.sum(gap * gap, axis=1)))) / scene.implicit.size
    if theta is not None:
        gap, seen = theta - first["0.thermal.theta"], clock.seen[0]
        bounds = bounds_of(body, seen)
        error = max(error, WARMER * float(np.sqrt(np.mean(gap * gap))) / max(seen[1] - seen[0], STILL))
        hotter(body.thermal.alpha, theta, first["0.thermal.theta"], body.thermal.zero)
    for name in SUMS:
        setattr(clock, name, 2 * getattr(clock, name) - past[name])
    for name in BOOKS if met is not None else ():
        array = getattr(scene.meeting.touching, name)
        array += array - met[name]
    if met is not None and isinstance(tools := scene.meeting.touching.tools, Tools):
        free = tools.light > 0
        for name, array in scene.meeting.free().items():
            array[free] += array[free] - met[name][free]
    for path, array in now.items():
        if path.rpartition(".")[2] in (ON_NODES if path.startswith("nodes") else CARRIED):
            array += array - first[path]
            if path.endswith(".most"):
                np.clip(array, before[path], latched(body.expansion).set, out=array)
    if scene.references:
        recover(scene.space, body, scene.references[0], scene.implicit.lasting)
    if isinstance(body.setting, Setting):
        np.clip(body.setting.X, before["0.setting.X"], 1.0, out=body.setting.X)
    if bounds is not None and scene.repair:
        walls, around = scene.walls if scene.meeting is None else scene.meeting.walls[0], scene.surroundings[0]
        mirrors = walls if around is None else around.mirrors(scene.space, body, walls)
        moved, left = keep_between(scene.space, body, work.rows, mirrors, *bounds)
        clock.repaired, clock.unrepaired = clock.repaired + moved, clock.unrepaired + left
    return error if upright(body) else np.inf
