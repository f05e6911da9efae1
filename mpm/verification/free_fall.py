"""Flight under gravity: u = v t + g t^2/2. Leapfrog is exact in any step, steps that change too."""

import numpy as np

from mpm.error import Motion
from mpm.verification.setup import only_body

ORDER = None


def exact(experiment):
    """Displacement and velocity of a body that touches nothing."""
    _, body = only_body(experiment)
    if len(experiment.bodies) != 1 or experiment.gravity is None or body.angular_velocity is not None:
        raise ValueError("free_fall needs one body, gravity, and no angular_velocity")
    g = np.array(experiment.gravity)
    v = np.zeros(len(g)) if body.velocity is None else np.array(body.velocity)
    return Motion({"displacement": lambda X, t: np.tile(v * t + g * t**2 / 2, (len(X), 1)), "velocity": lambda X, t: np.tile(v + g * t, (len(X), 1))})
