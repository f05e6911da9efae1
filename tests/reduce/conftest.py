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
    solid = {"density": 1000, "heat": HEAT, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}, "expansion": {"linear": {"coefficient": 1e-6, "reference": 300}}}
    config["materials"]["m"] = solid | material
    config["grid"]["cell"], config["time"]["end"], config["output"]["every"] = 0.005, 2.0, 0.5
    config["output"] = {"every": 0.5, "probes": {"c": [0.025, 0.037]}}
    return config


@pytest.fixture
def scenes():
    """The functions above."""
    return SimpleNamespace(box=box, gentle=gentle, elastic=elastic)
