"""Which nodes hold material: blocks of BLOCK nodes are marked as particles touch them, and only those are updated and cleared.

What is empty in the box around a diagonal strip, or around bodies far apart, costs a look at its marks, a byte for BLOCK nodes. Whether a scene is `thin`
is seen at the opening of a block of steps; where it is not, the whole box is marked at once, which costs less than to look (both give the same bits).
Marks are a byte each, so threads may set them side by side; nodes outside marked blocks are zero.
"""

import numpy as np

from mpm.jit import kernel
from mpm.lanes import poke

BLOCK = 8  # nodes that follow one another in memory
WORD = 8  # marks looked at together
ONE, TWO = np.uintp(1), np.uintp(2)


def new_blocks(n: int) -> np.ndarray:
    """Marks of two buffers of n nodes, none set (2, a whole number of words)."""
    return np.zeros((2, -(-n // (BLOCK * WORD)) * WORD), np.uint8)


@kernel(inline=True)
def long_rows(D, shape, box):
    """A box of nodes with the direction that runs fastest last: bounds of three directions, and nodes in the last two."""
    if D == 1:
        return 0, 1, 0, 1, box[0, 0], box[0, 1], 1, shape[0]
    if D == 2:
        return 0, 1, box[0, 0], box[0, 1], box[1, 0], box[1, 1], shape[0], shape[1]
    return box[0, 0], box[0, 1], box[1, 0], box[1, 1], box[2, 0], box[2, 1], shape[1], shape[2]


@kernel(inline=True)
def marks_of(D, shape, box):
    """About how many marks a box needs."""
    i0, i1, j0, j1, k0, k1, _, _ = long_rows(D, shape, box)
    return (i1 - i0) * (j1 - j0) * ((k1 - k0) // BLOCK + 2)


@kernel(inline=True)
def mark_box(blocks, D, shape, box):
    """Mark the blocks of one buffer that a box of nodes reaches into."""
    i0, i1, j0, j1, k0, k1, columns, length = long_rows(D, shape, box)
    for i in range(i0, i1):
        for j in range(j0, j1):
            at = (i * columns + j) * length
            first, last = np.uintp((at + k0) // BLOCK), np.uintp((at + k1 - 1) // BLOCK)
            blocks[first] = blocks[(first + last) >> ONE] = blocks[last] = 1  # mostly two or three: no loop for those
            if last > first + TWO:
                for b in range(first + ONE, last):
                    blocks[b] = 1


@kernel
def thin(shape, box, blocks):
    """Whether less than half of the nodes of a box lie in marked blocks."""
    (at, end), marked = span(shape, box), 0
    for b in range(at, end):
        marked += int(blocks[b])  # a byte runs over in plain Python
    return 2 * BLOCK * marked < (box[0, 1] - box[0, 0]) * (box[1, 1] - box[1, 0]) * (box[2, 1] - box[2, 0])


@kernel(inline=True)
def span(shape, box):
    """First block of a box and the one after its last."""
    first = (box[0, 0] * shape[1] + box[1, 0]) * shape[2] + box[2, 0]
    last = ((box[0, 1] - 1) * shape[1] + box[1, 1] - 1) * shape[2] + box[2, 1] - 1
    return first // BLOCK, last // BLOCK + 1


@kernel(inline=True)
def run(blocks, words, at, end):
    """The first run of marked blocks from `at` on, before `end`: its first and the one after its last, both `end` where there is none."""
    while at < end and blocks[at] == 0:
        at += WORD if at % WORD == 0 and words[at // WORD] == 0 else 1
    first = min(at, end)
    at = first
    while at < end and blocks[at] != 0:
        at += 1
    return first, at


@kernel
def wipe(nodes, shape, box, blocks):
    """Zero the nodes of the marked blocks within a box."""
    words, (at, end), wide = blocks.view(np.uint64), span(shape, box), nodes.shape[1]
    while at < end:
        first, at = run(blocks, words, at, end)
        for k in range(BLOCK * first * wide, min(BLOCK * at, nodes.shape[0]) * wide):
            poke(nodes, k, 0.0)


@kernel
def forget(shape, box, blocks):
    """Take the marks of a box away."""
    words, (at, end) = blocks.view(np.uint64), span(shape, box)
    for k in range(at // WORD, (end - 1) // WORD + 1):
        words[k] = 0
