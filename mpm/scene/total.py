"""Bodies of a config in the total frame: points, nodes, what walls hold of them, tractions (mpm.total)."""

import math
from types import SimpleNamespace

import numpy as np

from mpm.boundary import CONTACT, STICK, directions, extents
from mpm.diagnostics import nodal
from mpm.integrate.timestep import stiffest
from mpm.lanes import aligned
from mpm.materials import NoFlow, value
from mpm.scene.conventions import SIDES, STRAINS, spin_tensor
from mpm.scene.exchange import exchanging_surface
from mpm.scene.faded import by_area
from mpm.scene.law import expansion_law, law, mechanical_laws, setting_law
from mpm.scene.menus import pulling, wall_kind
from mpm.scene.quadrature import knots, points
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import shape
from mpm.scene.sources import sourced
from mpm.scene.traction import one_course
from mpm.state import PAD, Axisymmetric, Body, Heating, Isothermal, NoExchange, NoExpansion, NoHeating, NoSource, Particles, Ramp, Surface, Thermal, Within
from mpm.total.heat import NoWarmth, Warmth
from mpm.total.inertia import spreading
from mpm.total.reference import Reference, Skin, Still, new_nodes
from mpm.total.step import courant_of, leaning
from mpm.transfer import columns

NEAR = 1.5  # cells: what is nearer to a wall shares nodes with its mirror
FACING = 0.5  # of a unit normal
FLUSH = 1e-9  # of the domain


def wall_kinds(experiment) -> np.ndarray:
    """(3, 2) kinds; slip where the config says nothing, and on the axis."""
    kinds = np.full((3, 2), wall_kind("slip"))
    for number, side in enumerate(SIDES[experiment.grid.dimension]):
        if side in experiment.walls:
            kinds[number // 2, number % 2] = wall_kind(experiment.walls[side].acts)
    return kinds


def total_bodies(experiment, zero: float, space) -> tuple[tuple, tuple, tuple]:
    """(bodies, references, what surrounds each: mpm.integrate.surroundings.Surroundings or None)."""
    return tuple(zip(*(total_body(experiment, name, zero, space) for name in experiment.bodies), strict=True))


def sampled_points(experiment, name: str):
    """(x (N, D), V (N,), Surface, lower (D,), upper (D,)): the points of a body's reference shape and its bounds, in the order in which they are kept."""
    grid, method = experiment.grid, experiment.method
    outline = shape(experiment.bodies[name].shape, grid.dimension).moved(np.array(method.offset) * grid.cell)
    lower, upper = outline.bounds()
    radial = grid.dimension == "axisymmetric"
    if radial:
        lower = np.maximum(lower, [0.0, -np.inf])  # a ball on the axis: the other half is the same material
    for low, high, size in zip(lower, upper, grid.size, strict=True):
        if low < -1e-9 * size or high > size * (1 + 1e-9):
            said = f"{name} reaches from {low:g} m to {high:g} m, outside the domain of {size:g} m: move it, or enlarge grid.size"
            raise SceneError(("bodies", name, "shape"), said)
    x, V, surface = points(outline, knots(lower, upper, grid.cell, grid.basis), method.particles, radial)
    order = np.lexsort(np.floor(x / grid.cell + 0.5 + 1e-9).T[::-1])  # points that share nodes follow one another
    return x[order], V[order], surface, lower, upper


def total_body(experiment, name: str, zero: float, space):
    """(body, reference, surroundings) of one body."""
    config, grid, method = experiment.bodies[name], experiment.grid, experiment.method
    material, dtype, D = experiment.materials[config.material], np.dtype(method.precision), grid.directions
    x, V, surface, lower, upper = sampled_points(experiment, name)
    elastic, flow = mechanical_laws(material)
    velocity, slope = np.zeros((len(x), D)), np.zeros((len(x), D, D))
    if config.velocity is not None:
        velocity += config.velocity
    if config.angular_velocity is not None:
        spin = spin_tensor(config.angular_velocity, D)
        velocity += (x - np.average(x, axis=0, weights=V)) @ spin.T
        slope += spin
    arrays = (x, velocity, slope, np.zeros((len(x), STRAINS[D])), np.ones(len(x)), material.density * V, V)
    particles = Particles(*(np.array(a, dtype=dtype) for a in arrays))
    thermal, skin, expansion, heating, around = Isothermal(config.temperature), NoExchange(), NoExpansion(), NoHeating(), None
    if material.heat is not None:
        theta = np.full(len(x), config.temperature - zero, dtype)
        thermal = Thermal(theta, np.zeros((len(x), D), dtype), zero, law(material.heat.kappa), law(material.heat.alpha))
        pieces = SimpleNamespace(owner=np.zeros(len(surface.w), np.int64), volume=V, centroid=np.zeros((1, D)), area=surface.w, normal=surface.normal,
                                 side=surface.side, point=surface.x)  # fmt: skip
        skin, around, _ = exchanging_surface(experiment, name, pieces, zero, SIDES[grid.dimension], thermal)
    if isinstance(skin, Surface):
        skin = skin._replace(row=np.full(len(x), -1, np.int32))  # points of the surface belong to no particle here
    if material.expansion is not None:
        expansion = expansion_law(material.expansion, elastic, thermal.theta, zero)
    if material.heating is not None:
        gamma = expansion.gamma if material.heating.elastic is not None else 0.0
        heating = Heating(gamma, material.heating.dissipation.fraction if material.heating.dissipation is not None else 0.0)
    setting = setting_law(material, np.full(len(x), config.temperature))
    body = Body(particles, thermal, skin, elastic, flow, expansion, heating, sourced(experiment, name, NoSource(), particles, thermal), setting=setting)
    return body, reference_of(experiment, name, space, body, surface, lower, upper), around


def reference_of(experiment, name: str, space, body, surface, lower, upper) -> Reference:
    """Nodes, walls and loads of a body at rest in its reference shape."""
    D, n, dtype, particles = experiment.grid.directions, math.prod(extents(space)), body.particles.x.dtype, body.particles
    walls = bonded(experiment, name, surface, lower, upper)
    m = weigh(space, particles.x.astype(float), particles.m.astype(float)[:, None], n)[:, 0]
    touched = np.flatnonzero(m > 0)
    ghost, image, sign, wall, lean, held = folds = mirrors(space, walls, touched)
    pulled = folded(np.repeat(m[:, None], D, axis=1), *folds[:5])
    for g, i in zip(ghost, image, strict=True):
        m[i] += m[g]
    active = np.setdiff1d(np.union1d(touched, image), ghost)
    touched = np.union1d(touched, np.concatenate([ghost, image]))
    near = np.intersect1d(active, np.concatenate([image, wall]))
    less = 1 - pulled[near] / m[near, None]
    load, skin, ramp, drag = loads(experiment, name, space, surface, n, folds[:5], dtype)
    X = particles.x.copy()
    plastic = np.zeros((len(X) if not isinstance(body.flow, NoFlow) else 0, particles.B.shape[1]), dtype)
    courant = courant_of(space, X.astype(float), particles.V0.astype(float), walls, *stiffest(body))
    moved = spreading(space, m, active, walls)
    u, v, p, f = new_nodes(n, D, dtype)
    if experiment.method.mechanics == "implicit":
        p, moved = p[:0], (moved[0][:0], moved[1])
    m, sign, lean, less, spread = (np.ascontiguousarray(a, dtype=dtype) for a in (m, sign, lean, less, moved[0]))
    return Reference(X, plastic, u, v, p, f, m, load, touched, active, ghost, image, sign, wall, lean, near, less, held, walls, np.zeros(1),
                     ramp, drag, courant, spread, moved[1], warmth_of(space, body, walls, experiment.grid.size), skin)  # fmt: skip


def folded(nodes: np.ndarray, ghost, image, sign, wall, lean) -> np.ndarray:
    """Nodal values (n, D), what ghosts carry added where it comes from (mpm.total.reference.fold)."""
    for k in range(len(ghost)):
        nodes[image[k]] += sign[k] * nodes[ghost[k]]
        nodes[wall[k]] += lean[k] * nodes[ghost[k]]
    return nodes


def warmth_of(space, body, walls, size):
    """Nodes of heat. A wall that the body lies on mirrors temperature unless something is exchanged there."""
    if not isinstance(body.thermal, Thermal):
        return NoWarmth()
    skin, walls, D = body.surface, walls.copy(), directions(space)
    x, area = (skin.offset, skin.area) if isinstance(skin, Surface) else (np.zeros((0, D)), np.zeros((0, D)))
    for axis in range(D):
        for end in range(2):
            place = size[axis] if end else 0.0
            if np.any(np.abs(x[:, axis] - place) <= FLUSH * size[axis]) and not (isinstance(space, Axisymmetric) and axis == 0 and end == 0):
                walls[axis, end] = CONTACT
    p, n = body.particles, math.prod(extents(space))
    capacity = p.m.astype(float) * value(body.thermal.alpha, body.thermal.zero)
    C = weigh(space, p.x.astype(float), capacity[:, None], n)[:, 0]
    touched = np.flatnonzero(C > 0)
    ghost, image, *_ = mirrors(space, walls, touched)
    for g, i in zip(ghost, image, strict=True):
        C[i] += C[g]
    active = np.setdiff1d(np.union1d(touched, image), ghost)
    touched = np.union1d(touched, np.concatenate([ghost, image]))
    return Warmth(np.zeros(n), C, touched, active, ghost, image, np.ascontiguousarray(x), np.ascontiguousarray(area), np.linalg.norm(area, axis=1))


def bonded(experiment, name: str, surface, lower, upper) -> np.ndarray:
    """(3, 2) kinds of the walls that the body lies on, CONTACT for those that it does not: they hold nothing of it."""
    kinds, grid = wall_kinds(experiment), experiment.grid
    bound = np.full((3, 2), CONTACT)
    for number, side in enumerate(SIDES[grid.dimension]):
        axis, end = number // 2, number % 2
        size, place = grid.size[axis], grid.size[axis] if end else 0.0
        gap = np.abs(surface.x[:, axis] - place)
        facing = (surface.normal[:, axis] if end else -surface.normal[:, axis]) > FACING
        if abs((upper if end else lower)[axis] - place) <= FLUSH * size:
            bound[axis, end] = kinds[axis, end]
        near = facing & (gap > FLUSH * size) & (gap < NEAR * grid.cell)
        if bound[axis, end] != CONTACT and near.any():
            raise SceneError(
                ("bodies", name, "shape"),
                f"{name} lies on the {side} wall, and a part of it is {gap[near].min():.3g} m away from that wall: nearer than {NEAR:g} cells, it would be "
                "held as if it lay on it too; smaller cells, or method.frame: updated",
            )
    return bound


def mirrors(space, walls, touched):
    """(ghost (G,), image (G,), sign (G, D), wall (G,), lean (G,), held (H, 2)) of the walls: directions in turn, so that a corner is folded twice."""
    counts, D = extents(space), directions(space)
    nodes, ghost, image, sign, between, lean, held = touched, [], [], [], [], [], []
    for axis in range(D):
        for side in range(2):
            kind = walls[axis, side]
            if kind == CONTACT:
                continue
            wall = PAD if side == 0 else counts[axis] - 1 - PAD
            holds = [c for c in range(D) if kind == STICK or c == axis]
            index = np.stack(np.unravel_index(nodes, counts), axis=-1)
            beyond = (index[:, axis] < wall) if side == 0 else (index[:, axis] > wall)
            inside = index[beyond]
            inside[:, axis] = 2 * wall - inside[:, axis]
            ghost.append(nodes[beyond])
            image.append(np.ravel_multi_index(tuple(inside.T), counts))
            sign.append(np.tile([-1.0 if c in holds else 1.0 for c in range(D)], (len(inside), 1)))
            inside[:, axis] = wall
            between.append(np.ravel_multi_index(tuple(inside.T), counts))
            lean.append(np.full(len(inside), leaning(space) if kind == STICK else 0.0))
            on = nodes[index[:, axis] == wall]
            if kind != STICK:
                held.append(np.stack([on, np.full(len(on), axis)], axis=-1))
            nodes = np.union1d(nodes[~beyond], image[-1])
    none = np.zeros(0, np.int64)
    pairs = np.unique(np.concatenate([np.zeros((0, 2), np.int64), *held]), axis=0)
    whole = [np.concatenate([none, *each]) for each in (ghost, image, between)]
    return whole[0], whole[1], np.concatenate([np.zeros((0, D)), *sign]), whole[2], np.concatenate([np.zeros(0), *lean]), pairs


def weigh(space, x: np.ndarray, values: np.ndarray, n: int) -> np.ndarray:
    """sum w values on the nodes (n, C) of points x (Q, D) with values (Q, C)."""
    found, x = np.zeros((values.shape[1], n)), np.ascontiguousarray(x, dtype=float)
    for row, column in zip(found, values.T, strict=True):
        nodal(space, x, np.ascontiguousarray(column, dtype=float), row)
    return found.T


def loads(experiment, name: str, space, surface, n: int, folds, dtype) -> tuple[np.ndarray, Skin | Still, Ramp | Within, float]:
    """(nodal forces at full load, (0, D) without any; what acts by present area; their course; rate of the drag)."""
    D, entries = experiment.grid.directions, [entry for entry in experiment.loads if entry.of == name]
    tractions, drag = pulling(entries)
    course = one_course(experiment, name)
    if not tractions:
        return np.zeros((0, D), dtype), Still(), course, drag
    x, area, force, pressure, pull, outline = [], [], [], [], [], shape(experiment.bodies[name].shape, experiment.grid.dimension)
    for entry in tractions:
        pieces = outline.faces(surface, entry.side, experiment.grid.dimension == 2)
        one, zero = by_area(entry.traction, surface.normal[pieces]), np.zeros((pieces.sum(), D))
        x.append(surface.x[pieces])
        area.append(surface.w[pieces, None] * surface.normal[pieces])
        force.append(surface.w[pieces, None] * one)
        pressure.append(zero[:, 0] + (entry.traction.pressure or 0.0))
        pull.append(one if entry.traction.cauchy else zero)
    x, area, force, pressure, pull = (np.concatenate(each) for each in (x, area, force, pressure, pull))
    load = folded(weigh(space, x, force, n), *folds)
    present = (pressure != 0) | np.any(pull != 0, axis=1)
    still, wide = weigh(space, x[~present], force[~present], n), columns(D) if present.any() else D
    out, kept = aligned((n, wide), dtype), aligned((n, wide), dtype)
    out[:, :D], kept[:, :D] = load, still
    if not present.any():
        return out, Still(), course, drag
    at = [np.ascontiguousarray(one[present], dtype=dtype) for one in (x, area, pressure, pull)]
    return out, Skin(*at, kept), course, drag
