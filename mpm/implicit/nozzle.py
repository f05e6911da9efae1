"""What is still in its nozzle in an implicit step (docs/physics.md 20): nodes that it holds are no unknowns, and move as the nozzle does.

A node is told to move where at least SHARE of its mass is in the nozzle. Particles in the nozzle are put where they are told to be after each step.
Work       r . u of the nodes that are told: r is the force that holds them to it
"""

import numpy as np

from mpm.implicit.deliver import drag_rate, loads, pass_time
from mpm.implicit.matrix import new_matrix
from mpm.integrate.nozzle import Nozzle
from mpm.state import Surface

SHARE = 0.5


@loads.register(Nozzle)
def loads_nozzle(source, body, nodes, push, dt):
    return None


@drag_rate.register(Nozzle)
def drag_rate_nozzle(source, dt):
    return 0.0


@pass_time.register(Nozzle)
def pass_time_nozzle(source, i, A, D, dt):
    return None


def told_nodes(source, particles, flat: np.ndarray, w: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Which of the nodes (n,), of the mass `mass`, move as they are told; flat, w (N, M): nodes of the particles and their weights."""
    inside = source.behind > 0.0
    held = np.bincount(flat[inside].ravel(), (w * particles.m[:, None])[inside].ravel(), len(mass))
    return (held >= SHARE * mass) & (mass > 0.0)


def told_work(problem, u: np.ndarray) -> float:
    """Of the nozzle in a step, from its answer u (A, D), and by a change of its speed before it [J]."""
    source, p, held = problem.body.source, problem.body.particles, problem.nodes.eq < 0
    if not isinstance(source, Nozzle):
        return 0.0
    inside = source.behind > 0.0
    begun = 0.5 * np.sum(p.m[inside] * (source.speed[0] ** 2 - np.sum(p.v[inside] ** 2, axis=1)))
    r = np.empty(u.shape)
    problem.potential(u, r, new_matrix(problem.space, problem.nodes), np.zeros(len(problem.pushed.owner)), True)
    return float(np.sum(r[held] * u[held]) + begun)  # walls hold still


def carry(body, dt: float) -> None:
    """Particles in the nozzle at the end of a step."""
    source, p = body.source, body.particles
    if not isinstance(source, Nozzle):
        return
    inside = np.flatnonzero(source.behind > 0.0)
    source.behind[inside] -= dt * source.speed[0]
    p.x[inside] = source.place[inside] - source.behind[inside, None] * source.way
    p.v[inside], p.C[inside], p.B[inside], p.J[inside] = source.speed[0] * source.way, 0.0, 0.0, 1.0
    if isinstance(body.surface, Surface):
        rows = body.surface.row[inside]
        body.surface.F[rows[rows >= 0]] = np.eye(p.x.shape[1])
