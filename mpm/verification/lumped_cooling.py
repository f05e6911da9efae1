"""A rigid body of one temperature that cools through its surface (docs/physics.md 10, 0-D; good for Bi = beta V/(S kappa) < 0.1).

Theta = out + (Theta(0) - out) exp(-beta S t/(R0 alpha V)).
Order   exact in any step (round-off); 2 where alpha depends on temperature
"""

import numpy as np

from mpm.verification.path import constant, point
from mpm.verification.setup import one_exchange

ORDER = None


def exact(experiment):
    """t -> {temperature}: one convection, no elastic, constant alpha."""
    body, material = point(experiment)
    if material.elastic is not None or any(stage.temperature is not None for stage in experiment.loading):
        raise ValueError("lumped_cooling needs a rigid body and its temperature left free")
    beta, outside = one_exchange(experiment, next(iter(experiment.bodies)))
    if not np.isfinite(beta):
        raise ValueError("lumped_cooling needs a finite beta")
    rate = beta * body.shape.surface_to_volume / (material.density * constant(material.heat.alpha, "alpha"))
    return lambda times: {"temperature_mean": outside + (body.temperature - outside) * np.exp(-rate * times)}
