"""A small disc that everything acts on: gravity, a wall on which nothing slides, a pull, drag, and flow."""

import copy

import pytest

DISC = {
    "grid": {"dimension": "axisymmetric", "size": [8e-3, 8e-3], "cell": 1e-3},
    "bodies": {"disc": {"shape": {"cylinder": {"radius": 3.3e-3, "height": 2.7e-3, "base": [0, 0.02e-3]}}, "material": "dough"}},
    "materials": {"dough": {"density": 1000, "elastic": {"hencky": {"E": 1e4, "nu": 0.2}}, "flow": {"ellipse": {"M": 300, "p0": 2, "eta": 50}}}},
    "walls": {"bottom": {"contact": {"friction": float("inf")}}},
    "gravity": [0, -9.81],
    "loads": [{"of": "disc", "side": "top", "traction": {"nominal": [0, -20]}}, {"of": "disc", "drag": {"rate": 3.0}}],
    "method": {"mechanics": "implicit"},
    "time": {"end": 1.0},
}


@pytest.fixture
def disc():
    return copy.deepcopy(DISC)
