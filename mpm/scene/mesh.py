"""Closed triangle meshes as shapes: their exact cuts by a grid.

Every triangle is split where it crosses a grid plane (`split`). What lies below it in a cell is then a sum over pieces, by the divergence theorem along z:

    int_cell f dV = sum_(pieces in the cell) int (int_z0^z f dz') n_z dA + sum_(pieces above it, in its column) int (int_z0^z1 f dz') n_z dA

or from the top down where more of the cell's surface looks down.

Volume, first moment and area are those of the triangles to rounding, at any offset. A smooth side is what joins triangles at less than SMOOTH.
Weights of single points may be negative where surface looks both ways; sums are exact.
Fails when   the mesh is open or crosses itself (refused where it is read)
"""

import functools
from dataclasses import dataclass, field

import numpy as np

from mpm.contact.triangles import Triangles, new_triangles, pseudonormals, signed_all
from mpm.scene.base import Shape
from mpm.scene.cut import EDGE, Batch, Cut, Skin, gauss, locate
from mpm.triangles import SMOOTH, neighbours, placed

ROOM = 0.1  # of the largest edge of the box, about the mesh, in which distances are looked up


@dataclass(frozen=True, eq=False)
class Mesh(Shape):
    """vertices (V, 3) [m], trios (F, 3) of them, counter-clockwise from outside."""

    vertices: np.ndarray
    trios: np.ndarray
    _kept: dict = field(default_factory=dict, repr=False)

    def bounds(self):
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    def triangles(self, room: float) -> Triangles:
        """What distances are made of, looked up `room` [m] about the mesh."""
        if room not in self._kept:
            self._kept[room] = new_triangles(self.vertices, self.trios, room)
        return self._kept[room]

    def distance(self, x):
        low, high = self.bounds()
        found = np.empty(len(x))
        signed_all(self.triangles(ROOM * float((high - low).max())), np.ascontiguousarray(x, dtype=float), found)
        return found

    def moved(self, shift):
        return Mesh(self.vertices + np.asarray(shift, dtype=float), self.trios)

    def sides(self) -> np.ndarray:
        """(F,) the smooth side of each triangle."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        pairs, normal = neighbours(self.trios), pseudonormals(self.vertices, self.trios)[:, 0]
        pairs = pairs[np.sum(normal[pairs[:, 0]] * normal[pairs[:, 1]], axis=1) > SMOOTH]
        joined = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(self.trios),) * 2)
        return connected_components(joined, directed=False)[1]

    def edges(self, spacing: float) -> np.ndarray:
        """Points (K, 3) at most `spacing` apart on the edges between two sides."""
        side, pairs = self.sides(), neighbours(self.trios)
        pairs, found = pairs[side[pairs[:, 0]] != side[pairs[:, 1]]], [np.zeros((0, 3))]
        for one, two in pairs:
            a, b = self.vertices[np.intersect1d(self.trios[one], self.trios[two])[:2]]
            found.append(a + np.linspace(0, 1, max(1, int(np.ceil(np.linalg.norm(b - a) / spacing))) + 1)[:, None] * (b - a))
        return np.unique(np.concatenate(found), axis=0)

    def cuts(self, edges, order: int):
        corner, side = split(self.vertices[self.trios], self.sides(), edges)
        across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        twice = np.linalg.norm(across, axis=1)
        tiny = EDGE * min(np.diff(e).min() for e in edges)
        kept = twice > tiny * tiny
        corner, side, normal, twice = corner[kept], side[kept], across[kept] / twice[kept, None], twice[kept]
        home = locate(corner.mean(axis=1) - 2 * tiny * normal, edges)
        corner, side, normal, twice, home = (a[home >= 0] for a in (corner, side, normal, twice, home))
        u, v, w = on_triangle(order + 2)
        points = corner[:, None, 0] + u[:, None] * (corner[:, 1] - corner[:, 0])[:, None] + v[:, None] * (corner[:, 2] - corner[:, 0])[:, None]
        area = twice[:, None] * w
        skin = Skin(points, area, np.repeat(normal[:, None], len(w), axis=1), home, side)
        whole, (number, cell, low, high, way) = columns(home, normal, twice, edges)
        flux = way[:, None] * area[number] * normal[number, 2, None]
        z = points[number, :, 2]
        bottom, top = (np.where(np.isnan(end)[:, None], z, end[:, None]) for end in (low, high))
        g, gw = gauss(order // 2 + 1)
        x = np.repeat(points[number], len(g), axis=1)
        x[..., 2] = (bottom[..., None] + (top - bottom)[..., None] * g).reshape(len(number), -1)
        weight = (flux[..., None] * (top - bottom)[..., None] * gw).reshape(len(number), -1)
        return (Cut(whole, (Batch(x, weight, cell),), (skin,)),)


def columns(home, normal, twice, edges):
    """Cells that are full; and of cut ones (piece, cell, bottom, top, +1 or -1): strips of height from bottom to top below or above pieces, NaN is the piece.

    Below the pieces in a cell and above it, where most of its surface looks up; else above those in it and below: so points lie inside, but for odd cells.
    """
    Z, tall = edges[2], len(edges[2]) - 1
    up = np.flatnonzero(np.abs(normal[:, 2]) > EDGE)
    column, layer = home // tall, home % tall
    total = np.bincount(home[up], weights=0.5 * twice[up] * normal[up, 2], minlength=int(np.prod([len(e) - 1 for e in edges])))
    above = np.cumsum(total.reshape(-1, tall)[:, ::-1], axis=1)[:, ::-1] - total.reshape(-1, tall)
    cut, sense = np.unique(home), np.where(total < 0, -1.0, 1.0)
    full = above > 0.5 * np.multiply.outer(np.diff(edges[0]), np.diff(edges[1])).reshape(-1, 1)
    full.reshape(-1)[cut] = False
    order = up[np.argsort(home[up], kind="stable")]  # by column, then by height
    upward = sense[cut] > 0
    first = np.where(upward, np.searchsorted(home[order], cut, side="right"), np.searchsorted(column[order], cut // tall, side="left"))
    last = np.where(upward, np.searchsorted(column[order], cut // tall, side="right"), np.searchsorted(home[order], cut, side="left"))
    many = last - first
    steps = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many)
    over, cells = order[np.repeat(first, many) + steps], np.repeat(cut, many)
    own = sense[home[up]] > 0
    low = np.concatenate([np.where(own, Z[layer[up]], np.nan), Z[cells % tall]])
    high = np.concatenate([np.where(own, np.nan, Z[layer[up] + 1]), Z[cells % tall + 1]])
    every = np.concatenate([home[up], cells])
    return np.flatnonzero(full), (np.concatenate([up, over]), every, low, high, sense[every])


def on_triangle(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (u, v) and weights of the unit triangle, Gauss points collapsed on to a corner; the weights sum to 1/2."""
    g, w = gauss(n)
    u, v = np.repeat(g, n), np.tile(g, n) * (1 - np.repeat(g, n))
    return u, v, np.repeat(w, n) * np.tile(w, n) * (1 - np.repeat(g, n))


def split(corner: np.ndarray, side: np.ndarray, edges) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (F, 3, 3) cut along all grid planes, and the sides of the parts; what is nearer to a plane than EDGE lies on it."""
    for axis, planes in enumerate(edges):
        tiny = EDGE * np.diff(planes).min()
        for at in planes:
            away = corner[:, :, axis] - at
            away[np.abs(away) <= tiny] = 0.0
            crossed = (away.min(axis=1) < 0) & (away.max(axis=1) > 0)
            if not crossed.any():
                continue
            parts, whose = halved(corner[crossed], away[crossed])
            corner = np.concatenate([corner[~crossed], parts])
            side = np.concatenate([side[~crossed], side[crossed][whose]])
    return corner, side


def halved(t: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (F, 3, 3) with signed distances d (F, 3) to a plane that crosses them, each in two or three of the same sense; and whose part each is."""
    signs = np.sign(d)
    alone = np.argmax((signs != 0) & (signs != np.roll(signs, -1, axis=1)) & (signs != np.roll(signs, 1, axis=1)), axis=1)  # on its side of the plane
    turn = (alone[:, None] + np.arange(3)) % 3
    (a, b, c), (da, db, dc) = np.moveaxis(np.take_along_axis(t, turn[:, :, None], axis=1), 1, 0), np.take_along_axis(d, turn, axis=1).T
    p = np.where((db == 0)[:, None], b, a + (da / (da - db))[:, None] * (b - a))
    q = np.where((dc == 0)[:, None], c, a + (da / (da - dc))[:, None] * (c - a))
    parts = [(np.stack([a, p, q], axis=1), da != 0), (np.stack([p, b, c], axis=1), db != 0), (np.stack([p, c, q], axis=1), dc != 0)]
    return np.concatenate([one[there] for one, there in parts]), np.concatenate([np.flatnonzero(there) for _, there in parts])


@functools.lru_cache(maxsize=16)
def from_config(model) -> Mesh:
    """Of what a config holds: see mpm.config.meshes."""
    return Mesh(*placed(model))


__all__ = ["Mesh", "from_config"]
