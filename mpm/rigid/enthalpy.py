"""kappa and alpha that depend on temperature: lumped mass and specific enthalpy h on the nodes.

    m_i dh_i/dt = s_i - sum_j B_ij theta(h_j) - sum_j K_ij Pi(h_j)        m_i = rho int N_i,  Pi = Kirchhoff's potential, grad Pi = kappa grad theta

With constant kappa the two sums are one. No step can jump over latent heat, because h is what moves; 1.K = 0 makes sum m h the exchanged heat to round-off.
Second order in the cell (exact quadrature, lumped mass: physics.md 12).
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel
from mpm.materials.laws import Constant
from mpm.rigid.nodes import apply
from mpm.rigid.tables import Table, enthalpies, make_table, temperatures


class Lumped(NamedTuple):
    """One body for enthalpy methods; idle nodes have mass 1 and nothing else."""

    diff: np.ndarray
    mass: np.ndarray  # (N,) [kg]
    on_theta: np.ndarray  # (n, N) stencil applied to theta - zero
    on_potential: np.ndarray  # (n, N) or (0, N) stencil applied to Pi
    supply: np.ndarray
    facing: np.ndarray
    received: float
    table: Table


def make_lumped(system) -> tuple[Lumped, np.ndarray]:
    """The problem, and the specific enthalpies at the start."""
    shaped = system.geometry
    table = make_table(system.alpha, system.kappa, system.zero, system.coldest, system.hottest)
    mass = np.where(shaped.active, system.density * shaped.volume, 1.0)
    if isinstance(system.kappa, Constant):
        on_theta, on_potential = system.kappa.constant * shaped.stiffness + system.exchange, np.zeros((0, len(mass)))
    else:
        on_theta, on_potential = system.exchange, shaped.stiffness
    start = np.where(shaped.active, enthalpies(system.alpha, system.zero, np.array([system.start]))[0], 0.0)
    return Lumped(shaped.nodes.diff, mass, on_theta, on_potential, system.supply, system.facing, system.received, table), start


@kernel(inline=True)
def split(table, h, theta, potential, both):
    """theta - zero, and where `both` Pi, at enthalpies h."""
    top = len(table.theta) - 1
    for i in range(len(h)):
        s = (h[i] - table.start) * table.per
        k = min(max(int(np.floor(s)) + 1, 0), top)
        t = s - (k - 1)
        c = table.theta[k]
        theta[i] = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
        if both:
            p = table.potential[k]
            potential[i] = p[0] + t * (p[1] + t * (p[2] + t * p[3]))


@kernel
def rate(problem, h, out, theta, work):
    """dh/dt [W/kg] into `out`; returns the heat taken in a second [W]. theta and work are scratch."""
    both = len(problem.on_potential) > 0
    split(problem.table, h, theta, out, both)
    if both:
        apply(problem.on_potential, problem.diff, out, work)
        apply(problem.on_theta, problem.diff, theta, out)
        work += out
    else:
        apply(problem.on_theta, problem.diff, theta, work)
    taken = problem.received
    for i in range(len(h)):
        out[i] = (problem.supply[i] - work[i]) / problem.mass[i]
        taken -= problem.facing[i] * theta[i]
    return taken


class Enthalpy:
    """What the enthalpy methods share: see the protocol in mpm.rigid.drive."""

    def __init__(self, system, tolerance: float):
        self.system, self.tolerance = system, tolerance
        self.problem, self.state = make_lumped(system)
        self.first, self.q = self.state, 0.0
        self.weight = np.where(system.geometry.active, self.problem.mass, 0.0)
        low, high = enthalpies(system.alpha, system.zero, np.array([system.coldest, system.hottest]))
        self.allowed = tolerance * max(high - low, 1e-30) * np.sqrt(self.weight.sum())
        lowest = 1.0 / self.problem.table.steepest  # [J/(kg K)]
        self.diffusion = self.problem.table.conductivity / (system.density * lowest * system.geometry.nodes.h**2)  # [1/s]

    def temperature(self, state):
        return temperatures(self.problem.table, np.ascontiguousarray(state))

    def heat(self, state):
        """Heat content above `zero` [J]."""
        return float(state @ self.weight)
