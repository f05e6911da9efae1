"""Where the pieces of all bodies' surfaces are now: x_s = x_p + F D, S n = J F^-T A (as heat/surface.py, with the normal)."""

from typing import NamedTuple

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions
from mpm.jit import kernel, role
from mpm.lanes import fetch_ahead
from mpm.state import Axisymmetric, Line, NoExchange, Plane, Surface, Volume

AHEAD = 8  # pieces whose particles begin to come from memory
POINT = 1e-9  # of a face of a cell: the area of a piece that is a corner


class Skin(NamedTuple):
    """P pieces of all bodies, one body after another."""

    x: np.ndarray  # (P, D) where they are [m]
    normal: np.ndarray  # (P, D) unit, outward
    area: np.ndarray  # (P,) [m^(D-1)]; 0: shut
    home: np.ndarray  # (P, D) their particles
    owner: np.ndarray  # (P,) number of the particle
    body: np.ndarray  # (P,)
    first: np.ndarray  # (bodies + 1,) first piece of each body
    after: np.ndarray  # (P,) the next of the pieces that act as one (found.py)
    every: np.ndarray  # (P,) their numbers
    near: np.ndarray  # (P,) those that may be near something, for a while (find.py), of one body after another from
    starts: np.ndarray  # (bodies + 1,) on
    lone: np.ndarray  # (bodies,) whether particles without pieces may be
    left: np.ndarray  # (1,) how far anything may move until they are listed anew [m]
    sight: np.ndarray  # (1,) how far before a wall contacts are looked for [m]


def new_skin(D, first):
    """Room for the pieces of bodies that begin at `first`; nothing listed yet."""
    P = first[-1]  # pieces that are still to come stay shut
    skin = Skin(np.zeros((P, D)), np.zeros((P, D)), np.zeros(P), np.zeros((P, D)), np.zeros(P, np.int64), np.empty(P, np.int64), first,
                np.empty(P, np.int64), np.arange(P), np.arange(P), first.copy(), np.ones(len(first) - 1, np.bool_), np.full(1, -1.0),
                np.full(1, 1e300))  # fmt: skip
    for b in range(len(first) - 1):
        skin.body[first[b] : first[b + 1]] = b
    return skin


@kernel
def lay_skins(space, bodies, skin, some, starts):
    """Fill the skin from the bodies: pieces `some`, of body b from starts[b] on."""
    b = 0
    for body in literal_unroll(bodies):
        lay_skin(body.surface, space, body, skin, skin.first[b], some[starts[b] : starts[b + 1]])
        b += 1


@role
def lay_skin(surface, space, body, skin, first, some):
    """Pieces `some` of one body, whose numbers begin at `first`."""
    raise TypeError(f"no pieces of {type(surface).__name__}")


@lay_skin.register(NoExchange)
def lay_skin_no_exchange(surface, space, body, skin, first, some):
    return None


@lay_skin.register(Surface)
def lay_skin_surface(surface, space, body, skin, first, some):
    D, x, J = directions(space), body.particles.x, body.particles.J
    for at in range(len(some)):
        k = some[at]
        s, later = k - first, some[min(at + AHEAD, len(some) - 1)] - first
        if later < surface.owner.shape[0]:  # what its pieces stand by is strewn over the state of the body
            fetch_ahead(x, D * surface.owner[later])
            fetch_ahead(J, surface.owner[later])
            fetch_ahead(surface.F, D * D * surface.row[surface.owner[later]])
        if s >= surface.owner.shape[0]:  # still to come
            break
        p = surface.owner[s]
        F, A, o = surface.F[surface.row[p]], surface.area[s], surface.offset[s]
        skin.owner[k] = p
        for a in range(D):
            skin.home[k, a] = x[p, a]
            there = float(x[p, a])
            for c in range(D):
                there += F[a, c] * o[c]
            skin.x[k, a] = there
        if D == 1:
            skin.normal[k, 0] = A[0]
        elif D == 2:
            out = J[p] / (F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0])
            skin.normal[k, 0], skin.normal[k, 1] = out * (F[1, 1] * A[0] - F[1, 0] * A[1]), out * (F[0, 0] * A[1] - F[0, 1] * A[0])
        else:
            for a in range(3):
                b, c, total = (a + 1) % 3, (a + 2) % 3, 0.0
                for i in range(3):
                    j, k2 = (i + 1) % 3, (i + 2) % 3
                    total += (F[b, j] * F[c, k2] - F[b, k2] * F[c, j]) * A[i]
                skin.normal[k, a] = total
        size = 0.0
        for a in range(D):
            size += skin.normal[k, a] ** 2
        size = size**0.5
        skin.area[k] = size
        for a in range(D):
            skin.normal[k, a] /= max(size, 1e-300)


@role
def hoop(space):
    """Whether the first direction is a radius."""
    raise TypeError(f"no directions of {type(space).__name__}")


@hoop.register(Line)
@hoop.register(Plane)
@hoop.register(Volume)
def hoop_volume_or_plane_or_line(space):
    return False


@hoop.register(Axisymmetric)
def hoop_axisymmetric(space):
    return True
