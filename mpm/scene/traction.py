"""Loads of a config to the run-time Load of a body: forces and their moments about the particles.

A traction T on a flat face of normal N acts as the stress P_T = T N^T that it asks for, faded out inside, so that particles balance it with the quadrature by
which they bear it: with chi = 1 at the face and 0 farther than REACH cells inside, exactly (by parts)

    int_face w T dA = int [chi P_T . grad w + w T (N . grad chi) + w chi P_T e_r/r (axisymmetric)] dV + int_surface w (T on the face - chi P_T n) dA

by the particles' points and volumes and by the pieces of surface; what force and first moment then lack (of quadrature) is spread where chi falls. A load on a
face that is not flat acts at its pieces. Of tractions by present area this is what they are at the start; what the change of area adds acts at the pieces.
"""

import functools
import math

import numpy as np

from mpm.basis import inverse_moment
from mpm.config.boundary import spell
from mpm.integrate.traction import Nominal, Present
from mpm.scene.menus import pulling
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import shape
from mpm.sources import Both
from mpm.state import Axisymmetric, Load, NoSource, Ramp, Within
from mpm.transfer import uses_basis_gradient


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


REACH, WHOLE, ROOM, FLAT = 8.0, 0.25, 0.75, 1e-6  # cells; share of the reach over which chi is 1; share of the body; of a cell


def at_pieces(cut, pieces, each) -> tuple[np.ndarray, np.ndarray]:
    """(force (N, D), moment (N, D, D)) about the particles of forces `each` (S, D) at pieces."""
    N, D = cut.centroid.shape
    force, dipole, owner = np.zeros((N, D)), np.zeros((N, D, D)), cut.owner[pieces]
    np.add.at(force, owner, each)
    np.add.at(dipole, owner, each[:, :, None] * (cut.point[pieces] - cut.centroid[owner])[:, None, :])
    return force, dipole


def by_area(traction, normal: np.ndarray) -> np.ndarray:
    """Force by area (S, D) of a traction on undeformed surface of outward normals (S, D)."""
    return -traction.pressure * normal if traction.pressure is not None else np.tile(traction.nominal or traction.cauchy, (len(normal), 1))


def pushed(cut, pieces, traction, whole, h: float, radial: bool) -> tuple[np.ndarray, np.ndarray]:
    """(force, moment) of a traction on pieces; `whole`: those of its pieces."""
    normal = np.average(cut.normal[pieces], axis=0, weights=cut.area[pieces])
    size = float(np.linalg.norm(normal))
    depth = -(cut.centroid @ normal)
    front = cut.point[pieces] @ normal
    if size < 1 - FLAT or np.ptp(front) > FLAT * h:
        return whole
    depth += front.mean()
    T = by_area(traction, normal[None])[0]
    reach = min(REACH * h, ROOM * float(depth.max()))
    chi, fall = faded(depth, reach)
    V, x, P = cut.volume, cut.centroid, np.outer(T, normal)
    force = (V * fall)[:, None] * T
    if radial:
        force += (V * chi / x[:, 0])[:, None] * P[:, 0]
    dipole = (V * chi)[:, None, None] * P
    every = np.arange(len(cut.area))
    there = faded(front.mean() - cut.point @ normal, reach)[0]
    each = -(cut.area * there * (cut.normal @ normal))[:, None] * T
    each[pieces] += cut.area[pieces, None] * T
    more = at_pieces(cut, every, each)
    force, dipole, share = force + more[0], dipole + more[1], V * fall / np.sum(V * fall)
    force += np.outer(share, np.sum(whole[0] - force, axis=0))
    moments = [np.einsum("pc,pd->cd", f, x) + m.sum(axis=0) for f, m in (whole, (force, dipole))]
    return force, dipole + share[:, None, None] * (moments[0] - moments[1])


def faded(depth, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """(chi, N . grad chi = -d chi/d depth) at depths below a face: 1 to WHOLE of the reach, then 1 - 3 s^2 + 2 s^3."""
    span = (1 - WHOLE) * reach
    s = np.clip((depth - WHOLE * reach) / span, 0, 1)
    return 1 - s * s * (3 - 2 * s), 6 * s * (1 - s) / span


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


def one_load(experiment, name: str, cut, how, entries, course, courses) -> Load:
    """The Load of the entries of one course; a drag goes with the first that lasts as it does."""
    space, gradient = how
    first = next(one for one in courses if one[1:] == course[1:]) == course
    mine = [entry for entry in entries if (entry.traction is not None and course_of(entry) == course)]
    tractions = pulling(mine)[0]
    rate = pulling([entry for entry in entries if first and spell(entry) == course[1:]])[1]
    N, D = cut.centroid.shape
    force, dipole, radial = np.zeros((N, D)), np.zeros((N, D, D)), isinstance(space, Axisymmetric)
    press, pull, normal = (np.zeros((N, D)), np.zeros((N, D, D))), (np.zeros((N, D)), np.zeros((N, D, D))), np.zeros((N, D))
    outline = shape(experiment.bodies[name].shape, experiment.grid.dimension)
    for entry in tractions:
        pieces = np.flatnonzero(outline.faces(cut, entry.side, experiment.grid.dimension == 2))
        if len(pieces) == 0:
            raise SceneError(("loads", experiment.loads.index(entry)), f"{name} has no surface on its side {entry.side!r}: nothing would be loaded")
        whole = at_pieces(cut, pieces, cut.area[pieces, None] * by_area(entry.traction, cut.normal[pieces]))
        one, moment = pushed(cut, pieces, entry.traction, whole, space.h, radial)
        force, dipole = force + one, dipole + moment
        if entry.traction.pressure is not None:
            press = press[0] + whole[0], press[1] + whole[1]
        elif entry.traction.cauchy is not None:
            pull = pull[0] + whole[0], pull[1] + whole[1]
            np.add.at(normal, cut.owner[pieces], cut.area[pieces, None] * cut.normal[pieces])
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / space.h**2
    held = np.tile(np.eye(D), (N, 1, 1))
    carries = np.any(force != 0, axis=1) | np.any(dipole != 0, axis=(1, 2))
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal /= np.where(size > 0, size, 1.0)
    turns = any(entry.traction.nominal is None for entry in tractions)
    area = Present(force.copy(), dipole.copy(), *press, *pull, normal) if turns else Nominal()
    return Load(force, dipole, held, carries, np.zeros(N), ramp_of(*course), rate, float(scale), area)
