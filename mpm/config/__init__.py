"""Config: a YAML file or a dict becomes an `Experiment`, or a `ConfigError` that lists everything that is wrong with it.

Made of  base, quantities, units        kinds and menus, SI floats, pint
Models   laws, materials, bodies, boundary, numerics, output, sweep, experiment: field names as users write them
Reading  nodes (YAML with places), merge (extends, overrides), names (kappa, κ -> a path), schema_paths (what a path may hold), load
Errors   problems, explain (pydantic's words into ours), partial (go on after an error), checks, shapes_fit, condition, vary
To add   a kind: a class with `kind = "name"`, listed in its menu. Paths, errors, sweeps and the schema follow.

Further files
    cautions          what is valid in a config and yet seldom meant
    chart             what `mpm chart` draws
    contacts          pairs of bodies that meet
    curves            curves in CSV files as laboratories and bakers write them
    curve_units       units of their columns
    exact             exact solutions of moving bodies, and of the ring
    exact_heat        exact solutions of heat that a run may be compared with, beside those in config.output
    examples          an example of every key
    fit               what is fitted
    formula           A formula of one variable x, for lines of theory
    headers           the header of such a file
    inflow            a body that comes in through a nozzle
    loading           what is prescribed to a material point
    loads             forces on the surface of a body that moves, and a drag that brings it to rest
    measured          measured curves
    meshes            triangle meshes of a config
    model             which model answers the config
    parameters        named parameters
    programmes        temperatures over time
    rules_chart       rules of `chart:`
    rules_fit         rules for named parameters and for what is fitted
    rules_forces      rules for gravity and loads
    rules_frame       rules of `method.frame`
    rules_inflow      rules of `inflow`
    rules_mechanics   rules of `method.mechanics`
    rules_output      rules for the output
    rules_point       rules for grid.dimension 0, the material point
    rules_scene       rules for bodies, materials, surfaces, walls and grid
    rules_setting     rules of what sets
    rules_sides       rules for sides, by normals and of shapes
    rules_size        rules for sizes that no machine takes
    rules_sources     rules for sources
    rules_tools       rules for tools, and for observables of what bodies meet
    rules_stability   rules of `stability:`
    scalars           A plain scalar of YAML to a value of Python, by the core schema of YAML 1.2
    sources           heat from within a body, and a force by its mass
    stability         A map of failures
    tabs              tabs where YAML 1.2 allows them (its sections 6.1 to 6.3), which ruamel.yaml refuses
    tools             rigid bodies that move as they are told
    variation         what a sweep section comes to
"""

from mpm.config.experiment import PHYSICS_VERSION, Experiment
from mpm.config.load import load, restore
from mpm.config.problems import ConfigError, Problem
from mpm.config.schema import schema

__all__ = ["PHYSICS_VERSION", "ConfigError", "Experiment", "Problem", "load", "restore", "schema"]
