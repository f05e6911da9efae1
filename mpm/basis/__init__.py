"""Bases: how a particle sees the nodes around it.

Role      quadratic(f) -> weights, derivatives, offsets: three each, for the nodes r-1, r, r+1
Shapes    f = x/h - r in [-1/2, 1/2], r the nearest node            Units  derivatives and offsets in cells (divide, multiply by h)
May use   mpm.jit                                                  May not  see particles, grids or laws
To add    a file here and its name in config.numerics; tests/test_basis.py checks partition of unity and linear reproduction.
"""
