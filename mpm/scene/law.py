"""Laws of temperature: from a config's to those of a run."""

from mpm.materials import Bump, Constant, Logistic, Porous, table


def law(model):
    """The run-time law of a config's law."""
    kind = type(model).kind
    if kind == "constant":
        return Constant(float(model.value))
    if kind == "table":
        return table(model.temperature, model.value, model.interpolation)
    if kind == "bump":
        return Bump(model.base, model.heat, model.at, model.width)
    if kind == "porosity":
        return Porous(1.0 - model.initial, model.exponent)
    return Logistic(model.low, model.high, model.at, model.width)
