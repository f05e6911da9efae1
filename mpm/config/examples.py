"""An example for every key of a config: editors offer it, `mpm explain` and the docs print it.

Numbers by their unit, or by name where the unit alone would mislead; text and lists by class and key; sections are made of the examples of the keys that they
need. To add a key of text: a line in FIELDS. tests/config/test_examples.py reads every example back through the models.
"""

from typing import Any, Literal, get_args, get_origin

from mpm.config.schema_paths import Slot

UNITS: dict[str, Any] = {
    "m": "2 mm",
    "s": "20 min",
    "K": "190 degC",
    "Pa": "12 kPa",
    "Pa*s": "200 Pa*s",
    "Pa/K": "30 Pa/K",
    "Pa*K": "1 kPa*K",
    "Pa*s*K": "10 Pa*s*K",
    "m**3/s": "20 mL/s",
    "W/m/K": "0.35 W/m/K",
    "W/m": "0.1 W/m",
    "W/m**2": "500 W/m**2",
    "W/m**2/K": "20 W/m**2/K",
    "W/m**3": "0.2 W/cm**3",
    "W/kg": "5 W/kg",
    "J/kg/K": "2300 J/kg/K",
    "J/kg": "2.46e5 J/kg",
    "kg/m**3": "500 kg/m**3",
    "kg": "0.2 kg",
    "m/s": "10 mm/s",
    "m/s**2": "-9.81 m/s**2",
    "N": "5 N",
    "rad": "30 deg",
    "rad/s": "1 rad/s",
    "1/m": "300 1/m",
    "1/s": "-0.05 1/s",
    "1/K": "1e-4 1/K",
    "1/s*K": "0.05 K/s",
    "J/mol": "139 kJ/mol",
    "": 0.5,
}
NAMES: dict[str, Any] = {
    "aspect ratio": 0.6,
    "aspect ratio times kelvin": "1 K",
    "Poisson ratio": 0.3,
    "exponent": 2,
    "frequency factor": "2.8e18 1/s",
    "rate of setting": "1e-3 1/s",
    "rate of setting times kelvin": "0.05 K/s",
    "force by mass": "9.81 m/s**2",
    "number": 1,
    "rate of drag": "10 1/s",
    "relative tolerance": 1e-4,
    "temperature difference": "2 K",
    "time scale": 100,
    "tolerance": 0.01,
    "yield stress": "300 Pa",
}
HENCKY = {"hencky": {"E": "12 kPa", "nu": 0.3}}
FOURIER = {"fourier": {"kappa": "0.35 W/m/K", "alpha": "2300 J/kg/K"}}
BOX = {"box": {"lower": [0, 0], "upper": ["20 mm", "10 mm"]}}
BODY = {"shape": BOX, "temperature": "24 degC", "material": "dough"}
SPREAD = {"kappa": [0.2, 0.6], "beta": {"log": [5, 50]}}
CURVE = {"file": "loaf.csv", "time": "minute", "value": "centre_degC"}
FIELDS: dict[str, Any] = {
    "Experiment.title": "Loaf: conductivity and oven",
    "Experiment.grid": {"dimension": 2, "size": ["40 mm", "20 mm"], "cell": "1 mm"},
    "Experiment.bodies": {"loaf": BODY},
    "Experiment.materials": {"dough": {"density": 500, "heat": FOURIER}},
    "Experiment.surfaces": [{"of": "loaf", "convection": {"beta": 20, "outside": "190 degC"}}],
    "Experiment.sources": [{"of": "loaf", "heat": "0.2 W/cm**3"}],
    "Experiment.walls": {"bottom": "stick"},
    "Experiment.contacts": [{"between": ["egg", "pan"], "friction": 0.2}],
    "Experiment.gravity": [0, -9.81],
    "Experiment.loads": [{"of": "dough", "side": "top", "traction": {"nominal": [0, "-500 Pa"], "ramp": "8 s"}}],
    "Experiment.loading": [{"until": "8 s", "strain_rate": {"zz": -0.05}, "stress": {"xx": 0, "yy": 0}}],
    "Experiment.parameters": {"thickness": "25 mm"},
    "Experiment.smoke": {"grid.cell": "4 mm", "time.end": 60},
    "Experiment.sweep": {"axes": {"kappa": [0.2, 0.35, 0.5]}},
    "Experiment.chart": {"refine": {"cells": {"grid.cell": ["4 mm", "2 mm", "1 mm"]}}},
    "Experiment.fit": {"parameters": {"kappa": {"log": [0.1, 2]}}},
    "Experiment.output": {"every": "10 s", "observables": ["temperature.mean"]},
    "Experiment.method": {"transfer": "affine_flip"},
    "Experiment.formulas": {"bodies.loaf.temperature": "start + 5"},
    "Grid.size": ["40 mm", "20 mm"],
    "Body.material": "dough",
    "Body.shape": BOX,
    "Body.velocity": [0, "-1 m/s"],
    "Body.angular_velocity": "10 rad/s",
    "Body.inflow": {"velocity": [0, "-0.1 m/s"], "until": "2 s"},
    "Inflow.velocity": [0, "-0.1 m/s"],
    "Inflow.rate": "20 mL/s",
    "Inflow.temperature": "20 degC",
    "Box.lower": [0, 0],
    "Box.upper": ["20 mm", "10 mm"],
    "Cylinder.base": [0, 0],
    "Ring.inner": "10 mm",
    "Ring.outer": "20 mm",
    "Polygon.vertices": [[0, 0], ["20 mm", 0], ["10 mm", "10 mm"]],
    "SineAcceleration.amplitude": "1 m/s**2",
    "Mesh.file": "dinosaur.stl",
    "Mesh.unit": "1 mm",
    "Mesh.centre": ["20 mm", "20 mm", "15 mm"],
    "Tool.shape": BOX,
    "MaterialPoint.strain": {"zz": -0.01},
    "Material.elastic": HENCKY,
    "Material.flow": {"ellipse": {"M": "300 Pa", "p0": 0.6, "eta": "200 Pa*s"}},
    "Material.heat": FOURIER,
    "Material.expansion": {"linear": {"coefficient": "1e-4 1/K"}},
    "Material.heating": {"dissipation": {}},
    "Table.temperature": ["20 degC", "80 degC"],
    "TimeTable.time": [0, "10 min"],
    "Stage.strain_rate": {"zz": -0.05},
    "Stage.stretch_rate": {"zz": -0.05},
    "Stage.stress": {"xx": 0, "yy": 0},
    "Load.of": "dough",
    "Traction.nominal": [0, "-500 Pa"],
    "Traction.cauchy": [0, "-500 Pa"],
    "Traction.pressure": "2 kPa",
    "Surface.of": "loaf",
    "Source.of": "loaf",
    "Source.force": [0, "-9.81 m/s**2"],
    "ByFormula.text": "1e5*exp(-x/0.02)*sin(t)",
    "Formulas.temperature": "300 + 10*cos(pi*x)*cos(3*t)",
    "Formulas.displacement": ["0.05*sin(pi*x)*sin(3*t)"],
    "Surface.name": "pan",
    "Pair.between": ["egg", "pan"],
    "Motion.velocity": [0, "-1 mm/s"],
    "Motion.force": [0, "-5 N"],
    "Motion.spin": "1 rad/s",
    "Tool.motion": {"velocity": [0, "-1 mm/s"]},
    "Path.time": [0, "10 s"],
    "Path.displacement": [[0, 0], [0, "-5 mm"]],
    "Method.offset": [0.3, 0],
    "Method.locking": "fbar",
    "Output.probes": {"centre": [0, "20 mm"]},
    "Output.observables": ["temperature.mean", "time_to.centre.95_degC"],
    "Output.overview": ["temperature.mean"],
    "Output.snapshots": {"every": "20 s", "grid": ["temperature"]},
    "Output.measured": {"centre": CURVE},
    "Snapshots.grid": ["temperature"],
    "Snapshots.particles": ["position", "temperature"],
    "Measured.file": "loaf.csv",
    "Measured.of": "mass.total",
    "Measured.samples": [["3 s", "62.8 mm"], ["6 s", "63.1 mm"]],
    "Measured.equals": "11.4 min",
    "Measured.sigma": "10 s",
    "Measured.start": "12:30",
    "Measured.time": "minute",
    "Measured.unit": "degC",
    "Measured.units": "degC",
    "Measured.value": "centre_degC",
    "Named.label": "thickness of the steak",
    "Named.unit": "m",
    "Sweep.axes": {"kappa": [0.2, 0.35, 0.5], "beta": {"log": [5, 50, 6]}},
    "Sweep.zip": [{"kappa": [0.2, 0.5], "alpha": [2000, 3000]}],
    "Sweep.sample": {"sobol": {"count": 32, "ranges": SPREAD}},
    "Sweep.points": [{"kappa": 0.2, "beta": 10}, {"kappa": 0.5, "beta": 40}],
    "Sweep.derive": {"eta": "beta / 2"},
    "Sweep.where": "beta > 10 * kappa",
    "Sweep.refine": {"of": "temperature_centre", "level": "95 degC", "until": "1 %", "points": 200},
    "Refine.of": "temperature_centre",
    "Refine.level": "95 degC",
    "Fit.parameters": {"kappa": {"log": [0.1, 2]}, "beta": [2, 60]},
    "Fit.data": ["centre", "crust"],
    "Chart.error": ["error_l2"],
    "Chart.methods": {"apic": {"set": {"method.transfer": "apic"}}},
    "Chart.observables": ["temperature.mean"],
    "Chart.reference": "apic",
    "Chart.refine": {"cells": {"grid.cell": ["4 mm", "2 mm", "1 mm"]}},
    "ChartMethod.set": {"method.transfer": "apic"},
    "ChartMethod.refine": {"cells": {"grid.cell": ["4 mm", "2 mm", "1 mm"]}},
    "Stability.across": {"beta": {"log": [1, 1000, 7]}},
    "Stability.along": {"time.safety": {"log": [0.5, 8, 5]}},
    "Stability.panels": {"APIC": {"method.transfer": "apic"}, "PIC": {"method.transfer": "pic"}},
    "Stability.beyond": {"error_temperature": 0.05},
    "Stability.names": {"across": "Biot number of a cell", "along": "step over the automatic one"},
    "Stability.lines": [{"label": "theory", "formula": "1/(1/0.49 + x/1.5)"}],
    "Stability.steps": 400,
    "Growth.of": "temperature_max",
    "TheoryLine.label": "theory",
    "TheoryLine.formula": "1/(1/0.49 + x/1.5)",
    "TheoryLine.source": "docs/physics.md 6",
    "TheoryLine.panels": ["APIC"],
    "GaussianBox.centre": ["0.5 m", "0.5 m"],
    "ranges": SPREAD,
    "body": "loaf",
}
WHOLE = 8  # a whole number


def example(owner: str, name: str, slot: Slot, bases: tuple[str, ...] = ()) -> Any:
    """An example of a key: `owner` is the class that has it, `bases` what that is made from."""
    for key in (*(f"{one}.{name}" for one in (owner, *bases)), name):
        if key in FIELDS:
            return FIELDS[key]
    return of(slot)


def of(slot: Slot) -> Any:
    """An example of a value: the least that is allowed in the place."""
    if slot.quantity is not None:
        return NAMES.get(slot.quantity.name, UNITS[slot.quantity.unit])
    if slot.menu:
        name, kind = next(iter(slot.menu.kinds.items()))
        return name if kind.bare() else {name: least(kind)}
    if slot.model:
        return least(slot.model)
    if get_origin(slot.type) is Literal:
        return get_args(slot.type)[-1]
    if get_origin(slot.type) is dict:
        return {"name": of(slot.under(""))}
    if get_origin(slot.type) is tuple:
        return [of(slot.under(0))] * 2
    return {bool: True, int: WHOLE, str: "name"}[slot.type]


def least(model: Any) -> dict[str, Any]:
    """A mapping of the keys that are needed, or of the first."""
    bases = tuple(one.__name__ for one in model.__mro__)
    keys = [name for name, field in model.model_fields.items() if field.is_required()] or list(model.model_fields)[:1]
    return {name: example(model.__name__, name, Slot(model).under(name), bases) for name in keys}
