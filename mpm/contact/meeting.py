"""What meets in a scene, and when its steps have to look for it: made where a scene is built, asked before every block of steps."""

import math
from dataclasses import dataclass, field

import numpy as np

from mpm.boundary import CONTACT, directions, extents
from mpm.boundary.blocks import new_blocks
from mpm.contact import books, narrow, overlap, stretched
from mpm.contact.conduct import FIELDS, conduct_together
from mpm.contact.drive import Drive
from mpm.contact.found import BODY
from mpm.contact.held import Held, NotHeld
from mpm.contact.links import PERFECT, find_links
from mpm.contact.pairs import NoPairs, Pairs
from mpm.contact.skin import Skin, new_skin
from mpm.contact.solve import SURE
from mpm.contact.spots import seen
from mpm.contact.step import Pace, Touching, advance_touching
from mpm.contact.step_threaded import advance_touching_slabs
from mpm.contact.sums import Sums, kept, new_sums, taken_up
from mpm.contact.texture import texture
from mpm.contact.tools import NoTools
from mpm.integrate.heat_step import Back
from mpm.integrate.step_parts import Grids, method_of
from mpm.integrate.strain import SPEED
from mpm.integrate.timestep import conductance
from mpm.jit import kernel
from mpm.lanes import aligned
from mpm.outcome import UNPREPARED
from mpm.state import PAD, Surface, Thermal
from mpm.transfer import columns, wants_change

SLACK = 0.15  # cells beyond which nothing acts: gaps closer than SURE are in the sweeps
KEPT = ("warm", "touched", "pushed", "turned", "spread", "deepest", "worked", "rubbed", "parted")  # of Touching, by a run that goes on


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
    names: tuple[str, ...] = ()
    sides: tuple[str, ...] = ()  # names of walls by number
    drive: Drive | None = None
    held: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))  # (B,) which bodies stand still; of none where all move
    touching: Touching = field(init=False)
    passed: np.ndarray = field(init=False)  # (B, B) heat that a body took in from each other since the start [J]
    hardest: np.ndarray = field(init=False)  # (B, K, 2) largest force of each body on what it meets, and how many cells it touches there (narrow.py)
    grown: np.ndarray = field(init=False)  # (B, B) by how much the surfaces of a pair that presses have grown, the smaller of the two (stretched.py)
    entered: np.ndarray = field(init=False)  # (B, K) largest overlap of each body with what it meets [m] (overlap.py)
    passing: np.ndarray = field(init=False)  # (B, B) whether heat ever passes between two bodies; links may be 0 for a while (mpm.contact.course)
    warms: bool = False  # whether heat passes by touch
    unforeseen: tuple[int, int] | None = field(default=None, init=False)
    told: float = field(default=0.0, init=False)  # up to when impulses were recorded [s]
    shown: float = field(default=0.0, init=False)  # up to when areas in touch were recorded [s]
    left: float = field(default=-1.0, init=False)  # how far anything may still move before something can be near [m]
    skin: Skin = field(init=False)  # with what is near, while little moves (find.py)
    sums: Sums = field(init=False)  # what weights want of particles, likewise
    buffers: tuple | None = field(default=None, init=False)
    scratch: np.ndarray | None = field(default=None, init=False)

    def __post_init__(self):
        B, D, n = len(self.bodies), directions(self.space), math.prod(extents(self.space))
        first = np.cumsum([0, *(len(body.surface.owner) if isinstance(body.surface, Surface) else 0 for body in self.bodies)])
        T = len(self.tool_names)
        met = np.concatenate([(self.stops >= 0).any(axis=0).ravel(), (self.pairs >= 0).any(axis=0), np.ones(T, bool)])
        rows = np.where(met, np.cumsum(met) - 1, 0)
        R, P, F = max(int(met.sum()), 1), int(first[-1]), int(self.fields.max()) + 1
        walls = np.stack([self.walls[self.fields == f].min(axis=0) for f in range(F)])  # a group is a mirror's where one of it is
        tools, K = NoTools() if self.drive is None else self.drive.tools, BODY + B + T
        pairs = Pairs(self.pairs) if B > 1 else NoPairs()
        held = Held(np.array([self.held[self.fields == f].all() for f in range(F)])) if self.stands else NotHeld()
        self.touching = Touching(first, self.fields, walls, self.stops, pairs, tools, rows, np.zeros((P, R, D)), np.zeros((P, R)), np.zeros((B, K, D)),
                                 np.zeros((B, K, 3)), *np.zeros((2, B, K)), *np.zeros((3, 1)), np.full(n, -1),
                                 np.array([P // 4 + 64]), held)  # fmt: skip
        self.passed, self.passing, self.hardest, self.grown = np.zeros((B, B)), self.links > 0, np.zeros((B, K, 2)), np.zeros((B, B))
        self.entered = np.zeros((B, K))
        self.skin, self.sums = new_skin(D, first), new_sums(self.space, B)

    @property
    def tool_names(self) -> tuple[str, ...]:
        return () if self.drive is None else tuple(one.name for one in self.drive.told)

    @property
    def stands(self) -> bool:
        """Whether any body stands still beside others that move."""
        return bool(self.held.any())

    def memory(self) -> dict:
        """What a run that goes on needs (mpm.memory)."""
        own = {name: getattr(self, name) for name in ("left", "told", "shown", "passed", "hardest", "grown", "entered")}
        return {name: getattr(self.touching, name) for name in KEPT} | own | self.free() | {"sums": kept(self.sums)}

    def free(self) -> dict:
        """What forces have done to tools."""
        return {} if self.drive is None else {"v": self.drive.tools.v, "shift": self.drive.tools.shift}

    def recall(self, found: dict) -> None:
        """As it was when `memory` was kept."""
        self.left, self.told, self.shown = found["left"], found["told"], found["shown"]
        for name in KEPT:
            getattr(self.touching, name)[...] = found[name]
        for name in ("passed", "hardest", "grown", "entered"):
            getattr(self, name)[...] = found[name]
        for name, array in self.free().items():
            array[...] = found[name]
        self.skin.left[0], self.sums = -1.0, taken_up(self.sums, found["sums"])

    def forget(self) -> None:
        """Something may have moved of which the contacts were not told."""
        self.skin.left[0], self.sums.moved[0] = -1.0, np.inf

    def touched(self, b: int, against: int) -> np.ndarray:
        """Time in touch of the pieces of body b with an obstacle (mpm.contact.found): a view (pieces,) [s]."""
        first = self.touching.first
        if against < BODY and self.stops[b, against // 2, against % 2] < 0:
            return np.zeros(first[b + 1] - first[b])
        return self.touching.touched[first[b] : first[b + 1], self.touching.rows[against]]

    def covered(self, b: int, dt: float) -> np.ndarray | None:
        """Share of the last dt for which other bodies lay on each piece of body b (pieces,); None where none did."""
        rows = [int(self.touching.rows[BODY + c]) for c in np.flatnonzero(self.pairs[b] >= 0)]
        found = self.touching.touched[self.touching.first[b] : self.touching.first[b + 1], rows].max(axis=1, initial=0.0)
        return np.minimum(found / dt, 1.0) if dt > 0.0 and found.any() else None

    @property
    def work(self) -> float:
        """Of tools on bodies since the start [J]."""
        return float(self.touching.worked[0])

    @property
    def friction(self) -> float:
        """Work that friction has taken since the start [J]."""
        return float(self.touching.rubbed[0])

    @property
    def parted(self) -> float:
        """Work that pushed apart what overlapped since the start [J]."""
        return float(self.touching.parted[0])

    def series(self, axes: tuple[str, ...], now: float, time: float):
        """(dataset name, value) of forces and heat: see mpm.contact.books. `now`: up to when impulses have acted, at positions of `time` [s]."""
        since, span, self.told, self.shown = now - self.told, time - self.shown, now, time
        narrow.look(self, since)
        overlap.look(self)
        stretched.look(self)
        return books.series(self, axes, since, span, time)

    def texture(self, tool: str, axes: tuple[str, ...], series) -> dict[str, float]:
        """Of the bites of a tool, along the direction in which it moves most."""
        axis = max(axes, key=lambda one: np.ptp(series[f"travel_{tool}_{one}"]))
        way, force = series[f"travel_{tool}_{axis}"], series[f"force_{tool}_{axis}"]
        ahead = 1.0 if abs(way.max()) > abs(way.min()) else -1.0
        return texture(ahead * force, ahead * way)

    def warmed(self) -> None:
        """A heat step is over."""
        self.touching.touched[:] = 0.0

    def heat_links(self, walls, dt: float):
        """Where heat passes between bodies in the heat step of dt that is over; None where it does not. walls (B, 3, 2): mirrors of temperature."""
        if not self.links.any():
            return None
        most = np.array([conductance(body.thermal)[0] if isinstance(body.thermal, Thermal) else 0.0 for body in self.bodies])
        H = np.minimum(self.links, PERFECT / self.space.h * np.maximum(most[:, None], most[None]) * (np.minimum(most[:, None], most[None]) > 0))
        found = find_links(self.space, self.bodies, self.touching, new_skin(directions(self.space), self.touching.first), walls, H, dt)
        return found if len(found.rate) else None

    def conduct(self, scene, walls, links, dt: float):
        """The heat step of all bodies that `links` join: see conduct_together; and which they are. walls: mirrors of each body's temperature."""
        if self.scratch is None:
            self.scratch = np.zeros((len(self.bodies), FIELDS, math.prod(extents(self.space))))
        which, method = np.unique(links.body), (scene.heat.order, scene.heat.tolerance, Back(scene.blend, 1.0 if scene.sharp else scene.affine))
        done = conduct_together(self.space, scene.bodies, which, self.scratch, walls, links, dt, *method)
        self.passed += books.passed(links, done[1], len(self.bodies))
        return which, done

    def pace(self, time: float, span: float) -> float:
        """The fastest that a tool may go from `time` on for `span` [m/s]."""
        return self.stride(time, span, span)

    def stride(self, time: float, span: float, pushed: float) -> float:
        """The same where forces act for `pushed` [s] alone."""
        return 0.0 if self.drive is None else self.drive.pace(time, span, pushed)

    def near(self, travel: float, time: float) -> bool:
        """Whether anything may be near while no particle and no tool moves farther than `travel` [m] from `time` on."""
        if self.left < travel:
            self.left, self.unforeseen = self.distance(time)
        return self.left < travel or self.stands

    def distance(self, time: float) -> tuple[float, tuple[int, int] | None]:
        """How far a particle may move before anything acts [m]; (UNPREPARED, body) where a body that has no pieces to meet by is that near.

        A wall acts on pieces, a mirror that another body stands at on nodes, other bodies on nodes.
        """
        h, D, found, unforeseen = self.space.h, directions(self.space), [math.inf], None
        boxes, sight = [box(body.particles.x) for body in self.bodies], seen(self.space) + SLACK
        for b, (low, high) in enumerate(boxes):
            depth = skin_depth(self.bodies[b], h)
            for axis, side in np.argwhere(self.walls[b, :D] == CONTACT):
                far = (extents(self.space)[axis] - 1 - 2 * PAD) * h - high[axis] if side else low[axis]
                mirrored = (self.walls[:, axis, side] < CONTACT).any()
                margin = max(depth, 0.5 * sight * h if mirrored else 0.0)
                found.append(far - margin)
                if far < margin and self.stops[b, axis, side] < 0 and self.touching.walls[self.fields[b], axis, side] == CONTACT:
                    unforeseen = UNPREPARED, b
            found += [0.5 * (self.drive.gap(t, time, low, high) - depth - SURE * h) for t in range(len(self.tool_names))]
            for c in range(b):
                if self.fields[b] != self.fields[c]:
                    apart = float(np.max(np.maximum(low - boxes[c][1], boxes[c][0] - high)))
                    found.append(0.5 * (apart - sight * h))
                    if found[-1] < 0 and self.pairs[b, c] < 0:
                        unforeseen = UNPREPARED, b
        return min(found), unforeseen

    def advance(self, scene, buffers, pace: Pace, time: float, reports) -> bool:
        """One block of steps from `time` on in which something may be near; the nodes of a single field are `buffers`. Whether a chunk was late."""
        grids = Grids(*(self.apart(scene) if len(self.touching.walls) > 1 else (array[None] for array in buffers)))
        if self.drive is not None:
            self.drive.lay(time, pace.ahead, pace.steps, pace.kick - 0.5 * pace.dt)
        if scene.order.sliced:
            late = advance_touching_slabs(scene, self, grids, pace, reports)
        else:
            late, found = False, (self.touching, self.skin, self.sums, grids)
            self.sums = advance_touching(method_of(scene), scene.for_motion, *found, scene.gravity, pace, reports)
        self.skin.left[0] -= pace.dt * math.sqrt(max(reports[:, SPEED].tolist()))  # the last step's; those before it were counted
        return late

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
