"""Surfaces of a config: which pieces of a moving body exchange heat, with what, and the run-time programmes of temperatures over time."""

import numpy as np

from mpm.heat.exchange import PENALTY
from mpm.heat.programmes import Sine, bounds
from mpm.integrate.surroundings import Act, HotWall, Surroundings
from mpm.materials import table, value
from mpm.scene.menus import acting, known
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import on_side
from mpm.state import NoExchange, NoRadiation, Radiation, Surface

PROGRAMMES = {
    "table": lambda model: table(model.time, model.value, model.interpolation),
    "sine": lambda model: Sine(model.mean, model.amplitude, model.period, model.phase),
}


def programme(model):
    """The run-time programme of a config's: a number, a table over time or a sine."""
    if isinstance(model, float | int):
        return float(model)
    return known(PROGRAMMES, type(model).kind, "programme")(model)


def robin(entry):
    """[(beta, outside)] of a surface entry: convection, or a fixed temperature (beta = inf); a list, empty where it has neither."""
    return [(part.rate, programme(part.outside)) for part in acting(entry, "robin")]


def acts_of(entry, pieces) -> list[Act]:
    """What one surface entry does to `pieces`."""
    acts = [Act(pieces, beta=beta, outside=outside) for beta, outside in robin(entry) if beta > 0]
    acts += [Act(pieces, flux=part.rate) for part in acting(entry, "flux") if part.rate != 0]
    return acts + [Act(pieces, emissivity=part.rate, sky=programme(part.outside)) for part in acting(entry, "grey") if part.rate > 0]


def hot_walls(experiment, sides) -> list[HotWall]:
    """Walls and tools that have `heat`; `sides` are the names of walls by number (mpm.scene.build.SIDES)."""
    found = []
    for number, side in enumerate(sides):
        heat = getattr(experiment.walls.get(side), "heat", None)
        if heat is not None and heat.beta > 0:
            found.append(HotWall(number // 2, number % 2, heat.beta, programme(heat.temperature)))
    hot = [(name, tool.heat) for name, tool in experiment.tools.items() if tool.heat is not None and tool.heat.beta > 0]
    return found + [HotWall(-1, -1, heat.beta, programme(heat.temperature), tool=name) for name, heat in hot]


def must_conduct(name: str, conducts: bool, exchanges: bool) -> None:
    """SceneError where the exchange depends on a surface temperature that kappa = 0 leaves behind (config/rules_scene.py tells it of a single point)."""
    if exchanges and not conducts:
        raise SceneError(("surfaces",), f"kappa of {name} is 0, so its surface cannot pass heat inwards: give it a conductivity, or take the exchange away")


def exchanging_surface(experiment, name: str, cut, zero: float, sides, thermal, meets: bool = False):
    """(Surface, Surroundings, pieces kept) of a body: the pieces that an entry names, all of them where a wall is hot or the body `meets` something.

    NoExchange, None where nothing acts and nothing is met.
    """
    faces = (cut.area == 0.0) | (cut.area > 1e-6 * cut.area.max(initial=0.0))  # corners, by which bodies meet, are no face; shut seams are
    acts = [act for entry in experiment.surfaces if entry.of == name for act in acts_of(entry, np.flatnonzero(on_side(cut.normal, entry.side) & faces))]
    acts = [act for act in acts if len(act.pieces)]
    walls = hot_walls(experiment, sides)
    if not acts and not walls:
        kept = np.arange(len(cut.owner)) if meets else np.zeros(0, np.int64)
        return pieces_of(cut, kept, thermal.theta.dtype, NoRadiation()) if meets else NoExchange(), None, kept
    kept = np.arange(len(cut.owner)) if walls or meets else np.unique(np.concatenate([act.pieces for act in acts]))
    acts = [Act(np.searchsorted(kept, act.pieces), act.beta, act.outside, act.flux, act.emissivity, act.sky) for act in acts]
    radiating = [act for act in acts if act.emissivity > 0]
    if len(np.unique(np.concatenate([act.pieces for act in radiating] or [kept[:0]]))) < sum(len(act.pieces) for act in radiating):
        raise SceneError(("surfaces",), f"two surface entries of {name} radiate from the same place: merge them into one")
    around = [act.outside for act in acts if act.beta > 0] + [wall.temperature for wall in walls]
    seen = [experiment.bodies[name].temperature, *(t for one in around for t in bounds(one))]
    most = PENALTY * max(value(thermal.kappa, t) for t in seen) / experiment.grid.cell
    must_conduct(name, most > 0, any(act.beta > 0 for act in (*acts, *walls)) or bool(radiating))
    radiation = Radiation(np.zeros(len(kept)), np.ones(len(kept)), np.zeros(len(kept))) if radiating else NoRadiation()
    return pieces_of(cut, kept, thermal.theta.dtype, radiation), Surroundings(acts, walls, zero, most), kept


def pieces_of(cut, kept: np.ndarray, dtype, radiation) -> Surface:
    """The Surface of the pieces `kept`, that exchange nothing yet."""
    S, D = len(kept), cut.centroid.shape[1]
    owner = cut.owner[kept]
    owners = np.unique(owner)
    row = np.full(len(cut.volume), -1, np.int32)
    row[owners] = np.arange(len(owners))
    F = np.tile(np.eye(D, dtype=dtype), (len(owners), 1, 1))
    return Surface(
        F, row, owner, cut.area[kept, None] * cut.normal[kept], cut.point[kept] - cut.centroid[owner],
        np.zeros(S), np.zeros(S), np.zeros(S), np.zeros(S), radiation,
    )  # fmt: skip
