"""The nodes around a particle with weights and the gradient operator of the run; ghost nodes of mirror walls stand for their images.

A mirrored vector has the image's components times `sign`: -1 for what the wall holds, +1 else, 0 for what is held on the wall's own plane.
"""

import numpy as np

from mpm.basis import inverse_moment, stencil
from mpm.boundary import CONTACT, directions, extents
from mpm.boundary.walls import held
from mpm.contact.skin import hoop
from mpm.jit import kernel
from mpm.state import PAD
from mpm.transfer import uses_basis_gradient

WIDE = 4  # numbers of a weight: D directions and nothing


@kernel
def seen(space):
    """Nodes that a particle sees in one direction."""
    return len(stencil(space.basis, 0.5)[1])


@kernel
def new_spots(space):
    """Scratch of `along`."""
    D, reach = directions(space), seen(space)
    return np.empty((3, D, reach)), np.zeros((3, reach), np.int64), np.empty((2, D, reach), np.int64)


@kernel(inline=True)
def along(space, walls, home, spots):
    """Fill what the scratch has per direction, for a particle at `home` (D,) of a body that has mirrors where `walls` (3, 2) say so. Whether one is in sight.

    weights, slopes [1/m] and ways [m] (3, D, reach); places (3, reach), 0 where the space has no such direction; side of the mirror and whether on its plane.
    """
    line, place, mirror = spots
    D, shape, mirrored = directions(space), extents(space), False
    for a in range(D):
        i0, wa, ga, da, _ = stencil(space.basis, home[a] / space.h)
        for k in range(len(wa)):
            i, n = i0 + k, shape[a]
            line[0, a, k], line[1, a, k], line[2, a, k] = wa[k], ga[k] / space.h, da[k] * space.h
            mirror[0, a, k] = mirror[1, a, k] = -1  # side of the wall; whether on its plane
            if walls[a, 0] < CONTACT and i <= PAD:
                i, mirror[0, a, k], mirror[1, a, k] = 2 * PAD - i, 0, i == PAD
            elif walls[a, 1] < CONTACT and i >= n - 1 - PAD:
                i, mirror[0, a, k], mirror[1, a, k] = 2 * (n - 1 - PAD) - i, 1, i == n - 1 - PAD
            mirrored = mirrored or mirror[0, a, k] >= 0
            place[a, k] = i
    return mirrored


@kernel
def new_lines(space):
    """Room for what is a product of three numbers a node, one a direction: (3, reach, WIDE), one where the space lacks a direction."""
    return np.ones((3, seen(space), WIDE))


@kernel(inline=True)
def slopes(space, gradient, spots, lines):
    """The gradient operator of a particle and, last, its weights, as products of three; after `along`."""
    line, own = spots[0], uses_basis_gradient(gradient)
    scale = 0.0 if own else inverse_moment(space.basis) / space.h**2
    for a in range(directions(space)):
        for k in range(lines.shape[1]):
            for c in range(WIDE):
                lines[a, k, c] = line[0, a, k]
            lines[a, k, a] = line[1, a, k] if own else scale * line[0, a, k] * line[2, a, k]


@kernel(inline=True)
def turns(space, walls, spots, lines):
    """The signs of a vector on the nodes, as products of three, and nothing for what is no direction; after `along`."""
    mirror, D = spots[2], directions(space)
    for a in range(D):
        for k in range(lines.shape[1]):
            for c in range(WIDE):
                lines[a, k, c] = 1.0 if c < D else 0.0
                if c < D and mirror[0, a, k] >= 0 and held(walls[a, mirror[0, a, k]], a, c):
                    lines[a, k, c] = 0.0 if mirror[1, a, k] == 1 else -1.0


@kernel(inline=True)
def pulls(space, gradient, walls, home, spots, lines):
    """What a particle's stress puts on its nodes, per volume, as products of three: lines (3, reach, WIDE), components last; after `along`.

    G_ip with the signs of mirrors, and in an axisymmetric body w/r along r. Where the space lacks a direction its first line stays one.
    """
    line, mirror, D, own = spots[0], spots[2], directions(space), uses_basis_gradient(gradient)
    scale = 0.0 if own else inverse_moment(space.basis) / space.h**2
    for a in range(D):
        for k in range(mirror.shape[2]):
            for c in range(D):
                pull = line[0, a, k]
                if c == a:
                    pull = line[1, a, k] if own else scale * line[0, a, k] * line[2, a, k]
                    if hoop(space) and a == 0:
                        pull += line[0, a, k] / home[0]
                if mirror[0, a, k] >= 0 and held(walls[a, mirror[0, a, k]], a, c):
                    pull *= 0.0 if mirror[1, a, k] == 1 else -1.0
                lines[a, k, c] = pull
