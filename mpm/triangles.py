"""Closed triangle meshes as plain data: the text in which a config carries one, its smooth sides, and the lines that figures draw of it."""

import base64
import zlib
from typing import Any

import numpy as np

SMOOTH = np.cos(np.pi / 6)  # cosine between the normals of triangles of one side
DRAWN = 400  # edges


def packed(vertices: np.ndarray, faces: np.ndarray) -> str:
    """As text: the same triangles are the same text."""
    head = np.array([len(vertices), len(faces)], "<i8")
    whole = head.tobytes() + np.ascontiguousarray(vertices, "<f8").tobytes() + np.ascontiguousarray(faces, "<i4").tobytes()
    return base64.b64encode(zlib.compress(whole, 9)).decode()


def unpacked(data: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and faces (F, 3)."""
    try:
        whole = zlib.decompress(base64.b64decode(data))
        V, F = np.frombuffer(whole, "<i8", 2).tolist()
        vertices, faces = np.frombuffer(whole, "<f8", 3 * V, 16).reshape(V, 3), np.frombuffer(whole, "<i4", 3 * F, 16 + 24 * V).reshape(F, 3)
    except (ValueError, zlib.error):
        raise ValueError("these are no triangles") from None
    return vertices.astype(float), faces.astype(np.int64)


def put(data: str, unit: float, centre: Any) -> tuple[np.ndarray, np.ndarray]:
    """See placed."""
    vertices, faces = unpacked(data)
    vertices = vertices * unit
    if centre is not None:
        vertices = vertices + (np.array(centre) - 0.5 * (vertices.min(axis=0) + vertices.max(axis=0)))
    return vertices, faces


def neighbours(faces: np.ndarray) -> np.ndarray:
    """(E, 2) triangles that share an edge."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T)
    same = np.all(ends[order[1:]] == ends[order[:-1]], axis=1)
    return np.stack([order[:-1][same] // 3, order[1:][same] // 3], axis=1)


def lines(about: dict[str, Any]) -> list[np.ndarray]:
    """What a figure draws of a resolved mesh: its sharp edges; some of all, where it has none."""
    vertices, faces = put(about["data"], about["unit"], about["centre"])
    corner, pairs = vertices[faces], neighbours(faces)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    sharp = pairs[np.sum(normal[pairs[:, 0]] * normal[pairs[:, 1]], axis=1) < SMOOTH]
    drawn = sharp if len(sharp) else pairs
    return [vertices[np.intersect1d(faces[one], faces[two])[:2]] for one, two in drawn[:: 1 + len(drawn) // DRAWN]]


def placed(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Vertices in metres where the config puts them, and faces, of its shape `mesh`."""
    return put(model.data, model.unit, model.centre)
