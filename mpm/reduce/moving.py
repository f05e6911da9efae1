"""Fewer directions for bodies that move: a block between slip walls is a column, a round body that falls along its axis is axisymmetric.

Error     none by symmetry where a block fills its domain between two slip walls: the grid is the same along the directions that stay, and so is the step
          a round body is cut differently by the two grids: 0.4/n^2, n cells a radius (a free bar in a prototype: docs/physics.md 11), and 0.3/n^2 a transit of
          the wave through its smallest extent, as phases drift apart (measured 0.08 to 0.21: a bouncing ball, a jelly that swings, n = 4 to 11)
Fails     where something breaks the symmetry that the config does not show: buckling, fracture. The way to the walls is looked at after the run
"""

import math
from typing import Any

import numpy as np

from mpm.reduce.offers import Offer, asked, bare, entries, loaded, only_body
from mpm.scene.scales import Scales

BOTH, DRIFT = 0.4, 0.3  # of a squared cell over the radius: at once, and a transit of the elastic wave
ROOM = 2.0  # cells between a round body and the walls beside it
SCALAR = ("velocity_max", "J_min", "J_max", "pressure_mean", "strain_max", "mass_total", "volume_total", "energy_kinetic", "energy_elastic", "energy_total",
          "dissipation_total", "work_loads")  # fmt: skip
DIRECTED = ("momentum_", "position_mean_", "position_min_", "position_max_", "extent_")
HEAT = ("temperature_", "heat_", "time_to_")


def still(experiment: Any, body: Any, axes: list[int]) -> str:
    """Why a body does not stay as it is along some axes; empty where it does."""
    if any(experiment.gravity is not None and experiment.gravity[axis] for axis in axes) or any(body.velocity and body.velocity[axis] for axis in axes):
        return "it is pushed or thrown that way"
    if body.angular_velocity:
        return "it spins"
    return "a traction acts" if any(entry.traction is not None for entry in experiment.loads) else ""


def unknown(experiment: Any, kept: str) -> str:
    """Names that are asked for and that only the dropped directions have; of motion everything, where nothing is named."""
    want = asked(experiment)
    given = {stem + axis for stem in DIRECTED for axis in kept} | set(SCALAR)
    lost = [name for name in want.names if name not in given and not name.startswith(HEAT)]
    return "everything is asked for" if want.everything else f"{', '.join(lost)} is asked for" if lost else ""


def cut_observables(experiment: Any) -> list[str]:
    """Observables without those of one direction: every run of bodies that move has them under its own names."""
    return [name for name in experiment.output.observables if not name.replace(".", "_").startswith(DIRECTED)]


def renamed(pairs: dict[str, str]) -> dict:
    """Series of the larger model by those of the smaller: axis of the larger -> axis of the smaller."""
    return {stem + to: (lambda series, name=stem + of: series[name]) for to, of in pairs.items() for stem in DIRECTED}


def same_step(data: dict, one: Scales, many: int, few: int) -> None:
    """The step of the larger model, whose limit feels d lam + 2 mu in d directions: so that both models err alike in time."""
    if data["time"]["step"] == "auto":
        data["time"]["safety"] *= min(1.0, math.sqrt((few * one.lam + 2 * one.mu) / (many * one.lam + 2 * one.mu)))


def prism(experiment: Any, sides: dict) -> Offer | str:
    """A block that fills its domain between slip walls along some axes. `sides` are the names of sides by dimension."""
    found, dimension = only_body(experiment), experiment.grid.dimension
    if found is None or dimension == "axisymmetric" or found[1].shape.kind != "box" or found[1].shape.angle:
        return "no single block with its sides along the grid"
    name, body, one = found
    given = entries(experiment, name)
    dropped = [axis for axis in range(dimension) if filled(experiment, body, axis, sides[dimension][axis], given)]
    dropped = [axis for axis in dropped if not still(experiment, body, [axis])][: dimension - 1]
    if not dropped:
        return "it does not fill its domain between slip, insulated walls, or is pushed that way"
    kept = [axis for axis in range(dimension) if axis not in dropped]
    if said := unknown(experiment, "".join("xyz"[axis] for axis in kept)):
        return said
    data = bare(experiment)
    pick = lambda values: [values[axis] for axis in kept]  # noqa: E731
    names = {side: sides[len(kept)][place][end] for place, axis in enumerate(kept) for end, side in enumerate(sides[dimension][axis])}
    data["surfaces"] = [entry | {"side": names[entry["side"]]} for entry in given]
    data["walls"] = {names[side]: wall for side, wall in data["walls"].items() if side in names}
    data["grid"] |= {"dimension": len(kept), "size": pick(experiment.grid.size)}
    data["bodies"][name]["shape"] = {"box": {"lower": pick(body.shape.lower), "upper": pick(body.shape.upper)}}
    data["bodies"][name]["velocity"] = pick(body.velocity) if body.velocity else None
    data["gravity"] = pick(data["gravity"]) if experiment.gravity else None
    data["output"] |= {"probes": {probe: pick(x) for probe, x in experiment.output.probes.items()}, "observables": cut_observables(experiment)}
    if "offset" in data["method"]:
        data["method"]["offset"] = pick(experiment.method.offset)
    same_step(data, one, dimension, len(kept))
    depth = math.prod(experiment.grid.size[axis] for axis in dropped)
    said = f"{' and '.join('xyz'[axis] for axis in dropped)}: it fills its domain there, between slip walls"
    places = renamed({"xyz"[axis]: "xyz"[place] for place, axis in enumerate(kept)})
    lost = frozenset(stem + axis for stem in DIRECTED for axis in "xyz")
    return Offer(f"{len(kept)}-D", said, loaded(data, experiment), 0.0, depth, places, lost)


def filled(experiment: Any, body: Any, axis: int, sides: tuple, given: list[dict]) -> bool:
    """Whether a block touches two slip walls along an axis, and exchanges nothing there."""
    low, high, size = body.shape.lower[axis], body.shape.upper[axis], experiment.grid.size[axis]
    walls = [experiment.walls.get(side) for side in sides]
    return (
        abs(low) <= 1e-9 * size
        and abs(high - size) <= 1e-9 * size
        and all(wall is None or (wall.acts == "slip" and wall.heat is None) for wall in walls)
        and not any(entry["side"] in (*sides, "all", "lateral") for entry in given)
        and not experiment.method.offset[axis]
    )


def revolved(experiment: Any) -> Offer | str:
    """A ball or an upright cylinder that moves along its axis, away from the walls beside it."""
    found = only_body(experiment)
    if found is None or experiment.grid.dimension != 3 or found[1].shape.kind not in ("ball", "cylinder"):
        return "no single round body in three dimensions"
    name, body, one = found
    given = entries(experiment, name)
    allowed = ("all", "lateral", "bottom", "top") if body.shape.kind == "cylinder" else ("all",)
    if said := still(experiment, body, [0, 1]) or unknown(experiment, "z"):
        return said
    hot = [side for side, wall in experiment.walls.items() if wall.heat is not None]
    if any(entry["side"] not in allowed for entry in given) or set(hot) - {"bottom", "top"}:
        return "a part of its round side exchanges by itself"
    data, cell = bare(experiment), experiment.grid.cell
    centre = body.shape.centre if body.shape.kind == "ball" else body.shape.base
    room = min(min(centre[axis], experiment.grid.size[axis] - centre[axis]) for axis in (0, 1))
    rim = math.floor(room / cell + 1e-9) * cell
    if rim < body.shape.radius + ROOM * cell:
        return "the walls beside it are near"
    data["surfaces"] = given
    data["walls"] = {side: wall for side, wall in data["walls"].items() if side in ("bottom", "top")}
    data["grid"] |= {"dimension": "axisymmetric", "size": [rim, experiment.grid.size[2]]}
    shape = {"centre": [0.0, centre[2]], "radius": body.shape.radius}
    if body.shape.kind == "cylinder":
        shape = {"base": [0.0, centre[2]], "radius": body.shape.radius, "height": body.shape.height}
    data["bodies"][name] |= {"shape": {body.shape.kind: shape}, "velocity": [0.0, body.velocity[2]] if body.velocity else None}
    data["gravity"] = [0.0, data["gravity"][2]] if experiment.gravity else None
    probes = {probe: [math.hypot(x[0] - centre[0], x[1] - centre[1]), x[2]] for probe, x in experiment.output.probes.items()}
    data["output"] |= {"probes": probes, "observables": cut_observables(experiment)}
    if "offset" in data["method"]:
        data["method"]["offset"] = [0.0, experiment.method.offset[2]]
    same_step(data, one, 3, 2)
    transits = one.wave * experiment.time.end / min(one.extent)
    error = max(BOTH, DRIFT * transits) * (cell / min(body.shape.radius, max(one.extent) / 2)) ** 2
    lost = frozenset(stem + "r" for stem in DIRECTED)
    return Offer("axisymmetric", "the angle: nothing varies round the axis", loaded(data, experiment), error, 1.0, renamed({"z": "z"}), lost,
                 lambda run: touches(run, rim, cell))  # fmt: skip


def touches(run: Any, rim: float, cell: float) -> str:
    """Whether the body came near the walls beside it, which the smaller model does not have where they are."""
    widest = float(np.max(run.series["position_max_r"]))
    return f"it spreads to {widest:.3g} m, near the walls beside it" if widest > rim - ROOM * cell else ""
