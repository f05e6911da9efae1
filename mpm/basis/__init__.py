"""Bases: how a particle sees the nodes around it, in one direction; the product over directions is the transfers' business.

Roles     stencil(basis, s) -> first, w, g, d, b    s = x/h; first: index in a padded array of the first node seen; then a tuple each, one entry a node:
          w weights; g their derivatives; d offsets x_i/h - s; b = w d/(sum w d^2), which fits a slope by least squares (the MLS gradient)
          second_moment(basis, s) -> sum w d^2      inverse_moment(basis) -> its inverse where it is a constant
          room(basis)                               how far inside the outermost node of an array a particle must stay
Units     cells: divide g and b by h, multiply d by h. The number of nodes seen, len(w), is a constant at compile time.
May use   mpm.state, mpm.jit                                       May not  see particles, grids or laws
To add    a kind in mpm.state, a file here, its name in config.numerics and BASES; tests/test_bases.py ranges over BASES.

Further files
    cubic       cubic B-splines on nodes of spacing h (Steffen, Kirby, Berzins 2008)
    linear      hat functions on nodes of spacing h
    quadratic   quadratic B-splines on nodes of spacing h
    roles       what a basis is asked
"""

from mpm.basis import cubic, linear, quadratic  # registers the bases
from mpm.basis.roles import inverse_moment, room, second_moment, stencil
from mpm.state import Cubic, Linear, Quadratic

BASES = {"linear": Linear, "quadratic": Quadratic, "cubic": Cubic}

__all__ = ["BASES", "cubic", "inverse_moment", "linear", "quadratic", "room", "second_moment", "stencil"]
