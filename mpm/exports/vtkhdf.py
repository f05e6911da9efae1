"""VTKHDF: one file over time for ParaView, by h5py alone. Format: docs.vtk.org, "VTKHDF file format", version 2.

Particles are PolyData. Every step is one part of its own points; all steps share one list of vertices, 0, 1, 2, ..., of which a step takes as many as it
has points. Fields on the grid are ImageData whose arrays have the step as their first dimension; nodes without material are NaN.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np

from mpm.exports import replaced
from mpm.exports.space import spatial
from mpm.opened import Point, Results

PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def write(found: Results, point: Point, path: Path) -> list[Path]:
    """The files of one point: particles to `path`, fields on the grid to `<stem>.grid.vtkhdf` beside it where there are both."""
    first, written = point.shots[0], []
    if "position" in first.particles:
        written.append(put(path, lambda root: particles(root, point, found.dimension)))
    if first.grid:
        place = path.with_name(f"{path.stem}.grid{path.suffix}") if written else path
        written.append(put(place, lambda root: grid(root, point)))
    if not written:
        from mpm.exports import ExportError

        raise ExportError("the snapshots hold neither positions of particles nor fields on the grid (add position to output.snapshots.particles)")
    return written


def put(path: Path, fill: Any) -> Path:
    """A VTKHDF file, whole or not at all."""
    import h5py

    temporary, settle = replaced(path)
    try:
        with h5py.File(temporary, "w") as file:
            root = file.create_group("VTKHDF")
            root.attrs["Version"] = np.array([2, 0], np.int64)
            fill(root)
        settle()
    except OSError as error:
        if error.errno and not error.filename:  # h5py does not say which file
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from None
        raise
    finally:
        temporary.unlink(missing_ok=True)
    return path


def kind(root: Any, name: str) -> None:
    """What the file holds."""
    root.attrs.create("Type", name.encode("ascii"), dtype=f"S{len(name)}")


def steps(root: Any, times: np.ndarray) -> Any:
    """The group that says when each step is."""
    group = root.create_group("Steps")
    group.attrs["NSteps"] = np.int64(len(times))
    group["Values"] = np.asarray(times, float)
    return group


def particles(root: Any, point: Point, dimension: Any) -> None:
    """PolyData of vertices, frame by frame."""
    kind(root, "PolyData")
    shots, data, counts = point.shots, root.create_group("PointData"), []
    for k in range(len(shots)):
        fields = {name: spatial(name, values, dimension) for name, values in shots[k].particles.items()}
        counts.append(len(fields["position"]))
        for name, values in fields.items():
            append(root if name == "position" else data, "Points" if name == "position" else name, values)
    many, first = len(counts), np.cumsum(counts) - counts
    root["NumberOfPoints"] = np.array(counts, np.int64)
    for cells in ("Vertices", "Lines", "Polygons", "Strips"):
        group, longest = root.create_group(cells), max(counts) if cells == "Vertices" else 0
        group["NumberOfCells"] = group["NumberOfConnectivityIds"] = np.array(counts if longest else [0] * many, np.int64)
        group["Connectivity"], group["Offsets"] = np.arange(longest, dtype=np.int64), np.arange(longest + 1, dtype=np.int64)
    group = steps(root, shots.times)
    group["PartOffsets"], group["NumberOfParts"] = np.arange(many, dtype=np.int64), np.ones(many, np.int64)
    group["PointOffsets"] = first.astype(np.int64)
    group["CellOffsets"] = group["ConnectivityIdOffsets"] = np.zeros((many, 4), np.int64)
    for name in data:
        group.create_dataset(f"PointDataOffsets/{name}", data=first.astype(np.int64))


def append(group: Any, name: str, values: np.ndarray) -> None:
    """Rows at the end of an array."""
    if name not in group:
        group.create_dataset(name, data=values, maxshape=(None, *values.shape[1:]), chunks=(max(1, len(values)), *values.shape[1:]), **PACKED)
        return
    target = group[name]
    target.resize(len(target) + len(values), axis=0)
    target[len(target) - len(values) :] = values


def grid(root: Any, point: Point) -> None:
    """ImageData over time."""
    kind(root, "ImageData")
    shots, axes = point.shots, point.shots.axes
    named = {{"r": "x"}.get(name, name): values for name, values in axes.items()}
    lines = [named.get(name, np.zeros(1)) for name in "xyz"]
    root.attrs["WholeExtent"] = np.array([bound for line in lines for bound in (0, len(line) - 1)], np.int64)
    root.attrs["Origin"] = np.array([line[0] for line in lines])
    root.attrs["Spacing"] = np.array([line[1] - line[0] if len(line) > 1 else 1.0 for line in lines])
    root.attrs["Direction"] = np.eye(3).ravel()
    shape, data = tuple(len(line) for line in reversed(lines) if len(line) > 1), root.create_group("PointData")
    for k in range(len(shots)):
        for name, values in shots[k].grid.items():
            append(data, name, np.asarray(values, np.float32).reshape(1, *shape))
    group = steps(root, shots.times)
    for name in data:
        group.create_dataset(f"PointDataOffsets/{name}", data=np.arange(len(shots), dtype=np.int64))
