"""OpenUSD: the particles of one point as UsdGeom.Points over time, every field as a primvar. Time codes are seconds times RATE."""

from pathlib import Path
from typing import Any

import numpy as np

from mpm.exports import ExportError, needed, replaced
from mpm.exports.space import spatial
from mpm.opened import Point, Results

RATE = 24.0


def write(found: Results, point: Point, path: Path) -> list[Path]:
    """One stage: /particles, in metres; the third direction (of plane scenes the second) is up."""
    needed("pxr", "usd")
    from pxr import Sdf, Usd, UsdGeom, Vt

    if "position" not in point.shots[0].particles:
        raise ExportError("the snapshots hold no positions (add position to output.snapshots.particles)")
    temporary, settle = replaced(path)
    try:
        stage = Usd.Stage.CreateNew(str(temporary))
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y if found.dimension in (1, 2) else UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(RATE)
        stage.SetStartTimeCode(float(point.shots.times[0]) * RATE)
        stage.SetEndTimeCode(float(point.shots.times[-1]) * RATE)
        points = UsdGeom.Points.Define(stage, "/particles")
        stage.SetDefaultPrim(points.GetPrim())
        places = UsdGeom.PrimvarsAPI(points)
        types = {0: Sdf.ValueTypeNames.FloatArray, 3: Sdf.ValueTypeNames.Float3Array}
        for k, when in enumerate(point.shots.times):
            code = float(when) * RATE
            fields = {name: spatial(name, values, found.dimension) for name, values in point.shots[k].particles.items()}
            x = fields.pop("position")
            points.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(x), code)
            points.CreateExtentAttr().Set(Vt.Vec3fArray.FromNumpy(np.stack([x.min(axis=0), x.max(axis=0)])), code)
            if k == 0:
                points.CreateWidthsAttr(Vt.FloatArray.FromNumpy(np.full(len(x), width(x), np.float32)))
            if "id" in fields:
                points.CreateIdsAttr().Set(Vt.Int64Array.FromNumpy(fields.pop("id").astype(np.int64)), code)
            if "velocity" in fields:
                points.CreateVelocitiesAttr().Set(Vt.Vec3fArray.FromNumpy(fields["velocity"]), code)
            for name, values in fields.items():
                size = values.shape[1] if values.ndim == 2 and values.shape[1] == 3 else 0
                if values.ndim == 2 and not size:  # a tensor: its components one after another
                    primvar = places.CreatePrimvar(name, types[0], UsdGeom.Tokens.vertex, values.shape[1])
                elif values.dtype.kind == "i":
                    primvar = places.CreatePrimvar(name, Sdf.ValueTypeNames.IntArray, UsdGeom.Tokens.vertex)
                else:
                    primvar = places.CreatePrimvar(name, types[size], UsdGeom.Tokens.vertex)
                primvar.Set(converted(Vt, values), code)
        stage.GetRootLayer().Save()
        settle()
    finally:
        temporary.unlink(missing_ok=True)
    return [path]


def converted(Vt: Any, values: np.ndarray) -> Any:
    """An array as USD has it."""
    if values.dtype.kind == "i":
        return Vt.IntArray.FromNumpy(values)
    if values.ndim == 2 and values.shape[1] == 3:
        return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values))
    return Vt.FloatArray.FromNumpy(np.ascontiguousarray(values).ravel())


def width(x: np.ndarray) -> float:
    """A diameter with which neighbours about touch: the edge of an equal share of the box round all, in the directions that it has."""
    sides = np.ptp(x, axis=0)
    sides = sides[sides > 1e-6 * sides.max()] if sides.max() > 0 else np.ones(1)
    return float((np.prod(sides) / len(x)) ** (1 / len(sides)))
