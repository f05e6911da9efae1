"""Slip and stick walls on the faces of the domain.

With a ghost node g outside a wall (PAD of them, so that any basis finds its own) and its image i inside: fold  m_i += m_g, p_i += s p_g  with s = -1
for the components that the wall holds (the normal one; all of them at a stick wall) and +1 for the others; the wall's own node carries v = 0 in the
held components; unfold  v_g = s v_i.
This is the mirrored body written down, so it conserves mass, and heat (s = +1: insulated) exactly.
Contact walls do nothing here (mpm.contact). A stop, for measurements beside peers only: v_n = max(v_n, 0) inwards at and behind the wall.
"""

from mpm.boundary import CONTACT, STICK, STOP
from mpm.boundary.blocks import BLOCK
from mpm.jit import kernel
from mpm.lanes import poke
from mpm.state import PAD


@kernel
def held(kind, axis, component):
    """Whether a wall across `axis` holds `component`."""
    return kind == STICK or component == axis


@kernel
def fold(nodes, components, shape, box, walls, blocks=None):
    """Fold `components` vector components, and every further column (mass) evenly, of the ghost planes on to their images. Grows `box` to the images.

    With `blocks` (mpm.boundary.blocks) what is not marked is known to be zero, and what is written is marked; `unfold` likewise.
    """
    for axis in range(3):
        if shape[axis] == 1:
            continue
        for side in range(2):
            if walls[axis, side] >= CONTACT:
                continue
            wall = PAD if side == 0 else shape[axis] - 1 - PAD
            for k in range(1, PAD + 1):
                out = -k if side == 0 else k
                if not (box[axis, 0] <= wall + out < box[axis, 1]):
                    continue
                box[axis, 0], box[axis, 1] = min(box[axis, 0], wall - out), max(box[axis, 1], wall - out + 1)
                mirror_plane(nodes, components, shape, box, axis, wall + out, wall - out, walls[axis, side], True, blocks)


@kernel
def unfold(nodes, components, shape, box, walls, blocks=None):
    """Continue nodal values to the ghost planes by reflection."""
    for axis in range(2, -1, -1):
        if shape[axis] == 1:
            continue
        for side in range(2):
            if walls[axis, side] >= CONTACT:
                continue
            wall = PAD if side == 0 else shape[axis] - 1 - PAD
            for k in range(1, PAD + 1):
                out = -k if side == 0 else k
                if box[axis, 0] <= wall + out < box[axis, 1]:
                    mirror_plane(nodes, components, shape, box, axis, wall + out, wall - out, walls[axis, side], False, blocks)


@kernel
def mirror_plane(nodes, components, shape, box, axis, ghost, image, kind, add, blocks):
    """Add the ghost plane to its image (`add`), or copy the image to the ghost plane."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    stride = (shape[1] * shape[2], shape[2], 1)
    for i in range(box[a, 0], box[a, 1]):
        for j in range(box[b, 0], box[b, 1]):
            base = i * stride[a] + j * stride[b]
            g, n = base + ghost * stride[axis], base + image * stride[axis]
            if blocks is not None:
                if blocks[(g if add else n) // BLOCK] == 0:
                    continue
                blocks[(n if add else g) // BLOCK] = 1
            for c in range(nodes.shape[1]):
                sign = -1.0 if c < components and held(kind, axis, c) else 1.0
                if add:
                    nodes[n, c] += sign * nodes[g, c]
                else:
                    nodes[g, c] = sign * nodes[n, c]


@kernel
def impose(nodes, components, shape, box, walls):
    """Hold the velocity components that each wall holds, on its own plane; behind a stop, none moves outwards."""
    stride = (shape[1] * shape[2], shape[2], 1)
    for axis in range(3):
        if shape[axis] == 1:
            continue
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for side in range(2):
            kind = walls[axis, side]
            if kind == CONTACT:
                continue
            wall = PAD if side == 0 else shape[axis] - 1 - PAD
            first, last = (wall, wall + 1)
            if kind == STOP:
                first, last = (0, wall + 1) if side == 0 else (wall, shape[axis])
            for k in range(max(first, box[axis, 0]), min(last, box[axis, 1])):
                for i in range(box[a, 0], box[a, 1]):
                    for j in range(box[b, 0], box[b, 1]):
                        n = i * stride[a] + j * stride[b] + k * stride[axis]
                        for c in range(components):
                            if kind == STOP:
                                if c == axis:
                                    nodes[n, c] = max(nodes[n, c], 0.0) if side == 0 else min(nodes[n, c], 0.0)
                            elif held(kind, axis, c):
                                nodes[n, c] = 0.0


@kernel
def clear(nodes, shape, box):
    """Zero the nodes of the box, then empty the box."""
    for i in range(box[0, 0], box[0, 1]):
        for j in range(box[1, 0], box[1, 1]):
            row = (i * shape[1] + j) * shape[2]
            for k in range((row + box[2, 0]) * nodes.shape[1], (row + box[2, 1]) * nodes.shape[1]):
                poke(nodes, k, 0.0)
    empty(shape, box)


@kernel
def empty(shape, box):
    """A box that the first particle will grow; directions that the space lacks span their one node."""
    for axis in range(3):
        if shape[axis] == 1:
            box[axis, 0], box[axis, 1] = 0, 1
        else:
            box[axis, 0], box[axis, 1] = shape[axis], 0
