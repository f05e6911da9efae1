"""Fewer directions: an axisymmetric scene for a round body, a line or a plane for a slab or a bar whose sides are insulated, or nearly so.

Error     none by symmetry; else the tolerance of the steps, which are not the same (mpm.reduce.offers.own), and more. A round body is cut differently by
          the two grids, which differ by 0.2/n^2 at most, n cells a radius (lumped mass, docs/physics.md 12: 2.7e-3 and 6.8e-4 at n = 8 and 16). Of sides
          that exchange and are left out: what they would bring to the mean, at most 1 - exp(-beta S t/(R0 alpha V)), where means are asked for; at a
          probe in the depth d at most erfc(d/(2 sqrt(D t))) a side (a half space whose face is held), and no more than the exchange's own
          2 beta sqrt(t/(pi kappa R0 alpha)) (a half space under the full flux)
Fails     for bodies that are not centred on their axis, or turned boxes: then there is no offer
"""

import math
from typing import Any

from mpm.reduce.moving import prism, revolved
from mpm.reduce.offers import Offer, asked, bare, entries, loaded, only_body, own, refused
from mpm.scene.scales import Scales, scales

SIDES = {1: (("left", "right"),), 2: (("left", "right"), ("bottom", "top")), 3: (("left", "right"), ("front", "back"), ("bottom", "top"))}
SAMPLED = 0.15  # of a squared cell over the way inside: extremes are looked for at points half a cell apart or less
ROUND = 0.2  # of a squared cell over the radius: by how much the two grids may differ
THICK = 2  # cells of the slice that stands for a plane round body
AXES = "xyz"


def covered(side: str, dimension: int) -> set[str]:
    """The sides of a box that an entry's side names."""
    every = [one for pair in SIDES[dimension] for one in pair]
    return set(every) if side == "all" else set(every) - {"bottom", "top"} if side == "lateral" else {side}


def fewer(experiment: Any, left: float) -> Offer | str:
    """A box, or a round body between its ends, along the directions in which heat enters."""
    want = asked(experiment)
    if said := refused(experiment, want):
        return said
    if experiment.moving:
        return prism(experiment, SIDES)
    found = only_body(experiment)
    if found is None:
        return "there are several bodies"
    dimension = experiment.grid.dimension
    if dimension == 1:
        return "one direction is the least"
    name, body, one = found
    if body.shape.kind == "cylinder":
        return stack(experiment, name, body, one)
    if body.shape.kind != "box" or dimension == "axisymmetric" or body.shape.angle:
        return "no box with its sides along the grid"
    given = entries(experiment, name)
    if not given:
        return "nothing is exchanged"
    errors = [side_error(experiment, one, axis) for axis in range(dimension)]
    extremes = want.everything or {"temperature_min", "temperature_max"} & set(want.names)
    sampled = SAMPLED * (experiment.grid.cell / one.reach) ** 2 if extremes and one.reach > 0 else 0.0
    ranked = sorted(range(dimension), key=lambda axis: -errors[axis])
    offers = []
    for count in range(1, dimension):
        kept = sorted(ranked[:count])
        offers.append((sum(errors[axis] for axis in ranked[count:]), kept))
    offers = [(error + sampled + (own(experiment) if error > 0 else 0.0), kept) for error, kept in offers]  # by symmetry the steps are the same too
    error, kept = next(((error, kept) for error, kept in offers if error <= left), min(offers))
    return along(experiment, name, body, kept, error)


def along(experiment: Any, name: str, body: Any, kept: list[int], error: float) -> Offer:
    """The offer that keeps some axes of a box."""
    dimension, data = experiment.grid.dimension, bare(experiment)
    pick = lambda values: [values[axis] for axis in kept]  # noqa: E731
    surfaces = []
    for entry in entries(experiment, name):
        sides = covered(entry["side"], dimension)
        for place, axis in enumerate(kept):
            surfaces += [entry | {"side": SIDES[len(kept)][place][end]} for end, side in enumerate(SIDES[dimension][axis]) if side in sides]
    data["surfaces"] = surfaces
    data["grid"] |= {"dimension": len(kept), "size": pick(experiment.grid.size)}
    shape = {"box": {"lower": pick(body.shape.lower), "upper": pick(body.shape.upper)}}
    data["bodies"][name] |= {"shape": shape, "velocity": None, "angular_velocity": None}
    data["output"]["probes"] = {probe: pick(x) for probe, x in experiment.output.probes.items()}
    if "offset" in data["method"]:
        data["method"]["offset"] = pick(experiment.method.offset)
    left = [axis for axis in range(dimension) if axis not in kept]
    depth = math.prod(body.shape.upper[axis] - body.shape.lower[axis] for axis in left)
    said = f"{' and '.join(AXES[axis] for axis in left)}: nothing{'' if error == 0 else ' much'} varies there"
    return Offer(f"{len(kept)}-D", said, loaded(data, experiment), error, depth)


def side_error(experiment: Any, one: Scales, axis: int) -> float:
    """Error of leaving out one direction of a box: what its two faces would bring."""
    dimension, body = experiment.grid.dimension, experiment.bodies[one.name]
    sides = {side: [e for e in experiment.surfaces if e.of == one.name and side in covered(e.side, dimension)] for side in SIDES[dimension][axis]}
    low, high = body.shape.lower[axis], body.shape.upper[axis]
    depths = {SIDES[dimension][axis][0]: [x[axis] - low for x in experiment.output.probes.values()],
              SIDES[dimension][axis][1]: [high - x[axis] for x in experiment.output.probes.values()]}  # fmt: skip
    return sum(left_out(experiment, one, found, one.volume / (high - low), depths[side]) for side, found in sides.items() if found)


def left_out(experiment: Any, one: Scales, found: list, area: float, depths: list[float]) -> float:
    """Error of one side that exchanges and is left out."""
    if any(entry.flux is not None for entry in found):
        return math.inf
    want, t = asked(experiment), experiment.time.end
    beta = sum(e.beta for e in one.exchanges if any(entry.side == e.side for entry in found))
    share = -math.expm1(-beta * area * t / (one.density * one.alpha[0] * one.volume)) if math.isfinite(beta) else 1.0
    reach = math.sqrt(4 * one.kappa[1] * t / (one.density * one.alpha[0]))
    face = 2 * beta * math.sqrt(t / (math.pi * one.kappa[0] * one.density * one.alpha[0])) if one.kappa[0] > 0 else 1.0
    at = [min(math.erfc(max(d, 0.0) / reach), face) for d in depths]
    extremes = want.everything or {"temperature_min", "temperature_max"} & set(want.names)
    means = want.everything or any(name in ("temperature_mean", "heat_total", "heat_exchanged") for name in want.names)
    return max([*at, *([share] if means else []), *([min(1.0, face)] if extremes else [])], default=0.0)


def stack(experiment: Any, name: str, body: Any, one: Scales) -> Offer | str:
    """A cylinder that exchanges through its ends alone: a line along its axis."""
    given = entries(experiment, name)
    if not given or any(entry["side"] not in ("bottom", "top") for entry in given):
        return "its round side exchanges"
    data, base = bare(experiment), body.shape.base[-1]
    data["surfaces"] = [entry | {"side": {"bottom": "left", "top": "right"}[entry["side"]]} for entry in given]
    data["grid"] |= {"dimension": 1, "size": [experiment.grid.size[-1]]}
    data["bodies"][name]["shape"] = {"box": {"lower": [base], "upper": [base + body.shape.height]}}
    data["output"]["probes"] = {probe: [x[-1]] for probe, x in experiment.output.probes.items()}
    if "offset" in data["method"]:
        data["method"]["offset"] = [experiment.method.offset[-1]]
    return Offer("1-D", "the radius: nothing varies there", loaded(data, experiment), 0.0, math.pi * body.shape.radius**2)


def axisymmetric(experiment: Any, left: float) -> Offer | str:
    """A round body in the plane (r, z)."""
    if said := refused(experiment, asked(experiment)):
        return said
    if experiment.moving:
        return revolved(experiment)
    found = only_body(experiment)
    if found is None:
        return "there are several bodies"
    name, body, _ = found
    dimension, kind, given = experiment.grid.dimension, body.shape.kind, entries(experiment, name)
    if dimension not in (2, 3) or (dimension, kind) not in {(2, "ball"), (2, "ring"), (3, "ball"), (3, "cylinder")}:
        return "no round body"
    allowed = ("all", "lateral", "bottom", "top") if kind == "cylinder" else ("all",)
    if any(entry["side"] not in allowed for entry in given):
        return "a part of its round side exchanges by itself"
    return disc(experiment, name, body, given) if dimension == 2 else solid(experiment, name, body, given)


def rims(experiment: Any, centre: tuple, radius: float) -> float:
    """Radius of a domain that holds the body, in whole cells."""
    return math.ceil(radius / experiment.grid.cell + 1 - 1e-9) * experiment.grid.cell


def solid(experiment: Any, name: str, body: Any, given: list[dict]) -> Offer:
    """A ball or an upright cylinder."""
    data = bare(experiment)
    centre = body.shape.centre if body.shape.kind == "ball" else body.shape.base
    shape = {"centre": [0.0, centre[2]], "radius": body.shape.radius}
    if body.shape.kind == "cylinder":
        shape = {"base": [0.0, centre[2]], "radius": body.shape.radius, "height": body.shape.height}
    data["surfaces"] = given
    data["grid"] |= {"dimension": "axisymmetric", "size": [rims(experiment, centre, body.shape.radius), experiment.grid.size[2]]}
    data["bodies"][name]["shape"] = {body.shape.kind: shape}
    places = {probe: [math.hypot(x[0] - centre[0], x[1] - centre[1]), x[2]] for probe, x in experiment.output.probes.items()}
    return revolve(experiment, data, places, experiment.method.offset[-1:], 1.0)


def disc(experiment: Any, name: str, body: Any, given: list[dict]) -> Offer:
    """A disc or a ring: a slice of the long cylinder that plane heat means, insulated at its ends."""
    data, cell = bare(experiment), experiment.grid.cell
    inner, outer = (0.0, body.shape.radius) if body.shape.kind == "ball" else (body.shape.inner, body.shape.outer)
    data["surfaces"] = [entry | {"side": "lateral"} for entry in given]
    data["grid"] |= {"dimension": "axisymmetric", "size": [rims(experiment, body.shape.centre, outer), THICK * cell]}
    data["bodies"][name]["shape"] = {"box": {"lower": [inner, 0.0], "upper": [outer, THICK * cell]}}
    middle = THICK * cell / 2
    places = {probe: [math.dist(x, body.shape.centre), middle] for probe, x in experiment.output.probes.items()}
    return revolve(experiment, data, places, (0.0,), 1 / (THICK * cell))


def revolve(experiment: Any, data: dict, probes: dict, shift: tuple, factor: float) -> Offer:
    """The offer of a plane (r, z)."""
    data["output"]["probes"] = {probe: [min(r, data["grid"]["size"][0]), z] for probe, (r, z) in probes.items()}
    if "offset" in data["method"]:
        data["method"]["offset"] = [0.0, *shift]
    (one,) = scales(experiment).values()
    error = ROUND * (experiment.grid.cell / (one.reach or max(one.extent) / 2)) ** 2 + own(experiment)
    return Offer("axisymmetric", "the angle: nothing varies round the axis", loaded(data, experiment), error, factor)
