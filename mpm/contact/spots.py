"""The nodes around a particle with weights and the gradient operator of the run; ghost nodes of mirror walls stand for their images.

A mirrored vector has the image's components times `sign`: -1 for what the wall holds, +1 else, 0 for what is held on the wall's own plane.
"""

import numpy as np

from mpm.basis import inverse_moment, stencil
from mpm.boundary import CONTACT, directions, extents
from mpm.boundary.walls import held
from mpm.jit import kernel
from mpm.lanes import four, item, put, splat4, store
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


@kernel
def new_places(space):
    """Scratch of `places`."""
    return np.zeros((3, seen(space)), np.int64)


@kernel(inline=True)
def image(walls, a, n, i):
    """The node that stands for node i of n along direction a, and the side of its mirror: 0, 1, or -1 where a node stands for itself."""
    if walls[a, 0] < CONTACT and i <= PAD:
        return 2 * PAD - i, 0
    if walls[a, 1] < CONTACT and i >= n - 1 - PAD:
        return 2 * (n - 1 - PAD) - i, 1
    return i, -1


@kernel(inline=True)
def beside(walls, a, n, i, reach):
    """Whether any of `reach` nodes from i on, of n along direction a, may be one that another stands for."""
    return (walls[a, 0] < CONTACT and i <= PAD) or (walls[a, 1] < CONTACT and i + reach >= n - PAD)


@kernel(inline=True)
def places(space, walls, home, place):
    """The places (3, reach) that `along` fills, and nothing else. Whether a mirror is in sight."""
    mirrored = False
    for a in range(directions(space)):
        i0, n = stencil(space.basis, home[a] * (1.0 / space.h))[0], extents(space)[a]
        for k in range(seen(space)):
            place[a, k] = i0 + k
        if beside(walls, a, n, i0, seen(space)):
            for k in range(seen(space)):
                place[a, k], side = image(walls, a, n, i0 + k)
                mirrored = mirrored or side >= 0
    return mirrored


@kernel(inline=True)
def along(space, walls, home, spots):
    """Fill what the scratch has per direction, for a particle at `home` (D,) of a body that has mirrors where `walls` (3, 2) say so. Whether one is in sight.

    weights, slopes [1/m] and ways [m] (3, D, reach); places (3, reach), 0 where the space has no such direction; side of the mirror and whether on its plane.
    """
    line, place, mirror = spots
    shape, mirrored, cells = extents(space), False, 1.0 / space.h
    for a in range(directions(space)):
        i0, wa, ga, da, _ = stencil(space.basis, home[a] * cells)
        for k in range(len(wa)):
            line[0, a, k], line[1, a, k], line[2, a, k] = wa[k], ga[k] * cells, da[k] * space.h
            place[a, k], mirror[0, a, k] = i0 + k, -1
        if beside(walls, a, shape[a], i0, len(wa)):
            for k in range(len(wa)):
                place[a, k], mirror[0, a, k] = image(walls, a, shape[a], i0 + k)
                if mirror[0, a, k] >= 0:
                    mirror[1, a, k], mirrored = place[a, k] == i0 + k, True
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
def slopes_at(space, gradient, home, lines):
    """As `along` and `slopes`, for a particle at `home`."""
    own, cells = uses_basis_gradient(gradient), 1.0 / space.h
    scale = 0.0 if own else inverse_moment(space.basis) / space.h
    for a in range(directions(space)):
        _, wa, ga, da, _ = stencil(space.basis, home[a] * cells)
        for k in range(len(wa)):
            lines[0, a, k], lines[1, a, k] = wa[k], ga[k] * cells if own else scale * wa[k] * da[k]


@kernel(inline=True)
def lanes_of(D, x):
    """The D numbers of x as lanes. Put together in registers: a vector that is loaded from where single numbers were just stored waits for all of them."""
    return four(x[0], x[1] if D > 1 else 0.0, x[2] if D > 2 else 0.0, 0.0)


@kernel(inline=True)
def row_of(n, x):
    """The n numbers of x, one to four, as lanes."""
    return four(x[0], x[1] if n > 1 else 0.0, x[2] if n > 2 else 0.0, x[3] if n > 3 else 0.0)


@kernel(inline=True)
def gathered(values, row, at, n):
    """Of n nodes, whose numbers begin at row[at], as lanes."""
    found = splat4(0.0)
    for k in range(n):
        found = put(found, k, values[np.uint64(row[np.uint64(at + k)])])
    return found


@kernel(inline=True)
def gradients(space, gradient, spots, lines):
    """Of each direction, lanes whose products of three are the gradient operator; after `along`."""
    line, own = spots[0], uses_basis_gradient(gradient)
    scale = 0.0 if own else inverse_moment(space.basis) / space.h**2
    for a in range(directions(space)):
        for k in range(seen(space)):
            w, g = line[0, a, k], line[1, a, k] if own else scale * line[0, a, k] * line[2, a, k]
            store(lines, WIDE * (a * seen(space) + k), four(g if a == 0 else w, g if a == 1 else w, g if a == 2 else w, 0.0))


@kernel(inline=True)
def level(space, lines):
    """As `turns` wants them, where nothing turns: one for what is a direction."""
    D = directions(space)
    for k in range(D * seen(space)):
        store(lines, WIDE * k, four(1.0, 1.0 if D > 1 else 0.0, 1.0 if D > 2 else 0.0, 0.0))


@kernel(inline=True)
def turns(space, walls, spots, lines):
    """Turn the lanes of each direction by the signs of a vector on the nodes, whose products of three they are; after `along`."""
    mirror, D = spots[2], directions(space)
    for a in range(D):
        for k in range(seen(space)):
            if mirror[0, a, k] >= 0:
                for c in range(D):
                    if held(walls[a, mirror[0, a, k]], a, c):
                        lines[a, k, c] *= 0.0 if mirror[1, a, k] == 1 else -1.0


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
def products(a):
    """a_2 a_3, a_1 a_3, a_1 a_2."""
    return four(item(a, 1) * item(a, 2), item(a, 0) * item(a, 2), item(a, 0) * item(a, 1), 0.0)


@kernel(inline=True)
def way_to(home, point, shift):
    """What the gradients and the weight are multiplied by for w~ of a point: the way there [m], and one."""
    for c in range(WIDE - 1):
        shift[c] = point[c] - home[c] if c < len(home) else 0.0
    shift[WIDE - 1] = 1.0
