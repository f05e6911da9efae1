"""Loads of a config to the run-time Load of a body: forces and their moments about the particles.

Tractions on flat and round faces are stresses that particles bear (mpm.scene.faded); others act at pieces of surface. Of tractions by present area this is
what they are at the start.
"""

import functools
import math

import numpy as np

from mpm.basis import inverse_moment
from mpm.config.boundary import spell
from mpm.integrate.traction import BORNE, Nominal, Present
from mpm.scene.conventions import SIDES
from mpm.scene.faded import pushed
from mpm.scene.menus import pulling, wall_kind
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import shape
from mpm.sources import Both
from mpm.state import Axisymmetric, Load, NoSource, Ramp, Within
from mpm.transfer import uses_basis_gradient

FLUSH = 1e-9  # of the domain


def course_of(entry) -> tuple[float, float, float]:
    """(ramp, from, until) of a load."""
    return entry.traction.ramp if entry.traction is not None else 0.0, *spell(entry)


def ramp_of(ramp: float, begin: float, end: float) -> Ramp | Within:
    """What a run makes of it."""
    return Ramp(ramp) if begin == 0 and math.isinf(end) else Within(ramp, begin, end, np.zeros(1))


def one_course(experiment, name: str) -> Ramp | Within:
    """The course of all loads on one body; SceneError where they have several."""
    entries = [entry for entry in experiment.loads if entry.of == name]
    ramps = sorted({entry.traction.ramp for entry in entries if entry.traction is not None})
    spells = {spell(entry) for entry in entries}
    for said, several in ((f"ramps of {', '.join(f'{ramp:g} s' for ramp in ramps)}", ramps), ("several from and until", spells)):
        if len(several) > 1:
            at = ("loads", experiment.loads.index(entries[-1]), *(("traction",) if several is ramps else ()))
            raise SceneError(at, f"the loads on {name} have {said}, which the total frame does not know: give them the same, or method.frame: updated")
    return ramp_of(max(ramps, default=0.0), *next(iter(spells), (0.0, math.inf)))


def loaded(experiment, name: str, cut, space, gradient):
    """The Load of one body, Both of loads that begin, end or rise at different times; NoSource where nothing acts on it."""
    entries = [entry for entry in experiment.loads if entry.of == name]
    tractions, rate = pulling(entries)
    if not tractions and rate == 0:
        return NoSource()
    courses = sorted({course_of(entry) for entry in entries if entry.traction is not None})
    courses += sorted({one for entry in entries if (one := course_of(entry))[1:] not in [known[1:] for known in courses]})
    made = [one_load(experiment, name, cut, (space, gradient), entries, course, courses) for course in courses]
    return functools.reduce(lambda rest, one: Both(one, rest), reversed(made))


def on_walls(experiment, cut) -> np.ndarray:
    """(S,) pieces on walls that a body does not leave."""
    found, kept = np.zeros(len(cut.area), bool), (wall_kind("slip"), wall_kind("stick"))
    for number, side in enumerate(SIDES[experiment.grid.dimension]):
        size = experiment.grid.size[number // 2]
        if side not in experiment.walls or wall_kind(experiment.walls[side].acts) in kept:
            found |= np.abs(cut.point[:, number // 2] - (number % 2) * size) <= FLUSH * size
    return found


def one_load(experiment, name: str, cut, how, entries, course, courses) -> Load:
    """The Load of the entries of one course; a drag goes with the first that lasts as it does."""
    space, gradient = how
    first = next(one for one in courses if one[1:] == course[1:]) == course
    mine = [entry for entry in entries if (entry.traction is not None and course_of(entry) == course)]
    tractions = pulling(mine)[0]
    rate = pulling([entry for entry in entries if first and spell(entry) == course[1:]])[1]
    N, D = cut.centroid.shape
    (force, dipole), press, pull = ((np.zeros((N, D)), np.zeros((N, D, D))) for _ in range(3))
    normal, hoop, left, held, radial = np.zeros((N, D)), np.zeros(N), BORNE, on_walls(experiment, cut), isinstance(space, Axisymmetric)
    outline = shape(experiment.bodies[name].shape, experiment.grid.dimension)
    for entry in tractions:
        pieces = np.flatnonzero(outline.faces(cut, entry.side, experiment.grid.dimension == 2))
        if len(pieces) == 0:
            raise SceneError(("loads", experiment.loads.index(entry)), f"{name} has no surface on its side {entry.side!r}: nothing would be loaded")
        one = pushed(cut, pieces, entry.traction, space.h, radial, held)
        force, dipole, left = force + one.force, dipole + one.moment, max(left, one.left)
        if entry.traction.pressure is not None:
            press, hoop = (press[0] + one.turning, press[1] + one.turning_moment), hoop + one.hoop
        elif entry.traction.cauchy is not None:
            pull = pull[0] + one.turning, pull[1] + one.turning_moment
            np.add.at(normal, cut.owner[pieces], cut.area[pieces, None] * cut.normal[pieces])
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / space.h**2
    F = np.tile(np.eye(D), (N, 1, 1))
    carries = np.any(force != 0, axis=1) | np.any(dipole != 0, axis=(1, 2))
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal /= np.where(size > 0, size, 1.0)
    turns = any(entry.traction.nominal is None for entry in tractions)
    area = Present(force.copy(), dipole.copy(), *press, *pull, normal, hoop) if turns else Nominal()
    return Load(force, dipole, F, carries, np.zeros(N), ramp_of(*course), rate, float(scale), area, left)
