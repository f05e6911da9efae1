"""The nodes around a particle with weights and the gradient operator of the run; ghost nodes of mirror walls stand for their images.

A mirrored vector has the image's components times `sign`: -1 for what the wall holds, +1 else, 0 for what is held on the wall's own plane.
"""

import numpy as np

from mpm.basis import inverse_moment, stencil
from mpm.boundary import CONTACT, directions, extents
from mpm.boundary.walls import held
from mpm.jit import kernel
from mpm.lanes import four, item, store
from mpm.state import PAD
from mpm.transfer import uses_basis_gradient

WIDE = 4  # numbers of a weight: D directions and nothing


@kernel(inline=True)
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
    D, shape, mirrored, cells = directions(space), extents(space), False, 1.0 / space.h
    for a in range(D):
        i0, wa, ga, da, _ = stencil(space.basis, home[a] * cells)
        n = shape[a]
        for k in range(len(wa)):
            line[0, a, k], line[1, a, k], line[2, a, k] = wa[k], ga[k] * cells, da[k] * space.h
            place[a, k], mirror[0, a, k] = i0 + k, -1  # side of the wall; whether on its plane
        if (walls[a, 0] < CONTACT and i0 <= PAD) or (walls[a, 1] < CONTACT and i0 + len(wa) >= n - PAD):
            for k in range(len(wa)):
                i = i0 + k
                if walls[a, 0] < CONTACT and i <= PAD:
                    place[a, k], mirror[0, a, k], mirror[1, a, k], mirrored = 2 * PAD - i, 0, i == PAD, True
                elif walls[a, 1] < CONTACT and i >= n - 1 - PAD:
                    place[a, k], mirror[0, a, k], mirror[1, a, k], mirrored = 2 * (n - 1 - PAD) - i, 1, i == n - 1 - PAD, True
    return mirrored


@kernel
def new_lines(space):
    """Room for what is a product of three numbers a node, one a direction: (3, reach, WIDE), one where the space lacks a direction."""
    return np.ones((3, seen(space), WIDE))


@kernel
def new_slopes(space):
    """Room for `slopes`: (2, 3, reach), weights of one and slopes of nothing where the space lacks a direction."""
    lines = np.zeros((2, 3, seen(space)))
    lines[0] = 1.0
    return lines


@kernel(inline=True)
def slopes(space, gradient, spots, lines):
    """Weights and slopes of each direction: the gradient operator along it is its slope times the weights of the others. After `along`."""
    line, own = spots[0], uses_basis_gradient(gradient)
    scale = 0.0 if own else inverse_moment(space.basis) / space.h**2
    for a in range(directions(space)):
        for k in range(seen(space)):
            lines[0, a, k] = line[0, a, k]
            lines[1, a, k] = line[1, a, k] if own else scale * line[0, a, k] * line[2, a, k]


@kernel(inline=True)
def lanes_of(D, x):
    """The D numbers of x as lanes. Put together in registers: a vector that is loaded from where single numbers were just stored waits for all of them."""
    return four(x[0], x[1] if D > 1 else 0.0, x[2] if D > 2 else 0.0, 0.0)


@kernel(inline=True)
def turns(space, walls, spots, lines):
    """The signs of a vector on the nodes, as products of three, and nothing for what is no direction; after `along`."""
    mirror, D = spots[2], directions(space)
    plain = four(1.0, 1.0 if D > 1 else 0.0, 1.0 if D > 2 else 0.0, 0.0)
    for a in range(D):
        for k in range(seen(space)):
            store(lines, WIDE * (a * seen(space) + k), plain)
            if mirror[0, a, k] >= 0:
                for c in range(D):
                    if held(walls[a, mirror[0, a, k]], a, c):
                        lines[a, k, c] = 0.0 if mirror[1, a, k] == 1 else -1.0


@kernel(inline=True)
def spans(space):
    """How many nodes there are in each of three directions: constants to LLVM, which a length of an array is not."""
    D, reach = directions(space), seen(space)
    return reach, reach if D > 1 else 1, reach if D > 2 else 1


@kernel(inline=True)
def sum4(a):
    """Of all lanes."""
    return (item(a, 0) + item(a, 1)) + (item(a, 2) + item(a, 3))


@kernel(inline=True)
def way_to(home, point, shift):
    """What the gradients and the weight are multiplied by for w~ of a point: the way there [m], and one."""
    for c in range(WIDE - 1):
        shift[c] = point[c] - home[c] if c < len(home) else 0.0
    shift[WIDE - 1] = 1.0
