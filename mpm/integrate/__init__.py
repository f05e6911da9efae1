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

Further files
    active_nodes         what particles mark of the nodes they touch
    body_force           A force and a heat source of their own at every particle
    deformation          F <- (1 + dt L) F: the total deformation gradient, carried only where surfaces or loads need it
    dither               what is added to a step in float32 before it is rounded on to positions, so that rounding favours no side
    fracture_surface     new surface where a body tears
    given_source         the body force and the heat that a config gives
    fragments            gaps in a body
    heat_threaded        the explicit or stabilised heat step of a body in slabs, by threads
    grid_heating         elastic heating as the source document has it
    nozzle               what of a body is still in its nozzle
    sorting              particles in the order of the nodes that they touch, where that pays
    state_check          what a block of steps begins from, looked at as its opening reads it
    step_parts           what a mechanical step works with: the method, the nodes, and where in a block of steps it is
    step_threaded        the mechanical step of a large scene in slabs, by threads
    stress_hencky        what the particles of a chunk answer their trial strains
    stress_neo_hookean   neo-Hookean response, eight particles at once
    traction             nominal tractions and drag on a body
"""
