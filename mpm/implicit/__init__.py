"""Implicit mechanics: steps of seconds where explicit ones follow every wave (docs/physics.md 17).

Each step minimises an incremental potential over nodal displacements, by Newton's method, the true inertia left in.
nodes     weights, numbering, masses and ghost penalty of one step, at the positions of its start
lasting   the same in the total frame: weights and gradients of the reference shape, once for the run
trial     increment, strains, gradients in the moved shape
spans     F-bar: changes of volume averaged over knot spans, where a body asks for it
assemble  potential, residual and tangent of the particles in one and two directions
volume    the same in three
matrix    a band and its Cholesky factor, or blocks and conjugate gradients; what is skew beside it
contact   the same of pieces of surface at contact walls and tools, with friction
following tractions by present area, which turn and grow with the surface within the step
free      tools that a force moves: one more unknown each
newton    the minimisation: line search, shifts
nozzle    nodes and particles that a nozzle moves
deliver   what particles keep of the nodes' answer
extrapolate  a step and two halves of it make one of order 2
drive     heat and mechanics step by step, in steps chosen by their error; what fails is cut and tried again
Used only where `method.mechanics` says so: nothing of it is compiled otherwise.

May use   mpm.state, mpm.basis, mpm.boundary, mpm.materials, mpm.heat, mpm.contact, mpm.integrate, mpm.total; SciPy's LAPACK     May not  see configs or records
"""
