"""Rules for the output: probes lie in a body, observables and fields exist and have their physics, exact solutions their body."""

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import Any

from mpm.config.explain import Finding
from mpm.config.partial import MISSING, Unknown
from mpm.config.problems import near
from mpm.config.rules_scene import heats, hot, moves, plain_names, vector
from mpm.config.shapes_fit import bounds, home, misfits

MOST_SAMPLES, MOST_NAMED = 10**6, 4
OF_MATTER = ("mass.total", "volume.total")  # known of bodies that do not move too
OF_MOTION = ("momentum", "energy", "dissipation", "position", "extent", "velocity", "J", "radius", "area", "pressure", "strain", "stress", "kirchhoff",
             "displacement", "mass", "volume", "work", "force", "torque")  # fmt: skip


def clock(experiment: Any) -> Iterator[Finding]:
    """Series and snapshots have at most MOST_SAMPLES times."""
    every, end = experiment.output.every, experiment.time.end
    if every is not None and end / every > MOST_SAMPLES:
        yield Finding(("output", "every"), f"the series would have {end / every:.3g} samples", f"at least {end / MOST_SAMPLES:g} [s]", given=every)
    shots = experiment.output.snapshots
    if shots is not None and end / shots.every > MOST_SAMPLES:
        yield Finding(
            ("output", "snapshots", "every"), f"there would be {end / shots.every:.3g} snapshots", f"at least {end / MOST_SAMPLES:g} [s]", given=shots.every
        )


def probe(experiment: Any, name: str, point: Any) -> Iterator[Finding]:
    """A probe has a name of its own, lies in the domain, and has something to tell."""
    path = ("output", "probes", name)
    yield from plain_names(experiment, "output.probes", [name])
    yield from taken(name)
    wrong = list(vector(experiment, path, point, "a probe"))
    yield from wrong
    for index, (x, length) in enumerate(zip(point, experiment.grid.size, strict=False) if not wrong else ()):
        if not 0 <= x <= length:
            yield Finding((*path, index), "the probe lies outside the domain", f"0 to {length:g} [m]", given=x)
    if not wrong and experiment.grid.dimension != 0 and not known(heats, experiment) and not asked_of(experiment, name):
        allowed = f"a heat section in the material of a body, or observables: [displacement.{name}_x]"
        yield Finding(path, "no body has heat, and a probe tells a temperature unless an observable asks it for more", allowed, on_key=True)


def asked_of(experiment: Any, name: str) -> bool:
    """Whether an observable asks a probe for displacement or stress."""
    from mpm.records.variables import probed

    return any(found is not None and found[1] == name for found in map(probed, experiment.output.observables))


def probe_home(experiment: Any, name: str, point: Any) -> Iterator[Finding]:
    """A probe is a point of a body."""
    bodies, grid = experiment.bodies, experiment.grid
    fit = not any(body.shape.kind and list(misfits(body.shape, grid.dimension, grid.directions)) for body in bodies.values())
    inside = len(grid.size) == len(point) == grid.directions and all(0 <= x <= length for x, length in zip(point, grid.size, strict=True))
    if fit and inside and home(bodies, point, grid.size) is None:
        near_by = " or ".join(f"{body} ({spans(item.shape, grid.dimension)})" for body, item in list(bodies.items())[:MOST_NAMED])
        yield Finding(("output", "probes", name), "the probe lies in no body, so nothing has a temperature there", f"a point of {near_by}", given=list(point))


def spans(shape: Any, dimension: Any) -> str:
    """The box round a shape, in words."""
    return " x ".join(f"{low:.6g} to {high:.6g}" for low, high in zip(*bounds(shape, dimension), strict=True)) + " m"


def taken(name: str) -> Iterator[Finding]:
    """A probe whose series would be called as an observable is."""
    from mpm.records.variables import VARIABLES, of_probe

    for variable in of_probe(name):
        if variable in VARIABLES:
            said = f"the probe's {variable} is the name of an observable ({VARIABLES[variable].long_name})"
            yield Finding(("output", "probes", name), said, f"another name, as probe_{name}", on_key=True)


def apart(experiment: Any) -> Iterator[Finding]:
    """Every series has a name of its own in the dataset, where dots become underscores: of probes, of what walls, tools and bodies do, and observables."""
    from mpm.records.variables import VARIABLES, dataset_name, of_probe

    seen = {variable: f"the probe {probe}" for probe in experiment.output.probes for variable in of_probe(probe) if variable not in VARIABLES}
    met = {*(f"{one}_{two}" for one, two in combinations(experiment.bodies, 2)), *(name for _, name in hot(experiment))}
    for one, two in combinations(experiment.bodies, 2):
        name, told = f"heat_{one}_{two}", f"the heat between {one} and {two}"
        if (other := seen.setdefault(name, told)) != told:
            yield Finding(("bodies", two), f"{other} and {told} would both be {name} in the dataset", "a body of another name", on_key=True)
    for section, one in hot(experiment):
        name, told = f"heat_{one}", f"the heat from {one}"
        if (other := seen.setdefault(name, told)) != told:
            yield Finding((section, one), f"{other} and {told} would both be {name} in the dataset", "a probe, tool or body of another name", on_key=True)
    for index, name in enumerate(experiment.output.observables):
        other = seen.setdefault(dataset_name(name), name)
        if other != name and name.removeprefix("heat.") not in met:
            said = f"{other} and {name} would both be {dataset_name(name)} in the dataset"
            yield Finding(("output", "observables", index), said, "a probe, tool or body of another name", given=name)


def overview(experiment: Any) -> Iterator[Finding]:
    """What the overview shows is recorded."""
    known = list(experiment.output.observables)
    for index, name in enumerate(experiment.output.overview):
        if name not in known:
            path, allowed = ("output", "overview", index), known or "an observable that is listed"
            yield Finding(path, "it is not among output.observables", allowed, near(name, known), given=name)


def probes(experiment: Any) -> Iterator[tuple]:
    """Each probe with its name."""
    yield from list(experiment.output.probes.items())


def observables(experiment: Any) -> Iterator[tuple]:
    """Number and name of each observable, and whether bodies have heat and move."""
    physics = (known(heats, experiment), known(moves, experiment))
    yield from ((index, name, *physics) for index, name in enumerate(experiment.output.observables))


def known(question: Callable[[Any], bool], experiment: Any) -> bool:
    """The answer, and yes where it is not known."""
    try:
        return question(experiment)
    except Unknown:
        return True


def observable(experiment: Any, index: int, name: str, warm: bool, moving: bool, path: tuple = ()) -> Iterator[Finding]:
    """There is such an observable, and the scene has what it needs: the dimension, heat or motion, the probe, the body."""
    from mpm.records.variables import OBSERVABLES, fits, met, observable_exists, parts, probed, single, threshold

    path = path or ("output", "observables", index)
    if not observable_exists(name):
        dimension = experiment.grid.dimension
        allowed = [word for word in OBSERVABLES if dimension is MISSING or fits(word, dimension)] + [
            "<observable>.<body>",
            "time_to.<probe>.<value>_degC",
            "time_to.<probe>.<value>_K",
            "displacement.<probe>_<direction>",
            "stress.<probe>_<component>",
            "force.<wall, tool or pair>_<direction>",
            "torque.<wall, tool or pair>_<direction>",
            "area.<wall, tool or pair>",
            "heat.<hot wall or tool, or pair>",
            "travel.<tool>_<direction>",
            "hardness.<tool>, cohesiveness.<tool>, springiness.<tool>",
        ]
        yield Finding(path, "unknown observable", allowed, near(name, OBSERVABLES), given=name)
        return
    found, one = threshold(name, experiment.output.probes), single(name)
    if found is not None:
        known = experiment.output.probes
        if found.probe not in known:
            yield Finding(path, f"there is no probe {found.probe!r}", list(known) or "a probe under output.probes", near(found.probe, known), given=name)
    elif (asked := probed(name)) is not None and asked[1] not in experiment.output.probes:
        known_ones = list(experiment.output.probes)
        yield Finding(path, f"there is no probe {asked[1]!r}", known_ones or "a probe under output.probes", near(asked[1], known_ones), given=name)
    elif asked is not None and not fits(name, experiment.grid.dimension):
        allowed = [f"{asked[0]}.{asked[1]}_{part}" for part in parts(asked[0], experiment.grid.dimension)]
        yield Finding(path, f"there is no such component in dimension {experiment.grid.dimension}", allowed, given=name)
    elif one is not None and one[1] not in experiment.bodies:
        known_ones = list(experiment.bodies)
        yield Finding(path, f"there is no body {one[1]!r}", known_ones, near(one[1], known_ones), given=name)
    elif name.endswith(".inflow") and not any(body.inflow is not None for body in experiment.bodies.values()):
        yield Finding(path, "no body flows in", "an inflow of a body", given=name)
    elif one is not None and experiment.grid.dimension == 0:
        yield Finding(path, "a material point is the only body", name.rpartition(".")[0], given=name)
    elif one is not None and one[0].startswith(("temperature", "heat")) and experiment.materials[experiment.bodies[one[1]].material].heat is None:
        yield Finding(path, f"{one[1]} has no heat", f"a heat section in materials.{experiment.bodies[one[1]].material}", given=name)
    elif not fits(name, experiment.grid.dimension):
        touched = met(name)
        words = [f"{touched[0]}.{touched[1]}_{axis}" for axis in "xyzr"] if touched else OBSERVABLES
        fitting = [word for word in words if fits(word, experiment.grid.dimension)]
        yield Finding(path, f"there is no such direction in dimension {experiment.grid.dimension}", fitting or "another observable", given=name)
    family = name.split(".", maxsplit=1)[0]
    if family in ("temperature", "heat", "time_to", "area") and not warm and not (family == "area" and met(name)):
        yield Finding(path, "no body has heat", "a heat section in the material of a body", given=name)
    if family in OF_MOTION and not moving and ((name.rpartition(".")[0] if one else name) not in OF_MATTER or experiment.grid.dimension == 0):
        yield Finding(path, "no body is elastic, so nothing moves", "an elastic section in the material of a body", given=name)


def snapshots(experiment: Any) -> Iterator[Finding]:
    """There are such fields, and the scene has them."""
    from mpm.records.variables import FIELDS_GRID, FIELDS_PARTICLES

    shots, still = experiment.output.snapshots, not known(moves, experiment)
    for key, allowed in (("grid", FIELDS_GRID), ("particles", FIELDS_PARTICLES)) if shots is not None else ():
        for index, name in enumerate(getattr(shots, key)):
            path = ("output", "snapshots", key, index)
            if name not in allowed:
                yield Finding(path, "unknown field", list(allowed), near(name, allowed), given=name)
            elif still and (key, name) != ("grid", "temperature"):
                what = "has no particles" if key == "particles" else "has a temperature alone"
                yield Finding(path, f"a body without `elastic` does not move, and {what}", "grid: [temperature]", given=name)
            elif name == "velocity_gradient" and experiment.method.transfer.kind not in ("apic", "affine_flip"):
                yield Finding(path, "particles carry no gradient of velocity with this transfer", "method.transfer: apic or affine_flip", given=name)


def exact(experiment: Any) -> Iterator[Finding]:
    """Which body the exact solution is of."""
    solution = experiment.exact
    if solution is None:
        return
    known = list(experiment.bodies)
    path = ("exact", solution.kind, "body")
    if solution.body is None and len(known) > 1:
        yield Finding(path, "there are several bodies; say which one", known)
    elif solution.body is not None and solution.body not in known:
        yield Finding(path, "there is no such body", known, near(solution.body, known), given=solution.body)
