"""Quadratic B-splines on nodes of spacing h (docs/physics.md 3).

f = x/h - nearest node:  w = 1/2 (1/2 - f)^2, 3/4 - f^2, 1/2 (1/2 + f)^2;  sum w = 1, sum w d = 0, sum w d^2 = h^2/4.
Good for: nearly everything.   Fails when: particles are fewer than two a cell (the quadrature floor).
"""

import numpy as np

from mpm.basis.roles import inverse_moment, room, second_moment, stencil
from mpm.jit import kernel
from mpm.state import PAD, Quadratic

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


@stencil.register(Quadratic)
def stencil_quadratic(basis, s):
    nearest = np.floor(s + 0.5)
    f = s - nearest
    w = weights(f)
    left, right = -1.0 - f, 1.0 - f
    return int(nearest) + PAD - 1, w, slopes(f), (left, -f, right), (4.0 * left * w[0], -4.0 * f * w[1], 4.0 * right * w[2])


@second_moment.register(Quadratic)
def second_moment_quadratic(basis, s):
    return SECOND_MOMENT


@inverse_moment.register(Quadratic)
def inverse_moment_quadratic(basis):
    return 4.0


@room.register(Quadratic)
def room_quadratic(basis):
    return 0.6
