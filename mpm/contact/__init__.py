"""Bodies that meet walls and each other: hard non-penetration at the true pieces of their surfaces.

    lambda_n >= 0,   u_n + g/dt >= 0,   lambda_n (u_n + g/dt) = 0,   |lambda_t| <= mu lambda_n opposite to sliding        a contact, every step
    u = sum W v_A - (velocity of the obstacle, or sum W v_B),        v_i += W_i lambda/m_i

skin      where the pieces of a surface are now             spots     nodes and weights of a piece
find      which of them are near what, and the gap g        weights   W: linear-exact, and balanced with the stress of the particles
tools     rigid bodies that move as they are told            books     forces, torques, areas and heat of what meets, for the records
solve     the impulses, by projected Gauss-Seidel           step      the mechanical step of scenes in which something is near (integrate/explicit.py elsewhere)
meeting   what of it outlasts a step, and when it is needed

One velocity field a body, or a group of welded ones. No stiffness, no shorter step, no gap, no tension.
May use   mpm.integrate and below                          May not  see configs
Fails when   a contact is narrower than three cells (narrow.py: forces balance, pressure means nothing); a flow tears new surface, which has no pieces:
             against walls particles then stand for it, between bodies nothing does; a body folds on to itself; sheets are thinner than a cell

Further files
    block      the arrays that a run works on, and one block of its steps by whichever kernel it needs
    course     what changes over time beside heat
    conduct    one implicit heat step of bodies that touch
    distance   signed distances of tools and their gradients
    drive      how tools move as they are told
    found      the contacts of one step
    insync     velocities at the time of the positions
    outlook    how much of a run has something near, from its start alone
    step_threaded  the same for a scene in slabs, by threads; solve_threaded its impulses
    texture    what a press that bites twice says of a body
    triangles  signed distance of a closed triangle mesh
    pairs      contacts between bodies: a scene of one body has NoPairs, and compiles nothing of them
    held       bodies that stand still beside others that move
    links      where heat passes between bodies
    sums       what the weights want of the particles near a contact, kept while little moves
    stretched  how far the surfaces of a pair have grown, for a warning
    narrow     how many cells a contact is wide, for a warning
    overlap    how far what meets has entered each other, for a warning
"""
