"""Cubic B-splines on nodes of spacing h (Steffen, Kirby, Berzins 2008).

f = x/h - node on the left, e = 1 - f:  w = e^3/6, 2/3 - f^2 + f^3/2, 2/3 - e^2 + e^3/2, f^3/6;  sum w = 1, sum w d = 0, sum w d^2 = h^2/3.
Good for: smooth fields with few particles a cell, where the quadrature floor of the quadratic shows.   Fails when: cost matters more: 4^D nodes for 3^D.
"""

import numpy as np

from mpm.basis.roles import inverse_moment, room, second_moment, stencil
from mpm.jit import kernel
from mpm.state import PAD, Cubic

THIRD, SIXTH = 1.0 / 3.0, 1.0 / 6.0


@kernel(inline=True)
def weights(f):
    """Values at the four nodes."""
    e = 1.0 - f
    return SIXTH * e * e * e, 2.0 * THIRD - f * f + 0.5 * f * f * f, 2.0 * THIRD - e * e + 0.5 * e * e * e, SIXTH * f * f * f


@kernel(inline=True)
def slopes(f):
    """Derivatives times h."""
    e = 1.0 - f
    return -0.5 * e * e, f * (1.5 * f - 2.0), e * (2.0 - 1.5 * e), 0.5 * f * f


@stencil.register(Cubic)
def stencil_cubic(basis, s):
    left = np.floor(s)
    f = s - left
    w = weights(f)
    d = (-1.0 - f, -f, 1.0 - f, 2.0 - f)
    return int(left) + PAD - 1, w, slopes(f), d, (3.0 * d[0] * w[0], 3.0 * d[1] * w[1], 3.0 * d[2] * w[2], 3.0 * d[3] * w[3])


@second_moment.register(Cubic)
def second_moment_cubic(basis, s):
    return THIRD


@inverse_moment.register(Cubic)
def inverse_moment_cubic(basis):
    return 3.0


@room.register(Cubic)
def room_cubic(basis):
    return 1.1
