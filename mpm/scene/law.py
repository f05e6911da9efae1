"""Laws of temperature: from a config's to those of a run."""

from mpm.materials import Bump, Constant, Logistic, Porous, table
from mpm.scene.menus import known

LAW = {
    "constant": lambda model: Constant(float(model.value)),
    "table": lambda model: table(model.temperature, model.value, model.interpolation),
    "bump": lambda model: Bump(model.base, model.heat, model.at, model.width),
    "logistic": lambda model: Logistic(model.low, model.high, model.at, model.width),
    "porosity": lambda model: Porous(1.0 - model.initial, model.exponent),
}


def law(model):
    """The run-time law of a config's law."""
    return known(LAW, type(model).kind, "law")(model)
