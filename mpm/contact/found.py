"""The contacts of one step, as find.py and tools.py fill them and solve.py reads them."""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.contact.skin import POINT, hoop
from mpm.jit import kernel, role

NEAR, REACH = 0.6, 1.25  # cells: gaps that a step can close; how far faces of another body are looked for
CLEAR = 1e-6  # cells: positions are rounded
STRAY = 0.1  # cells that anything may move before what is near is listed anew
FACING, CORNER, LEVEL, ALIKE = -0.5, -0.2, -0.9, 0.9998  # cosines; the last of one degree
FLAT = 0.01  # cells: pieces that differ no more in their gaps act as one
BODY = 6  # against: 2 axis + side of a wall; BODY + b for body b of B; BODY + B + t for tool t


class Contacts(NamedTuple):
    """Room for C contacts of a piece of A with a wall, a tool or B; sides 0 (A) and 1 (B)."""

    piece: np.ndarray  # (C,) of A; -1: a particle without a piece
    against: np.ndarray  # (C,)
    gap: np.ndarray  # (C,) [m]
    mu: np.ndarray  # (C,) friction; inf: no sliding
    normal: np.ndarray  # (C, D) out of the obstacle
    body: np.ndarray  # (C, 2); -1 for a wall or a tool
    owner: np.ndarray  # (C, 2) particle
    home: np.ndarray  # (C, 2, D) of it [m]
    point: np.ndarray  # (C, 2, D) place of the contact [m]
    balanced: np.ndarray  # (C, 2) whether the weights are balanced with the stress: faces that look along the normal
    given: np.ndarray  # (C, D) velocity of the obstacle there [m/s], less that of a tool which is free
    free: np.ndarray  # (C,) number of a tool that forces move; -1
    over: np.ndarray  # (C,) first node that a level piece sees, to find others over the same nodes; -1
    mates: np.ndarray  # (C,) a piece that acts with `piece` as one, -1; the next one:
    after: np.ndarray  # (P,) of every piece, of the skin


@role(inline=True)
def others(which):
    """Whether there are any: other bodies (pairs.py), tools (tools.py). Else a body meets walls alone."""
    raise TypeError(f"nothing to meet in {type(which).__name__}")


@kernel
def new_contacts(C, D, after):
    """Room for C contacts; after (P,): of the skin."""
    return Contacts(np.empty(C, np.int64), np.empty(C, np.int64), np.empty(C), np.empty(C), np.empty((C, D)), np.empty((C, 2), np.int64),
                    np.empty((C, 2), np.int64), np.empty((C, 2, D)), np.empty((C, 2, D)), np.empty((C, 2), np.uint8), np.empty((C, D)),
                    np.empty(C, np.int64), np.empty(C, np.int64), np.empty(C, np.int64), after)  # fmt: skip


@kernel(inline=True)
def around(space, r):
    """What areas and volumes have been multiplied by: the radius, in an axisymmetric scene."""
    return max(r, 1e-300) if hoop(space) else 1.0


@kernel(inline=True)
def put(found, i, piece, against, gap, mu, who, where, balanced):
    """Write side A of contact i, where there is room; who: body and particle; where: the particle's place and the point that touches."""
    (b, owner), (home, point) = who, where
    found.piece[i], found.against[i], found.gap[i], found.mu[i] = piece, against, gap, mu
    found.body[i, 0], found.body[i, 1], found.owner[i, 0], found.balanced[i, 0], found.balanced[i, 1] = b, -1, owner, balanced, 0
    found.free[i] = found.over[i] = found.mates[i] = -1
    for a in range(len(home)):  # numpy's own way to fill a row compiles the words of its errors
        found.home[i, 0, a], found.point[i, 0, a], found.given[i, a] = home[a], point[a], 0.0


@kernel(inline=True)
def whole(contacts, area, i):
    """The area of all pieces that act as contact i."""
    total, s = area[contacts.piece[i]], contacts.mates[i]
    while s >= 0:
        total, s = total + area[s], contacts.after[s]
    return total


@kernel(inline=True)
def faces(space, skin, s, normal, out):
    """Whether piece s is a face that looks against `out` times the normal (D,) of an obstacle."""
    cosine = 0.0
    for c in range(directions(space)):
        cosine += out * skin.normal[s, c] * normal[c]
    return skin.area[s] > 2 * POINT * space.h ** (directions(space) - 1) and cosine < FACING
