"""Triangle meshes of a config: read from a file beside it when the config is, so that a point carries its triangles and no path."""

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpm.config.explain import Finding
from mpm.config.problems import brief
from mpm.config.shapes_fit import outside
from mpm.triangles import packed

KINDS = (".stl", ".obj", ".ply", ".off")
MOST_TRIANGLES = 25_000  # triangles
RAYS = 41  # a direction, along which a mesh is looked through
WATERTIGHT = "a closed mesh: every edge between two triangles, with one side out"


@dataclass
class Unfit(Exception):
    """What is wrong with a mesh, and what would do."""

    message: str
    allowed: str = WATERTIGHT


def read(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a file, checked: Unfit, OSError."""
    if path.suffix.lower() not in KINDS:
        raise Unfit(f"{path.name} is no file of triangles that is known", ", ".join(KINDS))
    content = path.read_bytes()
    import trimesh  # reads STL, OBJ and others, and joins the corners that triangles share

    try:
        mesh: Any = trimesh.load(io.BytesIO(content), file_type=path.suffix.lower()[1:], force="mesh", process=True, skip_materials=True)
        vertices, faces = np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, np.int64)
    except Exception as error:  # whatever a reader says of a broken file
        raise Unfit(f"{path.name} cannot be read: {brief(str(error))}", f"a whole file of kind {', '.join(KINDS)}") from None
    return checked(vertices, faces, path.name)


def checked(vertices: np.ndarray, faces: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh that does not cross itself, its triangles counter-clockwise from outside; Unfit."""
    if not len(faces) or not np.isfinite(vertices).all():
        raise Unfit(f"{name} holds no triangles")
    if len(faces) > MOST_TRIANGLES:
        raise Unfit(f"{name} has {len(faces)} triangles", f"at most {MOST_TRIANGLES}: a coarser mesh")
    corner = vertices[faces]
    size = float((vertices.max(axis=0) - vertices.min(axis=0)).max())
    flat = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1) <= (1e-9 * size) ** 2
    if flat.any():
        raise Unfit(f"{name} has {int(flat.sum())} triangles without area", "triangles with an area")
    ways = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ends, count = np.unique(np.sort(ways, axis=1), axis=0, return_counts=True)
    if (count != 2).any():
        x = ", ".join(f"{one:.4g}" for one in vertices[ends[count != 2][0]].mean(axis=0))
        raise Unfit(f"{name} is not closed: {int((count != 2).sum())} of its edges are not between two triangles, one near ({x})")
    if len(np.unique(ways, axis=0)) < len(ways):
        raise Unfit(f"triangles of {name} face different ways")
    volume = float(np.einsum("fa,fa->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2]))) / 6
    faces = faces if volume > 0 else faces[:, ::-1]
    if abs(volume) < 1e-9 * size**3:
        raise Unfit(f"{name} holds no volume", "a mesh with an inside")
    if (place := crossing(vertices, faces)) is not None:
        x = ", ".join(f"{one:.4g}" for one in place)
        raise Unfit(f"{name} crosses itself, near ({x}): there it would be inside twice, or outside within", "a mesh whose parts do not overlap")
    return vertices, faces


def crossing(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray | None:
    """Where a ray upwards finds two triangles one after another that face the same way; rays that meet edges are left out."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    corner, found = vertices[faces], []
    axes = [low[a] + (high[a] - low[a]) * (np.arange(RAYS) + 0.5 + 0.1234 * (a + 1)) / (RAYS + 1) for a in range(2)]
    for x in axes[0]:
        some = corner[(corner[:, :, 0].min(axis=1) < x) & (corner[:, :, 0].max(axis=1) > x)]
        for y in axes[1]:
            one = some[(some[:, :, 1].min(axis=1) < y) & (some[:, :, 1].max(axis=1) > y)]
            away = one[:, :, :2] - (x, y)
            turn = np.roll(away, -1, axis=1)
            parts = away[:, :, 0] * turn[:, :, 1] - away[:, :, 1] * turn[:, :, 0]  # twice the areas opposite to the next corner but one
            hit = (parts > 0).all(axis=1) | (parts < 0).all(axis=1)
            if not hit.any():
                continue
            share = np.roll(parts[hit], -1, axis=1) / parts[hit].sum(axis=1, keepdims=True)
            z, up = np.sum(share * one[hit][:, :, 2], axis=1), parts[hit][:, 0] > 0
            order = np.argsort(z)
            wrong = np.flatnonzero(up[order][1:] == up[order][:-1])
            if len(wrong):
                found.append((x, y, z[order][wrong[0]]))
    return np.array(found[len(found) // 2]) if len(found) > 1 else None  # one alone may have met a corner


def shapes(experiment: Any) -> Iterator[tuple[tuple, Any, Any]]:
    """(place, what holds it, shape) of every mesh of bodies and tools."""
    for section in ("bodies", "tools"):
        for name, item in getattr(experiment, section).items():
            if getattr(item.shape, "kind", "") == "mesh":
                yield (section, name, "shape", "mesh"), item, item.shape


def embed(experiment: Any, folder: Path) -> Iterator[Finding]:
    """Fill in the triangles from the files, which are relative to `folder`; yields what is wrong with them."""
    for at, item, shape in list(shapes(experiment)):
        if not shape.data:
            try:
                data = packed(*read(folder / shape.file))
            except (OSError, ValueError) as error:
                yield Finding((*at, "file"), f"cannot read {brief(shape.file)}: {getattr(error, 'strerror', None) or error}", "a mesh beside the config")
                continue
            except Unfit as error:
                yield Finding((*at, "file"), error.message, error.allowed)
                continue
            shape = shape.model_copy(update={"data": data, "file": Path(shape.file).name})
            getattr(experiment, at[0])[at[1]] = item.model_copy(update={"shape": shape})
        if at[0] == "bodies" and (said := outside(shape, experiment.grid.dimension, experiment.grid.size)):
            yield Finding(at, f"{said}; {shape.unit:g} m are a unit of the file", "a shape inside [0, size]: `centre` puts it, `unit` sizes it", on_key=True)
