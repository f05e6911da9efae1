"""Integration: what happens in a step, and how long a step may be.

particle_update.py    a particle's answer to the velocity gradient: strain, flow, stress, heating, and what it scatters next
heat_step.py  one explicit heat step: scatter, conduct, exchange, gather
heat_chebyshev.py  the same by stabilised steps of order 2; bounds.py  temperatures kept between their bounds
heat_implicit.py  the same by conjugate gradients (heat_matrix.py): any step, any beta
enthalpy_steps.py  the three where alpha follows temperature, on nodes that take up enthalpy (enthalpy_nodes.py)
surface_flux.py     surface pieces during a heat step; surroundings.py  who acts on which of them, hot walls
xpic.py    XPIC's extra transfers
fbar.py    F-bar: changes of volume averaged over the grid
explicit.py   the mechanical step as the algorithm box of docs/physics.md 4
timestep.py   every explicit limit, and which one binds
"""
