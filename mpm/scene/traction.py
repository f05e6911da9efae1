"""Loads of a config to the run-time Load of a body: forces and their moments about the particles.

A traction T on a flat face of normal N acts as the stress P_T = T N^T that it asks for, faded out inside, so that particles balance it with the quadrature by
which they bear it: with chi = 1 at the face and 0 farther than REACH cells inside, exactly (by parts)

    int_face w T dA = int [chi P_T . grad w + w T (N . grad chi) + w chi P_T e_r/r (axisymmetric)] dV + int_surface w (T on the face - chi P_T n) dA

by the particles' points and volumes and by the pieces of surface; what force and first moment then lack (of quadrature) is spread where chi falls. A load on a
face that is not flat acts at its pieces.
"""

import numpy as np

from mpm.basis import inverse_moment
from mpm.scene.menus import pulling
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import on_side
from mpm.state import Axisymmetric, Load, NoSource
from mpm.transfer import uses_basis_gradient


def one_ramp(experiment, name: str, tractions) -> set[float]:
    """The ramp of the tractions on one body; SceneError where they have several."""
    ramps = {entry.traction.ramp for entry in tractions}
    if len(ramps) > 1:
        said = f"the tractions on {name} have ramps of {', '.join(f'{ramp:g} s' for ramp in sorted(ramps))}: give them the same"
        raise SceneError(("loads", experiment.loads.index(tractions[-1]), "traction"), said)
    return ramps


REACH, WHOLE, ROOM, FLAT = 8.0, 0.25, 0.75, 1e-6  # cells; share of the reach over which chi is 1; share of the body; of a cell


def at_pieces(cut, pieces, each) -> tuple[np.ndarray, np.ndarray]:
    """(force (N, D), moment (N, D, D)) about the particles of forces `each` (S, D) at pieces."""
    N, D = cut.centroid.shape
    force, dipole, owner = np.zeros((N, D)), np.zeros((N, D, D)), cut.owner[pieces]
    np.add.at(force, owner, each)
    np.add.at(dipole, owner, each[:, :, None] * (cut.point[pieces] - cut.centroid[owner])[:, None, :])
    return force, dipole


def pushed(cut, pieces, T, h: float, radial: bool) -> tuple[np.ndarray, np.ndarray]:
    """(force, moment) of a traction T on pieces."""
    whole = at_pieces(cut, pieces, cut.area[pieces, None] * T)
    normal = np.average(cut.normal[pieces], axis=0, weights=cut.area[pieces])
    size = float(np.linalg.norm(normal))
    depth = -(cut.centroid @ normal)
    front = cut.point[pieces] @ normal
    if size < 1 - FLAT or np.ptp(front) > FLAT * h:
        return whole
    depth += front.mean()
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
    """The Load of one body; NoSource where nothing acts on it."""
    entries = [entry for entry in experiment.loads if entry.of == name]
    tractions, rate = pulling(entries)
    if not tractions and rate == 0:
        return NoSource()
    ramps = one_ramp(experiment, name, tractions)
    N, D = cut.centroid.shape
    force, dipole, radial = np.zeros((N, D)), np.zeros((N, D, D)), isinstance(space, Axisymmetric)
    for entry in tractions:
        pieces = np.flatnonzero(on_side(cut.normal, entry.side))
        if len(pieces) == 0:
            raise SceneError(("loads", experiment.loads.index(entry)), f"{name} has no surface on its side {entry.side!r}: nothing would be loaded")
        one, moment = pushed(cut, pieces, np.array(entry.traction.nominal), space.h, radial)
        force, dipole = force + one, dipole + moment
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / space.h**2
    held = np.tile(np.eye(D), (N, 1, 1))
    carries = np.any(force != 0, axis=1) | np.any(dipole != 0, axis=(1, 2))
    return Load(force, dipole, held, carries, np.zeros(N), max(ramps, default=0.0), rate, float(scale))
