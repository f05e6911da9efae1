"""Material points from validated experiments, and their Runs: one, or many in one compiled call a kind (mpm.point)."""

import math
from dataclasses import dataclass

import numpy as np

from mpm.outcome import Run
from mpm.point import NOMINAL, STRESS, Lumped, Matter, Program, Sourced, solve
from mpm.point.pick import kinds, stack
from mpm.point.state import RATE, NoConduction, Rigid
from mpm.scene.build import output_times
from mpm.scene.inventory import output_bytes, physics
from mpm.scene.law import expansion_law, law, mechanical_laws, setting_law
from mpm.scene.menus import acting
from mpm.scene.refusal import SceneError
from mpm.scene.sources import heats
from mpm.state import Heating, Isothermal, NoExchange, NoExpansion, NoHeating, Thermal

AXES = ("xx", "yy", "zz")
PRESCRIBED = (("strain_rate", RATE), ("stretch_rate", NOMINAL), ("stress", STRESS))
NS_STEP = 600.0  # nanoseconds a step, with two directions of prescribed stress
LEAST_SECONDS = 0.6e-3  # of the shortest run; both fitted to `python -m mpm.benchmarks.costs`
MOST_NUMBERS = 2**25  # numbers in the record of one compiled call: 256 MB


@dataclass
class Spot:
    """One point, before it joins a batch."""

    laws: Matter  # with numbers in place of arrays
    until: list
    kind: list
    value: list
    temperature: list
    times: np.ndarray
    step: float
    safety: float
    levels: dict  # dataset name -> (probe, kelvin)
    probes: tuple
    solution: object = None  # t -> {series: exact value}

    def key(self) -> tuple:
        """Points with equal keys share a batch."""
        return kinds(self.laws), len(self.until), len(self.levels)


def run_zero(experiment, exact=None, beat=None, keeper=None) -> Run:
    """One material point. `exact(t)` where the config names its solution: {series: values}."""
    return together([spot(experiment, exact)], beat, keeper)[0]


def batch(experiments, exacts=None) -> list[Run]:
    """Runs of many material points: those with the same kinds of laws and numbers of stages in one compiled call, whatever their values.

    exacts   for each, its exact solution or None; see `run_zero`
    """
    spots = [spot(experiment, exact) for experiment, exact in zip(experiments, exacts or [None] * len(experiments), strict=True)]
    groups: dict[tuple, list[int]] = {}
    for index, one in enumerate(spots):
        groups.setdefault(one.key(), []).append(index)
    runs: list = [None] * len(spots)
    for members in groups.values():
        for part in parts(members, [len(spots[index].times) for index in members]):
            for index, run in zip(part, together([spots[index] for index in part]), strict=True):
                runs[index] = run
    return runs


def parts(members: list[int], rows: list[int]) -> list[list[int]]:
    """Members in calls whose records stay below MOST_NUMBERS."""
    cut = np.cumsum(rows) * 20 // MOST_NUMBERS
    return [[members[k] for k in np.flatnonzero(cut == c)] for c in np.unique(cut)]


def together(spots: list[Spot], beat=None, keeper=None) -> list[Run]:
    """Runs of points of one key."""
    rows = np.array([len(one.times) for one in spots])
    levels = np.array([[kelvin for _, kelvin in one.levels.values()] for one in spots], dtype=float).reshape(len(spots), -1)
    program = Program(
        until=np.array([one.until for one in spots]),
        kind=np.array([one.kind for one in spots], dtype=np.int64),
        value=np.array([one.value for one in spots]),
        temperature=np.array([one.temperature for one in spots]),
        first=np.concatenate([[0], np.cumsum(rows)]),
        times=np.concatenate([one.times for one in spots]),
        step=np.array([one.step for one in spots]),
        safety=np.array([one.safety for one in spots]),
        thresholds=levels,
    )
    runs = solve(stack([one.laws for one in spots]), program, beat, keeper)
    for one, run in zip(spots, runs, strict=True):
        finish(one, run)
    return runs


def finish(one: Spot, run: Run) -> None:
    """Probes, crossings and errors of a run, in the names of the dataset."""
    if "temperature_mean" in run.series:
        run.series |= {f"temperature_{name}": run.series["temperature_mean"] for name in one.probes}
    if one.solution is not None:
        run.series |= errors(run, one.solution(run.times))
    crossed = run.facts.pop("crossed")
    run.finals |= {name: float(values[-1]) for name, values in run.series.items()} | dict(zip(one.levels, crossed, strict=True))
    run.facts |= {"particles": 1, "unknowns": 0}


def errors(run: Run, right: dict) -> dict[str, np.ndarray]:
    """Error of every quantity that the exact solution gives; the temperature's under the names that every exact solution shares."""
    found = {f"error_{name}": run.series[name] - values for name, values in right.items()}
    scale = {name: np.max(np.abs(values)) for name, values in right.items()}
    relative = [np.abs(found[f"error_{name}"]) / scale[name] for name in right if scale[name] > 0]
    if "temperature_mean" in right:
        found["error_l2"] = found["error_max"] = np.abs(found["error_temperature_mean"])
    return found | {"error_relative": np.max(relative, axis=0)}


def spot(experiment, exact=None) -> Spot:
    """One point of a validated experiment with grid.dimension 0."""
    from mpm.records.variables import dataset_name, threshold

    end = experiment.time.end
    stages = experiment.loading
    kind, value = zip(*map(prescribed, stages), strict=True) if stages else (((RATE,) * 3,), ((0.0,) * 3,))
    found = {dataset_name(name): threshold(name) for name in experiment.output.observables if threshold(name) is not None}
    return Spot(
        laws=laws(experiment),
        until=[end if stage.until is None else stage.until for stage in stages] or [end],
        kind=list(kind),
        value=list(value),
        temperature=[math.nan if stage.temperature is None else stage.temperature for stage in stages] or [math.nan],
        times=output_times(experiment),
        step=0.0 if experiment.time.step == "auto" else experiment.time.step,
        safety=experiment.time.safety,
        levels={name: (at.probe, at.kelvin) for name, at in found.items()},
        probes=tuple(experiment.output.probes),
        solution=exact,
    )


def prescribed(stage) -> tuple[list[int], list[float]]:
    """Kinds and values by direction; a direction that no key names is held."""
    kind, value = [RATE] * 3, [0.0] * 3
    for key, what in PRESCRIBED:
        for k, name in enumerate(AXES):
            given = getattr(getattr(stage, key), name)
            if given is not None:
                kind[k], value[k] = what, given
    return kind, value


def laws(experiment) -> Matter:
    """The matter of one point, with numbers in place of arrays."""
    ((name, body),) = experiment.bodies.items()
    material = experiment.materials[body.material]
    elastic, flow = mechanical_laws(material)
    elastic = elastic or Rigid()
    thermal, exchange, expansion, heating = Isothermal(body.temperature), NoExchange(), NoExpansion(), NoHeating()
    if material.heat is not None:
        thermal = Thermal(np.zeros(1), np.zeros(1), body.temperature, NoConduction(), law(material.heat.alpha))
        exchange = lumped(experiment, name, body)
    if material.expansion is not None:
        expansion = expansion_law(material.expansion, elastic, thermal.theta, body.temperature)
    if material.heating is not None:
        gamma = expansion.gamma if material.heating.elastic is not None else 0.0
        heating = Heating(gamma, material.heating.dissipation.fraction if material.heating.dissipation is not None else 0.0)
    strain = np.array([getattr(body.shape.strain, axis) for axis in AXES])
    setting = setting_law(material, np.array([body.temperature]))
    return Matter(material.density, elastic, flow, thermal, exchange, expansion, heating, strain, strain.copy(), setting)


def lumped(experiment, name: str, body):
    """All exchanges of the point as one."""
    pairs = [pair for surface in experiment.surfaces if surface.of == name for pair in exchanges(surface) if pair[0] > 0]
    rate = sum(one * factor for one, factor, *_ in heats(experiment, name))
    if not pairs:
        return Sourced(0.0, body.temperature, rate) if rate else NoExchange()
    total = sum(beta for beta, _ in pairs)
    if math.isinf(total) and len(pairs) > 1:
        raise SceneError(("surfaces",), "a fixed temperature, or beta = inf, must be the only exchange of a material point")
    outside = pairs[0][1] if len(pairs) == 1 else sum(beta * out for beta, out in pairs) / total
    found = Lumped(total * body.shape.surface_to_volume, outside)
    return Sourced(*found, rate) if rate else found


def exchanges(surface) -> list[tuple[float, float]]:
    """(beta, temperature outside) of a surface."""
    return [(part.rate, part.outside) for part in acting(surface, "robin")]  # nothing else, and nothing that changes: config/rules_point.py


def estimate(experiment) -> dict:
    """Size, limits and cost of one point, without running it: the automatic step at the start, at most 1000 an output interval."""
    from mpm.point.step import shares
    from mpm.point.time_loop import MOST_STEPS

    one = spot(experiment)
    plain = getattr(shares, "py_func", shares)  # nothing is compiled for a plan
    rates = np.where(np.array(one.kind) == STRESS, 0.0, one.value)
    speed = float(np.max(np.abs(rates)))
    found = dict(zip(("relaxation", "yield strain", "temperature", "time constant"), plain(one.laws, speed, 0.0), strict=True))
    found = {name: float(limit) for name, limit in found.items() if math.isfinite(limit)}
    every = min(experiment.output.every, experiment.time.end)
    step = one.step or max(one.safety * min(found.values(), default=math.inf), every / MOST_STEPS)
    steps = math.ceil(experiment.time.end / min(step, every) * (1 - 1e-9))
    return {
        "particles": 1,
        "unknowns": 0,
        "steps": steps,
        "seconds": LEAST_SECONDS + steps * NS_STEP * 1e-9,
        "memory_bytes": 175_000_000 + len(one.times) * 20 * 8,
        "output_bytes": output_bytes(experiment, 0),
        "limits": found,
        "binds": "time.step" if one.step else "output" if step >= every else min(found, key=found.get),
        "physics": physics(experiment),
    }
