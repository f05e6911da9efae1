"""Ranges: the values of each parameter along its dimension, from lists, even ranges and samples; and how one is set in a config."""

from typing import Any

import numpy as np

from mpm.config.schema_paths import Path
from mpm.config.variation import Group, Parameter
from mpm.sweep.designs import sample_apart


def columns(group: Group) -> list[list[Any]]:
    """The values of each parameter of a group along its dimension."""
    if group.form == "sample":
        unit = sample_apart(group.design, group.size, len(group.parameters), group.seed)
        return [spread(parameter, unit[:, index]).tolist() for index, parameter in enumerate(group.parameters)]
    return [parameter.values or even(parameter, group.size) for parameter in group.parameters]


def spread(parameter: Parameter, unit: np.ndarray) -> np.ndarray:
    """Numbers in [0, 1) over the parameter's range, even in the number or in its logarithm."""
    if parameter.log:
        return np.clip(parameter.low * (parameter.high / parameter.low) ** unit, parameter.low, parameter.high)
    return parameter.low + (parameter.high - parameter.low) * unit


def even(parameter: Parameter, size: int) -> list[float]:
    """An even range with exact ends; 15 digits, so that 0.1, 0.2, 0.3 are the same points as when they are listed."""
    step = np.linspace(0.0, 1.0, size)
    values = [float(f"{value:.15g}") for value in spread(parameter, step)]
    values[0] = parameter.low
    if size > 1:
        values[-1] = parameter.high
    return values


def replaced(data: Any, path: Path, value: Any) -> Any:
    """A copy of nested containers with one value exchanged; what lies beside the path is shared."""
    key = path[0]
    below = value if len(path) == 1 else replaced(data.get(key, {}) if isinstance(data, dict) else data[key], path[1:], value)
    if isinstance(data, dict):
        return {**data, key: below}
    return [*data[: int(key)], below, *data[int(key) + 1 :]]
