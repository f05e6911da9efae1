"""The outline of a sampled body: points of its surface, carried by the particles next to them (mpm.follow), so that extents are those of the material.

The points are the centroids of the pieces of surface, one a smooth side within a particle, and those of the shape's ridges (corners, edges, poles).
Undeformed, extremes are right to round-off where the shape has a ridge there, a flat side along the grid or a pole. Deformed, they are off by what a
curved surface rises between its points, a particle apart: (h/2)^2/(2 R) at most with two particles a cell, R the radius of curvature.
"""

import functools
import itertools

import numpy as np

from mpm.follow import Carried, carried
from mpm.scene.base import Shape
from mpm.scene.contents import nearest
from mpm.scene.cut import Segment
from mpm.scene.mesh import Mesh
from mpm.scene.shapes import Ball, Box, Cylinder, cells, shape

AT_ONCE = 4096  # points whose neighbours are looked at together
SINGLE = np.float32  # of weights: of a length of half a particle


def outline_of(outline: Shape, cut, edges, radial: bool) -> Carried:
    """Points on the surface of one body. outline: its shape in the grid's coordinates; cut, edges: its particles (mpm.scene.build.sample)."""
    sharp = ridges(outline, edges[0][1] - edges[0][0])
    sharp = sharp[sharp[:, 0] >= 0] if radial else sharp  # the other half is the same material
    owner, place = np.concatenate([cut.owner, beside(cut, edges, sharp)]), np.concatenate([cut.point, sharp])
    found = carried(cut.centroid, owner, place - cut.centroid[owner], neighbours(cut.cell, [len(e) - 1 for e in edges], owner))
    return Carried(owner.astype(np.int32), found.near.astype(np.int32), found.weight.astype(SINGLE), found.rest.astype(SINGLE))


def beside(cut, edges, x: np.ndarray) -> np.ndarray:
    """The particle nearest to each point x (K, d) of the surface, of those that have a piece of it."""
    skin = np.unique(cut.owner)
    skin = skin[np.argsort(cut.cell[skin])]
    index = np.array([np.clip(np.searchsorted(e, x[:, k], side="right") - 1, 0, len(e) - 2) for k, e in enumerate(edges)])
    return skin[nearest(index, x, cut.cell[skin], edges, cut.centroid[skin])]


def outline_near(experiment, name: str, x: np.ndarray) -> Carried:
    """Points on the surface of a body whose particles x (N, D) stand on no lattice of cells: carried by the 3^D nearest."""
    from scipy.spatial import cKDTree

    grid, method = experiment.grid, experiment.method
    outline, radial = shape(experiment.bodies[name].shape, grid.dimension).moved(np.array(method.offset) * grid.cell), grid.dimension == "axisymmetric"
    edge, (lower, upper) = grid.cell / method.particles, outline.bounds()
    edges = [np.arange(np.floor(low / edge), np.ceil(high / edge) + 1) * edge for low, high in zip(np.maximum(lower, 0.0), upper, strict=True)]
    place = np.concatenate([cells(outline, edges, radial).point, ridges(outline, edge)])
    place = place[place[:, 0] >= 0] if radial else place
    tree = cKDTree(x.astype(float))
    owner = tree.query(place)[1]
    found = []
    for some in np.array_split(np.arange(len(place)), 1 + len(place) // AT_ONCE):
        near = tree.query(x[owner[some]].astype(float), min(len(x), 3 ** x.shape[1]))[1].reshape(len(some), -1)
        one = carried(x.astype(float), owner[some], place[some] - x[owner[some]], near)
        found.append(one._replace(near=near.astype(np.int32)))
    return Carried(*map(np.concatenate, zip(*found, strict=True)))


def neighbours(cell: np.ndarray, counts: list[int], owner: np.ndarray) -> np.ndarray:
    """Particles (S, K) in the cells that share a face or an edge with those of `owner` (S,); the owner itself where there is none. cell (N,): of particles."""
    steps = np.array([step for step in itertools.product((-1, 0, 1), repeat=len(counts)) if 0 < np.abs(step).sum() <= 2])
    number = np.full(int(np.prod(counts)), -1, np.int64)
    number[cell] = np.arange(len(cell))
    index = np.stack(np.unravel_index(cell[owner], counts), axis=-1)[:, None] + steps
    inside = np.all((index >= 0) & (index < counts), axis=-1)
    found = np.where(inside, number[np.ravel_multi_index(tuple(np.moveaxis(np.where(inside[..., None], index, 0), -1, 0)), counts)], -1)
    return np.where(found >= 0, found, owner[:, None])


def spaced(low: float, high: float, spacing: float, whole: int = 1) -> np.ndarray:
    """From low to high, at most `spacing` apart, in a multiple of `whole` steps."""
    return np.linspace(low, high, whole * max(1, int(np.ceil((high - low) / spacing / whole * (1 - 1e-9)))) + 1)


@functools.singledispatch
def ridges(shape: Shape, spacing: float) -> np.ndarray:
    """Points (K, d) where the surface has corners, edges (at most `spacing` apart along them) and poles. Here of any plane shape: where its pieces meet."""
    ends = [(piece.start, (0.0, 0.0)) if isinstance(piece, Segment) else (piece.centre, (piece.radius, piece.start)) for piece in shape.pieces()]
    return np.array([np.add(x, radius * np.array([np.cos(angle), np.sin(angle)])) for x, (radius, angle) in ends])


@ridges.register
def ridges_box(shape: Box, spacing: float) -> np.ndarray:
    if len(shape.lower) == 2:
        return ridges.dispatch(Shape)(shape, spacing)
    lower, upper, found = np.array(shape.lower), np.array(shape.upper), []
    if len(lower) == 1:
        return np.stack([lower, upper])
    for axis, corner in itertools.product(range(3), np.ndindex(2, 2)):
        along = spaced(lower[axis], upper[axis], spacing)
        edge = np.tile(np.insert(np.where(corner, np.delete(upper, axis), np.delete(lower, axis)), axis, 0.0), (len(along), 1))
        edge[:, axis] = along
        found.append(edge)
    return np.concatenate(found)


@ridges.register
def ridges_mesh(shape: Mesh, spacing: float) -> np.ndarray:
    return shape.edges(spacing)


@ridges.register
def ridges_ball(shape: Ball, spacing: float) -> np.ndarray:
    reach = shape.radius * np.eye(len(shape.centre))
    return np.array(shape.centre) + np.concatenate([reach, -reach])


@ridges.register
def ridges_cylinder(shape: Cylinder, spacing: float) -> np.ndarray:
    if len(shape.base) == 2:
        return ridges(Box(*(tuple(corner) for corner in shape.bounds())), spacing)
    turn = spaced(0.0, 2 * np.pi, spacing / shape.radius, 4)
    rim = np.array(shape.base) + np.stack([shape.radius * np.cos(turn), shape.radius * np.sin(turn), 0 * turn], axis=1)
    return np.concatenate([rim, rim + np.array([0.0, 0.0, shape.height])])
