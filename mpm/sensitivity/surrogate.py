"""Surrogate: radial basis functions (SciPy's thin-plate splines with a linear part) through a smooth sample, over the unit cube of the ranges; and `ask`.

Chosen over chaospy's polynomials, which need their own designs and a degree: splines take any sample, run through its points, and bring no dependency.
Error    cross-validated: each of FOLDS parts predicted from the others; root mean square and 95th percentile. Fails when: the observable jumps, or parameters
         are so many that points are far apart; the error says so
"""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.sensitivity.sample import Sample
from mpm.sweep.lock import Refused

FOLDS, FINE, LEAST = 10, 400, 8
LARGEST = 0.5  # of the parameter's range: an answer that is less certain is none


@dataclass
class Surrogate:
    """`error`: 95th percentile of the cross-validated error; `explained`: share of the variance that it predicts."""

    model: Any
    error: float
    rms: float
    explained: float
    points: int

    def __call__(self, unit: np.ndarray) -> np.ndarray:
        return self.model(unit)


def build(unit: np.ndarray, y: np.ndarray, seed: int = 0) -> Surrogate:
    """Through the known points."""
    from scipy.interpolate import RBFInterpolator

    unit, first = np.unique(unit, axis=0, return_index=True)
    y = y[first]
    if len(y) < max(LEAST, unit.shape[1] + 2):
        raise Refused(f"{len(y)} points are too few for a surrogate of {unit.shape[1]} parameters; at least {max(LEAST, unit.shape[1] + 2)} are needed")
    near = 100 if len(y) > 2000 else None
    part = np.random.default_rng(seed).permutation(len(y)) % min(FOLDS, len(y))
    off = np.empty(len(y))
    for fold in range(part.max() + 1):
        off[part == fold] = RBFInterpolator(unit[part != fold], y[part != fold], neighbors=near, degree=1)(unit[part == fold]) - y[part == fold]
    rms = float(np.sqrt(np.mean(off**2)))
    return Surrogate(RBFInterpolator(unit, y, neighbors=near, degree=1), float(np.percentile(np.abs(off), 95)), rms, float(1 - rms**2 / np.var(y)), len(y))


def indices(surrogate: Surrogate, parameters: int, base: int = 4096, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """First and total indices, (value, lower, upper); the ends reach as far as what the surrogate does not explain can move them (Cauchy and Schwarz)."""
    from mpm.sensitivity.indices import saltelli
    from mpm.sweep.designs import unit_sample

    unit = unit_sample("saltelli", base * (parameters + 2), parameters, seed)
    first, total, _ = saltelli(surrogate(unit), base, parameters, seed)
    missed = max(0.0, 1 - surrogate.explained)
    for rows, share in ((first, first[:, 0]), (total, 1 - total[:, 0])):
        reach = 2 * np.sqrt(np.clip(share, 0, 1) * missed) + missed
        rows[:, 1:] += np.stack([-reach, reach], axis=1)
    return first, total


@dataclass(frozen=True)
class Answer:
    """Where a parameter gives the asked value, with its interval, in SI."""

    parameter: str
    units: str
    value: float
    low: float
    high: float


def ask(sample: Sample, question: str, by: str | None = None, at: dict[str, float] | None = None) -> tuple[list[Answer], Surrogate, dict[str, float]]:
    """`time_to_centre_95_degC = 660`: every value of the parameter `by` that gives it, the others `at` their values (the config's own unless given)."""
    match = re.fullmatch(r"\s*([A-Za-z_][\w.]*)\s*=\s*(.+?)\s*", question)
    name = match[1].replace(".", "_") if match else ""
    if not match or name not in sample.outputs:
        raise Refused(f"{question!r}: say NAME = VALUE with one of {', '.join(sample.outputs)}")
    wanted = number(match[2], sample.units[name])
    names = [parameter.name for parameter in sample.parameters]
    wrong = [one for one in [*(at or {}), *([by] if by else [])] if one not in names]
    if wrong:
        raise Refused(f"{wrong[0]!r} does not vary here; {', '.join(names)} do")
    if by is None:
        free = [one for one in names if one not in (at or {})]
        if len(free) != 1:
            raise Refused(f"{', '.join(free) or 'nothing'} could answer: say which with --by, and fix the others with --at NAME=VALUE")
        by = free[0]
    k, held = names.index(by), {one: (at or {}).get(one, middle(sample, one)) for one in names if one != by}
    y = sample.outputs[name]
    known = np.isfinite(y)
    surrogate = build(sample.unit[known], y[known])
    spread = float(np.ptp(y[known]))
    if surrogate.error > 0.5 * spread:
        raise Refused(f"the surrogate of {name} is off by {surrogate.error:.3g}, and {name} spans {spread:.3g}: it cannot answer; take more points")
    grid = np.tile([float(p.unit(held[p.name])) if p.name != by else 0.0 for p in sample.parameters], (FINE + 1, 1))
    grid[:, k] = np.linspace(0, 1, FINE + 1)
    reach = float(np.max(np.abs(np.delete(grid[0], k) - 0.5), initial=0))
    if reach > 0.5 + 1e-9:
        raise Refused("a value of --at lies outside the sample's range, where the surrogate knows nothing")
    curve, parameter = surrogate(grid) - wanted, sample.parameters[k]
    roots = crossings(grid[:, k], curve)
    if not roots:
        low, high = parameter.ends
        span = f"it goes from {curve.min() + wanted:.4g} to {curve.max() + wanted:.4g}"
        raise Refused(f"no {by} between {low:.4g} and {high:.4g} gives {name} = {wanted:.6g}: {span}")
    found = []
    for root in roots:
        low, high = within(grid[:, k], curve, root, surrogate.error)
        if high - low > LARGEST:
            raise Refused(f"the surrogate of {name} is off by {surrogate.error:.3g}: {by} could be {float(parameter.back(low)):.4g} to "
                          f"{float(parameter.back(high)):.4g}, which is no answer; take more points")  # fmt: skip
        found.append(Answer(by, parameter.units, *(float(parameter.back(u)) for u in (root, low, high))))
    return found, surrogate, held


def crossings(x: np.ndarray, f: np.ndarray) -> list[float]:
    """Where a curve is zero."""
    at = np.flatnonzero(np.sign(f[:-1]) * np.sign(f[1:]) < 0)
    return [float(x[i] - f[i] * (x[i + 1] - x[i]) / (f[i + 1] - f[i])) for i in at] + [float(one) for one in x[f == 0]]


def within(x: np.ndarray, f: np.ndarray, root: float, error: float) -> tuple[float, float]:
    """The stretch round a root where the curve is within the error of zero."""
    up = crossings(x, f - error) + crossings(x, f + error)
    return max((u for u in up if u < root), default=float(x[0])), min((u for u in up if u > root), default=float(x[-1]))


def middle(sample: Sample, name: str) -> float:
    """What the config says a parameter is, where that lies in the range; else the middle of it."""
    parameter = next(one for one in sample.parameters if one.name == name)
    value: Any = sample.config
    for key in parameter.config_path.split("."):
        value = value.get(key) if isinstance(value, dict) else value[int(key)] if isinstance(value, list) and key.isdigit() and int(key) < len(value) else None
    value = value.get("value") if isinstance(value, dict) else value  # a named parameter
    low, high = parameter.ends
    return float(value) if isinstance(value, float | int) and low <= value <= high else float(parameter.back(0.5))


def number(text: str, units: str) -> float:
    """A number in SI, or text with a unit."""
    try:
        return float(text)
    except ValueError:
        pass
    from mpm.config.units import UnitError, convert

    try:
        return convert(text, "" if units == "1" else units, "value")
    except UnitError as error:
        raise Refused(f"{text!r}: {error}") from None
