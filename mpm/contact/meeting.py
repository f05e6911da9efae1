"""What meets in a scene, and when its steps have to look for it: made where a scene is built, asked before every block of steps."""

import math
from dataclasses import dataclass, field

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.boundary.blocks import new_blocks
from mpm.contact.conduct import FIELDS, conduct_together
from mpm.contact.links import PERFECT, find_links
from mpm.contact.spots import seen
from mpm.contact.step import Touching, advance_touching
from mpm.integrate.timestep import conductance
from mpm.jit import kernel
from mpm.lanes import aligned
from mpm.outcome import UNPREPARED
from mpm.state import PAD, Surface, Thermal
from mpm.transfer import columns, wants_change

SLACK = 0.15  # cells beyond which nothing acts: gaps closer than SURE are in the sweeps


@dataclass
class Meeting:
    """Which bodies meet which walls and each other, with what friction; arrays of every piece."""

    space: object
    bodies: tuple
    walls: np.ndarray  # (B, 3, 2) kinds for each body: mirrors where it started at one, CONTACT elsewhere
    stops: np.ndarray  # (B, 3, 2)
    pairs: np.ndarray  # (B, B)
    fields: np.ndarray  # (B,)
    links: np.ndarray  # (B, B) conductance of pairs [W/(m2 K)], inf: none in the way, 0: no heat
    touching: Touching = field(init=False)
    warms: bool = False  # whether heat passes by touch
    unforeseen: tuple[int, int] | None = field(default=None, init=False)
    left: float = field(default=-1.0, init=False)  # how far anything may still move before something can be near [m]
    buffers: tuple | None = field(default=None, init=False)
    scratch: np.ndarray | None = field(default=None, init=False)

    def __post_init__(self):
        B, D, n = len(self.bodies), directions(self.space), math.prod(extents(self.space))
        first = np.cumsum([0, *(len(body.surface.owner) if isinstance(body.surface, Surface) else 0 for body in self.bodies)])
        met = np.concatenate([(self.stops >= 0).any(axis=0).ravel(), (self.pairs >= 0).any(axis=0)])
        rows = np.where(met, np.cumsum(met) - 1, 0)
        R, P, F = max(int(met.sum()), 1), int(first[-1]), int(self.fields.max()) + 1
        walls = np.stack([self.walls[self.fields == f].min(axis=0) for f in range(F)])  # a group is a mirror's where one of it is
        self.touching = Touching(first, self.fields, walls, self.stops, self.pairs, rows, np.zeros((P, R, D)), np.zeros((P, R)), np.zeros((B, 6 + B, D)),
                                 np.zeros(1), np.full(n, -1), np.array([P // 4 + 64]))  # fmt: skip

    def memory(self) -> dict:
        """What a run that goes on needs (mpm.memory)."""
        kept = ("warm", "touched", "pushed", "deepest")
        return {name: getattr(self.touching, name) for name in kept} | {"left": self.left}

    def recall(self, found: dict) -> None:
        """As it was when `memory` was kept."""
        self.left = found["left"]
        for name in ("warm", "touched", "pushed", "deepest"):
            getattr(self.touching, name)[...] = found[name]

    def touched(self, b: int, side: int) -> np.ndarray:
        """Time in touch of the pieces of body b with wall `side` (2 axis + side): a view (pieces,) [s]."""
        first = self.touching.first
        if self.stops[b, side // 2, side % 2] < 0:
            return np.zeros(first[b + 1] - first[b])
        return self.touching.touched[first[b] : first[b + 1], self.touching.rows[side]]

    def warmed(self) -> None:
        """A heat step is over."""
        self.touching.touched[:] = 0.0

    def heat_links(self, walls, dt: float):
        """Where heat passes between bodies in the heat step of dt that is over; None where it does not. walls (B, 3, 2): mirrors of temperature."""
        if not self.links.any():
            return None
        most = np.array([conductance(body.thermal)[0] if isinstance(body.thermal, Thermal) else 0.0 for body in self.bodies])
        H = np.minimum(self.links, PERFECT / self.space.h * np.maximum(most[:, None], most[None]) * (np.minimum(most[:, None], most[None]) > 0))
        found = find_links(self.space, self.bodies, self.touching, walls, H, dt)
        return found if len(found.rate) else None

    def conduct(self, scene, walls, links, dt: float):
        """The heat step of all bodies that `links` join: see conduct_together; and which they are. walls: mirrors of each body's temperature."""
        if self.scratch is None:
            self.scratch = np.zeros((len(self.bodies), FIELDS, math.prod(extents(self.space))))
        which, method = np.unique(links.body), (scene.heat.order, scene.heat.tolerance, scene.blend, scene.affine)
        return which, conduct_together(self.space, scene.bodies, which, self.scratch, walls, links, dt, *method)

    def near(self, travel: float) -> bool:
        """Whether anything may be near while no particle moves farther than `travel` [m]."""
        if self.left < travel:
            self.left, self.unforeseen = self.distance()
        return self.left < travel

    def distance(self) -> tuple[float, tuple[int, int] | None]:
        """How far a particle may move before anything acts [m]; (UNPREPARED, body) where a body that has no pieces to meet by is that near.

        A wall acts on pieces, a mirror that another body stands at on nodes, other bodies on nodes.
        """
        h, D, found, unforeseen = self.space.h, directions(self.space), [math.inf], None
        boxes, sight = [box(body.particles.x) for body in self.bodies], seen(self.space) + SLACK
        for b, (low, high) in enumerate(boxes):
            for axis, side in np.argwhere(self.walls[b, :D] == CONTACT):
                far = (extents(self.space)[axis] - 1 - 2 * PAD) * h - high[axis] if side else low[axis]
                mirrored = (self.walls[:, axis, side] < CONTACT).any()
                margin = max(skin_depth(self.bodies[b], h), 0.5 * sight * h if mirrored else 0.0)
                found.append(far - margin)
                if far < margin and self.stops[b, axis, side] < 0 and self.touching.walls[self.fields[b], axis, side] == CONTACT:
                    unforeseen = UNPREPARED, b
            for c in range(b):
                if self.fields[b] != self.fields[c]:
                    apart = float(np.max(np.maximum(low - boxes[c][1], boxes[c][0] - high)))
                    found.append(0.5 * (apart - sight * h))
                    if found[-1] < 0 and self.pairs[b, c] < 0:
                        unforeseen = UNPREPARED, b
        return min(found), unforeseen

    def advance(self, scene, nodes, force, boxes, blocks, dt: float, kick: float, ahead: float, steps: int, begun: int, sound: float,
                reports) -> None:  # fmt: skip
        """One block of steps in which something may be near."""
        if len(self.touching.walls) > 1:
            nodes, force, boxes, blocks = self.apart(scene)
        else:
            nodes, force, boxes, blocks = nodes[None], force[None], boxes[None], blocks[None]
        advance_touching(scene.space, scene.gradient, scene.scheme, scene.bodies, self.touching, nodes, force, boxes, blocks, scene.gravity, dt, kick,
                         ahead, steps, begun, sound, reports)  # fmt: skip

    def apart(self, scene):
        """Nodes of every field, once something is near."""
        if self.buffers is None:
            F, n, D = len(self.touching.walls), math.prod(extents(self.space)), directions(self.space)
            dtype, rows = self.bodies[0].particles.x.dtype, n if wants_change(scene.scheme) else 0
            marks = np.stack([new_blocks(n) for _ in range(F)])
            self.buffers = (aligned((F, 2, n, columns(D)), dtype), aligned((F, 2, rows, columns(D)), dtype), np.zeros((F, 2, 3, 2), np.int64), marks)
        return self.buffers


def skin_depth(body, h: float) -> float:
    """How far before a wall a particle may stand whose pieces it may touch [m]; a cell where it has none."""
    if not isinstance(body.surface, Surface):
        return h
    stretch = np.abs(body.surface.F).sum(axis=2).max(initial=1.0)
    return SLACK * h + float(stretch * np.linalg.norm(body.surface.offset, axis=1).max(initial=0.0))


@kernel
def bounds(x, low, high):
    """Smallest and largest coordinates."""
    for p in range(x.shape[0]):
        for a in range(x.shape[1]):
            low[a], high[a] = min(low[a], x[p, a]), max(high[a], x[p, a])


def box(x) -> tuple[np.ndarray, np.ndarray]:
    """(lowest, highest) of positions."""
    low, high = np.full(x.shape[1], np.inf), np.full(x.shape[1], -np.inf)
    bounds(x, low, high)
    return low, high
