"""A manufactured problem that the config poses: the solution by formulas, its force and heat under `sources`, and what acts at its surface as ever.

temperature   Theta(x, y, z, t) of the material point that began at x, y, z (r, z where round); the run starts from it
displacement  u(x, y, z, t), zero at the start; the run starts with its velocity (central differences)
Nothing checks that formulas and sources belong together: the error that does not fall with the cell tells.
"""

from typing import Any, NamedTuple

import numpy as np

from mpm.error import Motion
from mpm.scene.sources import total
from mpm.sources import values
from mpm.state import Thermal
from mpm.verification.setup import only_body

ORDER = None  # the config declares it
APART, LATER = 1e-2, 1e-5  # of a cell, and of the run: between the points of a difference


class Beginning(NamedTuple):
    """theta(x, t), from which the run starts."""

    theta: Any
    starts: bool = True

    def __call__(self, x, t: float):
        return self.theta(x, t)


def exact(experiment):
    """theta(x, t) of bodies at rest, or a Motion where the displacement is given."""
    name, body = only_body(experiment)
    given, h, D = experiment.exact, experiment.grid.cell, experiment.grid.directions
    if experiment.grid.dimension == 0:
        raise ValueError("formulas are for bodies, not for a material point")
    shift = np.array(experiment.method.offset) * h
    material = experiment.materials[body.material]
    if given.temperature is None and given.displacement is None:
        raise ValueError("formulas need a temperature, a displacement or both")
    if given.temperature is not None and material.heat is None:
        raise ValueError(f"formulas give {name} a temperature, and it has no heat")
    codes = {}
    if given.temperature is not None:
        codes["temperature"] = total(experiment, [(given.temperature, 1.0, 0.0, None)])
    if given.displacement is None:
        return Beginning(lambda x, t: values(codes["temperature"], x - shift, t))
    if name != next(iter(experiment.bodies)):
        raise ValueError(f"a displacement is compared for the first body that the config names: put {name} there")
    if material.elastic is None or len(given.displacement) != D:
        raise ValueError(f"a displacement needs one formula a direction ({D}), and a body with `elastic`")
    moved = [total(experiment, [(one, 1.0, 0.0, None)]) for one in given.displacement]

    def displacement(X, t):
        return np.stack([values(code, X - shift, t) for code in moved], axis=1)

    def velocity(X):
        later = LATER * experiment.time.end
        return (displacement(X, later) - displacement(X, -later)) / (2 * later)

    def slope(field, X):
        """d field/d X by central differences, the direction last."""
        return np.stack([(field(X + one) - field(X - one)) / (2 * APART * h) for one in APART * h * np.eye(D)], axis=-1)

    def start(one):
        p, X = one.particles, one.particles.x.astype(float)
        if np.abs(displacement(X, 0.0)).max() > 1e-12 * h:
            raise ValueError("the displacement must be zero at the start")
        p.v[:], p.C[:] = velocity(X), slope(velocity, X)
        if "temperature" in codes and isinstance(one.thermal, Thermal):
            one.thermal.theta[:] = values(codes["temperature"], X - shift, 0.0) - one.thermal.zero
            one.thermal.c[:] = slope(lambda x: values(codes["temperature"], x - shift, 0.0), X)
        return one

    fields = {"displacement": displacement}
    if "temperature" in codes:
        fields["temperature"] = lambda X, t: values(codes["temperature"], X - shift, t)
    return Motion(fields, start)
