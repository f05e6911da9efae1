"""Physics that a scene names and does not need: motion, flow, heating by deformation, heat itself.

rigid    heat is asked for and the body hardly moves: geometry off by a strain e changes Fourier and Biot numbers by 2 e and e, and temperatures by at most
         0.4 of that; error 3 e is an upper estimate. Added are the heat of elastic volume change, and what the particles' own grid is off by:
         0.06 (h/d)^2 Bi/(1 + Bi), d the depth that heat has reached at the first output (at most 0.45 of the way inside), Bi = beta d/kappa. At Fo = 0.2 that
         is 0.3/n^2 for a held surface; docs/physics.md 11 has 3.7e-3 and 8.6e-4 at n = 8 and 16 for a slab of Bi = 10. No estimate for transfers not affine
no flow  upper estimates of the stress stay below yield; looked at again in the elastic run
one way  deformation heats by gamma Theta tr(eps)/(R0 alpha), and stiffens waves by eps_c/2, which adds up over their transits
no heat  nothing of heat is asked for, and neither expansion nor a law of temperature lets it act on motion
"""

import math
from typing import Any

from mpm.reduce.offers import Offer, asked, bare, loaded, refused
from mpm.scene.groups import loads, strains, warming
from mpm.scene.scales import Scales, scales

STRAIN, LAYER, FULL = 3.0, 0.06, 0.45  # errors a strain, and a squared cell over the layer; the deepest layer, of the way inside
NEAR = 2.0  # cells between bodies that feel each other
AFFINE = ("apic", "affine_flip")
HEAT_METHOD = ("offset", "rigid")


def rigid(experiment: Any, left: float) -> Offer | str:
    """Heat alone in bodies that stay where they are."""
    want = asked(experiment)
    if not experiment.moving:
        return "nothing moves"
    if said := refused(experiment, want):
        return said
    if not want.heat_only:
        return "motion is asked for"
    if any(experiment.materials[body.material].heat is None for body in experiment.bodies.values()):
        return "a body has no heat"
    if any(wall.heat is not None for wall in experiment.walls.values()):
        return "a hot wall exchanges heat by contact"
    found = scales(experiment).values()
    pushed = experiment.gravity is not None or experiment.loads or any(one.speed for one in found)
    if len(found) > 1 and (near(experiment) or pushed):
        return "bodies may touch"
    data = bare(experiment)
    for material in data["materials"].values():
        material |= dict.fromkeys(("elastic", "flow", "expansion", "heating"))
    for body in data["bodies"].values():
        body |= {"velocity": None, "angular_velocity": None}
    data |= {"walls": {}, "gravity": None, "loads": [], "time": {"end": experiment.time.end}}
    data["grid"]["basis"] = "quadratic"
    data["method"] = {name: value for name, value in data["method"].items() if name in HEAT_METHOD}
    errors = [moved(experiment, one) for one in found]
    error = None if None in errors else max(errors)
    return Offer("rigid", "motion: heat alone, in bodies that stay where they are", loaded(data, experiment), error)


def moved(experiment, one: Scales) -> float | None:
    """Error of a body that is taken as rigid; None where it may flow."""
    if one.M is not None and max(loads(experiment, one)) >= 1:
        return None
    heating = experiment.materials[experiment.bodies[one.name].material].heating
    if type(experiment.method.temperature).kind not in AFFINE:
        return None
    error = STRAIN * sum(strains(experiment, one).values()) + particles(experiment, one)
    if heating is not None and heating.elastic is not None:
        error += warming(experiment, one)
    return error


def particles(experiment: Any, one: Scales) -> float:
    """What particles are off by in a layer that heat has just entered, as a share of the driving difference."""
    if one.kappa[0] <= 0:
        return 0.0
    first = min(experiment.output.every, experiment.time.end)
    layer = min(math.sqrt(one.kappa[0] * first / (one.density * one.alpha[1])), FULL * (one.reach or one.length))
    biot = one.beta * layer / one.kappa[0] if one.exchanges else math.inf
    return min(1.0, LAYER * (experiment.grid.cell / layer) ** 2 * (biot / (1 + biot) if math.isfinite(biot) else 1.0))


def near(experiment) -> bool:
    """Whether any two bodies come within NEAR cells of each other: their boxes do."""
    from mpm.scene.shapes import shape

    boxes = [shape(body.shape, experiment.grid.dimension).bounds() for body in experiment.bodies.values()]
    reach = NEAR * experiment.grid.cell
    return any(all(a <= d + reach and c <= b + reach for a, b, c, d in zip(*boxes[i], *boxes[j], strict=True)) for i in range(len(boxes)) for j in range(i))


def no_flow(experiment: Any, left: float) -> Offer | str:
    """Elasticity without yield."""
    flowing = [name for name, material in experiment.materials.items() if material.flow is not None]
    if not flowing:
        return "nothing flows"
    if said := refused(experiment, asked(experiment)):
        return said
    data = bare(experiment)
    for name in flowing:
        material = data["materials"][name]
        material["flow"] = None
        if material["heating"] is not None:
            material["heating"] = {"elastic": material["heating"]["elastic"]} if material["heating"]["elastic"] is not None else None
    bodies = [one for one in scales(experiment).values() if one.M is not None]
    calm = all(max(loads(experiment, one)) < 1 for one in bodies)
    offer = Offer("no flow", f"flow of {', '.join(flowing)}", loaded(data, experiment), 0.0 if calm else None,
                  doubt=lambda run: yields(run, bodies))  # fmt: skip
    return offer


def yields(run, bodies: list[Scales]) -> str:
    """Whether the largest strain of an elastic run could mean a stress past yield; three strains of at most e give q <= 4 mu e and p <= 3 K e + gamma theta."""
    strain = float(run.series["strain_max"].max())
    for one in bodies:
        if 4 * one.mu * strain >= one.M[0] or 3 * one.bulk * strain + one.thermal_stress >= one.p0[0] * one.M[0]:
            return f"{one.name} strains to {strain:.2g}, which may be past yield"
    return ""


def one_way(experiment: Any, left: float) -> Offer | str:
    """Heat drives motion, and motion does not heat."""
    heated = {name: material for name, material in experiment.materials.items() if material.heating is not None}
    if not heated:
        return "deformation does not heat"
    want = asked(experiment)
    if said := refused(experiment, want):
        return said
    data = bare(experiment)
    for name in heated:
        data["materials"][name]["heating"] = None
    errors = [back_action(experiment, one, want.heat_only) for one in scales(experiment).values() if experiment.bodies[one.name].material in heated]
    return Offer("one way", "heating by deformation", loaded(data, experiment), None if None in errors else max(errors, default=0.0))


def back_action(experiment, one: Scales, heat_only: bool) -> float | None:
    """Error of leaving out what deformation heats; None where plastic work has no bound from the config."""
    heating = experiment.materials[experiment.bodies[one.name].material].heating
    error = 0.0
    if heating.elastic is not None:
        error += warming(experiment, one)
        if not heat_only:
            transits = one.wave * experiment.time.end / max(one.extent)
            error += one.gamma**2 * one.high / (one.density * one.alpha[0] * one.stiffness) * (1 + math.pi * transits)
    if heating.dissipation is not None and (one.M is None or max(loads(experiment, one)) >= 1):
        return None
    return error


def no_heat(experiment: Any, left: float) -> Offer | str:
    """Motion alone, at the temperatures of the start."""
    hot = {name: material for name, material in experiment.materials.items() if material.heat is not None}
    if not hot or not experiment.moving:
        return "there is no heat beside motion"
    want = asked(experiment)
    if said := refused(experiment, want):
        return said
    if not want.motion_only:
        return "heat is asked for"
    data = bare(experiment)
    for name in hot:
        data["materials"][name] |= dict.fromkeys(("heat", "expansion", "heating"))
    data["surfaces"] = []
    for wall in data["walls"].values():
        for kind in wall.values():
            kind["heat"] = None
            kind |= {} if kind.get("friction") or "stick" in wall else {"from": 0.0, "until": None}  # then it says nothing any more
    error = 0.0 if all(map(deaf, scales(experiment).values())) else None
    return Offer("no heat", "heat: motion at the temperatures of the start", loaded(data, experiment), error)


def deaf(one: Scales) -> bool:
    """Whether temperature does not act on the motion of a body: no expansion, no law that changes with it."""
    return one.gamma == 0 and one.stiffening == 1 and all(pair is None or pair[0] == pair[1] for pair in (one.M, one.p0, one.eta))
