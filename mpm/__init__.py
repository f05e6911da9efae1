"""mpm: batch experiments in thermomechanical material point simulation.

    experiment = mpm.load("configs/scenes/loaf.yaml", {"time.end": 60})
    tree = mpm.run(experiment)                                     # xarray.DataTree: /, series, grid, particles
    tree = mpm.sweep(experiment, out="results/loaf", jobs=2)
    eps = mpm.materials.return_map(eps_trial, mu=..., lam=..., M=..., p0=..., eta=..., dt=...)

Nothing heavy is imported before it is used.
"""

import importlib

_PLACES = {
    "load": "mpm.config",
    "schema": "mpm.config",
    "ConfigError": "mpm.config",
    "Experiment": "mpm.config",
    "run": "mpm.notebook",
    "sweep": "mpm.notebook",
    "fit": "mpm.fit.api",
    "sensitivity": "mpm.sensitivity.api",
    "particles": "mpm.sweep.ragged",
    "export": "mpm.exports",
    "movie": "mpm.movies",
    "report": "mpm.reports",
    "plan": "mpm.sweep.cases",
    "estimate": "mpm.costs",
    "run_point": "mpm.runner",
    "Outcome": "mpm.outcome",
    "Run": "mpm.outcome",
}
_ROOMS = ("materials", "config", "records", "rigid", "plots", "verification")

__all__ = list(_PLACES) + list(_ROOMS)


def __getattr__(name: str):
    if name in _PLACES:
        return getattr(importlib.import_module(_PLACES[name]), name)
    if name in _ROOMS:
        return importlib.import_module(f"mpm.{name}")
    raise AttributeError(f"module 'mpm' has no attribute {name!r}")


def __dir__():
    return sorted(__all__)
