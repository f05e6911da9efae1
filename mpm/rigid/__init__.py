"""Heat in bodies that do not move: an immersed Galerkin method on the scene's grid. No particles, no transfer (physics.md 12, 10).

    rho alpha(theta) d theta/dt = div(kappa(theta) grad theta),      -kappa d theta/dn = beta (theta - outside)     0 <= beta <= inf

nodes      quadratic B-splines of a body's box of nodes; matrices as stencils          geometry   cut quadrature to M, K, B: once a shape and grid
system     one body's laws and surroundings                                            band       compiled band Cholesky
linear     constant laws: consistent mass, SDIRK of order 4 or 2 (sdirk)               tables     theta(h), Kirchhoff's potential Pi(h)
chebyshev  laws of temperature: lumped mass, enthalpy, RKC of order 2                  newton     the same equations by SDIRK and Newton
drive      the loop over steps: sizes, outputs, crossings                              run        `solve`, the choice of method, `RigidRun`

Which method wins, measured on one core of a 2-core Zen 4 machine, geometry kept (tests/rigid/figures.py makes these tables):

FIGURES
"""

from mpm.rigid.run import Method, RigidRun, solve
from mpm.rigid.system import RigidBody

__all__ = ["Method", "RigidBody", "RigidRun", "solve"]
