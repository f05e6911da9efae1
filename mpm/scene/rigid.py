"""A rigid scene from a validated experiment, and its Run: heat alone, on the nodes of an immersed Galerkin problem (mpm.rigid)."""

import time

import numpy as np

from mpm.heat.programmes import Parts, bounds, changes
from mpm.materials import value
from mpm.observe import merged, near
from mpm.outcome import Run
from mpm.scene.build import SceneError, output_times, watch
from mpm.scene.exchange import most, must_conduct, rates, refuse_absent, robin
from mpm.scene.law import law
from mpm.scene.shapes import cut_quadrature, shape
from mpm.scene.sources import resting
from mpm.scene.still import joints, refuse_covered
from mpm.warned import warning


def rigid_bodies(experiment, field=None) -> list:
    """The bodies of a rigid scene, with the temperatures `field(x)` at the start where given; SceneError for one that has nothing to do."""
    from mpm.rigid import RigidBody

    if experiment.grid.basis != "quadratic":
        said = f"{experiment.grid.basis}: bodies that do not move have quadratic splines only (order 3 in the cell); leave grid.basis out"
        raise SceneError(("grid", "basis"), said)
    if experiment.method.locking is not None:
        raise SceneError(("method", "locking"), "it is for bodies that move, and none of these has `elastic`; leave it out")
    if type(experiment.method.bounds).kind != "auto":
        raise SceneError(("method", "bounds"), "it is for bodies that move, and none of these has `elastic`; method.rigid: bounded keeps bounds here")
    refuse_absent(experiment)
    bodies = []
    for name, body in experiment.bodies.items():
        material = experiment.materials[body.material]
        if material.heat is None:
            raise SceneError(("materials", body.material), f"it has neither `elastic` nor `heat`: nothing would happen in {name}")
        entries = [entry for entry in experiment.surfaces if entry.of == name]
        surfaces = tuple((entry.side, beta, outside) for entry in entries for beta, outside in robin(entry))
        fluxes = tuple((entry.side, flux) for entry in entries for flux, _ in rates(entry, "flux"))
        radiation = tuple((entry.side, emissivity, sky) for entry in entries for emissivity, sky in rates(entry, "grey"))
        refuse_gradual(experiment)
        outline = shape(body.shape, experiment.grid.dimension)
        kappa, alpha = law(material.heat.kappa), law(material.heat.alpha)
        around = [outside for _, rate, outside in (*surfaces, *radiation) if most(rate) > 0]
        must_conduct(name, any(value(kappa, t) > 0 for t in (body.temperature, *(t for one in around for t in bounds(one)))), bool(around))
        bodies.append(
            RigidBody(outline, body.temperature, material.density, kappa, alpha, surfaces, fluxes, radiation, resting(experiment, name, outline), field)
        )
    return bodies


def refuse_gradual(experiment) -> None:
    """SceneError for a beta or an emissivity that changes between jumps: the matrices of a body that does not move are made for numbers."""
    for index, entry in enumerate(experiment.surfaces):
        for kind, role in (("beta", "robin"), ("emissivity", "grey")):
            for rate, _ in rates(entry, role):
                if any(changes(part) for part in (rate.parts if isinstance(rate, Parts) else (rate,))):
                    said = "changes gradually, which bodies that do not move cannot follow: let it jump (the same time twice in its table)"
                    raise SceneError(("surfaces", index), f"{kind} {said}, or give the material `elastic`")


def refuse_rigid(experiment) -> None:
    """SceneError where no method can run bodies that do not move."""
    refuse_covered(experiment, [body.shape for body in rigid_bodies(experiment)], joints(experiment))


def run_rigid(experiment, exact=None, beat=None, compare: bool = True, keeper=None) -> Run:
    """Heat alone, bodies that do not move. `exact(x, t)` where the config names its solution; it is compared with unless told otherwise."""
    from mpm.records.variables import dataset_name, threshold
    from mpm.rigid import solve
    from mpm.rigid.run import NOTICEABLE, Method

    began = time.perf_counter()
    found = {dataset_name(name): threshold(name) for name in experiment.output.observables if threshold(name) is not None}
    times, grid = output_times(experiment), experiment.grid
    kind = type(experiment.method.rigid).kind
    options = {name: getattr(experiment.method.rigid, name) for name in ("order", "tolerance") if getattr(experiment.method.rigid, name, None)}
    method = Method(kind, step=None if experiment.time.step == "auto" else experiment.time.step, **options)
    shift = np.array(experiment.method.offset) * grid.cell
    levels = [(at.probe, at.kelvin) for at in found.values()]
    look = Looks(experiment, times, exact if compare else None)
    field = (lambda x: exact(x + shift, 0.0)) if getattr(exact, "starts", False) else None
    bodies, end, probes, together = rigid_bodies(experiment, field), experiment.time.end, experiment.output.probes, joints(experiment)
    refuse_covered(experiment, [body.shape for body in bodies], together)
    if field is not None and together:
        raise SceneError(("exact",), "it sets the temperatures at the start, which is not known of bodies that touch")
    shots = look.times, look.points
    solved = solve(bodies, grid.dimension, grid.cell, -shift, end, times, probes, levels, method, beat, snapshots=shots, keeper=keeper, joints=together)
    series = {dataset_name(name): values for name, values in solved.series.items()}
    series["heat_total"] = series.pop("heat")
    series |= look.errors(solved.snapshots, shift, len(solved.times))
    masses = matter(experiment) if {name.partition(".")[0] for name in experiment.output.observables} & {"mass", "volume"} else []
    asked = {dataset_name(name) for name in experiment.output.observables} & {"mass_total", "volume_total"}
    series |= {name: np.full(len(solved.times), sum(one[name] for one in masses)) for name in sorted(asked)} | of_bodies(experiment, solved, masses, together)
    finals = {name: float(values[-1]) for name, values in series.items()}
    finals |= {name: solved.crossings[at.probe, at.kelvin] for name, at in found.items()}
    finals["steps"] = float(solved.steps)
    facts = solved.facts | {"unknowns": solved.unknowns, "rejected": solved.rejected, "limits": solved.limits, "binds": "accuracy"}
    warned = [
        warning("temperature", f"{name}: temperatures leave the bounds of their data by up to {100 * over:.2g} % of the range", "`method.rigid: bounded`")
        for name, over in zip(experiment.bodies, facts.pop("beyond"), strict=False)
        if over > NOTICEABLE
    ]
    run = Run(solved.outcome, solved.times, series, finals, steps=solved.steps, facts=facts | ({"warnings": warned} if warned else {}))
    look.frames(solved.snapshots, run)
    run.wall_time = solved.spent + time.perf_counter() - began
    return run


def matter(experiment) -> list[dict[str, float]]:
    """Mass and volume of each body: exact, from their outlines; per radian in an axisymmetric scene, as all that the solver sums."""
    grid, found = experiment.grid, []
    edges = [np.arange(round(size / grid.cell) + 1) * grid.cell for size in grid.size]
    for body in experiment.bodies.values():
        points, _ = cut_quadrature(shape(body.shape, grid.dimension), edges, 2)
        volume = float(np.sum(points.w * (points.x[:, 0] if grid.dimension == "axisymmetric" else 1.0)))
        found.append({"mass_total": volume * experiment.materials[body.material].density, "volume_total": volume})
    return found


def of_bodies(experiment, solved, masses, joints) -> dict[str, np.ndarray]:
    """Series of one body that are asked for, and the heat that the first body of each pair that touches has taken from the second; none of asked ones apart."""
    from mpm.records.variables import dataset_name, met, single

    names, count, found = list(experiment.bodies), len(solved.times), {}
    for told in experiment.output.observables:
        if (one := single(told)) is not None:
            b, own = names.index(one[1]), {"heat_total": "heat"}.get(one[0], one[0].replace("_", ".", 1))
            constant = masses[b].get(one[0], np.nan) if masses else np.nan
            found[dataset_name(told)] = solved.of[b].get(own, np.full(count, constant))
    flows = {(joint.first, joint.second): np.zeros(count) for joint in joints} | {pair: -flow for pair, flow in solved.passed.items()}
    apart = {dataset_name(told): np.zeros(count) for told in experiment.output.observables if met(told) is not None}
    return found | apart | {f"heat_{names[a]}_{names[b]}": flow for (a, b), flow in flows.items()}


class Looks:
    """Where and when a rigid run is looked at beside its probes: points of the bodies for the error against an exact solution, nodes for snapshots."""

    def __init__(self, experiment, times: np.ndarray, exact):
        grid, wanted = experiment.grid, watch(experiment)
        self.exact, self.due, self.axes = exact, wanted.snapshots, {}
        self.times = merged(times, self.due) if exact is not None else self.due
        self.told = near(self.times, times)  # the times of the series
        self.inside, self.weights = np.zeros((0, grid.directions)), np.zeros(0)
        if exact is not None:
            name = experiment.exact.body or next(iter(experiment.bodies))
            outline = shape(experiment.bodies[name].shape, grid.dimension)
            edges = [np.arange(round(size / grid.cell) + 1) * grid.cell for size in grid.size]
            volume, _ = cut_quadrature(outline, edges, 2)
            within = outline.distance(volume.x) <= 0  # a concave side has points outside: right in sums, but no temperature is there
            self.inside, self.weights = volume.x[within], (volume.w * (volume.x[:, 0] if grid.dimension == "axisymmetric" else 1.0))[within]
        nodes = np.zeros((0, grid.directions))
        if wanted.grid:
            names = ("r", "z") if grid.dimension == "axisymmetric" else ("x", "y", "z")[: grid.directions]
            self.axes = {axis: np.arange(round(size / grid.cell) + 1) * grid.cell for axis, size in zip(names, grid.size, strict=True)}
            nodes = np.stack([a.ravel() for a in np.meshgrid(*self.axes.values(), indexing="ij")], axis=-1)
        self.points = np.concatenate([self.inside, nodes])

    def errors(self, seen: np.ndarray, shift: np.ndarray, count: int) -> dict[str, np.ndarray]:
        """Root-mean-square and largest error at the first `count` output times; the exact solution stands in the grid's coordinates."""
        if self.exact is None:
            return {}
        told = np.flatnonzero(self.told)[:count]
        error = np.array([seen[row, : len(self.weights)] - self.exact(self.inside + shift, self.times[row]) for row in told])
        square = (error**2 @ self.weights) / self.weights.sum()
        return {"error_l2": np.sqrt(square), "error_max": np.abs(error).max(axis=1)}

    def frames(self, seen: np.ndarray, run: Run) -> None:
        """Snapshots on the grid, last direction first, NaN outside the bodies."""
        if not self.axes:
            return
        shown = np.flatnonzero(near(self.times, self.due))
        shown = shown[self.times[shown] <= run.times[-1] * (1 + 1e-12)]
        shape = tuple(len(a) for a in self.axes.values())
        fields = seen[shown, len(self.weights) :].reshape(len(shown), *shape)
        run.axes, run.snapshot_times = self.axes, self.due[: len(shown)]
        run.grid = {"temperature": fields.transpose(0, *range(len(shape), 0, -1)).astype(np.float32)}
