"""Warming: small scenes whose kernels are what most configs need, for `mpm warmup` without a config."""

from typing import Any

HEAT = {"fourier": {"kappa": 1.0, "alpha": 1000.0}}
DOUGH = {
    "density": 1000.0,
    "elastic": {"hencky": {"E": 1e4, "nu": 0.3}},
    "flow": {"ellipse": {"M": 1.0, "p0": 1e3, "eta": 1e3}},
    "heat": HEAT,
    "expansion": {"linear": {"coefficient": 1e-4, "reference": 300.0}},
    "heating": {"elastic": {}, "dissipation": {"fraction": 1.0}},
}
RUBBER = {"density": 1000.0, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}}


def scene(dimension: Any, directions: int, material: dict) -> dict[str, Any]:
    """A block of eight cells a side in a box of twelve, exchanging heat where it has heat."""
    lower, upper = [0.02] * directions, [0.1] * directions
    shape = {"cylinder": {"radius": 0.08, "height": 0.08, "base": [0.0, 0.02]}} if dimension == "axisymmetric" else {"box": {"lower": lower, "upper": upper}}
    config: dict[str, Any] = {
        "grid": {"dimension": dimension, "size": [0.12] * directions, "cell": 0.01},
        "bodies": {"block": {"shape": shape, "temperature": 310.0, "material": "m"}},
        "materials": {"m": material},
        "time": {"end": 1.0},
    }
    if "heat" in material:
        config["surfaces"] = [{"of": "block", "convection": {"beta": 10.0, "outside": 300.0}}]
    return config


def scenes() -> dict[str, dict[str, Any]]:
    """Configs by what they compile."""
    rigid = {"density": 1000.0, "heat": HEAT}
    return {
        "heat, 1-D": scene(1, 1, rigid),
        "heat, axisymmetric": scene("axisymmetric", 2, rigid),
        "heat, 3-D": scene(3, 3, rigid),
        "elastic, 3-D": scene(3, 3, RUBBER),
        "thermo-viscoplastic, plane strain": scene(2, 2, DOUGH),
    }
