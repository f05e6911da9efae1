"""New surface where a body tears: the faces between neighbouring particle cells, which exchange nothing until they come apart.

A face is one of the reference lattice, a piece of surface on either side of it, of area zero while it is shut. It opens, once, when
    its two particles no longer share a node of the grid (no force and no heat passes between them), and
    no particle of the body lies within a cell of the middle between the two faces (they have not slid past one another).
From then on both pieces have the face's area, carried by Nanson as any other, and meet what acts on their side of the body.
Exact     a cut along lattice planes of a box: the areas of both ends (tests/integrate/test_fracture_surface.py)
Fails when   a cut runs aslant: its area is that of the lattice faces, up to sqrt(D) too large; a gap narrower than the splines' support (quadratic: 3 cells).
"""

from dataclasses import dataclass

import numpy as np

from mpm.state import Cubic, Linear, Quadratic

NEAR = 1.0  # cells
NODES = {Linear: 2, Quadratic: 3, Cubic: 4}  # a direction


@dataclass(frozen=True)
class Seams:
    """Faces that may open, by their pieces: particles may be renumbered, pieces are not."""

    piece: np.ndarray  # (M, 2) in the body's Surface
    area: np.ndarray  # (M, 2, D) reference area times outward normal

    def torn(self, body) -> np.ndarray:
        """Which are open (M,)."""
        return np.any(body.surface.area[self.piece[:, 0]] != 0.0, axis=1)


def faces(body, piece: np.ndarray) -> np.ndarray:
    """Where pieces are now (P, D)."""
    surface = body.surface
    owner = surface.owner[piece]
    return body.particles.x[owner].astype(float) + np.einsum("pij,pj->pi", surface.F[surface.row[owner]].astype(float), surface.offset[piece])


def company(x, places, distance: float) -> np.ndarray:
    """Which `places` (M, D), all of them between points x (N, D), have a point within `distance`."""
    low = x.min(axis=0) - distance
    cell, home = (np.floor((a - low) / distance).astype(int) for a in (x, places))
    shape = tuple(np.maximum(cell.max(axis=0), home.max(axis=0)) + 2)
    key = np.ravel_multi_index(cell.T, shape)
    order = np.argsort(key)
    found = np.zeros(len(places), dtype=bool)
    for shift in np.ndindex(*[3] * x.shape[1]):
        there = np.ravel_multi_index((home + np.array(shift) - 1).T, shape, mode="clip")
        first, last = np.searchsorted(key[order], there, "left"), np.searchsorted(key[order], there, "right")
        owner = np.repeat(np.arange(len(places)), last - first)
        point = order[np.arange(len(owner)) - np.repeat(np.cumsum(last - first) - last, last - first)]
        found[owner[np.sum((x[point] - places[owner]) ** 2, axis=1) <= distance**2]] = True
    return found


def tear(space, body, seams: Seams) -> int:
    """Open what has come apart; the number of faces opened."""
    shut = np.flatnonzero(~seams.torn(body))
    pieces, x = seams.piece[shut], body.particles.x.astype(float)
    ends = x[body.surface.owner[pieces]] / space.h
    reach = NODES[type(space.basis)]
    base = np.floor(ends + 0.5 * (reach % 2))
    far = np.flatnonzero(np.any(np.abs(base[:, 1] - base[:, 0]) >= reach, axis=1))
    if len(far) == 0:
        return 0
    middle = 0.5 * (faces(body, pieces[far, 0]) + faces(body, pieces[far, 1]))
    apart = far[~company(x, middle, NEAR * space.h)]
    body.surface.area[seams.piece[shut[apart]]] = seams.area[shut[apart]]
    return len(apart)


def tear_open(scene) -> None:
    """Open what has come apart in every body that may tear."""
    for body, seams in zip(scene.bodies, scene.seams, strict=False):
        if seams is not None:
            tear(scene.space, body, seams)
