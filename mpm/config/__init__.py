"""Config: a YAML file or a dict becomes an `Experiment`, or a `ConfigError` that lists everything that is wrong with it.

Rooms    base, quantities, units        what models are made of: kinds and menus, SI floats, pint
         laws, materials, bodies, boundary, numerics, output, sweep, experiment     the models, field names as users write them
To add   a kind: a class with `kind = "name"`, listed in its menu. Paths, errors, sweeps and the schema follow.
"""

from mpm.config.experiment import PHYSICS_VERSION, Experiment

__all__ = ["PHYSICS_VERSION", "Experiment"]
