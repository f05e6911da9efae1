"""Which bodies of a config can meet which walls and each other, and the pieces of surface that they meet by.

A mirror wall (slip, stick, or a side that `walls` does not name) is bonded to the bodies that start at it; the others meet it as contact: without friction,
at `stick` without sliding. A body can meet what its speed, its weight and its own size could bring it to within the run (`reach`).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from mpm.boundary import CONTACT
from mpm.config.rules_inflow import ways
from mpm.contact.found import BODY
from mpm.contact.meeting import Meeting
from mpm.contact.skin import POINT
from mpm.heat.programmes import at
from mpm.scene.exchange import programme
from mpm.scene.menus import wall_kind
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import cut_quadrature, shape
from mpm.scene.still import insulator
from mpm.scene.tools import refuse_tools
from mpm.scene.weight import both_ways

AT = 1e-6  # cells: a body that starts nearer to a mirror is bonded to it
SHARP = 0.3  # sine of the angle between two faces from which on their edge is a corner
OVERLAP = 0.05  # cells that two bodies may overlap by at the start
AROUND, APART = 1.5, 4.5  # cells from a wall, and between bodies, within which something may act


@dataclass(frozen=True)
class Meets:
    """B bodies: see mpm.contact.meeting.Meeting. `any` (B,): whether a body can meet anything."""

    walls: np.ndarray
    stops: np.ndarray
    pairs: np.ndarray
    fields: np.ndarray
    links: np.ndarray
    held: np.ndarray
    tools: bool = False

    @property
    def any(self) -> np.ndarray:
        return (self.stops >= 0).any(axis=(1, 2)) | (self.pairs >= 0).any(axis=1) | (self.links > 0).any(axis=1) | self.tools


def plan_meetings(experiment, sides) -> Meets:
    """What can meet, from the config alone; `sides` are the names of walls by number (mpm.scene.build.SIDES)."""
    names, grid, B = list(experiment.bodies), experiment.grid, len(experiment.bodies)
    outlines, boxes, travels = reaches(experiment)
    flung = any(tool.until is not None and tool.until < experiment.time.end for tool in experiment.tools.values())  # what one held flies as fast as it likes
    walls, stops, pairs, links = np.full((B, 3, 2), CONTACT), np.full((B, 3, 2), -1.0), np.full((B, B), -1.0), np.zeros((B, B))
    for number, side in enumerate(sides):
        axis, upper, named = number // 2, number % 2, experiment.walls.get(side)
        acts = named.acts if named is not None else "slip"
        kind = wall_kind(acts)
        for b, (low, high) in enumerate(boxes):
            gap = (grid.size[axis] - high[axis] if upper else low[axis]) / grid.cell
            if side == "axis" or (acts != "contact" and gap <= AT and not behind(experiment, names[b], axis, upper)):
                walls[b, axis, upper] = kind
            elif acts == "contact" or flung or gap * grid.cell < travels[b][axis, upper] + AROUND * grid.cell:
                stops[b, axis, upper] = rubbing(named.friction) if named is not None else 0.0
    fields = np.zeros(B, np.int64)
    known = {frozenset(pair.between): pair for pair in experiment.contacts}
    held = np.array([experiment.materials[body.material].elastic is None for body in experiment.bodies.values()])
    for b in range(B):
        welded = [c for c in range(b) if getattr(known.get(frozenset((names[b], names[c]))), "welded", None) is not None]
        fields[b] = fields[welded[0]] if welded else fields[:b].max(initial=-1) + 1
        for c in welded[1:]:
            fields[fields == fields[c]] = fields[b]
    warm = [experiment.materials[body.material].heat is not None for body in experiment.bodies.values()]
    for b in range(B):
        for c in range(B):
            pair = known.get(frozenset((names[b], names[c])))
            far = out_of_reach((boxes[b], boxes[c]), (travels[b], travels[c]), grid.cell)
            if b == c or (far and not (held[b] or held[c])):
                continue
            if fields[b] != fields[c]:
                pairs[b, c] = friction(pair)
            if warm[b] and warm[c] and not far:
                links[b, c] = math.inf if pair is None or pair.conductance is None else pair.conductance
    fields = np.unique(fields, return_inverse=True)[1]
    for f in range(fields.max() + 1):  # what is welded to a body at a mirror is behind the same mirror
        mine = fields == f
        stops[mine] = np.where((walls[mine] < CONTACT).any(axis=0), -1.0, stops[mine])
    refuse_overlap(experiment, names, outlines, boxes)
    refuse_apart(experiment, outlines)
    refuse_held(experiment, names, held)
    refuse_tools(experiment, names, outlines)
    found = Meets(walls, stops, pairs, fields, links, held, bool(experiment.tools))
    refuse_methods(experiment, found)
    return found


def reaches(experiment) -> tuple[list, list, list]:
    """(outlines, their boxes, `reach`) of the bodies in the grid's coordinates."""
    grid = experiment.grid
    outlines = [shape(body.shape, grid.dimension).moved(np.array(experiment.method.offset) * grid.cell) for body in experiment.bodies.values()]
    boxes = [outline.bounds() for outline in outlines]
    return outlines, boxes, [reach(experiment, name, low, high) for name, (low, high) in zip(experiment.bodies, boxes, strict=True)]


def out_of_reach(boxes, travels, cell: float) -> bool:
    """Whether two bodies never come near each other."""
    (low, high), (lowest, highest) = boxes
    apart = np.linalg.norm(np.maximum(0.0, np.maximum(low - highest, lowest - high)))
    return bool(apart >= travels[0].max() + travels[1].max() + APART * cell)


def refuse_methods(experiment, meets: Meets) -> None:
    """SceneError where bodies can meet and the config asks for a method that cannot do it."""
    names, method = list(experiment.bodies), experiment.method
    materials = [experiment.materials[body.material] for body in experiment.bodies.values()]
    for b, c in np.argwhere(meets.pairs >= 0):
        both = f"{names[b]} and {names[c]} can meet"
        if type(method.transfer).kind == "xpic":
            said = f"xpic does not know bodies that meet, and {both}: take apic, flip or affine_flip, or weld them under `contacts`"
            raise SceneError(("method", "transfer"), said)
        if method.locking is not None:
            raise SceneError(("method", "locking"), f"it averages over one body only, and {both}: leave it out, or weld them under `contacts`")
        for of, one in ((b, materials[b]), (c, materials[c])):
            if one.heating is not None and one.heating.elastic is not None and one.heating.elastic.form == "grid":
                said = f"grid does not know bodies that meet, and {both}: take `particles`, or weld them under `contacts`"
                raise SceneError(("materials", experiment.bodies[names[of]].material, "heating", "elastic", "form"), said)
    for b, c in np.argwhere(meets.links > 0):
        both = f"{names[b]} and {names[c]} can pass heat where they touch"
        cure = f"or set `conductance: 0` for the pair: contacts: [{{between: [{names[b]}, {names[c]}], conductance: 0}}]"
        if type(method.heat).kind in ("explicit", "stabilised"):
            raise SceneError(("method", "heat"), f"{both}, which takes implicit steps: auto or implicit, {cure}")
        for of, one in ((b, materials[b]), (c, materials[c])):
            if type(one.heat.alpha).kind != "constant":
                at = ("materials", experiment.bodies[names[of]].material, "heat", "fourier", "alpha")
                raise SceneError(at, f"{both}, which is known for constant alpha only: a number, {cure}")
    for index, pair in enumerate(experiment.contacts):
        dull = [name for name in pair.between if pair.conductance and insulator(experiment, name)]  # both have heat, by config/rules_scene.py
        if dull:
            said = f"kappa of {dull[0]} is 0, so it can pass no heat on: give it a conductivity, or `conductance: 0`"
            raise SceneError(("contacts", index, "conductance"), said)


def refuse_apart(experiment, outlines) -> None:
    """SceneError where welded bodies do not touch at the start."""
    names, h = list(experiment.bodies), experiment.grid.cell
    for index, pair in enumerate(experiment.contacts):
        if pair.welded is None:
            continue
        a, b = (outlines[names.index(name)] for name in pair.between)
        low, high = a.bounds()
        edges = [np.linspace(p, q, max(2, int((q - p) / (0.25 * h)))) for p, q in zip(low, high, strict=True)]
        gap = float(np.min(np.abs(b.distance(cut_quadrature(a, edges, 2)[1].x))))
        if gap > OVERLAP * h:
            said = f"{' and '.join(pair.between)} are to be welded and lie {gap / h:.2g} cells apart: let them touch at the start"
            raise SceneError(("contacts", index), said)


def refuse_held(experiment, names, held) -> None:
    """SceneError where a body without `elastic`, which stands still, is welded to another."""
    for index, pair in enumerate(experiment.contacts):
        for name in pair.between if pair.welded is not None else ():
            if held[names.index(name)]:
                said = f"{name} has no `elastic` and stands still: what is welded to it would too. Take `stick`, which lets go where it is pulled off"
                raise SceneError(("contacts", index, "welded"), said)


def friction(pair) -> float:
    """Of an entry under `contacts`; none where a pair is not named."""
    if pair is None:
        return 0.0
    return math.inf if pair.stick is not None else rubbing(pair.friction)


def rubbing(friction) -> float:
    """A coefficient of friction at the start; mpm.contact.course goes on from there."""
    return at(programme(friction), 0.0)


def behind(experiment, name: str, axis: int, upper: int) -> bool:
    """Whether a side lies behind the nozzle of a body that flows in: it comes from there, so it is not bonded to it."""
    body = experiment.bodies[name]
    return body.inflow is not None and ways(experiment, body) == [(axis, -1.0 if upper else 1.0)]


def reach(experiment, name: str, low, high) -> np.ndarray:
    """How far a body could come towards either side of each direction within the run (D, 2) [m]: thrown, falling, pushed by tools, or by changing its shape."""
    end, size = experiment.time.end, float(np.max(high - low))
    body, material = experiment.bodies[name], experiment.materials[experiment.bodies[name].material]
    speed = max(math.hypot(*(one.velocity or (0.0,))) + (spun(one) if len(experiment.bodies) > 1 else 0.0) for one in experiment.bodies.values())
    g = both_ways(experiment)
    loaded = any(load.traction is not None for load in experiment.loads if load.of == name)
    if body.inflow is not None or (g.any() and material.flow is not None):
        return np.full((len(low), 2), math.inf)
    swells = material.flow is not None or getattr(material.expansion, "kind", "") == "latched"
    pushed = carried(experiment)
    stirred = g.any() or speed or loaded or pushed or material.expansion is not None or body.angular_velocity is not None
    shapes = (2.0 if swells else 0.5) * size if stirred else 0.0
    return shapes + speed * end + pushed + 0.5 * end * end * g


def carried(experiment) -> float:
    """How far a tool could take what it pushes within the run [m]; endless where a force moves it."""
    far, end = 0.0, experiment.time.end
    for tool in experiment.tools.values():
        move = tool.motion
        lasts = max(0.0, (end if move.until is None else min(move.until, end)) - getattr(move, "from"))
        low, high = shape(tool.shape, experiment.grid.dimension).bounds()
        ways = [math.dist(x, move.path.displacement[0]) for x in move.path.displacement] if move.path is not None else [0.0]
        turned = 0.0 if move.spin is None else float(np.linalg.norm(move.spin)) * math.dist(low, high) * lasts
        far = max(far, math.inf if move.force is not None else max(ways) + math.hypot(*(move.velocity or (0.0,))) * lasts + turned)
    return far


def spun(body) -> float:
    """Speed of the farthest point of a body's box by its rotation, at most [m/s]."""
    omega = body.angular_velocity
    if omega is None:
        return 0.0
    low, high = shape(body.shape).bounds()
    return float(np.linalg.norm(omega) * np.linalg.norm(np.subtract(high, low)))


def refuse_overlap(experiment, names, outlines, boxes) -> None:
    """SceneError where two bodies overlap by more than OVERLAP cells at the start: looked for on lines through the cells' middles of their common box."""
    h = experiment.grid.cell
    for b in range(len(names)):
        for c in range(b):
            low, high = np.maximum(boxes[b][0], boxes[c][0]), np.minimum(boxes[b][1], boxes[c][1])
            if np.any(high - low <= OVERLAP * h):
                continue
            counts = np.clip(np.ceil((high - low) / (0.1 * h)).astype(int) + 1, 3, 60 if len(low) > 2 else 400)  # 3: the middle of a thin one too
            axes = [np.linspace(p, q, n) for p, q, n in zip(low, high, counts, strict=True)]
            points = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=-1)
            depth = np.minimum(-outlines[b].distance(points), -outlines[c].distance(points))
            if depth.max() > 0.5 * OVERLAP * h:
                place = ", ".join(f"{1e3 * x:.4g}" for x in points[int(np.argmax(depth))])
                by = f"{2 * depth.max() / h:.2g} cells near ({place}) mm"
                said = f"bodies {names[c]} and {names[b]} overlap at the start by {by}: there would be mass twice; move one of them"
                raise SceneError(("bodies", names[b], "shape"), said)


def meeting(meets: Meets, space, bodies, surroundings, names, sides, tools) -> Meeting:
    """What the run keeps of it; hot walls that a body is not bonded to, and hot tools, act while it touches them."""
    met = Meeting(space, tuple(bodies), meets.walls, meets.stops, meets.pairs, meets.fields, meets.links, names, sides, tools, meets.held)
    met.warms = bool((met.links > 0).any())
    for b, around in enumerate(surroundings):
        if around is not None:
            around.walls = [replace(wall, touched=met.touched(b, at)) if (at := against(wall, met)) >= BODY or met.walls[b, wall.axis, wall.side] == CONTACT
                            else wall for wall in around.walls]  # fmt: skip
            met.warms = met.warms or any(wall.touched is not None for wall in around.walls)
    return met


def against(wall, met: Meeting) -> int:
    """The number of a hot wall or tool (mpm.contact.found)."""
    return BODY + len(met.names) + met.tool_names.index(wall.tool) if wall.tool else 2 * wall.axis + wall.side


def cornered(cut, h: float):
    """The cut cells with a piece of next to no area at every edge and corner: where the faces of a particle's pieces intersect."""
    D = cut.centroid.shape[1]
    order = np.argsort(cut.owner, kind="stable")
    begins = np.flatnonzero(np.diff(cut.owner[order], prepend=-1))
    owner, point, normal = [], [], []
    for mine in np.split(order, begins[1:]) if len(order) else []:
        if len(mine) < 2 or D == 1:
            continue
        for group in groups(cut.normal[mine]):
            N, x = cut.normal[mine[group]], cut.point[mine[group]]
            middle = x.mean(axis=0)
            corner = middle + np.linalg.lstsq(N, np.sum(N * (x - middle), axis=1), rcond=None)[0]
            mean = N.sum(axis=0)
            if np.linalg.norm(corner - middle) < 1.5 * h and np.linalg.norm(mean) > 0.1:
                owner.append(cut.owner[mine[0]])
                point.append(corner)
                normal.append(mean / np.linalg.norm(mean))
    if not owner:
        return cut
    n = len(owner)
    return replace(cut, owner=np.concatenate([cut.owner, owner]), area=np.concatenate([cut.area, np.full(n, POINT * h ** (D - 1))]),
                   point=np.concatenate([cut.point, point]), normal=np.concatenate([cut.normal, normal]),
                   side=np.concatenate([cut.side, np.full(n, cut.side.max(initial=0) + 1)]))  # fmt: skip


def groups(normal: np.ndarray):
    """Pairs of faces that make an edge, and in three directions triples that make a corner."""
    from itertools import combinations

    for number in range(2, normal.shape[1] + 1):
        for group in combinations(range(len(normal)), number):
            singular = np.linalg.svd(normal[list(group)], compute_uv=False)
            if singular[-1] > SHARP * 0.5:
                yield list(group)
