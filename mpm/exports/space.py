"""Fields in three directions, as other programs have them: x, y, z; an axisymmetric scene lies in the plane of x = r and z, with y = hoop.

vectors   (N, 3)    tensors, symmetric   (N, 6): xx yy zz xy yz xz, as VTK orders them    gradient of velocity   (N, 9), row by row
"""

from typing import Any

import numpy as np

PLACES = {1: (0,), 2: (0, 1), "axisymmetric": (0, 2), 3: (0, 1, 2)}  # of the scene's directions among x, y, z
SYMMETRIC = {1: (0, 1, 2), 2: (0, 1, 2, 3), "axisymmetric": (0, 2, 1, 5), 3: (0, 1, 2, 3, 4, 5)}  # of the columns of a tensor (records.variables.components)
VECTORS = ("position", "velocity", "displacement", "reference_position")
TENSORS = ("stress", "stress_recovered", "strain")


def spatial(name: str, values: np.ndarray, dimension: Any) -> np.ndarray:
    """A field of particles in three directions, numbers as float32, counts as int32."""
    values = np.asarray(values)
    kind = np.int32 if values.dtype.kind in "iu" else np.float32
    if name in VECTORS:
        return placed(values.reshape(len(values), -1), PLACES[dimension], 3, kind)
    if name in TENSORS:
        return placed(values, SYMMETRIC[dimension], 6, kind)
    if name == "velocity_gradient":
        axes = PLACES[dimension]
        return placed(values, [3 * i + j for i in axes for j in axes], 9, kind)
    return values.astype(kind)


def placed(values: np.ndarray, columns: Any, width: int, kind: Any) -> np.ndarray:
    """Columns of a wider array of zeros."""
    made = np.zeros((len(values), width), kind)
    made[:, list(columns)] = values
    return made
