"""What a dimension brings: the sides of its domain, its number of strains, its spins."""

import numpy as np

SIDES = {1: ("left", "right"), 2: ("left", "right", "bottom", "top"), "axisymmetric": ("axis", "outer", "bottom", "top"),
         3: ("left", "right", "front", "back", "bottom", "top")}  # fmt: skip
STRAINS = {1: 3, 2: 4, 3: 6}


def spin_tensor(omega, D: int) -> np.ndarray:
    """W with W x = omega cross x."""
    if D == 2:
        return np.array([[0.0, -omega], [omega, 0.0]])
    a, b, c = omega
    return np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
