"""Config: a YAML file or a dict becomes an `Experiment`, or a `ConfigError` that lists everything that is wrong with it.

Made of  base, quantities, units        kinds and menus, SI floats, pint
Models   laws, materials, bodies, boundary, numerics, output, sweep, experiment: field names as users write them
Reading  nodes (YAML with places), merge (extends, overrides), names (kappa, κ -> a path), slots (what a path may hold), load
Errors   problems, explain (pydantic's words into ours), loose (go on after an error), checks, shapes_fit, condition, vary
To add   a kind: a class with `kind = "name"`, listed in its menu. Paths, errors, sweeps and the schema follow.
"""

from mpm.config.experiment import PHYSICS_VERSION, Experiment
from mpm.config.load import load, restore
from mpm.config.problems import ConfigError, Problem
from mpm.config.schema import schema

__all__ = ["PHYSICS_VERSION", "ConfigError", "Experiment", "Problem", "load", "restore", "schema"]
