"""kappa and alpha that depend on temperature: lumped mass and specific enthalpy h on the nodes.

    m_i dh_i/dt = s_i - sum_j B_ij theta(h_j) - sum_j K_ij Pi(h_j)        m_i = rho int N_i,  Pi = Kirchhoff's potential, grad Pi = kappa grad theta

With constant kappa the two sums are one. No step can jump over latent heat, because h is what moves; 1.K = 0 makes sum m h the exchanged heat to round-off.
(Behind a stiff surface what is below ROUNDOFF is spread evenly over the body.)
Second order in the cell (exact quadrature, lumped mass: docs/physics.md 12).
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.materials.laws import Constant
from mpm.rigid.geometry import evaluated
from mpm.rigid.nodes import apply
from mpm.rigid.ordered import dot
from mpm.rigid.surroundings import Radiant, radiate
from mpm.rigid.tables import Table, Tables, enthalpies, make_table, piece, temperatures

ROUNDOFF = 1e-10  # of the heat that moves
CANCELLED = 1e-14  # of the terms that nearly cancel behind a stiff surface whose temperature changes


class Lumped(NamedTuple):
    """One body for enthalpy methods; idle nodes have mass 1 and nothing else."""

    diff: np.ndarray
    mass: np.ndarray  # (N,) [kg]
    weight: np.ndarray  # (N,) the same, zero on idle nodes
    on_theta: np.ndarray  # (n, N) stencil applied to theta - zero
    on_potential: np.ndarray  # (n, N) or (0, N) stencil applied to Pi
    facing: np.ndarray
    table: Table | Tables
    radiant: Radiant


def make_lumped(system) -> tuple[Lumped, np.ndarray]:
    """The problem, and the specific enthalpies at the start."""
    shaped = system.geometry
    table = make_table(system.alpha, system.kappa, system.zero, system.coldest, system.hottest)
    mass = np.where(shaped.active, system.density * shaped.volume, 1.0)
    if isinstance(system.kappa, Constant):
        on_theta, on_potential = system.kappa.constant * shaped.stiffness + system.exchange, np.zeros((0, len(mass)))
    else:
        on_theta, on_potential = system.exchange, shaped.stiffness
    start = np.full(len(mass), system.start)
    if system.field is not None:
        index, spline = evaluated(shaped.nodes, shaped.x)
        start[:] = 0.0
        np.add.at(start, index, (shaped.w * system.field(shaped.x))[:, None] * spline)
        start = np.where(shaped.active, start / np.where(shaped.active, shaped.volume, 1.0), system.start)
    start = np.where(shaped.active, enthalpies(system.alpha, system.zero, start), 0.0)
    weight = np.where(shaped.active, mass, 0.0)
    return Lumped(shaped.nodes.diff, mass, weight, on_theta, on_potential, system.facing, table, system.radiant), start


@kernel(inline=True)
def split(table, h, theta, potential, both):
    """theta - zero, and where `both` Pi, at enthalpies h."""
    for i in range(len(h)):
        t, c, p, _ = piece(table, i, h[i])
        theta[i] = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
        if both:
            potential[i] = p[0] + t * (p[1] + t * (p[2] + t * p[3]))


@kernel
def rate(problem, around, h, out, theta, work):
    """dh/dt [W/kg] into `out`; returns the heat taken in a second [W]. theta and work are scratch."""
    both = len(problem.on_potential) > 0
    split(problem.table, h, theta, out, both)
    if both:
        apply(problem.on_potential, problem.diff, out, work)
        apply(problem.on_theta, problem.diff, theta, out)
        work += out
    else:
        apply(problem.on_theta, problem.diff, theta, work)
    taken, total, size = around.received + radiate(problem.radiant, around.sky, theta, work), 0.0, 0.0
    scale = abs(around.received)
    for i in range(len(h)):  # sums apart from stores: see mpm.rigid.ordered
        net = around.supply[i] - work[i]
        total += net
        size += abs(net)
        passed = problem.facing[i] * theta[i]
        taken -= passed
        scale += abs(passed)
    for i in range(len(h)):
        out[i] = (around.supply[i] - work[i]) / problem.mass[i]
    gap = taken - total
    if abs(gap) <= ROUNDOFF * size + CANCELLED * scale:  # more would be an error, and the ledger has to show it
        gap /= np.sum(problem.weight)
        for i in range(len(h)):
            if problem.weight[i] > 0.0:
                out[i] += gap
    return taken


class Enthalpy:
    """What the enthalpy methods share: see the protocol in mpm.rigid.time_loop."""

    make = staticmethod(make_lumped)

    def __init__(self, system, tolerance: float):
        self.system, self.tolerance = system, tolerance
        self.problem, self.state = self.make(system)
        self.first, self.q = self.state, 0.0
        self.now, self.longest, self.steady = 0.0, system.programmes.longest, None
        self.weight = self.problem.weight
        low, high = enthalpies(system.alpha, system.zero, np.array([system.coldest, system.hottest]))
        lowest = 1.0 / self.problem.table.steepest  # [J/(kg K)]
        self.allowed = tolerance * max(high - low, lowest * system.span) * np.sqrt(self.weight.sum())
        self.diffusion = self.problem.table.conductivity / (system.density * lowest * system.geometry.nodes.h**2)  # [1/s]

    def around(self, t: float):
        """What surrounds the body at time t."""
        if self.steady is None or self.system.programmes.changes:
            self.steady = self.system.programmes.around(t)
        return self.steady

    def temperature(self, state):
        return temperatures(self.problem.table, np.ascontiguousarray(state))

    def heat(self, state):
        """Heat content above `zero` [J]."""
        return dot(state, self.weight)
