"""Bodies that conduct into one another as one system of equations: their nodes side by side, the stencils of all in one.

Every body has splines of its own on the scene's grid. A node of the box round all of them has as many unknowns as bodies share the node that most share
(two in a stack of layers, whatever its number; mpm.rigid.side_by_side), so that a stencil holds the coupling too, and every solver serves as it is.
"""

from dataclasses import dataclass

import numpy as np

from mpm.heat.programmes import SAME
from mpm.materials.laws import Constant
from mpm.materials.roles import value
from mpm.rigid.coupling import couple
from mpm.rigid.side_by_side import SideBySide, Triplets, numbers
from mpm.rigid.surroundings import radiate
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


def make_group(bodies, beside, joints, axisymmetric: bool, h: float, origin, end: float, moment: float = 0.0) -> Group:
    """bodies: RigidBody each; beside: shapes that touch each; joints: Joint each, by number among the bodies."""
    parts = tuple(make_system(body, axisymmetric, h, origin, end, others=others, moment=moment) for body, others in zip(bodies, beside, strict=True))
    side = SideBySide(parts, *numbers([part.geometry for part in parts]))
    return assembled(side, [body.shape for body in bodies], joints, axisymmetric, h, moment)


def assembled(side: SideBySide, shapes, joints, axisymmetric: bool, h: float, moment: float) -> Group:
    """The Group of bodies side by side, of given `shapes`, with the `joints` that act from `moment` [s] on."""
    parts = side.parts
    fixed = [isinstance(part.kappa, Constant) for part in parts]
    linear = all(fixed) and all(isinstance(part.alpha, Constant) and not len(part.hot) for part in parts)
    capacity = [part.density * part.alpha.constant if linear else 1.0 for part in parts]
    # where all kappa are constant but some alpha is not, kappa stands in the stiffness too
    kappas = [part.kappa.constant if all(fixed) else 1.0 for part in parts]
    linked = tuple(joint for joint in joints if joint.conductance > 0)
    coupled = {k: coupling(side, shapes, joint, axisymmetric, h) for k, joint in enumerate(linked) if joint.acts(moment)}
    between, leaving = [found for found, _ in coupled.values()], np.zeros((len(linked), side.size))
    for k, (_, (number, flow)) in coupled.items():
        np.add.at(leaving[k], number, flow)
    mass, stiffness = (side.triplets([getattr(part.geometry, name) for part in parts]) for name in ("mass", "stiffness"))
    exchange = side.triplets([part.exchange for part in parts])
    diff = np.unique(np.concatenate([np.abs(columns - rows) for rows, columns, _ in (*between, *mass, *stiffness, *exchange)]))
    hot = side.stencil(side.triplets([part.hot for part in parts]), diff) if any(len(part.hot) for part in parts) else np.zeros((0, 0))
    shaped = side.geometry(side.stencil(scaled(mass, capacity), diff), side.stencil(scaled(stiffness, kappas), diff), diff, capacity, h)
    zero = max(parts, key=lambda part: part.firm).zero
    coldest, hottest = min(part.coldest for part in parts), max(part.hottest for part in parts)
    start, density = (side.values([np.where(part.geometry.active, getattr(part, name), 0.0) for part in parts]) for name in ("start", "density"))
    return Group(
        geometry=shaped, density=1.0, kappa=Constant(1.0), alpha=Constant(1.0), start=start, field=None, zero=zero,
        exchange=side.stencil([*exchange, *between], diff), facing=side.values([part.facing for part in parts]), programmes=side.programmes(zero),
        radiant=side.radiant(zero), hot=hot, span=max(hottest - coldest, 1e-6 * max(abs(hottest), abs(coldest)), 1e-30), coldest=coldest, hottest=hottest,
        stiff=max(part.stiff for part in parts), bounds=(min(part.bounds[0] for part in parts), max(part.bounds[1] for part in parts)), parts=parts,
        firm=max(part.firm for part in parts), into=side.into, owner=side.owner(), leaving=leaving, joints=linked, density_of=density, blunt=not all(fixed),
    )  # fmt: skip


def coupling(side: SideBySide, shapes, joint: Joint, axisymmetric: bool, h: float):
    """As mpm.rigid.coupling.couple of the two bodies of a joint."""
    both = (joint.first, joint.second)
    two = [side.parts[b] for b in both]
    kappa = [max(value(part.kappa, part.coldest), value(part.kappa, part.hottest)) for part in two]
    one, other = ((part.geometry, k, side.into[b]) for part, k, b in zip(two, kappa, both, strict=True))
    blunt = not all(isinstance(part.kappa, Constant) for part in two)
    return couple(one, other, [shapes[b] for b in both], joint.conductance, axisymmetric, h, blunt)


def scaled(each: list[Triplets], factors: list[float]) -> list[Triplets]:
    """The matrix of each body times its factor."""
    return [(rows, columns, factor * values) for (rows, columns, values), factor in zip(each, factors, strict=True)]
