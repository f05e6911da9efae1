"""Tractions as the stress that they ask for, faded out inside: what particles balance with the quadrature by which they bear stress.

A face is flat, or round (of a circle, a cylinder or a sphere): depth below it and its normal N are then known everywhere, (N . grad) N = 0. With chi = 1 at
the face and 0 farther than REACH cells inside, exactly (by parts)

    int_face w T dA = int [chi P_T . grad w + w T (N . grad chi + chi div N) + w chi P_T e_r/r (axisymmetric)] dV
                      + int_surface w (T on the face - chi P_T n) dA,   P_T = T N^T

by the particles' points and volumes and by the pieces of surface. The last integral is nothing on sides that stand upright on the face, so at small strain
nothing is left at pieces. What force and first moment then lack (of quadrature) is spread where chi falls.
A pressure whose faded region no other surface bounds but walls that hold the body, and one that acts all around, is P_T = -p 1 instead, and G P_T = -p J F^-T
at any strain, since Div(J F^-T) = 0:  -int [chi p G grad w + w p G grad chi] dV, and -int w chi p G_tt/R dV of the hoop.
Else a face of another form, and the rest of a round one, is loaded at its pieces (ROUGH), as is what a change of area adds to a Cauchy traction (GROWS).
"""

from typing import NamedTuple

import numpy as np

from mpm.integrate.traction import BORNE, GROWS, ROUGH

REACH, WHOLE, ROOM, FLAT = 8.0, 0.25, 0.75, 1e-6  # cells; share of the reach over which chi is 1; share of the body; of a cell
ROUND, OPEN = 0.25, 1e-6  # of a cell, or of its square over the radius; of the area of the face


class Pushed(NamedTuple):
    """Force (N, D) and moment (N, D, D) about the particles at the start; of these what turns with the surface; the hoop's part of the force (N,);
    BORNE, GROWS or ROUGH."""

    force: np.ndarray
    moment: np.ndarray
    turning: np.ndarray
    turning_moment: np.ndarray
    hoop: np.ndarray
    left: float


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


def pushed(cut, pieces, traction, h: float, radial: bool, held: np.ndarray) -> Pushed:
    """A traction on pieces; held (S,): pieces on walls that the body does not leave."""
    whole = at_pieces(cut, pieces, cut.area[pieces, None] * by_area(traction, cut.normal[pieces]))
    none, turns = np.zeros(len(cut.volume)), traction.nominal is None
    other = ~held
    other[pieces] = False
    field = standing(cut, pieces, h)
    if traction.pressure is not None and not other.any():
        return squeezed(cut, traction.pressure, (none + 1, none[:, None] * cut.centroid), np.ones(len(cut.area)), radial)
    if field is None:
        return Pushed(*whole, *whole, none, ROUGH)
    depth, N, bend = field(cut.centroid)
    reach = min(REACH * h, ROOM * float(depth.max()))
    chi, fall = faded(depth, reach)
    below, n, _ = field(cut.point)
    there = faded(below, reach)[0]
    area = cut.area[pieces].sum()
    if traction.pressure is not None and np.sum((cut.area * there)[other]) <= OPEN * area:
        return squeezed(cut, traction.pressure, (chi, fall[:, None] * N), there, radial)
    sloped = there * np.sum(cut.normal * n, axis=1)
    if bend.any() and np.sum((cut.area * np.abs(sloped))[other]) > OPEN * area:
        return Pushed(*whole, *whole, none, ROUGH)
    T, V = by_area(traction, N), cut.volume
    force = (V * (fall + chi * bend))[:, None] * T
    if radial:
        force += (V * chi * N[:, 0] / cut.centroid[:, 0])[:, None] * T
    dipole = (V * chi)[:, None, None] * T[:, :, None] * N[:, None, :]
    each = -(cut.area * sloped)[:, None] * by_area(traction, n)
    each[pieces] += cut.area[pieces, None] * by_area(traction, cut.normal[pieces])
    more = at_pieces(cut, np.arange(len(cut.area)), each)
    made = evened(cut, (force + more[0], dipole + more[1]), totals(cut, *whole), V * fall)
    return Pushed(*made, *whole, none, GROWS if turns else BORNE)


def squeezed(cut, p: float, fade, there, radial: bool) -> Pushed:
    """A pressure as a stress -p chi; fade: chi (N,) and its gradient (N, D); there: chi at all pieces."""
    (chi, slope), V, every = fade, cut.volume, np.arange(len(cut.area))
    force, dipole, hoop = -p * V[:, None] * slope, (-p * V * chi)[:, None, None] * np.eye(slope.shape[1]), np.zeros(len(V))
    if radial:
        hoop = -p * V * chi / cut.centroid[:, 0]
        force[:, 0] += hoop
    if slope.any():
        wanted = at_pieces(cut, every, (-p * cut.area * there)[:, None] * cut.normal)
        force, dipole = evened(cut, (force, dipole), totals(cut, *wanted), V * np.linalg.norm(slope, axis=1))
    turning = force.copy()
    turning[:, 0] -= hoop
    return Pushed(force, dipole, turning, dipole, hoop, BORNE)


def totals(cut, force, moment) -> tuple[np.ndarray, np.ndarray]:
    """Force (D,) and first moment (D, D) of all particles."""
    return force.sum(axis=0), np.einsum("pc,pd->cd", force, cut.centroid) + moment.sum(axis=0)


def evened(cut, made, wanted, weight) -> tuple[np.ndarray, np.ndarray]:
    """Forces and moments with the totals that are wanted, what lacks spread by weight (N,)."""
    (force, dipole), share = made, weight / np.sum(weight)
    force = force + np.outer(share, wanted[0] - force.sum(axis=0))
    return force, dipole + share[:, None, None] * (wanted[1] - totals(cut, force, dipole)[1])


def standing(cut, pieces, h: float):
    """x (Q, D) -> (depth below the face (Q,), its normal there (Q, D), div N (Q,)) of a flat or a round face; None for another."""
    normal, point, area = cut.normal[pieces], cut.point[pieces], cut.area[pieces]
    mean = np.average(normal, axis=0, weights=area)
    front = point @ mean
    if np.linalg.norm(mean) >= 1 - FLAT and np.ptp(front) <= FLAT * h:
        return lambda x: (front.mean() - x @ mean, np.broadcast_to(mean, x.shape), np.zeros(len(x)))
    size, axes = np.linalg.eigh(np.einsum("s,sc,sd->cd", area, normal, normal) / area.sum())
    E = axes[:, size > FLAT]  # directions in which it bends
    (flat, up), k = (point @ E, normal @ E), E.shape[1]
    rows = np.concatenate([np.tile(np.eye(k), (len(flat), 1)), up.reshape(-1, 1)], axis=1)
    *centre, radius = np.linalg.lstsq(rows, flat.ravel(), rcond=None)[0]
    away = flat - centre - radius * up
    if k < 2 or radius == 0 or np.abs(away).max() > min(ROUND * h, h * h / abs(radius)):
        return None
    outward, radius = np.sign(radius), np.average(np.linalg.norm(flat - centre, axis=1), weights=area)

    def round_(x):
        away = x @ E - centre
        r = np.maximum(np.linalg.norm(away, axis=1), FLAT * h)
        return outward * (radius - r), outward * (away / r[:, None]) @ E.T, outward * (k - 1) / r

    return round_


def faded(depth, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """(chi, N . grad chi = -d chi/d depth) at depths below a face: 1 to WHOLE of the reach, then 1 - 3 s^2 + 2 s^3."""
    span = (1 - WHOLE) * reach
    s = np.clip((depth - WHOLE * reach) / span, 0, 1)
    return 1 - s * s * (3 - 2 * s), 6 * s * (1 - s) / span
