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


@kernel
def seen(space):
    """Nodes that a particle sees in one direction."""
    return len(stencil(space.basis, 0.5)[1])


@kernel
def new_spots(space):
    """Scratch of `spot`: nodes at (M,), weights w (M,), gradients G (D, M), ways (D, M) from the particle, signs (D, M), and per direction (`along`)."""
    D, reach = directions(space), seen(space)
    M = reach**D
    line, place, mirror = np.empty((3, D, reach)), np.zeros((3, reach), np.int64), np.empty((2, D, reach), np.int64)
    return np.empty(M, np.int64), np.empty(M), np.empty((D, M)), np.empty((D, M)), np.empty((D, M)), line, place, mirror


@kernel(inline=True)
def along(space, walls, home, spots):
    """Fill what the scratch has per direction, for a particle at `home` (D,) of a body that has mirrors where `walls` (3, 2) say so. Whether one is in sight.

    weights, slopes [1/m] and ways [m] (3, D, reach); places (3, reach), 0 where the space has no such direction; side of the mirror and whether on its plane.
    """
    line, place, mirror = spots[5], spots[6], spots[7]
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


@kernel(inline=True)
def spot(space, gradient, walls, home, spots):
    """Fill the scratch for a particle at `home`, as `along`."""
    at, w, G, way, sign, line, place, mirror = spots
    D, shape, reach = directions(space), extents(space), place.shape[1]
    mirrored = along(space, walls, home, spots)
    own = uses_basis_gradient(gradient)
    scale = 0.0 if own else inverse_moment(space.basis) / space.h**2
    at[0], w[0], size = 0, 1.0, 1
    for c in range(D):
        G[c, 0], way[c, 0] = 1.0, 0.0
    for a in range(D):  # products, one direction after another, from the last on: what is read is not yet written over
        for m in range(size - 1, -1, -1):
            n, weight = at[m] * shape[a], w[m]
            for k in range(reach):
                at[m * reach + k], w[m * reach + k] = n + place[a, k], weight * line[0, a, k]
        for c in range(D):
            row = 1 if own and c == a else 0
            for m in range(size - 1, -1, -1):
                slope, there = G[c, m], way[c, m]
                for k in range(reach):
                    if own:
                        G[c, m * reach + k] = slope * line[row, a, k]
                    way[c, m * reach + k] = line[2, a, k] if c == a else there
        size *= reach
    for c in range(D):
        for m in range(size):
            sign[c, m] = 1.0
            if not own:
                G[c, m] = scale * w[m] * way[c, m]
    if mirrored:
        flip(walls, mirror, sign)
    return mirrored


@kernel
def flip(walls, mirror, sign):
    """Signs of nodes that stand for ghosts, or lie on a mirror's own plane."""
    (D, M), reach = sign.shape, mirror.shape[2]
    for m in range(M):
        rest, stride = m, M
        for a in range(D):
            stride //= reach
            k = rest // stride
            rest -= k * stride
            if mirror[0, a, k] >= 0:
                for c in range(D):
                    if held(walls[a, mirror[0, a, k]], a, c):
                        sign[c, m] *= 0.0 if mirror[1, a, k] == 1 else -1.0


@kernel(inline=True)
def pulls(space, gradient, walls, home, spots, lines):
    """What a particle's stress puts on its nodes, per volume, as products of three: lines (3, reach, WIDE), components last; after `along`.

    G_ip with the signs of mirrors, and in an axisymmetric body w/r along r. Where the space lacks a direction its first line stays one.
    """
    line, mirror, D, own = spots[5], spots[7], directions(space), uses_basis_gradient(gradient)
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
