"""One point of a sweep: from a validated experiment to a Run. The shell, the workers and `mpm.run` all come through here.

run_point(experiment, beat) -> Run      warm(experiment): compile what it needs      estimate(experiment): what it will cost
Bodies without `elastic` do not move: heat alone, on the nodes of an immersed Galerkin problem (mpm.rigid). Otherwise particles (mpm.simulation).
In dimension 0 there is neither: a material point along its loading (mpm.point).
"""

import numpy as np

from mpm.state import Run


def run_point(experiment, beat=None) -> Run:
    """Run one point (no sweep). A failure of the model is the Run's outcome; SceneError says that no method here can run the config."""
    from mpm.verification import exact_solution

    exact = exact_solution(experiment)
    if experiment.grid.dimension == 0:
        from mpm.scene.point import run_zero

        run = run_zero(experiment, exact, beat)
    elif experiment.moving:
        from mpm.scene.build import build
        from mpm.simulation import simulate

        run = simulate(build(experiment, exact), beat)
    else:
        from mpm.scene.rigid import run_rigid

        run = run_rigid(experiment, exact, beat)
    run.facts["physics"] = physics(experiment)
    run.finals |= misfits(experiment, run)
    return run


def misfits(experiment, run: Run) -> dict[str, float]:
    """Root-mean-square difference between each probe and what was measured there, at the measured times that the run reached."""
    found = {}
    for probe, curve in experiment.output.measured.items():
        samples = np.array([pair for pair in curve.samples if pair[0] <= run.times[-1] * (1 + 1e-9)]).reshape(-1, 2)
        difference = np.interp(samples[:, 0], run.times, run.series[f"temperature_{probe}"]) - samples[:, 1]
        found[f"misfit_{probe}"] = float(np.sqrt(np.mean(difference**2))) if len(samples) else float("nan")
    return found


def physics(experiment) -> dict[str, list[str]]:
    """What is compiled for this config, and what is absent."""
    present: set[str] = set()
    for material in experiment.materials.values():
        for part in ("elastic", "flow", "heat", "expansion"):
            law = getattr(material, part)
            if law is not None:
                present.add(f"{part}: {type(law).kind}")
        if material.heating is not None:
            present |= {f"heating: {part}" for part in ("elastic", "dissipation") if getattr(material.heating, part) is not None}
    present |= {"exchange: convection"} if any(s.convection is not None for s in experiment.surfaces) else set()
    present |= {"gravity"} if experiment.gravity is not None else set()
    said = {text.split(":")[0] for text in present}
    parts = ("elastic", "flow", "heat", "expansion", "heating", "exchange", "gravity")
    return {"compiled": sorted(present), "absent": [part for part in parts if part not in said]}


def warm(experiment) -> None:
    """Compile (or load from the cache) what the experiment needs, by a run of one output interval of its smallest steps."""
    from mpm.config import load

    short = experiment.resolved()
    if experiment.grid.dimension == 0:
        short["time"]["end"] = experiment.time.end * 1e-3
    elif experiment.moving:
        from mpm.integrate.timestep import limits
        from mpm.scene.build import build
        from mpm.simulation import Clock

        scene = build(experiment)
        step = limits(scene.space, experiment.grid.directions, scene.bodies, Clock(scene).reports).step()
        short["time"]["end"] = min(experiment.time.end, step)
    else:
        short["time"]["end"] = experiment.time.end * 1e-3
    short["output"]["every"] = short["time"]["end"]
    short["sweep"] = None
    run_point(load(short))


def estimate(experiment) -> dict:
    """Size, limits and cost of one point, without running it."""
    from mpm import costs

    if experiment.grid.dimension == 0:
        from mpm.scene import point

        return point.estimate(experiment)
    return costs.estimate_moving(experiment) if experiment.moving else costs.estimate_rigid(experiment)
