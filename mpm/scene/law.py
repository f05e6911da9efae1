"""Laws of materials: from a config's to those of a run."""

import functools

import numpy as np

from mpm.config.laws import rate_of
from mpm.materials import (
    GAS,
    LAWS,
    Alike,
    Arrhenius,
    Constant,
    EllipseClipped,
    EllipseRadial,
    Hencky,
    HenckyWarm,
    NeoHookean,
    NoFlow,
    Porous,
    Sets,
    table,
    value,
)
from mpm.scene.menus import known
from mpm.state import Expansion, Latched, NoSetting, Setting, Softening


def of_the_same_fields(kind, model):
    """The run-time law whose fields are called as in the config."""
    return kind(*(getattr(model, name) for name in kind._fields))


LAW = {
    **{kind.__name__.lower(): functools.partial(of_the_same_fields, kind) for kind in LAWS},
    "constant": lambda model: Constant(float(model.value)),
    "table": lambda model: table(model.temperature, model.value, model.interpolation),
    "set": lambda model: Sets(law(model.raw), law(model.baked)),
    "arrhenius": lambda model: Arrhenius(model.k0, model.activation / GAS),
    "porosity": lambda model: Porous(1.0 - model.initial, model.exponent),
}


def law(model):
    """The run-time law of a config's law."""
    return known(LAW, type(model).kind, "law")(model)


def of_particles(model, sets: bool):
    """The run-time law of a mechanical parameter; where the material sets, one that is asked with temperature and X."""
    return law(model) if not sets or type(model).kind == "set" else Alike(law(model))


def mechanical_laws(material):
    """The run-time laws (elastic, flow) of a material; elastic is None where it is rigid."""
    sets, flow = rate_of(material) is not None, NoFlow()
    if material.flow is not None:
        kind = {"radial": EllipseRadial, "clipped": EllipseClipped}[material.flow.map]
        flow = kind(*(of_particles(getattr(material.flow, name), sets) for name in ("M", "p0", "eta")))
    return elastic_law(material.elastic, sets) if material.elastic is not None else None, flow


def setting_law(material, theta: np.ndarray):
    """Nothing has set yet; theta (N,) absolute temperatures at the start."""
    if (rate := rate_of(material)) is None:
        return NoSetting()
    run = law(rate)
    return Setting(np.zeros(len(theta)), np.array([value(run, float(t)) for t in theta]), run)


def elastic_law(model, sets: bool = False):
    """The run-time law, with Lame constants from whichever pair was given; of E = 1, with its law, where E follows temperature or setting."""
    kind = {"hencky": Hencky, "neo_hookean": NeoHookean}[type(model).kind]
    if model.E is not None:
        E = float(model.E.value) if type(model.E).kind == "constant" else 1.0
        found = kind(E / (2 * (1 + model.nu)), E * model.nu / ((1 + model.nu) * (1 - 2 * model.nu)))
        return found if type(model.E).kind == "constant" else HenckyWarm(found, of_particles(model.E, sets))
    if model.lam is not None:
        return kind(model.mu, model.lam)
    return kind(model.mu, model.K - 2 * model.mu / 3)


def stress_temperature_modulus(expansion, elastic: Hencky) -> float:
    """gamma [Pa/K] = 3 K alpha_L = c lam (docs/physics.md 0)."""
    coefficient, gamma = getattr(expansion, "coefficient", None), getattr(expansion, "gamma", None)
    if coefficient is not None:
        return 3 * (elastic.lam + 2 * elastic.mu / 3) * coefficient
    return gamma if gamma is not None else expansion.c * elastic.lam


def expansion_law(model, elastic, theta: np.ndarray, zero: float):
    """The run-time expansion; `theta` (N,) are temperatures at the start, less `zero`. A coefficient follows the moduli, a modulus gamma does not."""
    if isinstance(elastic, HenckyWarm):
        inner = expansion_law(model, elastic.one, theta, zero)
        return inner if getattr(model, "gamma", None) is not None else Softening(inner, elastic.E)
    gamma, shift = stress_temperature_modulus(model, elastic), zero - model.reference
    if type(model).kind != "latched":
        return Expansion(gamma, shift)
    return Latched(gamma, shift, np.minimum(theta, theta.dtype.type(model.set - zero)), model.set - zero)
