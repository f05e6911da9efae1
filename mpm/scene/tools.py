"""Tools of a config: their numbers for the kernels, and what is refused of them at the start."""

import math

import numpy as np

from mpm.contact.distance import BALL, BOX, CYLINDER, MESH, POLYGON
from mpm.contact.drive import Drive, Told
from mpm.contact.tools import Tools
from mpm.contact.triangles import together
from mpm.heat.programmes import at
from mpm.scene.base import Shape
from mpm.scene.conventions import spin_tensor
from mpm.scene.exchange import programme
from mpm.scene.law import elastic_law
from mpm.scene.mesh import Mesh
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import Ball, Box, Cylinder, Polygon, cut_quadrature, shape

MOST_STEPS = 64  # of a block
OVERLAP = 0.05  # cells
NEAR = 1.0  # cells about a mesh in which its distance is known
LOOKS = 21  # times of a tool's way
FAST = 0.2  # of the speed of sound: a tool that is faster passes pieces between two steps


def outline(experiment, tool) -> Shape:
    """Of a tool at the start, in the grid's coordinates."""
    return shape(tool.shape, experiment.grid.dimension).moved(np.array(experiment.method.offset) * experiment.grid.cell)


def drive(experiment) -> Drive | None:
    """The tools, ready to move; None without any. `tools` of the config."""
    if not experiment.tools:
        return None
    D, T, names = experiment.grid.directions, len(experiment.tools), list(experiment.tools)
    outlines = [outline(experiment, tool) for tool in experiment.tools.values()]
    shapes = [numbers(one, experiment.grid.dimension) for one in outlines]
    near = NEAR * experiment.grid.cell
    meshes = [one.moved(-centre).triangles(near) if isinstance(one, Mesh) else None for one, (_, centre, _, _) in zip(outlines, shapes, strict=True)]
    V = max(1, *(len(corner) for _, _, _, corner in shapes))
    tools = Tools(
        kind=np.array([kind for kind, _, _, _ in shapes]), size=np.stack([size for _, _, size, _ in shapes]), corner=np.zeros((T, V, 2)),
        corners=np.array([len(corner) for _, _, _, corner in shapes]), mesh=together(meshes), bound=np.zeros(T),
        mu=np.array([at(programme(tool.friction), 0.0) for tool in experiment.tools.values()]),
        there=np.ones(T, np.bool_), centre=np.zeros((T, D)), turn=np.tile(np.eye(D), (T, 1, 1)), v=np.zeros((T, D)), before=np.zeros((T, D)),
        spin=np.zeros((T, D, D)),
        force=np.zeros((T, D)), light=np.zeros(T), way=np.zeros((T, D)), shift=np.zeros((T, D)), path=np.zeros((MOST_STEPS + 1, T, D)),
        turns=np.zeros((MOST_STEPS + 1, T, D, D)), present=np.zeros((MOST_STEPS, T), np.bool_))  # fmt: skip
    told = []
    for t, (name, (kind, centre, size, corner)) in enumerate(zip(names, shapes, strict=True)):
        tool = experiment.tools[name]
        tools.corner[t, : len(corner)] = corner
        flat = {BALL: size[:1], CYLINDER: size[:2], BOX: size[:D], MESH: size}
        tools.bound[t] = np.linalg.norm(corner, axis=1).max() if kind == POLYGON else np.linalg.norm(flat[kind])
        if tool.motion.force is not None:
            tools.force[t], tools.light[t] = tool.motion.force, 1.0 / tool.motion.mass
            tools.way[t] = tools.force[t] / np.linalg.norm(tools.force[t])
        told.append(Told(name, *path(tool.motion, centre, experiment.time.end), spin=spin(tool.motion, D),
                         turning=spell(tool.motion), there=spell(tool), light=float(tools.light[t])))  # fmt: skip
    return Drive(tuple(told), tools)


def spell(model) -> tuple[float, float]:
    """From, until."""
    return getattr(model, "from"), math.inf if model.until is None else model.until


def spin(motion, D: int) -> np.ndarray:
    """W; nothing where there is no rotation."""
    return np.zeros((D, D)) if motion.spin is None else spin_tensor(motion.spin, D)


def path(motion, centre: np.ndarray, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and places of the centre."""
    if motion.path is not None:
        return np.array(motion.path.time), centre + np.array(motion.path.displacement)
    if motion.velocity is None:
        return np.zeros(1), centre[None]
    first, last = spell(motion)
    last = min(last, first + 2.0 * end)
    return np.array([first, last]), centre + np.outer([0.0, last - first], motion.velocity)


def numbers(body: Shape, dimension) -> tuple[int, np.ndarray, np.ndarray, np.ndarray]:
    """(kind, centre, size (3,), corners about the centre). A round body's box reaches over the axis."""
    low, high = body.bounds()
    radial, corner, size = dimension == "axisymmetric", np.zeros((0, 2)), np.zeros(3)
    if radial and low[0] <= 0.0 and not isinstance(body, Polygon):
        low = np.array([-high[0], low[1]])
    centre = 0.5 * (low + high)
    size[: len(low)] = 0.5 * (high - low)
    if isinstance(body, Ball) and len(low) > 1:
        return BALL, np.array(body.centre), np.array([body.radius, 0.0, 0.0]), corner
    if isinstance(body, Cylinder) and len(low) == 3:
        return CYLINDER, centre, np.array([body.radius, 0.5 * body.height, 0.0]), corner
    if isinstance(body, Mesh):
        return MESH, centre, size, corner
    if isinstance(body, Polygon) or (isinstance(body, Box) and body.angle and len(low) == 2):
        corner = np.array([piece.start for piece in body.pieces()])
        return POLYGON, centre, size, corner - centre
    return BOX, centre, size, corner


def refuse_tools(experiment, names, outlines) -> None:
    """SceneError where a tool and a body overlap at the start, a tool is thinner than a cell, rounder than one, or faster than pieces can be followed."""
    h = experiment.grid.cell
    for name, tool in experiment.tools.items():
        one = outline(experiment, tool)
        low, high = one.bounds()
        if np.min(high - low) < h * (1 - 1e-9):
            said = f"it is {np.min(high - low) / h:.2g} cells thick, and what is thinner than a cell passes between the pieces of a surface"
            raise SceneError(("tools", name, "shape"), f"{said}: take a thicker tool, or smaller cells")
        if isinstance(one, Ball | Cylinder) and len(low) > 1 and one.radius < h * (1 - 1e-9):
            said = f"its radius is {one.radius / h:.2g} cells, and a tool as round as that enters between the pieces of a surface"
            raise SceneError(("tools", name, "shape"), f"{said}: take a larger tool, or smaller cells")
        if getattr(tool, "from") > 0:
            continue  # where bodies are by then is not known
        for body, other in zip(names, outlines, strict=True):
            depth, place = deepest(one, other, h)
            if depth > OVERLAP * h:
                where = ", ".join(f"{1e3 * x:.4g}" for x in place)
                said = f"it overlaps {body} at the start by {depth / h:.2g} cells near ({where}) mm"
                raise SceneError(("tools", name, "shape"), f"{said}: move one of them")
    told = drive(experiment)
    refuse_through(experiment, names, outlines, told)
    slowest = min(FAST * sound(experiment.materials[experiment.bodies[name].material]) for name in names)
    for t, name in enumerate(experiment.tools):
        if told.fastest(t, 0.0, experiment.time.end) > slowest * (1 + 1e-9) and told.tools.light[t] == 0.0:
            said = f"a place on it goes {told.fastest(t, 0.0, experiment.time.end):.3g} m/s, over {FAST:g} of the speed of sound of what it meets"
            raise SceneError(("tools", name, "motion"), f"{said}: take at most {slowest:.3g} m/s")


def refuse_through(experiment, names, outlines, told) -> None:
    """SceneError where a tool is told to go into a body that stands still: looked for at LOOKS times of its way."""
    h = experiment.grid.cell
    still = [(body, other) for body, other in zip(names, outlines, strict=True) if experiment.materials[experiment.bodies[body].material].elastic is None]
    for name, way in zip(experiment.tools, told.told if told is not None and still else (), strict=False):
        one, (begin, end) = outline(experiment, experiment.tools[name]), way.there
        for when in np.linspace(begin, min(end, experiment.time.end), LOOKS) if len(way.times) > 1 else ():
            shift = np.array([np.interp(when, way.times, along) - along[0] for along in way.path.T])
            for body, other in still:
                if deepest(one.moved(shift), other, h)[0] > OVERLAP * h:
                    said = f"at {when:.3g} s it would stand in {body}, which has no `elastic` and stands still: end its way before that"
                    raise SceneError(("tools", name, "motion"), said)


def sound(material) -> float:
    """A speed of sound [m/s], sqrt(M/rho); infinite where the moduli follow temperature, and of what stands still."""
    law = elastic_law(material.elastic) if material.elastic is not None else None
    return math.sqrt((law.lam + 2 * law.mu) / material.density) if hasattr(law, "lam") else math.inf


def deepest(one: Shape, other: Shape, h: float) -> tuple[float, np.ndarray]:
    """How far the surface of either lies inside the other [m], and where."""
    found, place = 0.0, np.zeros(0)
    for a, b in ((one, other), (other, one)):
        low, high = a.bounds()
        if np.any(high - low > 1e3 * h):
            continue  # a plate far larger than what it meets: the other's surface says it
        edges = [np.linspace(p, q, max(2, min(60, int((q - p) / (0.25 * h)) + 1))) for p, q in zip(low, high, strict=True)]
        points, (least, most) = cut_quadrature(a, edges, 2)[1].x, b.bounds()
        points = points[np.all((points > least) & (points < most), axis=1)]  # no other can lie inside
        depth = -b.distance(points)
        if len(points) and depth.max() > found:
            found, place = float(depth.max()), points[int(np.argmax(depth))]
    return found, place
