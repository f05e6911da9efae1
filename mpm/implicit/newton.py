"""The minimum of one step's incremental potential over nodal displacements: Newton's method, banded Cholesky (LAPACK), Armijo's line search.

    Pi(u) = sum V0 W - sum f.u + sum m |u - dt v|^2/(2 dt^2) + rate sum m |u|^2/(2 dt) + ghost penalty + walls
The part of the particles is convex in the trial strain, not in u (large rotations and stresses may tip a tangent): then a share of the diagonal is added.
Forces that follow a surface need not have a potential: Pi takes what they work along the last move, by the mean of the forces at both of its ends.
A step is done where particles move by less than CLOSE cells of one full Newton step, or where the square of that move says that the next will (quadratic;
where forces follow a surface, that move times its ratio to the move before).
"""

import math
from dataclasses import dataclass

import numpy as np

from mpm.implicit.assemble import assemble
from mpm.implicit.contact import CLOSER, push_back
from mpm.implicit.following import Following, follow, stiffen, twist
from mpm.implicit.free import Free, couple, settle
from mpm.implicit.matrix import Band, add_diagonal, diagonal, new_matrix, solver, untwisted
from mpm.implicit.nodes import third_differences
from mpm.implicit.volume import assemble_volume
from mpm.state import Axisymmetric

CLOSE, SQUARE, MOST_MOVE = 1e-5, 1e-6, 0.5  # cells
ITERATIONS, HALVINGS, SHIFTS, LAGS = 30, 30, 12, 20
FIRST_SHIFT, ARMIJO = 1e-6, 1e-4
ROUNDED = 1e-13  # of forces: a sum of them that is nothing


@dataclass
class Answer:
    """Displacements u (A, D), or None where Newton's method failed; counts; how deep pieces are in walls."""

    u: np.ndarray | None
    iterations: int
    shifts: int
    depth: np.ndarray


@dataclass
class Problem:
    """What a step minimises."""

    space: object
    body: object
    nodes: object
    pushed: object
    free: Free
    dt: float
    drag: float
    most: float = math.inf  # that a particle may move in one iteration [m]
    following: Following | None = None
    begun: tuple = ()  # where the last gradient was asked for, and the forces there that follow the surface

    def potential(self, u: np.ndarray, r: np.ndarray, matrix, depth: np.ndarray, want: bool) -> float:
        """Pi(u) [J], inf where a particle is turned inside out; with `want` also its gradient r (A, D) and Hessian (mpm.implicit.matrix).

        What follows the surface counts from the last u that was asked for with `want`.
        """
        nodes, dt = self.nodes, self.dt
        if want:
            r[:], matrix.values[:] = 0.0, 0.0
        if isinstance(matrix, Band):
            total = assemble(self.space, self.body, nodes, u, dt, r, matrix.values, want)
        else:
            total = assemble_volume(self.space, self.body, nodes, u, dt, r, matrix, want)
        if not math.isfinite(total):
            return math.inf
        if self.following is not None:
            pull = np.zeros(u.shape)
            if not follow(self.following, u, pull):
                return math.inf
            if want:
                stiffen(self.following, nodes, matrix)
                self.begun = u.copy(), pull
                r -= pull
            total -= self.worked(u, pull)
        total += third_differences(nodes, u, r, matrix, want)
        if len(self.free.d):
            total += settle(nodes, self.pushed, self.free, u, dt)
        total += push_back(nodes, self.pushed, u, r, matrix, want, depth)
        late, inert, slow = u - dt * nodes.v, nodes.m[:, None] / (dt * dt), self.drag * nodes.m[:, None] / dt
        total += float(0.5 * np.sum(inert * late * late) + 0.5 * np.sum(slow * u * u) - np.sum(nodes.push * u))
        if want:
            r += inert * late + slow * u - nodes.push
            add_diagonal(matrix, nodes, np.broadcast_to(inert + slow, u.shape))
        return total

    def worked(self, u: np.ndarray, pull: np.ndarray) -> float:
        """Of forces that follow the surface, `pull` at u, on the way from where the last gradient was asked for [J]."""
        return float(0.5 * np.sum((self.begun[1] + pull) * (u - self.begun[0])))

    def followed(self, u: np.ndarray) -> float:
        """What they work in the whole step [J]."""
        if self.following is None:
            return 0.0
        first, last = np.zeros(u.shape), np.zeros(u.shape)
        follow(self.following, np.zeros(u.shape), first)
        follow(self.following, u, last)
        return float(0.5 * np.sum((first + last) * u))

    def move(self, step: np.ndarray) -> float:
        """The largest move of a particle [m]: at most that of its heaviest node, weighted."""
        size = np.sqrt(np.sum(step * step, axis=1))
        return float(np.max(np.einsum("pk,pk->p", self.nodes.w, size[self.nodes.node])))


def solve(problem: Problem, guess: np.ndarray) -> Answer:
    """The displacements of a step, from a guess (A, D) that is zero where walls hold: minima until friction is that of its own normal forces."""
    answer, pushed = minimise(problem, guess), problem.pushed
    rubs = (pushed.mu > 0) & np.isfinite(pushed.mu)
    if not rubs.any():
        return answer
    for _ in range(LAGS):
        if answer.u is None:
            return answer
        now = pushed.mu[rubs] * pushed.stiff[rubs] * answer.depth[rubs]
        if np.sum(np.abs(now - pushed.limit[rubs])) <= CLOSER * np.sum(now):
            return answer
        pushed.limit[rubs] = now
        again = minimise(problem, answer.u)
        answer = Answer(again.u, answer.iterations + again.iterations, answer.shifts + again.shifts, again.depth)
    return Answer(None, answer.iterations, answer.shifts, answer.depth)


def minimise(problem: Problem, guess: np.ndarray) -> Answer:
    """The minimum of the potential, with friction as it is."""
    nodes, h = problem.nodes, problem.space.h
    free, r, matrix = nodes.eq >= 0, np.empty(guess.shape), new_matrix(problem.space, nodes)
    depth = np.zeros(len(problem.pushed.owner))
    u, shifts, last = guess.copy(), 0, h
    if not nodes.unknowns:  # all of it is in its nozzle
        return Answer(u, 0, 0, depth)
    Pi = problem.potential(u, r, matrix, depth, True)
    if not math.isfinite(Pi) and u.any():
        u[free] = 0.0
        Pi = problem.potential(u, r, matrix, depth, True)
    if not math.isfinite(Pi):
        return Answer(None, 0, 0, depth)
    for count in range(1, ITERATIONS + 1):
        step, tried = newton_step(problem, u, r, matrix, depth)
        shifts += tried
        if step is None:
            return Answer(None, count, shifts, depth)
        full = problem.move(step)
        share = min(1.0, problem.most / full) if full > 0 else 1.0
        slope, small = float(np.sum(r[free] * step[free])), full < CLOSE * h
        for _ in range(HALVINGS):
            new = problem.potential(u + share * step, r, matrix, depth, False)
            if small or new <= Pi + ARMIJO * share * slope + 1e-13 * abs(Pi):
                break
            share *= 0.5
        else:
            return Answer(None, count, shifts, depth)
        if not math.isfinite(new):
            return Answer(None, count, shifts, depth)
        u += share * step
        if small or (count > 1 and share == 1.0 and not tried and full * full / last < SQUARE * h):
            return Answer(u, count, shifts, depth)
        last = h if problem.following is None else full
        Pi = problem.potential(u, r, matrix, depth, True)
    return Answer(None, ITERATIONS, shifts, depth)


def newton_step(problem: Problem, u, r, matrix, depth) -> tuple[np.ndarray | None, int]:
    """(-K^-1 r on the nodes, shifts that it took); None where K stays indefinite. The matrix is spent."""
    for tried in range(SHIFTS):
        if tried:
            problem.potential(u, r, matrix, depth, True)
        shift, Q = FIRST_SHIFT * 10.0 ** (tried - 1) if tried else 0.0, len(problem.free.d)
        c, k = np.empty((Q, *u.shape)), np.empty(Q)
        if Q:
            couple(problem.nodes, problem.pushed, problem.free, u, problem.dt, c, k)
        found = solved(problem, solver(matrix, problem.nodes, shift * shares(problem, matrix)), -np.concatenate([r[None], c]))
        if found is None:
            continue
        step, rest = found[0], np.diag(k) + np.einsum("qnc,pnc->qp", c, found[1:])  # k - c K^-1 c
        if Q and np.linalg.eigvalsh(rest + rest.T)[0] <= 0.0:
            continue
        if problem.following is not None:
            as_a_whole(problem, r, step, depth)
        return step - np.einsum("q,qnc->nc", np.linalg.solve(rest, np.einsum("qnc,nc->q", c, step)), found[1:]) if Q else step, tried
    return None, SHIFTS


def as_a_whole(problem: Problem, r: np.ndarray, step: np.ndarray, depth: np.ndarray) -> None:
    """Where nothing holds or touches a body, inertia and drag alone say how far it moves as a whole: shifts and a solver that stops early do not."""
    if depth.any() or problem.pushed.limit.any():
        return
    m, pace, pull = problem.nodes.m, 1.0 / problem.dt**2 + problem.drag / problem.dt, problem.begun[1]
    for c in np.flatnonzero(unheld(problem)):
        whole = np.sum(r[:, c])
        whole = whole if abs(whole) > ROUNDED * np.sum(np.abs(pull[:, c])) else 0.0
        step[:, c] -= (whole / pace + np.sum(m * step[:, c])) / np.sum(m)


def unheld(problem: Problem) -> np.ndarray:
    """(D,) whether no wall and no axis keeps a body from moving along a direction: no node is held there, and no weights are folded."""
    nodes = problem.nodes
    folded = [np.sum(np.where(nodes.flip >> c & 1, -nodes.w, nodes.w), axis=1).min() < 1.0 - 1e-9 for c in range(nodes.eq.shape[1])]
    found = (nodes.eq >= 0).all(axis=0) & ~np.array(folded)
    found[0] &= not isinstance(problem.space, Axisymmetric)
    return found


def shares(problem: Problem, matrix) -> np.ndarray:
    """What a shift of 1 adds to the diagonal (A, D): as much again; where forces follow a surface as much by mass, which moves no body as a whole."""
    size, m = diagonal(matrix, problem.nodes), problem.nodes.m[:, None]
    free = problem.nodes.eq >= 0
    return size if problem.following is None else np.median((size / m)[free]) * m * free


def solved(problem: Problem, solve, right: np.ndarray) -> np.ndarray | None:
    """K^-1 right (R, A, D) by the solver of K's symmetric part, with what of it is skew, too."""
    if solve is None or problem.following is None:
        return None if solve is None else solve(right)
    free = problem.nodes.eq >= 0

    def turned(x):
        out = np.zeros(x.shape)
        twist(problem.following, x, out)
        return out * free

    found = [untwisted(solve, turned, one * free) for one in right]
    return None if any(one is None for one in found) else np.stack(found)
