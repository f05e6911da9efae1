"""Bodies that conduct into one another as one system of equations: their nodes side by side, the stencils of all in one.

Every body has splines of its own on the scene's grid. A node of the box round all of them has as many unknowns as bodies share the node that most share
(two in a stack of layers, whatever its number): number = node * most + rank of the body at the node. So few differences of numbers occur, a stencil
holds the coupling too, and every solver serves as it is.
"""

from dataclasses import dataclass

import numpy as np

from mpm.heat.programmes import SAME
from mpm.materials.laws import Constant
from mpm.materials.roles import value
from mpm.rigid.coupling import couple
from mpm.rigid.geometry import Geometry
from mpm.rigid.nodes import Nodes
from mpm.rigid.surroundings import Programmes, Radiant, radiate
from mpm.rigid.system import System, make_system

ROUNDOFF = 1e-10  # of the heat that moves: what more is missing of a body's balance is an error, and the ledger shows it
CANCELLED = 1e-4  # as in mpm.rigid.linear


@dataclass(frozen=True)
class Joint:
    """Two bodies by number, and what conducts between them [W/(m2 K)]; inf: perfect contact, 0: covered, and insulated."""

    first: int
    second: int
    conductance: float = np.inf
    begin: float = 0.0  # [s]
    end: float = np.inf

    def acts(self, moment: float) -> bool:
        """Whether they touch from then on; before and after nothing passes, and nothing is covered."""
        return self.begin <= moment * (1 + SAME) and moment * (1 + SAME) < self.end


@dataclass(frozen=True)
class Group(System):
    """As System, of several bodies. geometry.mass, .stiffness and .volume hold rho alpha and kappa where all laws are constant (then kappa, alpha: 1)."""

    parts: tuple[System, ...] = ()
    into: tuple[np.ndarray, ...] = ()  # (N_b,) number of each of a body's nodes
    owner: np.ndarray | None = None  # (N,) body of a node; the number of bodies where there is none
    leaving: np.ndarray | None = None  # (P, N) heat that leaves the first body of each joint [W] is leaving @ theta
    joints: tuple[Joint, ...] = ()  # by number in the group
    density_of: np.ndarray | None = None  # (N,)
    blunt: bool = False  # some kappa follows temperature

    def sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (B,) over the nodes of each body."""
        return np.bincount(self.owner, weights=values, minlength=len(self.parts) + 1)[:-1]

    def flows(self, theta: np.ndarray, supply: np.ndarray, sky: np.ndarray) -> np.ndarray:
        """Heat a second [W]: what each body takes from its surroundings (B,), and what each joint takes from its first body (P,)."""
        lost = self.facing * theta
        radiate(self.radiant, sky, theta, lost)
        return np.concatenate([self.sums(supply - lost), (self.leaving * theta).sum(axis=1)])

    def gains(self, flows: np.ndarray) -> np.ndarray:
        """What each body gains (B,) [W] of `flows`."""
        gained = flows[: len(self.parts)].copy()
        for joint, flow in zip(self.joints, flows[len(self.parts) :], strict=True):
            gained[joint.first] -= flow
            gained[joint.second] += flow
        return gained

    def terms(self, theta: np.ndarray, supply: np.ndarray) -> float:
        """The largest sum of what adds up to a flow, without signs [W]: large behind a surface that is held at a temperature."""
        return float(np.append(self.sums(np.abs(supply) + np.abs(self.facing * theta)), np.abs(self.leaving * theta).sum(axis=1)).max())

    def balance(self, rate: np.ndarray, weight: np.ndarray, flows: np.ndarray, terms: float, slack: float = ROUNDOFF) -> None:
        """Spread over each body what a solver has left between sum weight `rate` and what it gains; not more than `slack` of the heat that moves, and
        CANCELLED of that of the `terms` that make up the flows."""
        gap, size = self.gains(flows) - self.sums(weight * rate), self.sums(weight * np.abs(rate)).max() + CANCELLED * terms
        every = np.append(np.where(np.abs(gap) <= slack * size, gap / self.sums(weight), 0.0), 0.0)
        rate += np.where(weight > 0, every[self.owner], 0.0)


def groups(number: int, joints) -> list[list[int]]:
    """Bodies that are joined, directly or through others, in rising order."""
    label = np.arange(number)
    for joint in joints:
        if joint.conductance > 0:
            label[label == label[joint.second]] = label[joint.first]
    return sorted((np.flatnonzero(label == one).tolist() for one in np.unique(label)), key=lambda group: group[0])


def stencil(rows, columns, values, diff, size: int) -> np.ndarray:
    """Stencil (n, size) of a symmetric matrix given in full by triplets."""
    half = columns >= rows
    rows, columns, values = rows[half], columns[half], values[half]
    place = np.searchsorted(diff, columns - rows) * size + rows
    return np.bincount(place, weights=values, minlength=len(diff) * size).reshape(len(diff), size)


def triplets(given: np.ndarray, diff: np.ndarray, into: np.ndarray):
    """Of a body's stencil, in full, under new numbers."""
    o, i = np.nonzero(given)
    j = i + diff[o]
    rows, columns, values = into[i], into[j], given[o, i]
    off = rows != columns
    return np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]]), np.concatenate([values, values[off]])


def make_group(bodies, beside, joints, axisymmetric: bool, h: float, origin, end: float, moment: float = 0.0) -> Group:
    """bodies: RigidBody each; beside: shapes that touch each; joints: Joint each, by number among the bodies."""
    parts = tuple(make_system(body, axisymmetric, h, origin, end, others=others, moment=moment) for body, others in zip(bodies, beside, strict=True))
    into, size = numbers([part.geometry for part in parts])
    return assembled(parts, into, [b.shape for b in bodies], tuple(joints), size, axisymmetric, h, moment)


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


def assembled(parts, into, shapes, joints, size: int, axisymmetric: bool, h: float, moment: float) -> Group:
    """The Group of bodies whose nodes have their numbers."""
    linear = all(isinstance(one, Constant) for p in parts for one in (p.kappa, p.alpha)) and not any(len(p.hot) for p in parts)
    fixed = [isinstance(p.kappa, Constant) for p in parts]
    conductivity = [max(value(p.kappa, p.coldest), value(p.kappa, p.hottest)) for p in parts]
    linked = [j for j in joints if j.conductance > 0]
    now = [k for k, j in enumerate(linked) if j.acts(moment)]
    found = [couple(*((parts[b].geometry, conductivity[b], into[b]) for b in (j.first, j.second)), [shapes[j.first], shapes[j.second]], j.conductance,
                    axisymmetric, h, not (fixed[j.first] and fixed[j.second])) for j in (linked[k] for k in now)]  # fmt: skip
    diffs = [np.abs(columns - rows) for (rows, columns, _), _ in found]
    pieces = {name: [triplets(getattr(p.geometry, name), p.geometry.nodes.diff, i) for p, i in zip(parts, into, strict=True)] for name in ("mass", "stiffness")}
    exchange = [triplets(p.exchange, p.geometry.nodes.diff, i) for p, i in zip(parts, into, strict=True)]
    hot = [triplets(p.hot, p.geometry.nodes.diff, i) if len(p.hot) else tuple(np.zeros((3, 0))) for p, i in zip(parts, into, strict=True)]
    diff = np.unique(np.concatenate([*diffs, *(np.abs(c - r) for group in (*pieces.values(), exchange) for r, c, _ in group)]))

    def whole(groups, factors=None):
        scaled = [(r, c, v * f) for (r, c, v), f in zip(groups, factors or [1.0] * len(groups), strict=True)]
        rows, columns, values = (np.concatenate(part) for part in zip(*scaled, strict=True))
        return stencil(rows.astype(np.int64), columns.astype(np.int64), values, diff, size)

    def spread(each):
        out = np.zeros(size)
        for values, i in zip(each, into, strict=True):
            np.add.at(out, i, values)  # idle nodes may share a number, with nothing to add
        return out

    capacity = [p.density * p.alpha.constant for p in parts] if linear else [1.0] * len(parts)
    # where all kappa are constant but some alpha is not, kappa stands in the stiffness too
    kappas = [p.kappa.constant for p in parts] if all(fixed) else [1.0] * len(parts)
    owner = np.full(size, len(parts))
    for b, (p, i) in enumerate(zip(parts, into, strict=True)):
        owner[i[p.geometry.active]] = b
    volume = spread([c * p.geometry.volume for c, p in zip(capacity, parts, strict=True)])
    nodes = Nodes(h, np.zeros(3), np.zeros(3, np.int64), np.array([size, 1, 1]), np.ones(3, np.int64), parts[0].geometry.nodes.local, diff, np.zeros((0, 0)))
    index, spline = (np.concatenate([i[p.geometry.sight[0]] if k == 0 else p.geometry.sight[1] for p, i in zip(parts, into, strict=True)]) for k in (0, 1))
    x, w = (np.concatenate([getattr(p.geometry, name) for p in parts]) for name in ("x", "w"))
    mass, stiffness = whole(pieces["mass"], capacity), whole(pieces["stiffness"], kappas)
    shaped = Geometry(nodes, parts[0].geometry.dimension, mass, stiffness, (), volume, (), owner < len(parts), x, w, (), (index, spline))
    lead = max(parts, key=lambda p: p.stiff)
    zero, facing = lead.zero, spread([p.facing for p in parts])
    steady = spread([p.programmes.steady + (p.zero - zero) * (p.facing - sum(v for _, v in p.programmes.forcing)) for p in parts])
    forcing, given = (tuple((programme, spread([v if q is p else np.zeros(len(q.facing)) for q in parts])) for p in parts
                            for programme, v in getattr(p.programmes, name)) for name in ("forcing", "given"))  # fmt: skip
    within = tuple(one._replace(index=i[one.index], size=size) for p, i in zip(parts, into, strict=True) for one in p.programmes.within)
    skies, radiants = (), []
    for p, i in zip(parts, into, strict=True):
        radiants.append(p.radiant._replace(index=i[p.radiant.index], sky=p.radiant.sky + len(skies)))
        skies += p.programmes.skies
    radiant = Radiant(*(np.concatenate([getattr(r, name) for r in radiants]) for name in ("index", "value", "weight", "sky")), float(zero))
    leaving = np.zeros((len(linked), size))
    for k, (_, (number, flow)) in zip(now, found, strict=True):
        np.add.at(leaving[k], number, flow)
    joined = whole([*exchange, *(t for t, _ in found)])
    coldest, hottest = min(p.coldest for p in parts), max(p.hottest for p in parts)
    start, density = (spread([np.where(p.geometry.active, getattr(p, name), 0.0) for p in parts]) for name in ("start", "density"))
    return Group(
        geometry=shaped, density=1.0, kappa=Constant(1.0), alpha=Constant(1.0), start=start, field=None, zero=zero, exchange=joined, facing=facing,
        programmes=Programmes(steady, forcing, given, skies, zero, within),
        radiant=radiant, hot=whole(hot) if any(len(p.hot) for p in parts) else np.zeros((0, 0)),
        span=max(hottest - coldest, 1e-6 * max(abs(hottest), abs(coldest)), 1e-30), coldest=coldest, hottest=hottest, stiff=max(p.stiff for p in parts),
        bounds=(min(p.bounds[0] for p in parts), max(p.bounds[1] for p in parts)), parts=parts, into=into, owner=owner, leaving=leaving, joints=tuple(linked),
        density_of=density, blunt=not all(fixed),
    )  # fmt: skip
