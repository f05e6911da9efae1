"""The one table of what a dataset holds: name, symbol, units, dimensions, long name.

`VARIABLES`     dataset name -> Variable                       (`temperature_mean`)
`OBSERVABLES`   what a config may list under `output.observables` (`temperature.mean`); dots become underscores in the dataset
`describe`      a dataset name -> Variable, names with a probe in them too (`temperature_crust`, `time_to_centre_95_degC`)
`Threshold`     `time_to.<probe>.<value>_<unit>` taken apart; `single`, `met`, `probed`: `position.max_y.<body>`, `force.<tool>_z`, `stress.<probe>_xx`
`is_total`      whether a variable is a sum over the body; `turn`, `PER` and `describe` say of what body, and nothing else does: the whole body in 3-D and
                axisymmetric scenes, a metre of its depth in plane ones, a square metre in 1-D, a cubic metre of the material in dimension 0

Imports nothing of the package but the patterns beside it, and nothing heavy. To add a quantity: one line in TABLE.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

from mpm.records.patterns import AT_PROBE, BITES, IN_DATASET, MEETING, MET, PROBED, SINGLE, THRESHOLD, meets

POINT, SERIES, GRID, PARTICLES = "point", "series", "grid", "particles"
STATUS = ("ok", "failed", "timeout", "killed", "diverged", "skipped", "pending")  # int8 values 0..6, fixed
OK, FAILED, TIMEOUT, KILLED, DIVERGED, SKIPPED, PENDING = range(7)
MEMORY = "memory"  # the outcome of a point that wants more than there is
AXES = ("x", "y", "z", "r")
TOTALS = ("J", "W", "N", "N m", "kg", "kg m/s", "m3", "m2")  # units of sums over a body
PER = {
    0: (("J/m3", "W/m3", "", "", "", "", "", ""), "per cubic metre"),
    1: (("J/m2", "W/m2", "N/m2", "N/m", "kg/m2", "kg/m/s", "m", "1"), "per square metre"),
    2: (("J/m", "W/m", "N/m", "N", "kg/m", "kg/s", "m2", "m"), "per metre of depth"),
}
EXACT_FIELDS = (("displacement", "m"), ("velocity", "m/s"), ("stress", "Pa"))
INFLOW = (("mass", "kg"), ("volume", "m3"), ("heat", "J"), ("energy", "J"))
RELATIVE = {"frequency": "frequency", "damping": "damping rate", "tip": "deflection of the tip", "force": "force at the end"}


@dataclass(frozen=True)
class Variable:
    """A quantity in a dataset. `dims` is the group that it lives in: point, series, grid or particles."""

    name: str
    symbol: str
    units: str
    dims: str
    long_name: str


@dataclass(frozen=True)
class Threshold:
    """`time_to.centre.95_degC`: when probe `centre` first reaches `kelvin`, rising or falling."""

    probe: str
    value: float
    unit: str
    kelvin: float


TABLE = [
    # series, observables of a config
    ("temperature.mean", "θ", "K", SERIES, "mean temperature, weighted with the heat capacity at the start"),
    ("temperature.min", "θ", "K", SERIES, "lowest temperature"),
    ("temperature.max", "θ", "K", SERIES, "highest temperature"),
    ("heat.total", "H", "J", SERIES, "heat content above that at the start"),
    ("heat.exchanged", "Q", "J", SERIES, "heat taken in through surfaces and given by sources since the start"),
    ("heat.ledger", "", "J", SERIES, "heat content gained less heat taken in: what the method lost"),
    ("mass.total", "m", "kg", SERIES, "total mass"),
    ("energy.kinetic", "", "J", SERIES, "kinetic energy"),
    ("energy.elastic", "", "J", SERIES, "elastic energy"),
    ("energy.total", "", "J", SERIES, "kinetic, elastic and gravitational energy; the last only where gravity does not change over time"),
    ("energy.ledger", "", "J", SERIES, "energy and heat gained or dissipated, less work of loads and heat taken in: what the method made"),
    ("dissipation.total", "", "J", SERIES, "work dissipated by flow since the start"),
    ("dissipation.friction", "", "J", SERIES, "work that friction between surfaces has taken since the start; it warms nothing"),
    ("dissipation.transfer", "", "J", SERIES, "energy of motion that no law of the config took: lost in transfers, at walls and by the time step"),
    ("work.loads", "", "J", SERIES, "work of loads, tools, nozzles and gravity that changes over time on the bodies since the start"),
    *((f"{name}.inflow", "", units, SERIES, f"{name} of what flowed in since the start, as it enters its nozzle") for name, units in INFLOW),
    ("velocity.max", "v", "m/s", SERIES, "largest speed of a particle"),
    ("volume.total", "V", "m3", SERIES, "total volume"),
    ("area.exchanging", "S", "m2", SERIES, "area of the surface that exchanges heat"),
    ("radius.max", "r", "m", SERIES, "largest radius of the material"),
    *((f"radius.{share}", f"r{share}", "m", SERIES, f"radius that holds {share} % of the volume") for share in (95, 99)),
    ("J.min", "J", "1", SERIES, "smallest volume ratio det F"),
    ("J.max", "J", "1", SERIES, "largest volume ratio det F"),
    ("pressure.mean", "p", "Pa", SERIES, "mean pressure, weighted with volume"),
    ("strain.max", "ε", "1", SERIES, "largest principal Hencky strain"),
    ("setting.mean", "X", "1", SERIES, "mean degree of setting, weighted with mass"),
    ("setting.min", "X", "1", SERIES, "smallest degree of setting"),
    # a material point (grid.dimension 0), along its principal directions
    *((f"stress.{a}{a}", f"σ{a}{a}", "Pa", SERIES, f"Cauchy stress along {a}, positive in tension") for a in "xyz"),
    *((f"strain.{a}{a}", f"ε{a}{a}", "1", SERIES, f"Hencky strain along {a}") for a in "xyz"),
    *((f"strain.elastic_{a}{a}", "", "1", SERIES, f"elastic Hencky strain along {a}") for a in "xyz"),
    ("kirchhoff.p", "p", "Pa", SERIES, "Kirchhoff pressure, in which flow is written"),
    ("kirchhoff.q", "q", "Pa", SERIES, "von Mises measure of the Kirchhoff stress"),
    # errors against the exact solution that a config names
    ("error_l2", "", "K", SERIES, "root-mean-square error against the exact solution"),
    ("error_max", "", "K", SERIES, "largest error against the exact solution"),
    ("error_relative", "", "1", SERIES, "largest error against the exact solution, over the largest value of each quantity"),
    *((f"error_{name}_l2", "", units, SERIES, f"root-mean-square error of {name} against the exact solution") for name, units in EXACT_FIELDS),
    *((f"error_{name}_max", "", units, SERIES, f"largest error of {name} against the exact solution") for name, units in EXACT_FIELDS),
    *((f"error_{name}", "", "1", POINT, f"error of {name} over its size, root mean square over the run") for name, _ in EXACT_FIELDS),
    ("error_temperature", "", "1", POINT, "error of temperature over its size, root mean square over the run"),
    *((f"error_{key}", "", "1", POINT, f"relative error of the {name}") for key, name in RELATIVE.items()),
    ("tip_displacement", "", "m", SERIES, "deflection of the tip"),
    ("amplitude_displacement", "U", "m", SERIES, "displacement in the shape of the wave"),
    ("amplitude_temperature", "", "K", SERIES, "temperature in the shape of the wave"),
    # one number a point
    ("status", "", "1", POINT, "outcome of the point"),
    ("error", "", "1", POINT, "why the point is not ok"),
    ("advice", "", "1", POINT, "what would help, where the point is not ok"),
    ("warnings", "", "1", POINT, "what a careful user wants to know of the run, one a line, each `kind: what; advice`"),
    ("warning_flags", "", "1", POINT, "kinds of the warnings"),
    ("outcome", "", "1", POINT, "how the run ended"),
    ("run_id", "", "1", POINT, "hash of the point's config"),
    ("model_name", "", "1", POINT, "model: auto: what was dropped from the full model"),
    *((f"frame_{part}", "", "1", POINT, f"method.frame: auto: {said}") for part, said in (("name", "the frame that answered"), ("why", "why that one"))),
    ("model_error", "", "1", POINT, "model: auto: predicted error of what was dropped, as a share of the driving difference or of the change"),
    ("scaling_froude", "Fr", "1", POINT, "time scaling: largest (S v)^2/(g H), to be at most 0.02"),
    ("scaling_kinetic", "", "1", POINT, "time scaling: largest kinetic energy over the work done, to be at most 0.05"),
    ("steps", "", "1", POINT, "time steps taken"),
    ("steps_rejected", "", "1", POINT, "implicit mechanics: steps made again for their error"),
    ("steps_failed", "", "1", POINT, "implicit mechanics: steps that found no balance and were cut"),
    ("newton_iterations", "", "1", POINT, "implicit mechanics: iterations of Newton's method"),
    ("newton_shifts", "", "1", POINT, "implicit mechanics: matrices that were not positive and got a share of their diagonal"),
    ("wall_depth", "", "m", POINT, "implicit mechanics: how deep a piece of surface was in a contact wall, at most"),
    ("kinetic_over_work", "", "1", POINT, "implicit mechanics: kinetic energy of the last step over that at the start and the work of all forces so far"),
    *((f"step_{word}", "", "s", POINT, f"{word} time step that bodies moved by") for word in ("shortest", "longest")),
    ("wall_time", "", "s", POINT, "wall time of the run"),
    ("attempts", "", "1", POINT, "times the point was started"),
    # coordinates
    ("time", "t", "s", SERIES, "time"),
    ("x", "x", "m", GRID, "first coordinate"),
    ("y", "y", "m", GRID, "second coordinate"),
    ("z", "z", "m", GRID, "height"),
    ("r", "r", "m", GRID, "distance from the axis"),
    ("snapshot", "t", "s", GRID, "time of the snapshot"),
    # fields of particles; temperature, velocity and density on the grid too
    ("position", "x", "m", PARTICLES, "position"),
    ("velocity", "v", "m/s", PARTICLES, "velocity"),
    ("temperature", "θ", "K", PARTICLES, "temperature"),
    ("setting", "X", "1", PARTICLES, "degree of setting; 0 where a material does not set"),
    ("density", "ρ", "kg/m3", GRID, "density"),
    ("pressure", "p", "Pa", PARTICLES, "pressure"),
    ("J", "J", "1", PARTICLES, "volume ratio det F"),
    ("stress_mises", "", "Pa", PARTICLES, "von Mises stress"),
    ("stress", "σ", "Pa", PARTICLES, "Cauchy stress, positive in tension"),
    ("stress_recovered", "σ", "Pa", PARTICLES, "Cauchy stress, linear over patches of cells by least squares"),
    ("strain", "ε", "1", PARTICLES, "elastic Hencky strain, with what temperature has expanded"),
    ("displacement", "u", "m", PARTICLES, "displacement since the start"),
    ("reference_position", "X", "m", PARTICLES, "position at the start"),
    ("velocity_gradient", "∇v", "1/s", PARTICLES, "gradient of velocity, row by row"),
    ("id", "", "1", PARTICLES, "number of the particle, the same in every snapshot"),
    ("mass", "m", "kg", PARTICLES, "mass"),
    ("body", "", "1", PARTICLES, "number of the body, in the config's order"),
    ("row_size", "", "1", PARTICLES, "number of particles in this snapshot"),
    ("row_start", "", "1", PARTICLES, "where this snapshot begins in obs"),
    # a direction each
    *((f"stress_{ab}", "σ", "Pa", GRID, f"Cauchy stress {ab}, positive in tension, recovered") for ab in ("xy", "yz", "xz", "rr", "tt", "rz")),
    *((f"velocity_{a}", f"v{a}", "m/s", GRID, f"velocity along {a}") for a in AXES),
    *((f"momentum.{a}", "p", "kg m/s", SERIES, f"momentum along {a}") for a in AXES),
    *((f"position.mean_{a}", a, "m", SERIES, f"centre of mass along {a}") for a in AXES),
    *((f"position.min_{a}", a, "m", SERIES, f"smallest {a} of the material") for a in AXES),
    *((f"position.max_{a}", a, "m", SERIES, f"largest {a} of the material") for a in AXES),
    *((f"extent.{a}", "", "m", SERIES, f"extent of the material along {a}") for a in AXES),
]

AT_A_POINT = ("stress.", "strain.", "kirchhoff.")
NOT_AT_A_POINT = ("energy.kinetic", "energy.total", "energy.ledger", "dissipation.transfer", "dissipation.friction", "work.loads", "velocity.max", "strain.max",
                  "pressure.mean", "mass.total", "volume.total", "area.exchanging", *(f"{name}.inflow" for name, _ in INFLOW))  # fmt: skip
FIELDS_GRID = ("temperature", "velocity", "density", "stress")
FIELDS_PARTICLES = ("position", "velocity", "temperature", "pressure", "J", "stress_mises", "mass", "body",
                    "stress", "stress_recovered", "strain", "displacement", "reference_position", "velocity_gradient", "id", "setting")  # fmt: skip
TENSORS = ("stress", "stress_recovered", "strain", "velocity_gradient")  # fields of particles with a column a component
OBSERVABLES = tuple(row[0] for row in TABLE if "." in row[0])


def components(name: str, dimension: int | str | None) -> str:
    """What the columns of a tensor of particles are, in order; nothing for any other field. Axisymmetric: t is the hoop."""
    axes = {1: "x", 2: "xy", "axisymmetric": "rz", 3: "xyz"}.get(dimension, "")
    if name == "velocity_gradient":
        return " ".join(a + b for a in axes for b in axes)
    return {1: "xx yy zz", 2: "xx yy zz xy", "axisymmetric": "rr zz tt rz", 3: "xx yy zz xy yz xz"}.get(dimension, "") if name in TENSORS else ""


def dataset_name(observable: str) -> str:
    """`temperature.mean` -> `temperature_mean`."""
    return observable.replace(".", "_")


VARIABLES = {dataset_name(row[0]): Variable(dataset_name(row[0]), *row[1:]) for row in TABLE}
_SINGLE = sorted((dataset_name(name) for name in OBSERVABLES if dataset_name(name).startswith(SINGLE)), key=len, reverse=True)


def single(name: str) -> tuple[str, str] | None:
    """(observable, body) of `position.max_y.ball`, or of its name in a dataset; the observable as in a dataset. None for any other name."""
    told = dataset_name(name)
    base = next((base for base in _SINGLE if told.startswith(f"{base}_")), None) if told not in VARIABLES else None
    return (base, told[len(base) + 1 :]) if base is not None and ("." not in name or name[len(base)] == ".") else None


def threshold(name: str, probes: Iterable[str] = ()) -> Threshold | None:
    """Take `time_to.centre.95_degC` (or its dataset name) apart; None for any other name. In a dataset's name only `probes` tell tc_1 at 5 from tc at 1.5."""
    match = THRESHOLD.fullmatch(name)
    for probe in () if match else (*probes, r"[A-Za-z_]\w*?"):
        if match := re.fullmatch(IN_DATASET.format(probe), name):
            break
    if match is None:
        return None
    value, unit = float(match["value"].replace("_", ".")), match["unit"]
    return Threshold(match["probe"], value, unit, value + 273.15 if unit == "degC" else value)


def probed(name: str) -> tuple[str, str, str] | None:
    """(field, probe, part) of `displacement.tip_y` or `stress.root_xx`, or of their names in a dataset; None for any other name."""
    match = PROBED.fullmatch(name)
    return (match["field"], match["probe"], match["part"]) if match and (match["field"] == "stress") == (len(match["part"]) == 2) else None


def met(name: str) -> tuple[str, str, str] | None:
    """(what, wall or tool or pair, direction or nothing) of `force.bottom_z`, `area.press`, `heat.a_b`, or of their names in a dataset; None for any other."""
    match = MEETING.fullmatch(name) if dataset_name(name) not in VARIABLES else None
    return match and (match["turned"] or match["what"], match["on"] or match["of"], match["axis"] or "")


def parts(field: str, dimension: int | str | None) -> list[str]:
    """What a probe of a field may be asked for in scenes of a dimension."""
    return components(field, dimension).split() if field == "stress" else list({1: "x", 2: "xy", "axisymmetric": "rz", 3: "xyz"}.get(dimension, ""))


def observable_exists(name: str) -> bool:
    """Whether a config may list `name`. Whether its probe exists is for the config to say."""
    return name in OBSERVABLES or any(found(name) is not None for found in (threshold, probed, met, single))


def is_total(name: str) -> bool:
    """Whether a dataset name is a sum over the body."""
    name = found[0] if (found := single(name)) else name
    return VARIABLES[name].units in TOTALS if name in VARIABLES else (one := met(name)) is not None and MET[one[0]][0] in TOTALS


def turn(dimension: int | str | None) -> float:
    """What an axisymmetric scene computes is per radian: sums over the body are this much more."""
    return 2 * math.pi if dimension == "axisymmetric" else 1.0


def of_probe(probe: str) -> tuple[str, ...]:
    """The names that a dataset may hold for a probe, but for times to a temperature."""
    return f"temperature_{probe}", f"misfit_{probe}", f"measured_temperature_{probe}", f"measured_time_{probe}"


def describe(name: str, dimension: int | str | None = None, probes: Iterable[str] = (), bodies: Iterable[str] = ()) -> Variable:
    """The variable of a dataset name; KeyError with the name if there is none. In scenes of dimension 0, 1 and 2 totals are of a part of the body.

    `probes` as in `threshold`, `bodies` as in `meets`.
    """
    whole = VARIABLES.get(name)
    field, _, probe = name.partition("_")
    if whole is None and (summed := single(name)) and not (field in AT_PROBE and probe in probes):
        whole = replace(VARIABLES[summed[0]], name=name, long_name=f"{VARIABLES[summed[0]].long_name}, of {summed[1].replace('_', ' ')}")
    elif whole is None and (meeting := met(name)):
        what, of, axis = meeting
        said = MET[what][1].format(*meets(what, of, bodies)) + (f", along {axis}" if axis else "")
        whole = Variable(name, "", MET[what][0], POINT if what in BITES else SERIES, said)
    if whole is not None and is_total(name) and dimension in PER:
        units, share = PER[dimension]
        return replace(whole, units=units[TOTALS.index(whole.units)], long_name=f"{whole.long_name}, {share}")
    if whole is not None:
        return whole
    if reached := threshold(name, probes):
        unit = "°C" if reached.unit == "degC" else "K"
        return Variable(name, "t", "s", POINT, f"time for {reached.probe} to reach {reached.value:g} {unit}")
    if directed := probed(name):
        of, at, part = directed
        return replace(VARIABLES[of], name=name, symbol="", dims=SERIES, long_name=f"{of} along {part} at {at.replace('_', ' ')}")
    if field == "error" and probe in VARIABLES:
        return replace(VARIABLES[probe], name=name, symbol="", long_name=f"error of {VARIABLES[probe].long_name}")
    if field == "misfit" and probe:
        return Variable(name, "", "K", POINT, f"root-mean-square difference from the temperature measured at {probe.replace('_', ' ')}")
    if field == "measured" and probe:
        return replace(base := describe(probe, dimension, probes), name=name, long_name=f"measured {base.long_name}")
    if field in AT_PROBE and probe:
        return replace(VARIABLES[field], name=name, dims=SERIES, long_name=f"{field} at {probe.replace('_', ' ')}")
    raise KeyError(name)


def fits(observable: str, dimension: int | str) -> bool:
    """Whether an observable has a meaning in this dimension: `momentum.z` has none in 2."""
    if directed := probed(observable):
        return directed[2] in parts(directed[0], dimension)
    if summed := single(observable):
        return dimension != 0 and fits(next(name for name in OBSERVABLES if dataset_name(name) == summed[0]), dimension)
    if found := met(observable):
        if dimension == 0 or (found[0] == "torque" and dimension not in (2, 3)):
            return False
        return not found[2] or (found[2] == "z" if (found[0], dimension) == ("torque", 2) else found[2] in parts("displacement", dimension))
    if observable.startswith(AT_A_POINT) and observable != "strain.max":
        return dimension == 0
    if dimension == 0 and observable in NOT_AT_A_POINT:
        return False
    if observable.startswith("radius."):
        return dimension == "axisymmetric"
    axis = observable[-1] if observable[-2:-1] in (".", "_") else ""
    return axis not in AXES or axis in {0: "", 1: "x", 2: "xy", "axisymmetric": "rz", 3: "xyz"}[dimension]
