"""Small scenes that a smaller model can answer, by what it leaves out."""

from types import SimpleNamespace

import pytest

HEAT = {"fourier": {"kappa": 0.5, "alpha": 2500.0}}


def box(dimension, **more):
    """A block of 3 cm in a box of 5 cm, 300 K, warmed from outside."""
    body = {"shape": {"box": {"lower": [0.01] * dimension, "upper": [0.04] * dimension}}, "temperature": 300, "material": "m"}
    return {
        "grid": {"dimension": dimension, "size": [0.05] * dimension, "cell": 0.0025},
        "bodies": {"b": body},
        "materials": {"m": {"density": 1000, "heat": HEAT}},
        "surfaces": [{"of": "b", "side": "top" if dimension > 1 else "right", "convection": {"beta": 20, "outside": 400}}],
        "time": {"end": 600},
        "output": {"every": 60, "probes": {"c": [0.025] * dimension}, "observables": ["temperature.mean", "heat.total", "time_to.c.303_K"]},
    } | more


def gentle(dimension):
    """The same under a weak exchange all round, for hours."""
    output = {"every": 1000, "probes": {"c": [0.025] * dimension}, "observables": ["temperature.mean", "heat.total"]}
    return box(dimension, surfaces=[{"of": "b", "convection": {"beta": 0.2, "outside": 400}}], time={"end": 20000}, output=output)


def elastic(**material):
    """The block of two directions, stiff enough to stay where it is."""
    config = box(2)
    heat = {"fourier": {"kappa": 5.0, "alpha": 2500.0}}
    solid = {"density": 1000, "heat": heat, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}, "expansion": {"linear": {"coefficient": 1e-6, "reference": 300}}}
    config["materials"]["m"] = solid | material
    config["grid"]["cell"], config["time"]["end"], config["output"]["every"] = 0.005, 2.0, 0.5
    config["output"] = {"every": 0.5, "probes": {"c": [0.025, 0.037]}}
    return config


def column():
    """Two directions, one of them between slip walls: it swings under its weight."""
    return {
        "grid": {"dimension": 2, "size": [0.5, 1.5], "cell": 0.125},
        "bodies": {"b": {"shape": {"box": {"lower": [0, 0], "upper": [0.5, 1.0]}}, "material": "m"}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}},
        "gravity": [0, -0.05],
        "time": {"end": 2.0},
        "output": {"every": 0.2, "observables": ["position.max_y", "energy.kinetic", "momentum.y"]},
    }


def ball():
    """Three directions, a ball thrown at the floor."""
    return {
        "grid": {"dimension": 3, "size": [1.0, 1.0, 1.0], "cell": 0.0625},
        "bodies": {"b": {"shape": {"ball": {"centre": [0.5, 0.5, 0.4], "radius": 0.25}}, "material": "m", "velocity": [0, 0, -2]}},
        "materials": {"m": {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}}},
        "walls": {"bottom": "contact"},
        "time": {"end": 0.12},
        "output": {"every": 0.01, "observables": ["position.mean_z", "energy.kinetic"]},
    }


@pytest.fixture
def scenes():
    """The functions above."""
    return SimpleNamespace(box=box, gentle=gentle, elastic=elastic, column=column, ball=ball)
