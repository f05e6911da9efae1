"""One temperature for the whole body: R0 alpha V dTheta/dt = -beta S (Theta - outside) (docs/physics.md 10, 0-D).

Error     the quasi-steady unevenness of the inside (mpm.scene.groups.uneven), an upper estimate; exp(-1) of it, the largest x exp(-x), where only
          means are asked for: they are off by as much as the rate is, a third of the unevenness or less; and the tolerance of the full model's steps
Fails     for held surfaces, fluxes, radiation and surroundings that change: the material point has none of them, and so there is no offer
"""

import math
from typing import Any

from mpm.reduce.offers import Offer, asked, bare, loaded, only_body, own, refused
from mpm.scene.groups import uneven

MEAN = math.exp(-1)


def lumped(experiment: Any, left: float) -> Offer | str:
    """The body as a material point."""
    want = asked(experiment)
    if said := refused(experiment, want):
        return said
    if experiment.moving:
        return "the body moves"
    found = only_body(experiment)
    if found is None:
        return "there are several bodies"
    name, body, one = found
    entries = [entry for entry in experiment.surfaces if entry.of == name]
    if not one.exchanges:
        return "nothing is exchanged"
    if any(entry.flux is not None or entry.radiation is not None for entry in entries) or not all(each.constant for each in one.exchanges):
        return "a material point exchanges by convection of constant temperature only"
    if not math.isfinite(one.beta):
        return "a surface is held at a temperature"
    total = sum(each.area for each in one.exchanges)
    data = bare(experiment)
    convections = [{"beta": each.beta * each.area / one.area, "outside": each.low} for each in one.exchanges]
    if len({(each.beta, each.low) for each in one.exchanges}) == 1:
        convections = [{"beta": one.beta, "outside": one.exchanges[0].low}]
        ratio = total / one.volume
    else:
        ratio = one.area / one.volume
    data["grid"] = {"dimension": 0}
    data["bodies"] = {name: {"shape": {"point": {"surface_to_volume": ratio}}, "temperature": body.temperature, "material": body.material}}
    data["materials"] = {body.material: data["materials"][body.material]}
    data["surfaces"] = [{"of": name, "convection": convection} for convection in convections]
    data["time"] = {"end": experiment.time.end}
    data["output"]["probes"] = {probe: [] for probe in experiment.output.probes}
    data.pop("method")
    error = uneven(one) * (MEAN if want.means_only else 1.0) + own(experiment)
    return Offer("lumped", f"conduction inside {name}: one temperature", loaded(data, experiment), error, one.volume)
