"""Sweeps over the fake runner (tests/fakes): what is tested here is the machinery, not the model."""

import numpy as np

from mpm.config import load
from mpm.sweep.api import execute
from mpm.sweep.engine import Options


def config(kappas, **sections):
    """Conductivities on an axis; the fake runner does what they say."""
    base = {
        "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
        "bodies": {"slab": {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}},
        "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
        "time": {"end": 10},
        "output": {"every": 1, "probes": {"centre": [0.01]}},
        "sweep": {"axes": {"kappa": list(kappas)}},
    }
    if sections.get("output", {}).get("snapshots", {}).get("particles"):  # which only a body that moves has
        base["materials"]["m"]["elastic"] = {"hencky": {"E": 1e4, "nu": 0.3}}
    return base | sections


def fields(kappas):
    """The same of a body that moves, with snapshots of grid and particles."""
    output = {"every": 1, "probes": {"centre": [0.01]}, "snapshots": {"every": 2, "grid": ["temperature"], "particles": ["position", "body"]}}
    materials = {"m": {"density": 1000, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}}
    return config(kappas, output=output, materials=materials)


def many(count):
    """Points that the fake runner computes at once."""
    return config(np.round(np.linspace(0.01, 10.0, count), 6).tolist())


def go(data, out, jobs=0, reporter=None, **more):
    return execute(load(data), out, Options(jobs=jobs, runner="fake_runner", **more), reporter)
