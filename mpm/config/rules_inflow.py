"""Rules of `inflow`: a straight nozzle along one direction, methods that know bodies which grow."""

from collections.abc import Iterator
from typing import Any

from mpm.config.bodies import Box, Cylinder
from mpm.config.explain import Finding
from mpm.config.programmes import Sine, TimeTable
from mpm.config.rules_frame import known
from mpm.config.rules_scene import heats, vector
from mpm.config.shapes_fit import bounds, misfits

CELLS = 2.0  # least length of a nozzle: what has left it sees none of what is farther behind


def ends(one: Any) -> tuple[float, float]:
    """Lowest and highest value of a programme."""
    if isinstance(one, TimeTable):
        return min(one.value), max(one.value)
    return (one.mean - one.amplitude, one.mean + one.amplitude) if isinstance(one, Sine) else (one, one)


def ways(experiment: Any, item: Any) -> list[tuple[int, float]]:
    """(direction, sign) in which an inflow goes; of one that is right there is one."""
    flow = item.inflow
    entries = flow.velocity if flow.velocity is not None else experiment.gravity or ()
    return [(axis, sign) for axis, one in enumerate(entries) for sign, most in zip((-1.0, 1.0), ends(one), strict=True) if sign * most > 0]


def inflow(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """A direction, a mouth across it, and a length behind it."""
    flow, grid = item.inflow, experiment.grid
    if flow is None or (flow.velocity is None) == (flow.rate is None):  # the latter is told by the model
        return
    at, dimension = ("bodies", name, "inflow"), grid.dimension
    if dimension == 0 or experiment.materials[item.material].elastic is None:
        said = "a material point has no extent" if dimension == 0 else f"{item.material!r} has no elastic law, so the body cannot move"
        yield Finding(at, f"{said}, and nothing can flow in", f"an elastic section in materials.{item.material}, in grid.dimension 1 or more", on_key=True)
        return
    for key in ("velocity", "angular_velocity"):
        if getattr(item, key) is not None:
            yield Finding(("bodies", name, key), "what flows in has the velocity of its inflow", "no velocity of the body", on_key=True)
    if flow.temperature is not None and not known(heats, experiment):
        yield Finding((*at, "temperature"), "no body has heat, so nothing has a temperature", "a heat section in its material", on_key=True)
    if flow.rate is not None and dimension not in ("axisymmetric", 3):
        said = f"a volume by time is known where the mouth is whole, and there is none in dimension {dimension}"
        yield Finding((*at, "rate"), said, "velocity", on_key=True)
        return
    wrong = list(vector(experiment, (*at, "velocity"), flow.velocity, "the velocity"))
    yield from wrong
    if wrong:
        return
    key = "velocity" if flow.velocity is not None else "rate"
    found = ways(experiment, item)
    if len(found) != 1:
        said = "a nozzle is straight along one direction, and its flow never turns round: " if flow.velocity is not None else "a rate flows along gravity: "
        said += f"it would flow {len(found)} ways" if found else "it does not flow"
        yield Finding((*at, key), said, "one entry that is not zero, of one sign" if flow.velocity is not None else "gravity along one direction, or velocity")
        return
    yield from mouth(experiment, name, item, found[0][0])


def mouth(experiment: Any, name: str, item: Any, axis: int) -> Iterator[Finding]:
    """The nozzle is the same all along the flow."""
    grid, shape, at = experiment.grid, item.shape, ("bodies", name, "shape")
    upright = isinstance(shape, Cylinder) or grid.dimension == "axisymmetric"
    if not isinstance(shape, Box | Cylinder) or (isinstance(shape, Box) and shape.angle):
        yield Finding((*at, shape.kind), "a nozzle is the same all along the flow", ["box, not turned", "cylinder"], on_key=True)
        return
    if upright and axis != grid.directions - 1:
        yield Finding((*at, shape.kind), "what flows through it goes along its axis", "velocity along the last direction, or a box")
        return
    if list(misfits(shape, grid.dimension, grid.directions)) or grid.cell is None:
        return
    low, high = bounds(shape, grid.dimension)
    if (length := high[axis] - low[axis]) < CELLS * grid.cell * (1 - 1e-9):
        said = f"the nozzle is {length:g} m long, {length / grid.cell:.2g} of a cell: what leaves it would feel its end"
        yield Finding((*at, shape.kind), said, f"at least {CELLS:g} cells, {CELLS * grid.cell:g} m, along the flow")


def methods(experiment: Any) -> Iterator[Finding]:
    """What knows no body that grows."""
    flowing = [name for name, body in experiment.bodies.items() if known(lambda body=body: body.inflow is not None)]
    if not flowing:
        return
    for section in ("loads", "sources"):
        for index, entry in enumerate(getattr(experiment, section)):
            if known(lambda entry=entry: entry.of in flowing):
                yield Finding((section, index, "of"), f"{section} of what flows in are not known yet", "another body", given=entry.of)
    said, method = f"{flowing[0]} flows in, which {{}} does not know", experiment.method
    if known(lambda: experiment.time.scale > 1):
        yield Finding(("time", "scale"), said.format("time scaling"), "no scale", on_key=True)
    if experiment.exact is not None:
        yield Finding(("exact",), said.format("an exact solution"), "no exact", on_key=True)
    if known(lambda: method.locking is not None):
        yield Finding(("method", "locking"), said.format("F-bar"), "no locking", on_key=True)
    if known(lambda: method.transfer.kind == "xpic"):
        yield Finding(("method", "transfer"), said.format("xpic"), ["apic", "flip", "affine_flip", "pic"], on_key=True)
    if known(lambda: method.fracture == "surface"):
        yield Finding(("method", "fracture"), said.format("opening of faces"), ["warn", "fail"], on_key=True)
    if known(lambda: method.frame == "total"):
        yield Finding(("method", "frame"), said.format("the total frame"), "updated", on_key=True)
    for name in sorted({experiment.bodies[one].material for one in flowing}):
        heating = experiment.materials[name].heating
        if heating is not None and known(lambda heating=heating: heating.elastic is not None and heating.elastic.form == "grid"):
            yield Finding(("materials", name, "heating", "elastic", "form"), said.format("heating on the grid"), "adiabat", on_key=True)
