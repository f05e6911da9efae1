"""One point of a sweep: from a validated experiment to a Run. The shell, the workers and `mpm.run` all come through here.

run_point(experiment, beat, compare, keeper, threads) -> Run      run_points(experiments) -> list of Runs, for material points
warm(experiment): compile what it needs      estimate(experiment): what it will cost (mpm.costs)
Bodies without `elastic` do not move: heat alone, on the nodes of an immersed Galerkin problem (mpm.rigid). Otherwise particles (mpm.simulation).
In dimension 0 there is neither: a material point along its loading (mpm.point).
"""

import itertools

import numpy as np

from mpm.costs import estimate
from mpm.integrate.order import SHARED
from mpm.memory import Turn
from mpm.records.variables import is_total, turn
from mpm.review import review
from mpm.scene.inventory import physics
from mpm.scene.refusal import SceneError
from mpm.state import Run


def run_point(experiment, beat=None, compare: bool = True, keeper=None, threads: int = 1) -> Run:
    """Run one point (no sweep). A failure of the model is the Run's outcome; SceneError says that no method here can run the config.

    compare    False leaves out the errors against the exact solution, which cost time that a run does not need; what starts from it still does
    keeper     what the run remembers (mpm.memory), to go on where it was cut; None where nobody keeps it
    threads    that share the work of one large run (mpm.integrate.slabs); the result is the same for any number
    """
    if getattr(experiment.model, "kind", "full") == "auto":
        from mpm.reduce.choose import smallest

        turns = itertools.count()
        run = smallest(experiment, lambda smaller: run_named(smaller, beat, compare, keeper and Turn(keeper, next(turns)), threads))
        run.finals |= misfits(experiment, run)
        return complete(experiment, run)
    return run_named(experiment, beat, compare, keeper, threads)


def run_named(experiment, beat=None, compare: bool = True, keeper=None, threads: int = 1) -> Run:
    """Run the model that the config names."""
    from mpm.verification import exact_solution

    exact, shared = exact_solution(experiment), False
    if experiment.grid.dimension == 0:
        from mpm.scene.point import run_zero

        run = run_zero(experiment, exact if compare else None, beat, keeper)
    elif experiment.moving:
        from mpm.scene.build import build
        from mpm.scene.scaling import physical
        from mpm.simulation import simulate

        scene = build(experiment, exact)
        scene.watch.exact = scene.watch.exact if compare else None
        scene.threads = threads
        run = physical(simulate(scene, beat, keeper), experiment)
        shared = scene.order.shared
    else:
        from mpm.scene.rigid import run_rigid

        run = run_rigid(experiment, exact, beat, compare, keeper)
    run = whole(run, experiment.grid.dimension)
    if threads > 1:
        run.facts["threads"] = threads if shared else 1
        if not shared:
            run.facts["threads_idle"] = f"one thread did all: more help from {SHARED} moving particles on, in two or three dimensions"
    return told(experiment, run)


def whole(run: Run, dimension) -> Run:
    """The run with the totals of the whole body: what an axisymmetric scene computes is per radian."""
    factor = turn(dimension)
    if factor != 1.0:
        for found in (run.series, run.finals, *run.particles):
            found |= {name: values * factor for name, values in found.items() if is_total(name)}
    return run


def run_points(experiments) -> list[Run]:
    """Run many material points (grid.dimension 0): the Runs that `run_point` gives one by one, from one compiled call for each kind of point."""
    from mpm.scene.point import batch
    from mpm.verification import exact_solution

    runs = batch(experiments, [exact_solution(experiment) for experiment in experiments])
    return [told(experiment, run) for experiment, run in zip(experiments, runs, strict=True)]


def told(experiment, run: Run) -> Run:
    """The run, with its physics, its warnings, and how far it is from what was measured."""
    run.facts["physics"] = physics(experiment)
    run.facts["warnings"] = [*run.facts.get("warnings", ()), *review(experiment, run)]
    run.finals |= misfits(experiment, run)
    return complete(experiment, run)


def complete(experiment, run: Run) -> Run:
    """The run; SceneError by name where it completed, and lacks something that the config asks for."""
    from mpm.records.variables import dataset_name

    output, shots, have = experiment.output, experiment.output.snapshots, {*run.series, *run.finals}
    wanted = [(f"observables.{name}", dataset_name(name) in have) for name in output.observables]
    wanted += [(f"probes.{name}", f"temperature_{name}" in have) for name in output.probes]
    for kind, fields in (("grid", run.grid), ("particles", run.particles[0] if run.particles else {})) if shots is not None else ():
        stems = {*fields, *(name.rpartition("_")[0] for name in fields)}  # a vector has a field a direction
        wanted += [(f"snapshots.{kind}.{name}", name in stems) for name in getattr(shots, kind)]
    lacking = [name for name, there in wanted if not there]
    if run.outcome.ok and lacking:
        raise SceneError(f"output.{', output.'.join(lacking)}: asked for, and this model does not tell {'it' if len(lacking) == 1 else 'them'}")
    return run


def misfits(experiment, run: Run) -> dict[str, float]:
    """Root-mean-square difference between each probe and what was measured there, at the measured times that the run reached."""
    found = {}
    for probe, curve in experiment.output.measured.items():
        samples = np.array([pair for pair in curve.samples if pair[0] <= run.times[-1] * (1 + 1e-9)]).reshape(-1, 2)
        difference = np.interp(samples[:, 0], run.times, run.series[f"temperature_{probe}"]) - samples[:, 1]
        found[f"misfit_{probe}"] = float(np.sqrt(np.mean(difference**2))) if len(samples) else float("nan")
    return found


def warm(experiment) -> None:
    """Compile (or load from the cache) what the experiment needs, by a run of one output interval of its smallest steps."""
    from mpm.config import load

    if getattr(experiment.model, "kind", "full") == "auto":
        from mpm.reduce.choose import likely

        experiment = likely(experiment)
    short = experiment.resolved()
    if experiment.grid.dimension == 0:
        short["time"]["end"] = experiment.time.end * 1e-3
    elif experiment.moving:
        from mpm.integrate.timestep import limits
        from mpm.scene.build import build
        from mpm.simulation import Clock

        scene = build(experiment)
        step = limits(scene.space, experiment.grid.directions, scene.bodies, Clock(scene).reports).step() * experiment.time.scale
        short["time"]["end"] = min(experiment.time.end, step)
    else:
        short["time"]["end"] = experiment.time.end * 1e-3
    short["output"]["every"] = short["time"]["end"]
    short["sweep"] = None
    run_point(load(short))


__all__ = ["estimate", "run_point", "run_points", "warm"]
