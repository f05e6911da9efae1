"""Implicit steps that keep temperatures between those of body and surroundings, for any step, cell, cut and beta: on hat functions (mpm.rigid.hats).

Two stages of order 2 (mpm.rigid.newton); where they leave the bounds, the step is taken again by backward Euler, which cannot. The step ends with
Newton's last iterate; what its residual leaves of the heat taken goes to nodes with room for it, so bounds hold to the last bit and the ledger closes.
Inside a step the state is a straight line.
Measured by tests/rigid/test_bounded.py.   Good values  thermal shocks on few cells.
Fails when   a flux is given: there is no bound on its side;   beta h/kappa is large on a surface off the grid lines: order 1 in the cell.
"""

import numpy as np

from mpm.rigid.newton import NewtonSteps
from mpm.rigid.ordered import dot
from mpm.rigid.tables import enthalpies, temperatures

TIGHT = 1e-10  # of the span: residual of Newton, for what it leaves is not between bounds
CLEAN = 1e-9  # of the span: what a solve may leave beyond the bounds


class BoundedSteps(NewtonSteps):
    """Steps of one body whose system was made with `hats`."""

    CARRIES = (*NewtonSteps.CARRIES, "euler")

    def __init__(self, system, tolerance: float):
        super().__init__(system, tolerance, 2)
        self.close = TIGHT / tolerance
        self.low, self.high = system.bounds[0] - system.zero, system.bounds[1] - system.zero
        self.ends = [float(enthalpies(system.alpha, system.zero, np.array([t]))[0]) if np.isfinite(t) else t for t in system.bounds]
        self.range = abs(float(np.diff(enthalpies(system.alpha, system.zero, np.array([system.coldest, system.hottest])))[0]))  # [J/kg]
        self.euler = 0

    def beyond(self, state) -> float:
        """How far the temperatures leave the bounds [K]."""
        theta = temperatures(self.problem.table, state)[self.weight > 0]
        return max(float((theta - self.high).max()), float((self.low - theta).max()), 0.0)

    def attempt(self, dt: float) -> float:
        error = super().attempt(dt)
        if not np.isfinite(error):
            return error
        new, taken, self.by_euler = self.reached, dt * dot(self.tableau.a[-1], self.taken), False
        if self.beyond(new) > CLEAN * self.system.span:
            found = self.stage(self.state, dt, self.around(self.now + dt), new, np.empty(len(self.state)))
            if found is None or self.beyond(found[0]) > CLEAN * self.system.span:
                return np.inf
            error, self.by_euler = self.norm(found[0] - new) / self.allowed, True
            new, taken = found[0], dt * found[1]
        self.new, self.gain = self.within(new, taken)
        return error

    def within(self, state, taken: float):
        """(state clipped to the bounds, heat taken): what that and the residual of the solve left over goes to nodes with room, or was never taken.

        The latter where the whole body is at the bound, and only as far as round-off goes: more is left for the ledger to show.
        """
        low, high = self.ends
        kept = np.where(self.weight > 0, np.clip(state, low, high), state)
        spare = dot(self.weight, self.state) + taken - dot(self.weight, kept)
        room = np.where(self.weight > 0, (high - kept) if spare > 0 else (kept - low), 0.0)
        room = np.where(np.isfinite(room), room, 1.0)
        whole = dot(self.weight, room)
        if whole > abs(spare):
            return kept + spare / whole * room, taken
        return kept, taken - spare if abs(spare) <= CLEAN * float(self.weight.sum()) * self.range else taken

    def accept(self):
        self.before, self.before_q = self.state, self.q
        self.state, self.q = self.new, self.q + self.gain
        self.euler += self.by_euler
        self.now += self.dt

    def dense(self, s):
        """Basis (S, 1), columns (1, N), exchanged heat (S,)."""
        s = np.asarray(s, dtype=float)
        return s[:, None], (self.state - self.before)[None], self.before_q + s * self.gain

    def temperature(self, state):
        return np.clip(super().temperature(state), self.low, self.high)  # the table's last digits
