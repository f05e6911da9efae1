"""What a config lets change over time beside heat, to mpm.contact.course.Course: gravity, frictions, spells of walls, pairs and loads."""

import math

from mpm.boundary import SLIP, STICK
from mpm.config.boundary import spell
from mpm.contact.course import Course
from mpm.heat.programmes import Parts, changes
from mpm.heat.programmes import spell as limited
from mpm.scene.conventions import SIDES
from mpm.scene.exchange import most, programme
from mpm.scene.menus import wall_kind
from mpm.sources import Given, Jumping, acting
from mpm.state import Load, Within


def lasting(entry, what):
    """A programme of an entry, nothing before it begins and after it ends."""
    begin, end = spell(entry)
    return limited(programme(what), begin, None if math.isinf(end) else end)


def kinds(wall):
    """The kind of a mirror over time: it slides where it does not hold."""
    one = limited(float(wall_kind(wall.acts)), getattr(wall, "from"), wall.until)
    return Parts(one.jumps, tuple(float(SLIP) if part == 0.0 else part for part in one.parts)) if isinstance(one, Parts) else one


def of_walls(experiment, met, walls):
    """(array, index, programme) of the domain's sides; `walls` (3, 2): kinds that the nodes of a single field have."""
    for number, side in enumerate(SIDES[experiment.grid.dimension]):
        wall, place = experiment.walls.get(side), (number // 2, number % 2)
        if wall is None:
            continue
        rubs = lasting(wall, wall.friction)
        if changes(rubs) and met is not None:
            yield from ((met.stops, (b, *place), rubs) for b in range(len(met.bodies)) if met.stops[b][place] >= 0)
        if wall.acts == "stick" and changes(holds := kinds(wall)):
            arrays = (walls[None], *((met.walls, met.touching.walls) if met is not None else ()))
            yield from ((array, (b, *place), holds) for array in arrays for b in range(len(array)) if array[b][place] == STICK)


def of_pairs(experiment, met):
    """(array, index, programme) of pairs of bodies."""
    names = list(experiment.bodies)
    for pair in experiment.contacts if met is not None else ():
        b, c = map(names.index, pair.between)
        given = math.inf if pair.conductance is None else pair.conductance
        for array, what in ((met.pairs, math.inf if pair.stick is not None else pair.friction), (met.links, given)):
            one = lasting(pair, what)
            if changes(one) and most(one) > 0:
                yield from ((array, index, one) for index in ((b, c), (c, b)) if array[index] >= 0 and (array is met.pairs or array[index] > 0))


def course(experiment, met, walls, bodies, references) -> Course | None:
    """What changes; None where nothing does."""
    found = [*of_walls(experiment, met, walls), *of_pairs(experiment, met)]
    if met is not None and met.drive is not None:
        each = ((t, programme(tool.friction)) for t, tool in enumerate(experiment.tools.values()))
        found += [(met.drive.tools.mu, (t,), one) for t, one in each if changes(one)]
    gravity = tuple(programme(one) for one in experiment.gravity or ())
    gravity = gravity if any(map(changes, gravity)) else ()
    loads = [one.ramp for body in bodies for one in acting(body.source) if isinstance(one, Load)] + [reference.ramp for reference in references]
    loads = [one for one in loads if isinstance(one, Within)]
    forces = [one.force for body in bodies for one in acting(body.source) if isinstance(one, Given) and isinstance(one.force, Jumping)]
    times = tuple(when for one in loads for when in (one.begin, one.end))
    pasts = tuple(one.past for one in (*loads, *forces))
    return Course(tuple(found), gravity, pasts, times) if found or gravity or pasts else None
