"""Quadratic B-splines on nodes of spacing h (physics.md 3).

w = 1/2 (1/2 - f)^2, 3/4 - f^2, 1/2 (1/2 + f)^2;  sum w = 1, sum w d = 0, sum w d^2 = h^2/4.
"""

from mpm.jit import kernel

SECOND_MOMENT = 0.25  # sum_i w d d^T = SECOND_MOMENT h^2 1


@kernel(inline=True)
def weights(f):
    """Values at the three nodes."""
    left, right = 0.5 - f, 0.5 + f
    return 0.5 * left * left, 0.75 - f * f, 0.5 * right * right


@kernel(inline=True)
def slopes(f):
    """Derivatives times h."""
    return f - 0.5, -2.0 * f, f + 0.5
