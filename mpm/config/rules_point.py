"""Rules for grid.dimension 0, the material point: no shape and no grid, one body, and a loading whose stages fill the run."""

from collections.abc import Iterator
from typing import Any, get_args

from mpm.config.boundary import EXCHANGES
from mpm.config.explain import Finding
from mpm.config.quantities import Length, PerLength
from mpm.config.rules_scene import heats, moves

EXCHANGED = {"convection": "outside", "fixed": "temperature"}  # what a material point has, and the field of the temperature that it meets


def lacks(path: tuple, wanted: Any) -> Finding:
    """A key that is needed here and not there."""
    return Finding(path, f"{path[-1]!r} is missing", wanted, on_key=True, missing=True)


def grid(experiment: Any) -> Iterator[Finding]:
    """A material point has no grid; every other scene has one."""
    size, cell = experiment.grid.size, experiment.grid.cell
    if experiment.grid.dimension != 0:
        if not size:
            yield lacks(("grid", "size"), "extent of the domain, one length a direction")
        if cell is None:
            yield lacks(("grid", "cell"), get_args(Length)[1].wanted)
        return
    for key, value in (("size", size), ("cell", cell)):
        if value:
            yield Finding(("grid", key), "a material point has no grid", "dimension: 0 alone", on_key=True)


def body(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """Exchange needs a surface, strain needs elasticity."""
    if item.shape.kind != "point":
        return
    at = ("bodies", name, "shape", "point")
    if item.shape.surface_to_volume is None and any(surface.of == name for surface in experiment.surfaces):
        yield lacks((*at, "surface_to_volume"), get_args(PerLength)[1].wanted)
    if item.shape.strain != type(item.shape.strain)() and experiment.materials[item.material].elastic is None:
        yield Finding((*at, "strain"), "a rigid body has no strain", f"an elastic section in materials.{item.material}", on_key=True)


def loading(experiment: Any) -> Iterator[Finding]:
    """Only a material point is loaded, and its physics must answer what is prescribed."""
    stages = experiment.loading
    if experiment.grid.dimension != 0:
        if stages:
            yield Finding(("loading",), "loading is for a material point", "grid: {dimension: 0}", on_key=True)
        return
    if not stages and moves(experiment):
        yield lacks(("loading",), "[{until: time, strain_rate: {zz: ...}, stress: {xx: 0, yy: 0}}, ...]")
    elif not stages and not experiment.surfaces and not experiment.sources:
        yield Finding(("bodies",), "nothing happens to the material point", ["surfaces", "sources", "loading"], on_key=True)
    for index, stage in enumerate(stages):
        for key in ("strain_rate", "stretch_rate", "stress"):
            if getattr(stage, key) != type(getattr(stage, key))() and not moves(experiment):
                yield Finding(("loading", index, key), "the body is rigid", "an elastic section in its material", on_key=True)
        if stage.temperature is not None and not heats(experiment):
            yield Finding(("loading", index, "temperature"), "the body has no heat", "a heat section in its material", on_key=True)


def exchange(experiment: Any, index: int, item: Any) -> Iterator[Finding]:
    """A material point meets what is constant, by a coefficient."""
    if experiment.grid.dimension != 0:
        return
    for kind in EXCHANGES:
        if getattr(item, kind) is not None and kind not in EXCHANGED:
            said = f"a material point has no {kind}; its temperature may be prescribed in `loading`"
            yield Finding(("surfaces", index, kind), said, list(EXCHANGED), on_key=True)
        elif getattr(item, kind) is not None:
            said = "what a material point meets is constant; a temperature over time may be prescribed in `loading`"
            for key in type(getattr(item, kind)).model_fields:
                if not isinstance(given := getattr(getattr(item, kind), key), float):
                    yield Finding(("surfaces", index, kind, key), said, "a number", given=type(given).kind)
    for key in ("from", "until"):
        if getattr(item, key):
            yield Finding(("surfaces", index, key), "what a material point meets acts from the start to the end", "no from and no until", on_key=True)


def alone(experiment: Any) -> Iterator[Finding]:
    """A material point has no neighbours."""
    if experiment.grid.dimension == 0 and len(experiment.bodies) > 1:
        yield Finding(("bodies",), f"a material point is one body, found {len(experiment.bodies)}", "one body", on_key=True)


def stages(experiment: Any) -> Iterator[Finding]:
    """The ends of the stages rise, and the last one reaches the end of the run."""
    before, last, end = 0.0, len(experiment.loading) - 1, experiment.time.end
    for index, stage in enumerate(experiment.loading):
        if stage.until is None:
            if index < last:
                yield lacks(("loading", index, "until"), "the time at which the stage ends; only the last stage may leave it out")
            continue
        if stage.until <= before:
            yield Finding(("loading", index, "until"), "the ends of the stages must rise", f"above {before:g} [s]", given=stage.until)
        before = max(before, stage.until)
        if index == last and stage.until < end * (1 - 1e-9):
            yield Finding(("loading", index, "until"), f"the last stage ends before time.end = {end:g} s", "time.end or later, or no until", given=stage.until)


def clock(experiment: Any) -> Iterator[Finding]:
    """Nothing to scale without inertia."""
    if experiment.grid.dimension == 0 and experiment.time.scale != 1:
        yield Finding(("time", "scale"), "a material point has no inertia, so no time to scale", "1", given=experiment.time.scale)


def heating(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """The grid form of elastic heating needs a grid."""
    if experiment.grid.dimension == 0 and item.heating is not None and item.heating.elastic is not None and item.heating.elastic.form == "grid":
        yield Finding(("materials", name, "heating", "elastic", "form"), "a material point has no grid", ["adiabat"], given="grid")


def output(experiment: Any) -> Iterator[Finding]:
    """One point has no fields."""
    if experiment.grid.dimension == 0 and experiment.output.snapshots is not None:
        yield Finding(("output", "snapshots"), "a material point has no fields", "observables, which are written as series", on_key=True)
