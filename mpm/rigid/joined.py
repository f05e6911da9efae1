"""Implicit steps of bodies that conduct into one another (mpm.rigid.group): as of one body, and every body's balance is kept apart.

Constant laws: mpm.rigid.linear; laws of temperature: mpm.rigid.newton, every node with the table of its body.
Fluxes are those of the stages as the solver left them: behind a surface that is held at a temperature (beta = inf) a slope that is 1e-12 off moves the
flux by 1e-7. So no stage is closed before its fluxes are known, and then body by body.
`q` is an array: what each body has taken from its surroundings, and what each joint has taken from its first body [J].
"""

import numpy as np

from mpm.materials.roles import value
from mpm.rigid.enthalpy import Lumped
from mpm.rigid.gradients import Gradients
from mpm.rigid.group import ROUNDOFF
from mpm.rigid.linear import FLOOR, LinearSteps
from mpm.rigid.newton import NewtonSteps
from mpm.rigid.ordered import dot
from mpm.rigid.tables import Tables, enthalpies, make_table

SLACK = 1e-6  # of the heat that moves, where conjugate gradients have ended at their tolerance


def slowest(system) -> float:
    """h^2 over the largest diffusivity of the bodies [s]."""
    found = [p.density * p.alpha.constant / p.kappa.constant for p in system.parts if p.kappa.constant > 0]
    return system.geometry.nodes.h**2 * min(found, default=0.0)


class JoinedLinear(LinearSteps):
    """Constant laws."""

    closes = -1.0  # by `balance`

    def __init__(self, system, tolerance: float, order: int, iterate: bool, checked: bool):
        super().__init__(system, tolerance, order, iterate, checked)
        self.floor, self.q = FLOOR * slowest(system), np.zeros(len(system.parts) + len(system.joints))
        self.slack = SLACK if isinstance(self.solver, Gradients) else ROUNDOFF

    def attempt(self, dt: float) -> float:
        error = super().attempt(dt)
        if np.isfinite(error):
            reached = self.state + (dt * self.tableau.a) @ self.stages
            supply, sky = self.surroundings(dt)[0], np.zeros(0)
            self.fluxes = np.array([self.system.flows(theta, given, sky) for theta, given in zip(reached, supply, strict=True)])
            terms = [self.system.terms(theta, given) for theta, given in zip(reached, supply, strict=True)]
            for rate, flows, each in zip(self.stages, self.fluxes, terms, strict=True):
                self.system.balance(rate, self.weight, flows, each, self.slack)
        return error

    def heat(self, state):
        """Heat content of each body above `zero` (B,) [J]."""
        return self.system.sums(self.weight * state)


def make_joined(system) -> tuple[Lumped, np.ndarray]:
    """As mpm.rigid.enthalpy.make_lumped."""
    shaped, parts = system.geometry, system.parts
    every = [make_table(p.alpha, p.kappa, system.zero, system.coldest, system.hottest) for p in parts]
    longest = max(len(one.theta) for one in every)
    rows = [[np.concatenate([one, np.tile(one[-1:], (longest - len(one), 1))]) for one in (table.theta, table.potential)] for table in every]
    which = np.minimum(system.owner, len(parts) - 1)
    numbers = (np.array([getattr(table, name) for table in every]) for name in ("start", "per"))
    top = np.array([len(table.theta) - 1 for table in every])
    theta, potential = (np.stack([pair[k] for pair in rows]) for k in (0, 1))
    table = Tables(which, *numbers, top, theta, potential, max(t.steepest for t in every), max(t.conductivity for t in every))
    mass = np.where(shaped.active, system.density_of * shaped.volume, 1.0)
    weight = np.where(shaped.active, mass, 0.0)
    if system.blunt:
        on_theta, on_potential = system.exchange, shaped.stiffness
    else:
        on_theta, on_potential = shaped.stiffness + system.exchange, np.zeros((0, len(mass)))
    start = np.zeros(len(mass))
    for b, p in enumerate(parts):
        start[system.owner == b] = enthalpies(p.alpha, system.zero, np.array([p.start]))[0]
    return Lumped(shaped.nodes.diff, mass, weight, on_theta, on_potential, system.facing, table, system.radiant), start


class JoinedNewton(NewtonSteps):
    """Laws of temperature."""

    make = staticmethod(make_joined)

    def __init__(self, system, tolerance: float, order: int):
        super().__init__(system, tolerance, order)
        self.q = np.zeros(len(system.parts) + len(system.joints))
        ends = system.coldest, system.hottest
        fastest = max(value(p.kappa, t) / (p.density * value(p.alpha, t)) for p in system.parts for t in ends)
        self.floor = FLOOR * system.geometry.nodes.h**2 / fastest if fastest > 0 else 0.0
        ranges = [abs(float(np.diff(enthalpies(p.alpha, system.zero, np.array([system.coldest, system.hottest])))[0])) for p in system.parts]
        self.allowed = tolerance * float(np.sqrt(dot(system.sums(self.weight), np.square(ranges))))

    def stage(self, base, dt: float, around, h, f):
        found = super().stage(base, dt, around, h, f)
        if found is None:
            return None
        theta = self.temperature(found[0])
        flows = self.system.flows(theta, around.supply, around.sky)
        self.system.balance(f, self.weight, flows, self.system.terms(theta, around.supply))
        return found[0], flows

    def heat(self, state):
        """Heat content of each body above `zero` (B,) [J]."""
        return self.system.sums(self.weight * state)
