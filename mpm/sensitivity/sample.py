"""Sample: what a dataset holds of a design: parameters, observables, and which points are ok; any swept dimensions, one after another."""

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.records.variables import OK, SKIPPED, threshold
from mpm.sweep.lock import Refused

OWN = {"status", "error", "advice", "warnings", "warning_flags", "outcome", "run_id", "steps", "step_shortest", "step_longest", "wall_time", "attempts",
       "model_name", "frame_name", "frame_why"}  # fmt: skip


@dataclass
class Parameter:
    """A parameter that varies; `log`: evenly in its logarithm."""

    name: str
    values: np.ndarray
    log: bool
    units: str
    config_path: str

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value, in SI."""
        return float(self.values.min()), float(self.values.max())

    def unit(self, values: Any) -> np.ndarray:
        """0 to 1 over the range."""
        low, high = self.ends
        v = np.asarray(values, dtype=float)
        return np.log(v / low) / math.log(high / low) if self.log else (v - low) / (high - low)

    def back(self, unit: Any) -> np.ndarray:
        """From 0 to 1."""
        low, high = self.ends
        return low * (high / low) ** np.asarray(unit) if self.log else low + (high - low) * np.asarray(unit)


@dataclass
class Sample:
    """`outputs`: NaN where a point is not ok, or where what it tells was not reached. `late`: what is then known of it, that it is at least so much."""

    parameters: list[Parameter]
    outputs: dict[str, np.ndarray]
    units: dict[str, str]
    long_names: dict[str, str]
    ok: np.ndarray
    reasons: np.ndarray
    late: dict[str, float]
    base: int  # rows of a Saltelli design, 0 elsewhere
    title: str
    config: dict

    @property
    def refined(self) -> bool:
        """Whether refinement placed the points, so that they are no sample of the ranges."""
        return bool((self.config.get("sweep") or {}).get("refine"))

    @property
    def unit(self) -> np.ndarray:
        """Parameters over their ranges, shape (points, parameters)."""
        return np.stack([parameter.unit(parameter.values) for parameter in self.parameters], axis=1)


def read(tree: Any) -> Sample:
    """The sample of a sweep's dataset; Refused where nothing varies."""
    root = tree.to_dataset() if hasattr(tree, "to_dataset") else tree
    config = json.loads(root.attrs.get("config_resolved", "{}"))
    sweep = config.get("sweep") or {}
    dims = root["status"].dims
    follows = {*(sweep.get("derive") or {}), *(config.get("formulas") or {}), *(path.removesuffix(".value") for path in config.get("formulas") or {})}
    keep = np.asarray(root["status"].values).ravel() != SKIPPED

    def flat(row: Any) -> np.ndarray:
        """Over all swept dimensions, one point after another."""
        inner = row.transpose(*(dim for dim in dims if dim in row.dims)).values
        return np.broadcast_to(inner[tuple(slice(None) if dim in row.dims else None for dim in dims)], root["status"].shape).ravel()[keep]

    parameters = []
    for name, row in root.coords.items():
        path = row.attrs.get("config_path", "")
        if len(row.dims) == 1 and path and path not in follows and row.dtype.kind in "fi" and np.isfinite(row.values).all() and np.ptp(row.values) > 0:
            parameters.append(Parameter(str(name), flat(row).astype(float), logarithmic(row, sweep, str(name), path), row.attrs.get("units", "1"), path))
    if not parameters:
        raise Refused("nothing in this dataset varies by number; sensitivity needs a sweep")
    status = flat(root["status"])
    listed = [name for name, row in root.data_vars.items() if name not in OWN and row.dtype.kind == "f" and row.dims == dims]
    outputs = {name: np.where(status == OK, flat(root[name]).astype(float), np.nan) for name in listed}
    probes = (config.get("output") or {}).get("probes") or {}
    end = (config.get("time") or {}).get("end", math.nan)
    late = {name: float(end) for name in outputs if threshold(name, probes) is not None and isinstance(end, float | int)}
    outputs = {name: values for name, values in outputs.items() if np.isfinite(values).any() and np.nanmax(values) > np.nanmin(values)}
    design = sweep.get("sample") or {}
    base = int(design["saltelli"]["count"]) if "saltelli" in design and len(dims) == 1 else 0
    units = {name: root[name].attrs.get("units", "1") for name in outputs}
    long_names = {name: root[name].attrs.get("long_name", name.replace("_", " ")) for name in outputs}
    reasons = np.array([str(text).partition(":")[0] for text in flat(root["error"])])
    return Sample(parameters, outputs, units, long_names, status == OK, reasons, late, base, root.attrs.get("title", ""), config)


def logarithmic(row: Any, sweep: dict, name: str, path: str) -> bool:
    """Whether a parameter is spread evenly in its logarithm: as its range says, else as its values lie."""
    for design in (sweep.get("sample") or {}).values():
        for key, span in (design or {}).get("ranges", {}).items():
            if key in (name, path) or path.endswith("." + key):
                return isinstance(span, dict)
    values = np.unique(row.values)
    if values[0] <= 0 or len(values) < 3:
        return False
    return bool(np.std(np.diff(np.log(values))) / np.mean(np.diff(np.log(values))) < np.std(np.diff(values)) / np.mean(np.diff(values)))
