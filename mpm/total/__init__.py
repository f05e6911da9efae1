"""The total-Lagrangian frame: a body that deforms without flowing far, on weights and gradients of its reference shape, computed once.

    u_i, v_i on the nodes;   F = 1 + sum u_i grad_X w_i(X_p);   P = tau F^-T;   m_i dp_i/dt = -sum V0 P grad_X w_i + m_i g + int w_i T dA + ...;   v from p

Particles are quadrature points of the reference shape (mpm.scene.quadrature): exact for what these splines make of an affine motion, wherever the surface
lies in its cell. Nothing is transferred from step to step, so there is no damping, no crossing of cells, no numerical fracture, and the answer at rest
depends neither on the step nor on the path.

reference   the state (Reference), its energies, and what the particles show of it
strain      from the gradient of displacement to trial strains, and from Kirchhoff stress to the first Piola-Kirchhoff stress, by dimension
step        velocity Verlet on the nodes; the largest stable step
Weights     Reference.X gives them; implicit mechanics and contact may use the same: the sparsity lasts as long as the run
Source      A. de Vaucorbeil, V. P. Nguyen, C. R. Hutchinson, Comput. Methods Appl. Mech. Engrg. 360 (2020) 112783, who keep particles as carriers of
            velocity; here the nodes keep it
May use     mpm.integrate (the response of materials), mpm.transfer, mpm.diagnostics and what is below

Further files
    drive    A whole scene in the total frame
    forces   what acts on a body in the total frame beside its stress, and what averages its changes of volume
    heat     heat of a body in the total frame
    inertia  how the momentum of the nodes moves them: not by row sums of mass alone
"""
