"""Surfaces of a config: which pieces of a moving body exchange heat, with what, and the run-time programmes of temperatures over time."""

from itertools import pairwise

import numpy as np

from mpm.config.rules_scene import hot
from mpm.heat.exchange import FIRMER, PENALTY
from mpm.heat.programmes import Parts, Sine, bounds, during, spell, turns
from mpm.integrate.surroundings import Act, HotWall, Surroundings
from mpm.materials import table, value
from mpm.scene.menus import acting, known
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import cut_quadrature, shape
from mpm.state import Exposure, NoExchange, NoExposure, NoRadiation, Radiation, Surface

COARSE, NOTHING = 4, 1e-9  # cells along each extent in which a side is looked for; of the surface
ON = 0.05  # cells from the face of a body to which another is welded


def table_over_time(model):
    """A table, or one after another where it jumps; a part of one entry is a number."""
    ends = [k + 1 for k, (a, b) in enumerate(zip(model.time, model.time[1:], strict=False)) if a == b]
    parts = [(model.time[a:b], model.value[a:b]) for a, b in pairwise([0, *ends, len(model.time)])]
    made = tuple(table(when, values, model.interpolation) if len(when) > 1 else float(values[0]) for when, values in parts)
    return Parts(tuple(model.time[end] for end in ends), tuple(map(flat, made))) if ends else made[0]


def flat(programme):
    """A table that has one value is a number."""
    low, high = bounds(programme)
    return low if low == high else programme


PROGRAMMES = {"table": table_over_time, "sine": lambda model: Sine(model.mean, model.amplitude, model.period, model.phase)}


def programme(model):
    """The run-time programme of a config's: a number, a table over time or a sine."""
    if isinstance(model, float | int):
        return float(model)
    return known(PROGRAMMES, type(model).kind, "programme")(model)


def rates(entry, role: str):
    """[(rate, outside)] of what a surface entry does in one role (mpm.scene.menus), 0 before `from` and after `until`."""
    return [(spell(programme(part.rate), getattr(entry, "from"), entry.until), part.outside if part.outside is None else programme(part.outside))
            for part in acting(entry, role)]  # fmt: skip


def robin(entry):
    """[(beta, outside)] of a surface entry: convection, or a fixed temperature (beta = inf); a list, empty where it has neither."""
    return rates(entry, "robin")


def most(rate) -> float:
    """The largest size that a rate ever has."""
    return max(abs(bound) for bound in bounds(rate))


def acts_of(entry, pieces) -> list[Act]:
    """What one surface entry does to `pieces`."""
    acts = [Act(pieces, beta=beta, outside=outside) for beta, outside in robin(entry) if most(beta) > 0]
    acts += [Act(pieces, flux=flux) for flux, _ in rates(entry, "flux") if most(flux) > 0]
    return acts + [Act(pieces, emissivity=emissivity, sky=sky) for emissivity, sky in rates(entry, "grey") if most(emissivity) > 0]


def hot_walls(experiment, sides) -> list[HotWall]:
    """Walls and tools that have `heat`; `sides` are the names of walls by number (mpm.scene.build.SIDES)."""
    found, names = [], [name for _, name in hot(experiment)]
    for number, side in enumerate(sides):
        heat = getattr(experiment.walls.get(side), "heat", None)
        if heat is not None:
            acts = spell(1.0, getattr(experiment.walls[side], "from"), experiment.walls[side].until)
            found.append(HotWall(number // 2, number % 2, programme(heat.beta), programme(heat.temperature), acts, number=names.index(side)))
    tools = [(name, tool.heat) for name, tool in experiment.tools.items() if tool.heat is not None]
    return found + [HotWall(-1, -1, programme(heat.beta), programme(heat.temperature), tool=name, number=names.index(name)) for name, heat in tools]


def twice(pieces: list[np.ndarray]) -> bool:
    """Whether a piece is in more than one of them."""
    return len(pieces) > 0 and len(np.unique(np.concatenate(pieces))) < sum(map(len, pieces))


def must_conduct(name: str, conducts: bool, exchanges: bool) -> None:
    """SceneError where the exchange depends on a surface temperature that kappa = 0 leaves behind (config/rules_scene.py tells it of a single point)."""
    if exchanges and not conducts:
        raise SceneError(("surfaces",), f"kappa of {name} is 0, so its surface cannot pass heat inwards: give it a conductivity, or take the exchange away")


def refuse_absent(experiment) -> None:
    """SceneError for what is to act on a side that its body does not have, as the inner one of a full cylinder: it would do nothing, and say nothing."""
    axisymmetric, plane = experiment.grid.dimension == "axisymmetric", experiment.grid.dimension == 2
    for section in ("surfaces", "loads"):
        for index, entry in enumerate(getattr(experiment, section)):
            if entry.side == "all" or (section == "loads" and entry.traction is None):
                continue
            outline = shape(experiment.bodies[entry.of].shape, experiment.grid.dimension)
            lower, upper = outline.bounds()
            lower = np.maximum(lower, [0.0, -np.inf]) if axisymmetric else lower
            rim = cut_quadrature(outline, [np.linspace(*ends, COARSE + 1) for ends in zip(lower, upper, strict=True)], 2)[1]
            area = rim.w * rim.x[:, 0] if axisymmetric else rim.w
            if not area[outline.faces(rim, entry.side, plane)].sum() > NOTHING * area.sum():
                raise SceneError((section, index, "side"), f"no part of the surface of {entry.of} is its side {entry.side!r}: nothing would act there")


def welded_over(experiment, name: str, cut) -> np.ndarray:
    """(S,) pieces that lie on a body to which this one is welded, and see nothing of what surrounds it. What meets is covered as it touches (mpm.contact)."""
    group, pairs = {name}, [set(pair.between) for pair in experiment.contacts if pair.welded is not None]
    for _ in pairs:
        group |= {one for pair in pairs if pair & group for one in pair}
    h, shift, found = experiment.grid.cell, np.array(experiment.method.offset) * experiment.grid.cell, np.zeros(len(cut.point), bool)
    for other in group - {name}:
        found |= np.abs(shape(experiment.bodies[other].shape, experiment.grid.dimension).moved(shift).distance(cut.point)) <= ON * h
    return found


def exchanging_surface(experiment, name: str, cut, zero: float, sides, thermal, meets: bool = False):
    """(Surface, Surroundings, pieces kept) of a body: the pieces that an entry names, all of them where a wall is hot or the body `meets` something.

    NoExchange, None where nothing acts and nothing is met.
    """
    faces = (cut.area == 0.0) | (cut.area > 1e-6 * cut.area.max(initial=0.0))  # corners, by which bodies meet, are no face; shut seams are
    faces &= ~welded_over(experiment, name, cut)
    outline, plane = shape(experiment.bodies[name].shape, experiment.grid.dimension), experiment.grid.dimension == 2
    entries = [entry for entry in experiment.surfaces if entry.of == name]
    acts = [act for entry in entries for act in acts_of(entry, np.flatnonzero(outline.faces(cut, entry.side, plane) & faces))]
    acts = [act for act in acts if len(act.pieces)]
    walls = [wall for wall in hot_walls(experiment, sides) if acts or most(wall.beta) > 0]
    if not acts and not walls:
        kept = np.arange(len(cut.owner)) if meets else np.zeros(0, np.int64)
        return pieces_of(cut, kept, thermal.theta.dtype, NoRadiation()) if meets else NoExchange(), None, kept
    kept = np.arange(len(cut.owner)) if walls or meets else np.unique(np.concatenate([act.pieces for act in acts]))
    acts = [Act(np.searchsorted(kept, act.pieces), act.beta, act.outside, act.flux, act.emissivity, act.sky) for act in acts]
    radiating = [act for act in acts if most(act.emissivity) > 0]
    times = sorted({0.0, *(when for act in radiating for when in turns(act.emissivity))})
    if any(twice([act.pieces for act in radiating if most(during(act.emissivity, when)) > 0]) for when in times):
        raise SceneError(("surfaces",), f"two surface entries of {name} radiate from the same place: merge them into one")
    around = [act.outside for act in acts if most(act.beta) > 0] + [wall.temperature for wall in walls]
    seen = [experiment.bodies[name].temperature, *(t for one in around for t in bounds(one))]
    firm = PENALTY * (FIRMER if experiment.method.frame == "total" else 1.0)
    penalty = firm * max(value(thermal.kappa, t) for t in seen) / experiment.grid.cell
    must_conduct(name, penalty > 0, any(most(act.beta) > 0 for act in (*acts, *walls)) or bool(radiating))
    radiation = Radiation(np.zeros(len(kept)), np.ones(len(kept)), np.zeros(len(kept))) if radiating else NoRadiation()
    exposure = Exposure(*np.zeros((3, len(kept)))) if walls else NoExposure()
    return pieces_of(cut, kept, thermal.theta.dtype, radiation)._replace(exposure=exposure), Surroundings(acts, walls, zero, penalty), kept


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
