"""Bodies that do not move: which of them touch, and what conducts between them. Perfect contact where a pair is not named and both conduct."""

import math
from itertools import combinations

import numpy as np

from mpm.config.boundary import spell
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import shape


def joints(experiment) -> tuple:
    """mpm.rigid.group.Joint of every two bodies that touch. SceneError for overlap, contacts of bodies apart, and contact with what conducts nothing."""
    from mpm.rigid.group import Joint
    from mpm.rigid.touching import touch
    from mpm.scene.meeting import refuse_overlap

    names, h = list(experiment.bodies), experiment.grid.cell
    if len(names) < 2:
        return ()
    outlines = [shape(body.shape, experiment.grid.dimension) for body in experiment.bodies.values()]
    refuse_overlap(experiment, names, outlines, [outline.bounds() for outline in outlines])
    named = {frozenset(pair.between): (index, pair) for index, pair in enumerate(experiment.contacts)}
    found = []
    for (a, one), (b, two) in combinations(enumerate(outlines), 2):
        index, pair = named.get(frozenset((names[a], names[b])), (None, None))
        if touch(one, two, h):
            given = math.inf if pair is None or pair.conductance is None else pair.conductance
            H = 0.0 if pair is None and any(insulator(experiment, names[k]) for k in (a, b)) else given
            found.append(Joint(a, b, H) if pair is None else Joint(a, b, H, *spell(pair)))
        elif index is not None:
            said = f"{names[a]} and {names[b]} do not touch, so no heat can pass: let faces of theirs meet, or leave the pair out"
            raise SceneError(("contacts", index), said)
    refuse(experiment, names, [joint for joint in found if joint.conductance > 0])
    return tuple(found)


def refuse(experiment, names, conducting) -> None:
    """SceneError where bodies conduct into one another, and the method or a material cannot."""
    kind = type(experiment.method.rigid).kind
    for joint in conducting:
        both = f"{names[joint.first]} and {names[joint.second]} touch and pass heat"
        cure = f"contacts: [{{between: [{names[joint.first]}, {names[joint.second]}], conductance: 0}}]"
        if kind in ("explicit", "bounded"):
            raise SceneError(("method", "rigid"), f"{both}, which takes implicit steps: auto or implicit, not {kind}; or keep them apart by {cure}")
        for name in (names[joint.first], names[joint.second]):
            if insulator(experiment, name):
                material = experiment.bodies[name].material
                raise SceneError(("materials", material, "heat"), f"{both}, and kappa is 0: give it a conductivity; or keep them apart by {cure}")


def insulator(experiment, name: str) -> bool:
    """Whether a body conducts nothing."""
    kappa = experiment.materials[experiment.bodies[name].material].heat.kappa
    return type(kappa).kind == "constant" and kappa.value == 0


def refuse_covered(experiment, outlines, found) -> None:
    """SceneError for an exchange of a side that other bodies cover from end to end, for as long as it would act."""
    from mpm.rigid.touching import covered, lines_of, surface_beside

    names, h = list(experiment.bodies), experiment.grid.cell
    for index, entry in enumerate(experiment.surfaces):
        b, (begin, end) = names.index(entry.of), spell(entry)
        lasting = [j for j in found if b in (j.first, j.second) and j.begin <= begin and j.end >= min(end, experiment.time.end)]
        others = tuple(outlines[j.second if j.first == b else j.first] for j in lasting)
        if not others:
            continue
        lines = [lines_of(outlines[b], h, k) for k in range(outlines[b].dimension)]
        surface = surface_beside(outlines[b], others, lines, 2, h)
        bare = ~covered(surface.x, surface.normal, others, h)
        if not np.any(bare & outlines[b].faces(surface, entry.side, experiment.grid.dimension == 2)):
            said = f"other bodies cover side {entry.side!r} of {entry.of}, and nothing is exchanged there: leave the entry out"
            raise SceneError(("surfaces", index), said)
