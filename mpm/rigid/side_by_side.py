"""Bodies side by side under one numbering of their nodes: values, stencils, points and programmes of each body become those of the group (mpm.rigid.group).

number = node of the box round all bodies * most + rank of the body at the node, with `most` bodies at the node that most share. So few differences
of numbers occur, and a stencil (one row a difference) holds the coupling of bodies too.
"""

from dataclasses import dataclass

import numpy as np

from mpm.rigid.geometry import Geometry
from mpm.rigid.nodes import Nodes
from mpm.rigid.surroundings import Programmes, Radiant

Triplets = tuple[np.ndarray, np.ndarray, np.ndarray]  # row, column, value of a matrix


def numbers(shaped: list[Geometry]) -> tuple[tuple[np.ndarray, ...], int]:
    """Number of each node of each body, and how many there are."""
    first = np.min([one.nodes.first for one in shaped], axis=0)
    count, stride, size = np.max([one.nodes.first + one.nodes.count for one in shaped], axis=0) - first, np.zeros(3, dtype=np.int64), 1
    for k in np.argsort(count, kind="stable"):
        stride[k] = size
        size *= int(count[k])
    places = []
    for one in shaped:
        flat, nodes = np.arange(one.nodes.size), one.nodes
        places.append(sum(((flat // max(nodes.stride[k], 1)) % nodes.count[k] + nodes.first[k] - first[k]) * stride[k] for k in range(3)))
    shared, ranks = np.zeros(size, dtype=np.int64), []
    for one, place in zip(shaped, places, strict=True):
        ranks.append(np.where(one.active, shared[place], 0))
        shared[place[one.active]] += 1
    most = int(shared.max())
    return tuple(place * most + rank for place, rank in zip(places, ranks, strict=True)), size * most


def triplets(given: np.ndarray, diff: np.ndarray, into: np.ndarray) -> Triplets:
    """Of a body's stencil (n, N_b) of a symmetric matrix, in full, under new numbers. A stencil of no rows gives none."""
    o, i = np.nonzero(given)
    j = i + diff[o]
    rows, columns, values = into[i], into[j], given[o, i]
    off = rows != columns
    return np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]]), np.concatenate([values, values[off]])


@dataclass(frozen=True)
class SideBySide:
    """What is known of each of B bodies, brought under the numbers of all. `parts`: a mpm.rigid.system.System each."""

    parts: tuple
    into: tuple[np.ndarray, ...]  # (N_b,) number of each of a body's nodes
    size: int  # N

    def triplets(self, each: list[np.ndarray]) -> list[Triplets]:
        """Of a stencil a body."""
        return [triplets(given, part.geometry.nodes.diff, i) for given, part, i in zip(each, self.parts, self.into, strict=True)]

    def stencil(self, each: list[Triplets], diff: np.ndarray) -> np.ndarray:
        """Stencil (len(diff), N) of the sum of symmetric matrices given in full."""
        rows, columns, values = (np.concatenate(part) for part in zip(*each, strict=True))
        half = columns >= rows
        rows, columns, values = rows[half], columns[half], values[half]
        place = np.searchsorted(diff, columns - rows) * self.size + rows
        return np.bincount(place, weights=values, minlength=len(diff) * self.size).reshape(len(diff), self.size)

    def values(self, each: list[np.ndarray]) -> np.ndarray:
        """(N,) of values a node of each body (N_b,). Idle nodes may share a number, with nothing to add."""
        out = np.zeros(self.size)
        for values, i in zip(each, self.into, strict=True):
            np.add.at(out, i, values)
        return out

    def alone(self, part, values: np.ndarray) -> np.ndarray:
        """(N,) of values at the nodes of one body."""
        return self.values([values if one is part else np.zeros(len(i)) for one, i in zip(self.parts, self.into, strict=True)])

    def owner(self) -> np.ndarray:
        """(N,) the body of a node; B where there is none."""
        found = np.full(self.size, len(self.parts))
        for b, (part, i) in enumerate(zip(self.parts, self.into, strict=True)):
            found[i[part.geometry.active]] = b
        return found

    def geometry(self, mass: np.ndarray, stiffness: np.ndarray, diff: np.ndarray, capacity: list[float], h: float) -> Geometry:
        """Of all bodies; `capacity` scales each body's volume, as it does the mass."""
        each, whole = [part.geometry for part in self.parts], np.array([self.size, 1, 1])
        nodes = Nodes(h, np.zeros(3), np.zeros(3, np.int64), whole, np.ones(3, np.int64), each[0].nodes.local, diff, np.zeros((0, 0)))
        index = np.concatenate([i[one.sight[0]] for one, i in zip(each, self.into, strict=True)])
        x, w, spline = (np.concatenate(part) for part in zip(*((one.x, one.w, one.sight[1]) for one in each), strict=True))
        volume = self.values([c * one.volume for c, one in zip(capacity, each, strict=True)])
        return Geometry(nodes, each[0].dimension, mass, stiffness, (), volume, (), self.owner() < len(each), x, w, (), (index, spline))

    def programmes(self, zero: float) -> Programmes:
        """What surrounds the bodies, over temperatures relative to `zero`."""
        each = [part.programmes for part in self.parts]
        unforced = [part.facing - sum(facing for _, facing in part.programmes.forcing) for part in self.parts]
        steady = self.values([p.steady + (part.zero - zero) * facing for part, p, facing in zip(self.parts, each, unforced, strict=True)])
        forcing = tuple((programme, self.alone(part, v)) for part, p in zip(self.parts, each, strict=True) for programme, v in p.forcing)
        given = tuple((programme, self.alone(part, v)) for part, p in zip(self.parts, each, strict=True) for programme, v in p.given)
        within = tuple(one._replace(index=i[one.index], size=self.size) for p, i in zip(each, self.into, strict=True) for one in p.within)
        return Programmes(steady, forcing, given, tuple(sky for p in each for sky in p.skies), zero, within)

    def radiant(self, zero: float) -> Radiant:
        """Points that radiate, their skies counted as `programmes` has them."""
        before, moved = 0, []
        for part, i in zip(self.parts, self.into, strict=True):
            moved.append(part.radiant._replace(index=i[part.radiant.index], sky=part.radiant.sky + before))
            before += len(part.programmes.skies)
        return Radiant(*(np.concatenate([getattr(one, name) for one in moved]) for name in ("index", "value", "weight", "sky")), float(zero))
