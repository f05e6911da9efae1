"""Signed distance of a closed triangle mesh, exact: to the nearest of the triangles that a list of cells offers, with the sign of its pseudonormal.

    phi(y) = sign((y - p) . N) |y - p|,   p the nearest point of the mesh, N the normal of the face, edge or corner on which it lies

An edge has the sum of its faces' normals, a corner the sum weighted by the faces' angles there: then the sign is right everywhere
(J. A. Baerentzen, H. Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243). Nearest point: C. Ericson, Real-Time Collision Detection (2005) 5.1.5.
Fails when   the mesh is open or crosses itself (refused where it is read, mpm.config.meshes)
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel, role

CELLS, OFFERED, BLOCK = 24, 4, 3  # most cells a direction; about so many cells a triangle; cells a direction that are looked at together
NONE = np.zeros(0, np.int64)
THIN = 1e-12  # of the box: nearer than this the normal of the surface is taken


class NoTriangles(NamedTuple):
    """No tool is a mesh."""


class Triangles(NamedTuple):
    """F triangles of T meshes, and which of them can be the nearest to a point of each cell of a box about its mesh."""

    corner: np.ndarray  # (F, 3, 3) [m]
    normal: np.ndarray  # (F, 7, 3) of the face, of the edges 01, 12, 20, of the corners; of any length but the face's
    first: np.ndarray  # (T + 1,) first triangle of each mesh
    low: np.ndarray  # (T, 3) of the box of cells [m]
    size: np.ndarray  # (T, 3) of a cell [m]
    shape: np.ndarray  # (T, 3) cells
    cell: np.ndarray  # (T,) the first cell of each mesh in
    begin: np.ndarray  # (cells of all + 1,) where a cell's triangles begin in
    offer: np.ndarray  # (K,)
    beyond: np.ndarray  # (cells of all,) 1 where a cell is farther than `room` outside, 2 where it is that deep inside: those offer none


def new_triangles(vertices: np.ndarray, faces: np.ndarray, room: float) -> Triangles:
    """Of vertices (V, 3) and faces (F, 3), counter-clockwise from outside; the cells reach `room` [m] beyond the mesh."""
    corner = np.ascontiguousarray(vertices[faces], dtype=float)
    low, high = vertices.min(axis=0) - room, vertices.max(axis=0) + room
    count = min(CELLS, max(2, int((OFFERED * len(faces)) ** (1 / 3))))
    shape = np.maximum(1, np.ceil(count * (high - low) / (high - low).max())).astype(np.int64)
    size = (high - low) / shape
    least, most, offer = corner.min(axis=1), corner.max(axis=1), {}
    for index in np.ndindex(*(-(-shape // BLOCK))):  # what a block of cells may be nearest to is enough for each of them
        begins, ends = np.array(index) * BLOCK, np.minimum((np.array(index) + 1) * BLOCK, shape)
        some = nearby(low + 0.5 * (begins + ends) * size, 0.5 * float(np.linalg.norm((ends - begins) * size)), room, corner, least, most)
        one = corner[some], least[some], most[some]
        for inside in np.ndindex(*(ends - begins)) if len(some) else ():
            k = begins + inside
            offer[tuple(k)] = some[nearby(low + (k + 0.5) * size, 0.5 * float(np.linalg.norm(size)), room, *one)]
    lists = [offer.get(k, NONE) for k in np.ndindex(*shape)]
    begin = np.cumsum([0, *map(len, lists)])
    one = np.array([0, len(faces)]), low[None], size[None], shape[None], np.zeros(1, np.int64)
    return Triangles(corner, pseudonormals(vertices, faces), *one, begin, np.concatenate(lists), sides(np.diff(begin).reshape(shape) == 0).ravel())


def nearby(x: np.ndarray, radius: float, room: float, corner, least, most) -> np.ndarray:
    """Numbers of the triangles of which one is the nearest to any point of a ball; none where all are farther than `room`. least, most (F, 3): their boxes."""
    apart = np.maximum(0.0, np.maximum(least - x, x - most))
    square = np.sum(apart * apart, axis=1)
    if np.sqrt(square.min()) > room + radius:
        return NONE
    near = np.sqrt(min(np.min(np.sum((corner - x) ** 2, axis=2)), np.min(np.sum((corner.mean(axis=1) - x) ** 2, axis=1)))) + 2 * radius
    return np.flatnonzero(square <= near * near)


def sides(empty: np.ndarray) -> np.ndarray:
    """Of cells (I, J, K) without triangles: 1 where a way through such cells leads out of the box, else 2; 0 of the others."""
    out = np.zeros_like(np.pad(empty, 1))
    free, out[0] = np.pad(empty, 1, constant_values=True), True
    while True:
        more = out.copy()
        for axis in range(3):
            for way in (-1, 1):
                more |= np.roll(out, way, axis=axis)
        more &= free
        if np.array_equal(more, out):
            break
        out = more
    return np.where(empty, np.where(out[1:-1, 1:-1, 1:-1], 1, 2), 0).astype(np.uint8)


def together(meshes: list[Triangles | None]) -> Triangles | NoTriangles:
    """Several as one, with room for those that are none."""
    if all(one is None for one in meshes):
        return NoTriangles()
    none = Triangles(np.zeros((0, 3, 3)), np.zeros((0, 7, 3)), np.zeros(2, np.int64), *np.ones((2, 1, 3)), np.ones((1, 3), np.int64), np.zeros(1, np.int64),
                     np.zeros(2, np.int64), NONE, np.ones(1, np.uint8))  # fmt: skip
    parts = [none if one is None else one for one in meshes]
    first = np.cumsum([0, *(len(one.corner) for one in parts)])
    offered = np.cumsum([0, *(len(one.offer) for one in parts)])
    begin = np.concatenate([*(one.begin[:-1] + at for one, at in zip(parts, offered, strict=False)), offered[-1:]])
    offer = np.concatenate([one.offer + at for one, at in zip(parts, first, strict=False)])
    low, size, shape = (np.concatenate([getattr(one, name) for one in parts]) for name in ("low", "size", "shape"))
    cell = np.cumsum([0, *(int(one.shape.prod()) for one in parts)])[:-1]
    beyond = np.concatenate([one.beyond for one in parts])
    whole = (np.concatenate([getattr(one, name) for one in parts]) for name in ("corner", "normal"))
    return Triangles(*whole, first, low, size, shape, cell, begin, offer, beyond)


def pseudonormals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(F, 7, 3): see Triangles."""
    corner = vertices[faces]
    sides = np.roll(corner, -1, axis=1) - corner  # 01, 12, 20
    face = np.cross(sides[:, 0], sides[:, 1])
    face /= np.linalg.norm(face, axis=1, keepdims=True)
    unit = sides / np.linalg.norm(sides, axis=2, keepdims=True)
    angle = np.arccos(np.clip(-np.sum(unit * np.roll(unit, 1, axis=1), axis=2), -1.0, 1.0))
    at = np.zeros_like(vertices)
    np.add.at(at, faces, angle[:, :, None] * face[:, None])
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    _, number = np.unique(ends, axis=0, return_inverse=True)
    edge = np.zeros((number.max() + 1, 3))
    np.add.at(edge, number.ravel(), np.repeat(face, 3, axis=0))
    return np.concatenate([face[:, None], edge[number.ravel()].reshape(-1, 3, 3), at[faces]], axis=1)


@kernel
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def nearest_of(tri, y, p):
    """p (3,) becomes the point of a triangle (3, 3) nearest to y; where it lies: 0 the face, 1 to 3 an edge, 4 to 6 a corner."""
    ab, ac, ap = np.empty(3), np.empty(3), np.empty(3)
    for a in range(3):
        ab[a], ac[a], ap[a] = tri[1, a] - tri[0, a], tri[2, a] - tri[0, a], y[a] - tri[0, a]
    d1, d2 = dot(ab, ap), dot(ac, ap)
    d3, d4 = d1 - dot(ab, ab), d2 - dot(ab, ac)  # of y - b
    d5, d6 = d1 - dot(ab, ac), d2 - dot(ac, ac)  # of y - c
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    v, w, where = 0.0, 0.0, 0
    if d1 <= 0.0 and d2 <= 0.0:
        where = 4
    elif d3 >= 0.0 and d4 <= d3:
        v, where = 1.0, 5
    elif d6 >= 0.0 and d5 <= d6:
        w, where = 1.0, 6
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v, where = d1 / (d1 - d3), 1
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w, where = d2 / (d2 - d6), 3
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v, where = 1.0 - w, 2
    else:
        v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    for a in range(3):
        p[a] = tri[0, a] + v * ab[a] + w * ac[a]
    return where


@kernel
def signed_to(mesh, t, y, everywhere, n):
    """phi of mesh t at y (3,), whose gradient n (3,) becomes. Farther than `room` outside: of all triangles where `everywhere`, else as if far away."""
    cell, outside, count = 0, False, mesh.first[t + 1] - mesh.first[t]
    for a in range(3):
        k = int(np.floor((y[a] - mesh.low[t, a]) / mesh.size[t, a]))
        outside = outside or k < 0 or k >= mesh.shape[t, a]
        cell = cell * mesh.shape[t, a] + k
    cell += mesh.cell[t]
    if (outside or mesh.beyond[cell] == 1) and not everywhere:
        n[0], n[1], n[2] = 0.0, 0.0, 1.0
        return 1e300
    listed = not outside and mesh.beyond[cell] == 0
    if listed:
        count = mesh.begin[cell + 1] - mesh.begin[cell]
    p, best, out = np.empty(3), np.empty(3), np.empty(3)
    least, width = 1e300, 0.0
    for k in range(count):
        i = mesh.offer[mesh.begin[cell] + k] if listed else mesh.first[t] + k
        where = nearest_of(mesh.corner[i], y, p)
        square = (y[0] - p[0]) ** 2 + (y[1] - p[1]) ** 2 + (y[2] - p[2]) ** 2
        if square < least:
            least = square
            for a in range(3):
                best[a], out[a] = p[a], mesh.normal[i, where, a]
    for a in range(3):
        width = max(width, mesh.shape[t, a] * mesh.size[t, a])
        n[a] = y[a] - best[a]
    gap, length = np.sqrt(least), np.sqrt(dot(out, out))
    sign = 1.0 if dot(n, out) >= 0.0 else -1.0
    for a in range(3):
        n[a] = sign * n[a] / gap if gap > THIN * width else out[a] / length
    return sign * gap


@role
def to_mesh(meshes, t, y):
    """Signed distance of y (3,) to mesh t, near it; y becomes the normal."""
    raise TypeError(f"no meshes of {type(meshes).__name__}")


@to_mesh.register(NoTriangles)
def to_mesh_no_triangles(meshes, t, y):
    return 1e300


@to_mesh.register(Triangles)
def to_mesh_triangles(meshes, t, y):
    n = np.empty(3)
    gap = signed_to(meshes, t, y, False, n)
    for a in range(3):
        y[a] = n[a]
    return gap


@kernel
def signed_all(mesh, x, found):
    """phi at every point of x (N, 3), to `found` (N,)."""
    n = np.empty(3)
    for i in range(len(x)):
        found[i] = signed_to(mesh, 0, x[i], True, n)
