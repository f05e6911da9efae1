"""Review: what of a run's records a careful user wants to know, as warnings (mpm.warned). What only a running scene can see is warned of by mpm.guards.

volume    at the end the volume of a body is off its start by more than VOLUME beyond what expansion explains; not where loads or moving tools press
heat      heat content and heat taken in disagree by more than HEAT of the larger, or of what the spread of temperatures holds; or PIC, or
          FLIP's share of it, conducts by itself more than HEAT of what the material does: R0 alpha h^2/(4 dt) (docs/physics.md 3)
depth     heat that a surface exchanges, or a body that is touched, reaches less than DEPTH cells deep, where the body resists (beta depth/kappa over RESISTS):
          two half spaces that meet are 1.9 % of their difference too even at 0.7 cells, a quarter of a cell from the face. Against a half space
          bodies that move take in at most 10 % (h/depth)^2 too much (1-D, 0.12 to 4 cells, beta h/kappa from 0.3 to inf: 0.2 % at 4 cells, 2.5 % at 2, 9.8 %
          at 1, 285 % at 0.12); those that do not 2 % too little at 0.25 and three times too much at 0.12. With kappa towards 0 both take in what a layer
          of a cell does, and that layer takes a given flux
energy    energy of motion that no law accounts for is more than ENERGY of what it holds, dissipates or takes from loads. It shows in the answer: slump.yaml
          loses 15 % at one of its points with `transfer: apic`, 10 % with affine FLIP, and spreads 0.109 and 0.123 mm
thin      a body, or all material, is less than THIN cells across
probe     a probe has no value
step      steps are shorter than `time.step` says by more than SHORTER, cut to end at output times or at heat steps
edge      material comes within a cell of a side of the domain that `walls` does not name: a wall without friction stands there
near      bodies that do not move lie less than a cell apart, and do not touch
late      what acts `from` a time on begins with the end of the run or after it; or all of a measured curve lies behind the end
ring      between two explicit heat steps sound passes through a body that expands and flows, and what one step adds is more than RINGS of its yield stress: it
          rings after each, and flows too far. The loaf is 1.6 % too low with 4.2 passages a step, 0.4 % with 0.4 (docs/accuracy.md)
bend      an elastic body SLENDER times as long as it is thick, held at a wall, moves across its length by more than BENDS cells in the updated frame, where
          quadrature errors change as particles pass cells: docs/frames.md has what a cantilever is off by
Cost      a few microseconds a point: series are looked at once, at the end.
"""

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np

from mpm.guards import ROUNDED
from mpm.materials import value
from mpm.outcome import Run
from mpm.records.variables import describe, turn
from mpm.rigid.touching import TOUCH
from mpm.scene.bearing import lying
from mpm.scene.exchange import most, programme
from mpm.scene.inventory import beginnings
from mpm.scene.law import elastic_law, law, stress_temperature_modulus
from mpm.scene.rigid import matter
from mpm.scene.scales import exchanging, scales
from mpm.scene.shapes import cut_quadrature, shape
from mpm.warned import warning

VOLUME, HEAT, ENERGY, THIN, SHORTER = 0.1, 0.01, 0.1, 2.0, 0.01
DEPTH = {True: 1.0, False: 0.25}  # cells, of bodies that move and of those that do not
RINGS = 0.05  # of the yield stress
SLENDER, BENDS = 3.0, 1.0
RESISTS = 0.3  # beta depth/kappa from which the body resists, and not only the air
SIDES = {"x": ("left", "right"), "r": ("axis", "outer"), "y": ("bottom", "top"), "z": ("bottom", "top")}  # of the domain, low and high


def review(experiment: Any, run: Run) -> list[str]:
    """The warnings that the records of a run of one point give rise to."""
    if not len(run.times):
        return []
    return [warning(kind, said) for kind, look in LOOKS.items() for said in look(experiment, run)]


def explained(experiment: Any, run: Run, name: str) -> tuple[float, float]:
    """Smallest and largest volume ratio that expansion gives a body at the temperatures of the run."""
    material, found = experiment.materials[experiment.bodies[name].material], [0.0]
    if material.expansion is None:
        return 1.0, 1.0
    law = elastic_law(material.elastic)
    law = getattr(law, "one", law)  # moduli that follow temperature: gamma follows them
    slope = stress_temperature_modulus(material.expansion, law) / (law.lam + 2 * law.mu / 3)
    for series in ("temperature_min", "temperature_max"):
        reached = np.minimum(run.series[series], getattr(material.expansion, "set", np.inf))
        found += (slope * (reached - material.expansion.reference)).tolist()
    return float(np.exp(min(found))), float(np.exp(max(found)))


def extents(experiment: Any, run: Run) -> dict[str, np.ndarray]:
    """Extent over time along each direction; none where nothing moves."""
    return {name.removeprefix("extent_"): values for name, values in run.series.items() if name.startswith("extent_")} if experiment.moving else {}


def volume(experiment: Any, run: Run) -> Iterator[str]:
    moving = any(getattr(tool.motion, key) is not None for tool in experiment.tools.values() for key in ("velocity", "path", "force"))
    pressed = moving or any(load.traction is not None for load in experiment.loads)
    for name, ratio in run.facts.get("volume_ratios", {}).items():
        least, most = explained(experiment, run, name)
        for share, word in ((0.0 if pressed else 1 - ratio / least, "lost"), (ratio / most - 1, "gained")):
            if share > VOLUME:
                yield f"{100 * share:.0f} % of the volume of {name} is {word} by the end, beyond what expansion explains"


def joules(experiment: Any) -> str:
    """The unit of a total of energy."""
    return describe("energy_total", experiment.grid.dimension).units


def within(experiment: Any, run: Run) -> float:
    """The heat that evens out between warm and cold at the start, or a billionth of all [J]: the scale where none is exchanged and the ledger is round-off."""
    least, most = float(run.series["temperature_min"][0]), float(run.series["temperature_max"][0])
    alphas = [value(law(material.heat.alpha), least) for material in experiment.materials.values() if material.heat is not None]
    if not alphas:
        return 0.0
    mass = run.series["mass_total"][0] if "mass_total" in run.series else sum(body["mass_total"] for body in matter(experiment))
    return float(mass) * max(alphas) * max(most - least, 1e-9 * most)


def heat(experiment: Any, run: Run) -> Iterator[str]:
    if "heat_ledger" not in run.series:
        return
    yield from conducted(experiment, run)
    largest, off = (max(np.abs(run.series[name]).max() for name in names) for names in (("heat_total", "heat_exchanged"), ("heat_ledger",)))
    if off > HEAT * largest and off > HEAT * (largest := max(largest, within(experiment, run))) > 0:
        yield f"heat content and heat taken in disagree by {off:.3g} {joules(experiment)}, {float(f'{100 * off / largest:.2g}'):g} % of the larger"


def exchanged(experiment: Any, name: str) -> float:
    """The largest beta that acts on a body, of surfaces, walls and tools; radiation's at the warmest of body and sky [W/(m2 K)]."""
    hot = [programme(one.heat.beta) for one in (*experiment.walls.values(), *experiment.tools.values()) if getattr(one, "heat", None) is not None]
    mine = (entry for entry in experiment.surfaces if entry.of == name)
    betas = [one.beta for entry in mine for one in exchanging(entry, 1.0, experiment.bodies[name].temperature)]
    return max((*betas, *map(most, hot)), default=0.0)


def met(experiment: Any, run: Run, name: str) -> float:
    """The largest conductance of a contact through which heat passed into a body or out of it [W/(m2 K)]; inf where nothing was in its way."""
    pairs = ((name, other, pair) for other in experiment.bodies for pair in (f"heat_{name}_{other}", f"heat_{other}_{name}") if other != name)
    passed = [{one, other} for one, other, pair in pairs if np.any(run.series.get(pair, 0.0))]
    limits = {frozenset(entry.between): entry.conductance for entry in experiment.contacts}
    return max((np.inf if (limit := limits.get(frozenset(pair))) is None else limit for pair in passed), default=0.0)


def conducted(experiment: Any, run: Run) -> Iterator[str]:
    """Bodies whose temperatures PIC smooths as a conductivity would, by transfers at every heat step."""
    kind, steps = experiment.method.temperature, run.facts.get("heat_steps", 0)
    if not steps or not experiment.moving or experiment.grid.dimension == 0:
        return
    blend = {"pic": 1.0, "flip": getattr(kind, "blend", 0.0), "xpic": float(getattr(kind, "order", 2) == 1)}.get(kind.kind, 0.0)
    share = blend * experiment.grid.cell**2 * steps / (4 * experiment.time.end)
    for name, body in experiment.bodies.items():
        material = experiment.materials[body.material]
        if kind.kind == "xpic" and exchanged(experiment, name):  # it keeps slopes there (mpm.integrate.bounds)
            continue
        if share and material.heat is not None and np.ptp([run.series["temperature_min"], run.series["temperature_max"]]) > 0:
            own = share * material.density * value(law(material.heat.alpha), body.temperature)
            if own > HEAT * (kappa := value(law(material.heat.kappa), body.temperature)):
                yield f"{name}: `{kind.kind}` of temperature conducts {own:.2g} W/(m K) by itself, beside {kappa:.2g} of the material"


def depth(experiment: Any, run: Run) -> Iterator[str]:
    """sqrt(kappa t/(rho alpha)) against the cell, where the surface, not the air, resists, or a flux is given."""
    if experiment.grid.dimension == 0:
        return
    for name, body in experiment.bodies.items():
        material, h = experiment.materials[body.material], experiment.grid.cell
        beta = max(exchanged(experiment, name), met(experiment, run, name))
        given = any(programme(one.flux.q) for one in experiment.surfaces if one.of == name and one.flux is not None)
        if material.heat is None or not (beta or given):
            continue
        seen = {body.temperature, *(float(run.series[at][-1]) for at in ("temperature_min", "temperature_max") if at in run.series)}
        kappa = max(value(law(material.heat.kappa), T) for T in seen)
        deep = float(np.sqrt(kappa * experiment.time.end / (material.density * value(law(material.heat.alpha), body.temperature))))
        if deep < DEPTH[experiment.moving] * h * (1 - 1e-9) and (given or beta * deep > RESISTS * kappa):
            what = "what is exchanged is that" if beta else "temperatures beside its surface are those"
            more = f": at most {10 * (h / deep) ** 2:.0f} % too much" if experiment.moving and deep and exchanged(experiment, name) else ""
            yield f"heat reaches {deep:.2g} m into {name}, {deep / h:.1g} of a cell, and {what} of a layer of about a cell{more}"


def turned_over(series: dict[str, np.ndarray]) -> float:
    """The energy that a motion turns over: the largest that it holds, dissipates or takes from loads [J]."""
    held = series["energy_kinetic"] + series["energy_elastic"]
    return float(max(np.abs(values).max() for values in (held, series["dissipation_total"], series["work_loads"])))


def round_off(experiment: Any, run: Run) -> float:
    """Elastic energy of a strain of ROUNDED round-offs [J]: what lies at rest turns over no more, and that is none (as in mpm.guards)."""
    stiffest = 0.0
    for material in experiment.materials.values():
        if material.elastic is not None:
            law = elastic_law(material.elastic)
            law = getattr(law, "one", law)  # moduli that follow temperature
            stiffest = max(stiffest, law.lam + 2 * law.mu)
    strain = ROUNDED * float(np.finfo(experiment.method.precision).eps)
    return 0.5 * stiffest * strain**2 * float(run.series["volume_total"][0])


def energy(experiment: Any, run: Run) -> Iterator[str]:
    if "dissipation_transfer" not in run.series:
        return
    gone, moved = run.series["dissipation_transfer"], run.facts.get("moved", 0.0)
    worst, most = float(gone[np.argmax(np.abs(gone))]), max(turned_over(run.series), moved)
    if worst < 0:  # what overlapped was pushed apart (mpm.contact.overlap)
        worst = min(0.0, worst + turn(experiment.grid.dimension) * run.facts.get("parted", 0.0))
    implicit = experiment.method.mechanics == "implicit"
    slow = implicit and worst > 0 and moved <= ENERGY * most  # long steps damp what moves: that is what they are for
    if abs(worst) > ENERGY * most > ENERGY * round_off(experiment, run) and not slow:
        lost = "is lost to long steps, which damp what is thrown or falls" if implicit else "is lost to transfers, walls and time steps"
        said = lost if worst > 0 else "appears that no load and no heat accounts for"
        yield f"{abs(worst):.3g} {joules(experiment)}, {float(f'{100 * abs(worst) / most:.2g}'):g} % of what motion holds or dissipates, {said}"


def cells(count: float) -> str:
    """`1 cell`, `1.5 cells`."""
    told = f"{count:.2g}"
    return f"{told} cell{'s' if told != '1' else ''}"


def thin(experiment: Any, run: Run) -> Iterator[str]:
    if not extents(experiment, run):
        return
    cell, dimension = experiment.grid.cell, experiment.grid.dimension
    for name, body in experiment.bodies.items():
        lower, upper = shape(body.shape, dimension).bounds()
        if (across := float(np.min(upper - lower)) / cell) < THIN * (1 - 1e-9):
            yield f"{name} is {cells(across)} across"
            return
    across = {axis: values.min() / cell for axis, values in extents(experiment, run).items()}
    axis = min(across, key=across.get)
    if across[axis] < THIN - 1:
        yield f"the material is down to {cells(across[axis])} along {axis}"


def probe(experiment: Any, run: Run) -> Iterator[str]:
    for name in experiment.output.probes:
        gone = np.flatnonzero(~np.isfinite(run.series.get(f"temperature_{name}", np.zeros(0))))
        if len(gone):
            yield f"{name} has no value from t = {run.times[gone[0]]:.4g} s on"


def edge(experiment: Any, run: Run) -> Iterator[str]:
    axes = extents(experiment, run)
    for axis, size in zip(axes, experiment.grid.size, strict=False):
        sides = ("front", "back") if axis == "y" and len(axes) == 3 else SIDES[axis]
        rooms = run.series[f"position_min_{axis}"], size - run.series[f"position_max_{axis}"]
        for side, room in zip(sides, rooms, strict=True):
            near = np.flatnonzero((room < experiment.grid.cell) & (room < room[0] - 0.1 * experiment.grid.cell))
            if side != "axis" and side not in experiment.walls and len(near):
                yield f"material is within a cell of the side {side} from t = {run.times[near[0]]:.4g} s on, where the domain ends with a wall without friction"


def near(experiment: Any, run: Run) -> Iterator[str]:
    if experiment.moving or len(experiment.bodies) < 2:
        return
    h, D = experiment.grid.cell, experiment.grid.dimension
    edges = [np.arange(round(size / h) + 1) * h for size in experiment.grid.size]
    for (one, a), (two, b) in combinations(((name, shape(body.shape, D)) for name, body in experiment.bodies.items()), 2):
        (low, high), (least, most) = a.bounds(), b.bounds()
        if np.any(np.maximum(low, least) - np.minimum(high, most) >= h):
            continue
        gap = float(np.min(b.distance(cut_quadrature(a, edges, 2)[1].x))) / h
        if TOUCH < gap < 1 - 1e-9:
            yield f"{one} and {two} lie {gap:.2g} cells apart, and pass no heat"


def late(experiment: Any, run: Run) -> Iterator[str]:
    end = experiment.time.end
    for where, begins in beginnings(experiment):
        if begins >= end:
            yield f"{where} begins at {begins:.4g} s and the run ends at {end:.4g} s: it never acts"
    for name, curve in experiment.output.measured.items():
        if curve.samples and min(row[0] for row in curve.samples) > end * (1 + 1e-9):
            yield f"all that was measured for {name} lies behind the end of the run at {end:.4g} s: it has no misfit"


def step(experiment: Any, run: Run) -> Iterator[str]:
    wanted, taken = experiment.time.step, run.finals.get("step_longest")
    if isinstance(wanted, float) and taken is not None and taken < wanted * (1 - SHORTER):
        yield f"time.step is {wanted:.4g} s, and steps of at most {taken:.4g} s were taken, so that they end at output times and heat steps"


def ring(experiment: Any, run: Run) -> Iterator[str]:
    steps, scale = run.facts.get("heat_steps", 0), experiment.time.scale
    if not steps or not experiment.moving or experiment.grid.dimension == 0 or experiment.method.mechanics == "implicit":
        return
    for name, one in scales(experiment).items():
        if one.M is None or not one.gamma:
            continue
        pause, passage = experiment.time.end / (steps * scale), max(one.extent) / one.wave
        if pause > passage and one.thermal_stress > RINGS * steps * one.M[0]:
            yield f"{name} expands at each heat step, and sound passes through it {pause / passage:.2g} times until the next, {scale * passage:.2g} s each"


def bend(experiment: Any, run: Run) -> Iterator[str]:
    axes = extents(experiment, run)
    if experiment.method.frame != "updated" or len(experiment.bodies) > 1 or len(axes) < 2:
        return
    ((name, body),) = experiment.bodies.items()
    if experiment.materials[body.material].flow is not None:
        return
    lower, upper = shape(body.shape, experiment.grid.dimension).bounds()
    for along, axis in enumerate(axes):
        others = [one for one in axes if one != axis]
        thick = min(upper[k] - lower[k] for k in range(len(axes)) if k != along)
        if lying(experiment, lower, upper, along)[1] and upper[along] - lower[along] >= SLENDER * thick:
            ends = [run.series[f"position_{end}_{one}"] for one in others for end in ("min", "max")]
            if (moved := max(float(np.abs(end - end[0]).max()) for end in ends) / experiment.grid.cell) > BENDS:
                yield f"{name} is held at a wall and bends by {moved:.2g} cells, and comes out too soft in the updated frame, some per cent where that is far"


LOOKS = {"volume": volume, "heat": heat, "depth": depth, "energy": energy, "thin": thin, "probe": probe, "edge": edge, "step": step, "near": near, "late": late,
         "ring": ring, "bend": bend}  # fmt: skip
