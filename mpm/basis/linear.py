"""Hat functions on nodes of spacing h.

f = x/h - node on the left:  w = 1 - f, f;  sum w = 1, sum w d = 0, sum w d^2 = f (1 - f) h^2, so that the fitted slope is the derivative itself:
the B-spline and the MLS gradient are one.
Good for: showing what the smoother bases cure.   Fails when: particles cross cells: the gradient jumps there, and refinement makes it worse; and no step is
stable for a lone particle near a node (sum g^2/w = 1/(f (1 - f)) has no bound).
"""

import math

import numpy as np

from mpm.basis.roles import inverse_moment, room, second_moment, stencil
from mpm.state import PAD, Linear


@stencil.register(Linear)
def stencil_linear(basis, s):
    left = np.floor(s)
    f = s - left
    return int(left) + PAD, (1.0 - f, f), (-1.0, 1.0), (-f, 1.0 - f), (-1.0, 1.0)


@second_moment.register(Linear)
def second_moment_linear(basis, s):
    f = s - np.floor(s)
    return f * (1.0 - f)


@inverse_moment.register(Linear)
def inverse_moment_linear(basis):
    return math.nan  # mpm.scene.build takes the B-spline gradient, which is the same


@room.register(Linear)
def room_linear(basis):
    return 0.1
