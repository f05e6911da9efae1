"""Right configs as dicts, for tests to change."""

import copy

import pytest

LOAF = {
    "title": "Loaf",
    "grid": {"dimension": "axisymmetric", "size": [0.044, 0.044], "cell": 1e-3},
    "bodies": {"loaf": {"shape": {"cylinder": {"radius": "36 mm", "height": "35 mm", "base": [0, "4 mm"]}}, "temperature": "24 degC", "material": "dough"}},
    "materials": {
        "dough": {
            "density": 301,
            "heat": {"fourier": {"kappa": 0.35, "alpha": {"bump": {"base": 2247, "heat": 2.46e5, "at": "99.6 degC", "width": "1.5 K"}}}},
        }
    },
    "surfaces": [{"of": "loaf", "convection": {"beta": 13.1, "outside": "190 degC"}}],
    "time": {"end": 780},
    "output": {"every": 10, "probes": {"centre": [0, "21.5 mm"]}, "observables": ["temperature.mean", "time_to.centre.95_degC"]},
}

BLOCK = {
    "grid": {"dimension": 2, "size": [0.1, 0.1], "cell": "5 mm"},
    "bodies": {"block": {"shape": {"box": {"lower": [0.02, 0], "upper": [0.06, 0.04]}}, "material": "dough"}},
    "materials": {
        "dough": {
            "density": 1000,
            "elastic": {"hencky": {"E": 1e4, "nu": 0.3}},
            "flow": {"ellipse": {"M": 100, "p0": 0.5, "eta": 10}},
            "heat": {"fourier": {"kappa": 0.4, "alpha": 2800}},
        }
    },
    "walls": {"bottom": "stick"},
    "gravity": [0, -9.81],
    "time": {"end": 0.1},
}


@pytest.fixture
def loaf() -> dict:
    """Heat only, axisymmetric."""
    return copy.deepcopy(LOAF)


@pytest.fixture
def block() -> dict:
    """Thermo-viscoplastic, plane strain."""
    return copy.deepcopy(BLOCK)
