"""Heat in bodies that do not move: an immersed Galerkin method on the scene's grid. No particles, no transfer (docs/physics.md 12, 10).

    rho alpha(theta) d theta/dt = div(kappa(theta) grad theta),      -kappa d theta/dn = beta (theta - outside)     0 <= beta <= inf

nodes      quadratic B-splines of a body's box of nodes; matrices as stencils          geometry   cut quadrature to M, K, B: once a shape and grid
surroundings   what is outside, over time; radiation
system     one body's laws and surroundings                                            band       compiled band Cholesky; gradients   where that is too large
linear     constant laws: consistent mass, SDIRK of order 4 or 2 (sdirk)               tables     theta(h), Kirchhoff's potential Pi(h)
chebyshev  laws of temperature: lumped mass, enthalpy (enthalpy), RKC of order 2       newton     the same equations by SDIRK and Newton
hats       hat functions, M-matrices                                                   bounded    their steps: nothing beyond its data
touching   which points of a surface lie on another body        coupling   heat through a shared surface (Nitsche)
group      bodies that conduct into one another as one system   joined     their steps
time_loop  the loop over steps: sizes, outputs, crossings                              run        `solve`, `outlook`, the choice of method
gather     what came out, of all bodies and of each

Measured by tests/rigid/figures.py: one core of a busy 2-core Zen 4 machine, best of five, geometry kept (6 ms for the loaf, 3 for the disc).

Loaf, 780 s, 1 mm, 1 482 unknowns, tolerance 1e-3   | time to 95 degC | steps | ms     explicit wins by 7 to 30 at the same answer: a latent front wants
explicit, lumped mass, RKC                          | 685.98 s        | 97    | 22     short steps, and Newton several factorisations each. 2 mm: 678.1 s
implicit, lumped mass, SDIRK 2 and Newton           | 685.74 s        | 64    | 348    in 9 ms, 0.5 mm: 688.7 s in 96 ms (tolerance 1e-4: 688.59 s, 135);
implicit, lumped mass, SDIRK 4 and Newton           | 685.90 s        | 47    | 632    misfit to the measured curve 2.15 degC centre, 4.5 degC surface.

Disc, Bi 10, t = 0.2, rms error and ms at 3, 4, 6, 8, 12 cells a radius (73 to 605 unknowns): implicit wins by 10 to 50 in error
implicit, consistent mass, 4 steps of fixed size | 5.5e-4 0.3 | 2.3e-4 0.4 | 1.0e-4 0.6 | 8.2e-5 1.0 | 7.7e-5 2.0
the same, 8 steps                                | 5.3e-4 0.5 | 2.1e-4 0.6 | 5.8e-5 0.9 | 2.4e-5 1.7 | 7.0e-6 3.4
the same, tolerance 1e-4 (19 to 27 steps)        | 5.3e-4 1.0 | 2.1e-4 1.4 | 5.8e-5 3.2 | 2.4e-5 5.5 | 6.8e-6 16
explicit, lumped mass, tolerance 1e-4            | 9.5e-3 1.5 | 4.5e-3 1.7 | 1.6e-3 2.1 | 8.3e-4 2.5 | 3.4e-4 3.9

Slab, worst of five offsets, n = 8 to 64: order 3 implicit (Bi 10: 1.7e-5, 2.0e-6, 2.4e-7, 3.2e-8), order 2 explicit (2.7e-3, 6.8e-4, 1.7e-4, 4.3e-5).
Sphere, 6 cells a radius, Bi 1, 10, inf: 3-D 1.4e-5, 5.2e-5, 1.6e-4 (2 304 unknowns, 0.7 to 1.0 s); axisymmetric 1.4e-5, 5.0e-5, 1.1e-4 (121 unknowns, 2 ms).
Bounded, tolerance 1e-5: slab as above, Bi 1: 6.4e-4, 1.6e-4, 3.9e-5, 9.8e-6; Bi 10: 4.4e-3, 6.2e-4, 1.6e-4, 3.9e-5; Bi inf: 2.1e-2, 1.0e-2, 5.2e-3, 2.6e-3.
Fails when   a temperature must stay strictly between its data: in the first steps of a shock splines pass it by up to 26 % of the range at a corner one cell
             wide (tests/rigid/test_bounded.py): method `bounded` never does, of order 2 (order 1 behind beta = inf);
             a body in 3-D behind beta = inf is finer than 9 cells a radius: 200 iterations a stage instead of 5.

Further files
    side_by_side   nodes, stencils and surroundings of several bodies under one numbering
    ordered   sums of products in an order of their own
"""

from mpm.rigid.gather import RigidRun
from mpm.rigid.group import Joint
from mpm.rigid.run import Method, outlook, solve
from mpm.rigid.system import RigidBody

__all__ = ["Joint", "Method", "RigidBody", "RigidRun", "outlook", "solve"]
