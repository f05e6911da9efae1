"""Particles in the order of the nodes that they touch, where that pays: neighbours in memory are neighbours in space.

A body is sorted (counting sort by its first node, stable) where more than MIXED of its particles come more than FAR rows of nodes after the one before them;
looked at before a block of steps, at the start of an output interval and after that when the fastest particle may have moved a cell, EVERY steps at least.
That depends on positions and counts alone, so a run that was cut goes on with the same bits. At output times the original order is restored.
Bodies are sampled cell by cell (mpm.scene.build) and stay as they were sampled while they are not mixed. At 1e5 particles in 3-D
random order costs 1.2 (float32) to 1.4 (float64) of the time where it is left (`mpm bench --order shuffle` with LEAST out of reach), 1.01 where it is
sorted, sorting counted (`python -m mpm.benchmarks.speed --only random`).
Bodies of less than LEAST particles, or in one direction, are left alone: they stay in the cache.

Scenes of SHARED particles and more are cut into slabs (step_threaded.py), about equally full: there particles are sorted by slab, and within it by node.
"""

from typing import Any

import numpy as np

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.jit import kernel
from mpm.state import PER_PARTICLE, Surface

LEAST = 10_000
MIXED, FAR = 0.1, 4
EVERY = 16
SHARED, GAP, FULL = 200_000, 2, 4096  # particles of a scene in slabs; nodes between a slab and the next but one; particles a slab, at least


@kernel
def first_nodes(space, x):
    """Index of the first node that each particle touches (N,)."""
    shape, out = extents(space), np.empty(x.shape[0], np.int64)
    inverse = 1.0 / space.h
    for i in range(x.shape[0]):
        node = 0
        for a in range(x.shape[1]):
            first = stencil(space.basis, x[i, a] * inverse)[0]
            node = node * shape[a] + min(max(first, 0), shape[a] - 1)
        out[i] = node
    return out


@kernel
def mixed(nodes, far):
    """Share of particles more than `far` nodes away from the one before."""
    jumps = 0
    for i in range(1, nodes.shape[0]):
        jumps += abs(nodes[i] - nodes[i - 1]) > far
    return jumps / nodes.shape[0]


@kernel
def sorting(values):
    """The permutation that sorts whole numbers, equal ones in the order they had: values[sorting(values)] rises."""
    low = high = values[0]
    for i in range(values.shape[0]):  # numpy's min and max take Numba longer than all the rest
        low, high = min(low, values[i]), max(high, values[i])
    places = np.zeros(high - low + 2, np.int64)
    for i in range(values.shape[0]):
        places[values[i] - low + 1] += 1
    for k in range(1, places.shape[0]):
        places[k] += places[k - 1]
    out = np.empty(values.shape[0], np.int64)
    for i in range(values.shape[0]):
        at = values[i] - low
        out[places[at]] = i
        places[at] += 1
    return out


def parts(tree: Any):
    """Every named tuple within named tuples."""
    if isinstance(tree, tuple) and hasattr(tree, "_fields"):
        yield tree
        for part in tree:
            yield from parts(part)


def permute(body, order: np.ndarray) -> None:
    """Particle k becomes what particle order[k] was, in every array of particles; pieces of a surface go with their owners."""
    for part in parts(body):
        for name in PER_PARTICLE.get(type(part), ()):
            array = getattr(part, name)
            array[...] = array[order]
        if isinstance(part, Surface):
            part.owner[...] = inverse(order)[part.owner]


def inverse(order: np.ndarray) -> np.ndarray:
    """The permutation that undoes one."""
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return back


@kernel
def per_plane(nodes, stride, planes, counts):
    """counts (planes,) grow by the particles whose first node lies in each plane."""
    for node in nodes:
        counts[node // stride % planes] += 1


def cuts(counts: np.ndarray, width: int) -> np.ndarray:
    """First planes of slabs and the end of the last (M + 1,): as many slabs as can be `width` wide and FULL, about equally full."""
    used = np.flatnonzero(counts)
    begin, end, total = used[0], used[-1] + 1, counts.sum()
    M = max(1, min((end - begin) // width, total // FULL))
    found = begin + np.searchsorted(np.cumsum(counts[begin:end]), np.arange(M + 1) * total / M)
    found[0], found[-1] = begin, end
    for k in range(1, M):
        found[k] = max(found[k], found[k - 1] + width)
    for k in range(M - 1, 0, -1):
        found[k] = min(found[k], found[k + 1] - width)
    return found


class Order:
    """Where the particles of a scene's bodies are."""

    def __init__(self, space, bodies):
        self.space, self.bodies = space, bodies
        self.original: list[np.ndarray | None] = [None] * len(bodies)  # by body: the original number of each particle, None where nothing was moved
        self.due, self.moved, self.steps = True, 0.0, 0  # whether to look, and how far [m] and for how many steps the fastest has moved since
        self.starts = np.zeros((len(bodies), 0), np.int64)  # (B, M + 1) first particle of each slab; none where the scene is not in slabs
        self.shared = False  # whether it was ever in slabs
        self.axis, self.astray = 0, True  # across which; whether particles are not in their slabs
        self.reach = np.zeros((0, 2), np.int64)  # (M, 2) nodes that each slab touched last along the axis

    def grow(self, bodies) -> None:
        """Bodies with more particles, behind those that they had (mpm.inflow)."""
        for b, (old, new) in enumerate(zip(self.bodies, bodies, strict=True)):
            if self.original[b] is not None:
                self.original[b] = np.concatenate([self.original[b], np.arange(len(old.particles.m), len(new.particles.m))])
        self.bodies, self.due, self.astray = bodies, True, True

    def memory(self) -> dict:
        """Enough to go on from here with the arrays of the bodies as they are (mpm.memory)."""
        return {name: value for name, value in vars(self).items() if name not in ("space", "bodies")}

    def recall(self, found: dict) -> None:
        """As it was when `memory` was kept; the arrays of the bodies are put back by others."""
        vars(self).update(found)

    def passed(self, distance: float, steps: int, astray: bool = False) -> None:
        """After a block: the farthest that a particle can have moved in it [m], and whether some left what their slab may touch."""
        self.moved, self.steps, self.astray = self.moved + distance, self.steps + steps, self.astray or astray
        self.due = self.due or self.astray or (self.moved > self.space.h and self.steps >= EVERY)

    def refresh(self) -> None:
        """Before a block: sort what is worth it."""
        if not self.due:
            return
        self.due, self.moved, self.steps = False, 0.0, 0
        D, sizes = directions(self.space), [len(body.particles.m) for body in self.bodies]
        shared = D > 1 and sum(sizes) >= SHARED
        if D == 1 or (max(sizes) < LEAST and not shared):
            return
        nodes = [first_nodes(self.space, body.particles.x) for body in self.bodies]
        worth = [size >= LEAST and mixed(one, FAR * extents(self.space)[D - 1]) > MIXED for size, one in zip(sizes, nodes, strict=True)]
        if shared and (self.astray or any(worth)):
            self.slice(nodes)
        if not self.sliced:
            for b in np.flatnonzero(worth):
                self.take(b, sorting(nodes[b]))

    def slice(self, nodes: list[np.ndarray]) -> None:
        """Sort by slabs across the axis along which the scene is longest; none where it is too short for two."""
        shape, D = extents(self.space), directions(self.space)
        strides = (shape[1] * shape[2], shape[2], 1)
        self.astray, self.starts = False, self.starts[:, :0]
        counts = [np.zeros(shape[a], np.int64) for a in range(D)]
        for a in range(D):
            for one in nodes:
                per_plane(one, strides[a], shape[a], counts[a])
        self.axis = max(range(D), key=lambda a: np.ptp(np.flatnonzero(counts[a])))
        a = self.axis
        seen = len(stencil(self.space.basis, 0.5)[1])
        planes = cuts(counts[a], seen - 1 + GAP)
        if len(planes) < 3:
            return
        self.shared, self.starts = True, np.zeros((len(self.bodies), len(planes)), np.int64)
        self.reach = np.stack([planes[:-1], planes[1:] + seen - 1], axis=1)
        for b, one in enumerate(nodes):
            order = sorting(one)
            slab = np.searchsorted(planes, one[order] // strides[a] % shape[a], side="right") - 1
            by_slab = sorting(slab)
            self.starts[b] = np.searchsorted(slab[by_slab], np.arange(len(planes)))
            self.take(b, order[by_slab])

    @property
    def sliced(self) -> bool:
        """Whether the scene is in slabs."""
        return self.starts.shape[1] > 0

    def block(self, most: int, work: int) -> int:
        """Steps of a block of about `work` particle-steps. In slabs they are longer: every block begins with a scatter of its own, and Python hears signals."""
        particles = sum(len(body.particles.m) for body in self.bodies)
        return max(4, min(most // 2, 5 * work // particles)) if self.sliced else max(1, min(most, work // particles))

    def take(self, b: int, order: np.ndarray) -> None:
        """Put the particles of a body in that order of the present one."""
        if np.array_equal(order, np.arange(len(order))):
            return
        permute(self.bodies[b], order)
        self.original[b] = order if self.original[b] is None else self.original[b][order]

    def restore(self) -> None:
        """The original order, for records."""
        for b, original in enumerate(self.original):
            if original is not None:
                permute(self.bodies[b], inverse(original))
                self.original[b], self.due, self.astray = None, True, True

    def name(self, b: int, i: int) -> int:
        """The original number of what is particle i now; -1 stays what it is."""
        return i if self.original[b] is None or i < 0 else int(self.original[b][i])

    def places(self, b: int) -> np.ndarray | None:
        """Where the particles of a body are now, by their original numbers; None where nothing was moved."""
        return None if self.original[b] is None else inverse(self.original[b])
