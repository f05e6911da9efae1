"""One point of a sweep: from a validated experiment to a Run. The shell, the workers and `mpm.run` all come through here.

run_point(experiment, beat, compare, keeper, threads) -> Run      run_points(experiments) -> list of Runs, for material points
warm(experiment): compile what it needs
estimate(experiment): what it will cost (mpm.costs)      refuse(experiment): SceneError where no method here can run it, before anything is compiled
Bodies without `elastic` do not move: heat alone, on the nodes of an immersed Galerkin problem (mpm.rigid). Otherwise particles (mpm.simulation).
In dimension 0 there is neither: a material point along its loading (mpm.point).
"""

import functools
import itertools
import sys

import numpy as np
from threadpoolctl import ThreadpoolController

from mpm import compiling
from mpm.config.rules_frame import named
from mpm.costs import estimate, mechanics_settled, refuse_endless, settled
from mpm.guards import MODERATE
from mpm.integrate.sorting import SHARED
from mpm.memory import Turn
from mpm.outcome import Run
from mpm.records.variables import is_total, turn
from mpm.review import review
from mpm.scene.framing import choice
from mpm.scene.inventory import physics
from mpm.scene.refusal import SceneError, placed


@placed
def run_point(experiment, beat=None, compare: bool = True, keeper=None, threads: int = 1) -> Run:
    """Run one point (no sweep). A failure of the model is the Run's outcome; SceneError says that no method here can run the config.

    compare    False leaves out the errors against the exact solution, which cost time that a run does not need; what starts from it still does
    keeper     what the run remembers (mpm.memory), to go on where it was cut; None where nobody keeps it
    threads    that share the work of one large run (mpm.integrate.step_threaded); the result is the same for any number
    """
    if not compiling.begun():
        from mpm.ahead import compile_ahead

        compiling.expect(experiment)
        compile_ahead(experiment)
    with one_thread():
        if getattr(experiment.model, "kind", "full") == "auto":
            from mpm.reduce.choose import smallest

            turns = itertools.count()
            run = smallest(experiment, lambda smaller: run_named(smaller, beat, compare, threads, keeper and Turn(keeper, next(turns))))
            run.finals |= misfits(experiment, run)
            return complete(experiment, run)
        return run_named(experiment, beat, compare, threads, keeper)


def one_thread():
    """Keeps BLAS to one thread: factors are small, and two threads wait for one another (the loaf by implicit steps: 36 s of processor, 3 s with one)."""
    return blas("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas")


@functools.cache
def blas(scipy: bool) -> ThreadpoolController:
    """Of NumPy, and of SciPy once that is loaded: it brings its own."""
    return ThreadpoolController()


@placed
def refuse(experiment) -> None:
    """SceneError with its place where `run_point` would raise it: the scene is put together, of bodies that are only sampled to look at."""
    from mpm.verification import exact_solution

    estimate(experiment)
    exact_solution(experiment)
    if experiment.grid.dimension != 0 and not experiment.moving:
        from mpm.scene.rigid import refuse_rigid

        refuse_rigid(experiment)


def in_a_frame(experiment, *given, keeper=None) -> Run:
    """Run `method.frame: auto` (mpm.scene.framing): in the total frame; where a body outgrows it on in the updated one, or again where it cannot go on."""
    experiment = mechanics_settled(experiment)
    frame, why = choice(experiment)
    if frame == "total":
        try:
            run = run_named(named(experiment, "total"), *given, keeper=keeper and Turn(keeper, 0), moderate=MODERATE)
            ended = "" if run.outcome.ok or run.outcome.kind == "budget" else f"the total frame was left: {run.outcome.message or run.outcome.kind}"
        except SceneError as error:  # what only the scene shows
            ended = error.message
        if not ended:
            over = run.facts.pop("over", "")
            run.facts["frame"] = {"name": "updated" if over else "total", "why": over or why}
            return run
        why = ended
    run = run_named(named(experiment, "updated"), *given, keeper=keeper and Turn(keeper, 1))
    run.facts["frame"] = {"name": "updated", "why": why}
    return run


def run_named(experiment, beat=None, compare: bool = True, threads: int = 1, keeper=None, moderate: float = np.inf) -> Run:
    """Run the model that the config names. `moderate`: the strain beyond which a body has outgrown the total frame."""
    from mpm.verification import exact_solution

    if experiment.moving and experiment.grid.dimension != 0 and experiment.method.frame == "auto":
        return in_a_frame(experiment, beat, compare, threads, keeper=keeper)
    experiment = settled(experiment)
    exact, shared, before = exact_solution(experiment), False, compiling.seconds()
    if experiment.grid.dimension == 0:
        from mpm.scene.point import run_zero

        run = run_zero(experiment, exact if compare else None, beat, keeper)
    elif experiment.moving:
        from mpm.scene.build import build
        from mpm.scene.scaling import physical, shown
        from mpm.simulation import Clock, simulate
        from mpm.total.drive import present_limits

        scene = build(experiment, exact)
        refuse_endless(experiment, (scene.step or present_limits(scene, Clock(scene)).step() * scene.safety) * scene.scale)
        scene.watch.exact = scene.watch.exact if compare else None
        scene.threads, scene.moderate, scene.watch.shown = threads, moderate, shown(experiment)
        if moderate < np.inf and scene.implicit is None:
            from mpm.scene.over import go_over

            scene.over = functools.partial(go_over, named(experiment, "updated"), exact)
        with one_thread():  # SciPy is loaded by now where steps are implicit
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
    run.wall_time = max(0.0, run.wall_time - (compiling.seconds() - before))
    compiling.remember(experiment, again=compiling.seconds() > before)
    return with_facts(experiment, run)


def whole(run: Run, dimension) -> Run:
    """The run with the totals of the whole body: what an axisymmetric scene computes is per radian. Snapshots are so already (mpm.scene.scaling.shown)."""
    factor = turn(dimension)
    if factor != 1.0:
        for found in (run.series, run.finals):
            found |= {name: values * factor for name, values in found.items() if is_total(name)}
    return run


def run_points(experiments) -> list[Run]:
    """Run many material points (grid.dimension 0): the Runs that `run_point` gives one by one, from one compiled call for each kind of point."""
    from mpm.scene.point import batch
    from mpm.verification import exact_solution

    runs = batch(experiments, [exact_solution(experiment) for experiment in experiments])
    return [with_facts(experiment, run) for experiment, run in zip(experiments, runs, strict=True)]


def with_facts(experiment, run: Run) -> Run:
    """The run, with its physics, its warnings, and how far it is from what was measured."""
    run.facts["physics"] = physics(experiment)
    run.facts["warnings"] = [*run.facts.get("warnings", ()), *review(experiment, run)]
    run.finals |= misfits(experiment, run)
    return complete(experiment, run)


def complete(experiment, run: Run) -> Run:
    """The run; SceneError by name where it completed, and lacks something that the config asks for."""
    from mpm.records.variables import dataset_name, probed

    output, shots, have = experiment.output, experiment.output.snapshots, {*run.series, *run.finals}
    wanted = [(("observables", k), name, dataset_name(name) in have) for k, name in enumerate(output.observables)]
    more = {found[1] for found in map(probed, output.observables) if found is not None}
    wanted += [(("probes", name), f"probes.{name}", name in more or f"temperature_{name}" in have) for name in output.probes]
    grid, particles = run.frames[0][1:] if run.frames is not None else (run.grid, run.particles[0] if run.particles else {})
    for kind, fields in (("grid", grid), ("particles", particles)) if shots is not None else ():
        stems = {*fields, *(name.rpartition("_")[0] for name in fields)}  # a vector has a field a direction
        wanted += [(("snapshots", kind, k), f"snapshots.{kind}.{name}", name in stems) for k, name in enumerate(getattr(shots, kind))]
    lacking = [(at, name) for at, name, there in wanted if not there]
    if run.outcome.ok and lacking:
        said = f"{', '.join(name for _, name in lacking)}: asked for, and this model does not tell {'it' if len(lacking) == 1 else 'them'}"
        raise SceneError(("output", *lacking[0][0]), said)
    return run


def misfits(experiment, run: Run) -> dict[str, float]:
    """Root-mean-square difference between the run and each measured curve, at the measured times that it reached; NaN where it reached none."""
    from mpm.config.measured import target

    found = {}
    for name, curve in experiment.output.measured.items():
        variable = target(experiment, name, curve)[0]
        if curve.equals is not None:
            found[f"misfit_{name}"] = abs(run.finals.get(variable, np.nan) - curve.equals)
            continue
        samples = np.array([row[:2] for row in curve.samples if row[0] <= run.times[-1] * (1 + 1e-9)]).reshape(-1, 2)
        difference = np.interp(samples[:, 0], run.times, run.series[variable]) - samples[:, 1] if variable in run.series else np.full(len(samples), np.nan)
        found[f"misfit_{name}"] = float(np.sqrt(np.mean(difference**2))) if len(samples) else float("nan")
    return found


def warm(experiment) -> None:
    """Compile (or load from the cache) what the experiment needs, by a run of one output interval of its smallest steps."""
    from mpm.config import load

    if getattr(experiment.model, "kind", "full") == "auto":
        from mpm.reduce.choose import likely

        experiment = likely(experiment)
    experiment = settled(experiment)
    short = experiment.resolved() | {"formulas": {}}  # what they say stands in the numbers, which are changed here
    if experiment.moving and experiment.grid.dimension != 0:
        from mpm.ahead import at_start
        from mpm.total.drive import present_limits

        scene, clock = at_start(experiment)
        short["time"]["end"] = min(experiment.time.end, present_limits(scene, clock).step() * experiment.time.scale)
    else:
        short["time"]["end"] = experiment.time.end * 1e-3
    short["output"]["every"] = short["time"]["end"]
    short["sweep"] = None
    run_point(load(short))


__all__ = ["estimate", "refuse", "run_point", "run_points", "warm"]
