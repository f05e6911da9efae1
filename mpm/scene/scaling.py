"""Slow scenes on a fast clock: time scaling (docs/physics.md 10).

With S = time.scale, kappa, beta and every other rate are multiplied by S and eta is divided by it; density, gravity, moduli, M and p0 stay; the run
ends at end/S. Heat and viscous flow then go through the same states S times sooner, and only inertia differs. What leaves the run is physical again:
times, and velocities (hence momentum and kinetic energy) divided by S.

Valid while inertia is small, which the run itself measures at its output times, with its own speeds:
froude    largest (S v)^2/(g H), v the fastest particle, H the extent along gravity                    at most 0.02
kinetic   largest kinetic energy over the work done: kinetic, elastic and dissipated energy together   at most 0.05
"""

import numpy as np

from mpm.config import boundary
from mpm.outcome import Run
from mpm.records.variables import is_total, turn
from mpm.scene.weight import strongest
from mpm.warned import warning

FROUDE, KINETIC = 0.02, 0.05
MOMENTS = {"table": ("time",), "sine": ("period",)}  # fields of a programme over time
RATES = {"table": ("value",), "sine": ("mean", "amplitude")}  # its values


def times(value, factor: float):
    """A number, text (`auto`), nothing, or a tuple of them, by `factor`."""
    if isinstance(value, tuple):
        return tuple(times(one, factor) for one in value)
    return value if value is None or isinstance(value, str) else value * factor


def changed(model, factor: float, *names: str):
    """The model with the fields `names` multiplied; nothing of it is validated again, so that a rate may pass its physical bounds."""
    return None if model is None else model.model_copy(update={name: times(getattr(model, name), factor) for name in names})


def law_times(law, factor: float):
    """A law of temperature or setting whose values are multiplied."""
    if type(law).kind == "set":
        return law.model_copy(update={name: law_times(getattr(law, name), factor) for name in ("raw", "baked")})
    return changed(law, factor, *law.values, *getattr(law, "areas", ()))


def sooner(programme, S: float):
    """What changes over time, on the fast clock."""
    return programme if isinstance(programme, float | int) else changed(programme, 1 / S, *MOMENTS[type(programme).kind])


def faster(programme, S: float):
    """A rate, S times larger and on the fast clock."""
    return programme * S if isinstance(programme, float | int) else changed(sooner(programme, S), S, *RATES[type(programme).kind])


def exchange(model, S: float):
    """One exchange of a surface or a wall: its rates, and its temperature over time."""
    if model is None:
        return None
    rates = {name: faster(getattr(model, name), S) for name in model.rates}
    return model.model_copy(update=rates | ({model.meets: sooner(getattr(model, model.meets), S)} if model.meets else {}))


def setting(model, S: float, *names: str):
    """The model, its parameters `names` setting S times faster."""
    for name in names:
        one = getattr(model, name, None)
        if one is not None and type(one).kind == "set" and one.rate is not None:
            model = model.model_copy(update={name: one.model_copy(update={"rate": law_times(one.rate, S)})})
    return model


def material(model, S: float):
    heat, flow = model.heat, model.flow
    if heat is not None:
        heat = heat.model_copy(update={"kappa": law_times(heat.kappa, S)})
    if flow is not None:
        flow = setting(flow.model_copy(update={"eta": law_times(flow.eta, 1 / S)}), S, "M", "eta")
    return model.model_copy(update={"heat": heat, "flow": flow, "elastic": setting(model.elastic, S, "E")})


def surface(model, S: float):
    model = changed(model, 1 / S, "from", "until")
    return model.model_copy(update={kind: exchange(getattr(model, kind), S) for kind in boundary.EXCHANGES})


def wall(model, S: float):
    rubs = {"friction": sooner(model.friction, S)} if "friction" in type(model).model_fields else {}
    return changed(model, 1 / S, "from", "until").model_copy(update={"heat": exchange(model.heat, S)} | rubs)


def pair(model, S: float):
    return changed(changed(model, S, "conductance"), 1 / S, "from", "until").model_copy(update={"friction": sooner(model.friction, S)})


def load(model, S: float):
    model = changed(model, 1 / S, "from", "until")
    return model.model_copy(update={"traction": changed(model.traction, 1 / S, "ramp"), "drag": changed(model.drag, S, "rate")})


def hurried(experiment):
    """The experiment on the fast clock; itself where `time.scale` is 1."""
    S = experiment.time.scale
    if S == 1:
        return experiment
    output = changed(experiment.output, 1 / S, "every")
    return experiment.model_copy(
        update={
            "bodies": {name: changed(body, S, "velocity", "angular_velocity") for name, body in experiment.bodies.items()},
            "materials": {name: material(one, S) for name, one in experiment.materials.items()},
            "surfaces": tuple(surface(one, S) for one in experiment.surfaces),
            "contacts": tuple(pair(one, S) for one in experiment.contacts),
            "gravity": experiment.gravity and tuple(sooner(one, S) for one in experiment.gravity),
            "loads": tuple(load(one, S) for one in experiment.loads),
            "walls": {side: wall(one, S) for side, one in experiment.walls.items()},
            "time": changed(experiment.time, 1 / S, "end", "step").model_copy(update={"scale": 1.0}),
            "method": changed(experiment.method, 1 / S, "heat_step"),
            "output": output.model_copy(update={"snapshots": changed(output.snapshots, 1 / S, "every")}),
        }
    )


def validity(run: Run, gravity) -> dict[str, float]:
    """froude (where there is gravity) and kinetic of a run on the fast clock."""
    series, found = run.series, {}
    if gravity is not None and any(gravity):
        axis = int(np.argmax(np.abs(gravity)))
        extent = [values for name, values in series.items() if name.startswith("extent_")][axis]
        found["froude"] = float(np.max(series["velocity_max"] ** 2 / (np.linalg.norm(gravity) * extent)))
    kinetic = series["energy_kinetic"]
    work = float(np.max(kinetic + series["energy_elastic"] + series["dissipation_total"]))
    return found | {"kinetic": float(np.max(kinetic)) / work if work > 0 else 0.0}


def shown(experiment):
    """What turns a snapshot of a scene into that of the experiment: in physical times and velocities, with the mass of whole particles."""
    S, factor = experiment.time.scale, turn(experiment.grid.dimension)

    def fields(found: dict) -> dict:
        made = {name: values / S if S != 1 and name.startswith("velocity") else values for name, values in found.items()}
        return {name: values * factor if factor != 1 and is_total(name) else values for name, values in made.items()}

    return lambda when, grid, particles: (when * S, fields(grid), fields(particles))


def physical(run: Run, experiment) -> Run:
    """The run in physical times and velocities, with the measure of what the scaling did; as it is where `time.scale` is 1."""
    S = experiment.time.scale
    if S == 1:
        return run
    found = validity(run, strongest(experiment))
    run.times = run.times * S
    kinetic = run.series["energy_kinetic"]
    run.series["energy_total"] = run.series["energy_total"] - kinetic + kinetic / S**2
    run.series["energy_kinetic"] = kinetic / S**2
    lent = kinetic - kinetic / S**2  # by the fast clock: books close on what is shown
    run.series["dissipation_transfer"] = run.series["dissipation_transfer"] + (lent - lent[0])
    run.series["energy_ledger"] = run.series["energy_ledger"] - (lent - lent[0])
    for name in run.series:
        if name.startswith(("velocity_", "momentum_")):
            run.series[name] = run.series[name] / S
    run.finals |= {name: float(values[-1]) for name, values in run.series.items()}
    run.finals |= {name: value * S for name, value in run.finals.items() if name.startswith(("time_to_", "step_"))}
    run.finals |= {f"scaling_{name}": value for name, value in found.items()}
    past = [f"{what} {found[key]:.2g} above {most:g}" for key, what, most in (("froude", "Froude number", FROUDE), ("kinetic", "kinetic share", KINETIC))
            if found.get(key, 0.0) > most]  # fmt: skip
    run.facts["time_scaling"] = {"scale": S, **found, "valid": not past}
    if past:
        said = f"time scaling by {S:g} lets inertia in: {', '.join(past)}"
        run.facts["warnings"] = [*run.facts.get("warnings", ()), warning("inertia", said)]
    return run
