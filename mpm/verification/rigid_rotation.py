"""Steady rotation with translation (docs/physics.md 7, problem 10): x = x_c + v t + exp(W t) (X - x_c), no strain.

The body is elastic: the load of rotation strains it by some R0 Omega^2 R^2/(lam + 2 mu), and it rings about that. The explicit update alone would strain
by 1/2 Omega^2 dt t; the stress that follows takes that back, so at any cell the error is that of the load.
Order   none: the error stays below LOAD R0 Omega^2 R^2/(lam + 2 mu) at any cell
"""

import numpy as np

from mpm.error import Motion
from mpm.verification.setup import only_body

ORDER = None
LOAD = 1.0


def exact(experiment):
    """Displacement and velocity of a body that turns freely, without gravity."""
    from mpm.scene.conventions import spin_tensor

    _, body = only_body(experiment)
    D = experiment.grid.directions
    if len(experiment.bodies) != 1 or experiment.grid.dimension not in (2, 3) or body.angular_velocity is None or experiment.gravity is not None:
        raise ValueError("rigid_rotation needs one body with angular_velocity in grid.dimension 2 or 3, and no gravity")
    W = spin_tensor(body.angular_velocity, D)
    drift = np.zeros(D) if body.velocity is None else np.array(body.velocity)
    centre = []

    def turn(t):
        from scipy.linalg import expm

        return expm(W * t)

    def start(one):
        centre.append(np.average(one.particles.x, axis=0, weights=one.particles.m))
        return one

    return Motion(
        {
            "displacement": lambda X, t: (X - centre[-1]) @ (turn(t) - np.eye(D)).T + drift * t,
            "velocity": lambda X, t: (X - centre[-1]) @ (W @ turn(t)).T + drift,
        },
        start,
    )
