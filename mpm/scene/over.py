"""From the total frame to the updated one within a run: what `method.frame: auto` does where a body outgrows the first (mpm.guards).

The points of the reference shape go on as particles: x, v, C, B, J, temperatures and what laws remember are carried over as they are, so mass, momentum, heat
and elastic energy are; kinetic energy is told of the particles from then on, and what the nodes held beyond that is booked as lost to the transfer.
Pieces of surface belong to the nearest point, and their F is that of the nodes there.
Fails when   a body has passed a wall already: then there is nothing to go on from, and the run begins again.
"""

import numpy as np

from mpm.boundary import extents
from mpm.integrate.traction import turn_all
from mpm.memory import arrays
from mpm.scene.build import build
from mpm.scene.contents import CutCells
from mpm.scene.total import sampled_points
from mpm.sources import acting
from mpm.state import PAD, Load, NoSource, Surface
from mpm.total.reference import gradients_at

CARRIED = ("particles", "thermal", "expansion", "setting")


def go_over(experiment, exact, before, time: float):
    """The scene of `experiment`, in the updated frame, in the state of a scene in the total frame at `time`; None where a body is beyond a wall."""
    space, h = before.space, before.space.h
    for body in before.bodies:
        size = (np.array(extents(space)[: body.particles.x.shape[1]]) - 1 - 2 * PAD) * h
        if np.any(body.particles.x < 0) or np.any(body.particles.x > size):
            return None
    cuts = {name: as_cells(experiment, name) for name in before.names}
    after = build(experiment, exact, points=cuts)
    for old, new, reference, around in zip(before.bodies, after.bodies, before.references, after.surroundings, strict=True):
        carry(space, old, new, reference, time)
        if around is not None:
            around.write(space, new, time, 0.0)
    after.threads, after.watch, after.outlines, after.facts = before.threads, before.watch, before.outlines, before.facts
    return after


def as_cells(experiment, name: str) -> CutCells:
    """The points of a body in the total frame as cut cells, with its points of surface as pieces."""
    from scipy.spatial import cKDTree

    X, V, surface, *_ = sampled_points(experiment, name)
    return CutCells(V, X, np.arange(len(X)), cKDTree(X).query(surface.x)[1], surface.w, surface.x, surface.normal, surface.side)


def carry(space, old, new, reference, time: float) -> None:
    """The state of a body, on the same points."""
    found, D = arrays(old), reference.X.shape[1]
    for path, array in arrays(new).items():
        if path.partition(".")[0] in CARRIED:
            array[...] = found[path]
    F = np.eye(D) + gradients_at(space, reference, reference.X)[0]
    if isinstance(new.surface, Surface):
        some = new.surface.row >= 0
        new.surface.F[new.surface.row[some]] = F[some]
    for one in acting(new.source):
        if not isinstance(one, NoSource):
            one.t[:] = time
        if isinstance(one, Load):
            one.F[:] = F
            turn_all(one, new.particles.J, D)
