"""Tools that a force moves along one direction e, in an implicit step: one more unknown each, its displacement d (docs/physics.md 17).

    Pi += M (d - dt v)^2/(2 dt^2) - F d,   pieces meet a tool where it then stands: their moves are less d e
For any u the best d is found first (a convex function of one number), so Newton's method sees Pi at it. The Hessian is then K - c k^-1 c^T with
c = d2Pi/du dd and k = d2Pi/dd2 > 0: solved with the factor of K and one right side more a tool (M. A. Woodbury, Princeton Stat. Res. Group 42 (1950)).
Fails when   a tool goes farther than FAR cells in a step, past the pieces that were looked for: the step is cut.
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.contact.tools import Tools
from mpm.implicit.contact import place, pressed, springs
from mpm.implicit.trial import sign
from mpm.jit import kernel

FAR, SETTLED, SWEEPS = 1.0, 1e-12, 200  # cells; of the force; iterations for d


class Free(NamedTuple):
    """Q tools of a step."""

    number: np.ndarray  # (Q,) among all tools
    way: np.ndarray  # (Q, D) e
    mass: np.ndarray  # (Q,) [kg]
    force: np.ndarray  # (Q,) along e [N]
    v: np.ndarray  # (Q,) along e [m/s]
    d: np.ndarray  # (Q,) [m]


def free_tools(scene, dt: float) -> Free:
    """The free tools that are there, as they stand; d is how far they would go by themselves."""
    tools = scene.meeting.touching.tools if scene.meeting is not None else None
    if not isinstance(tools, Tools):
        return Free(np.zeros(0, np.int64), np.zeros((0, scene.gravity.shape[1])), *np.zeros((4, 0)))
    which = np.flatnonzero((tools.light > 0) & tools.there)
    way = tools.way[which]
    mass, force, v = 1.0 / tools.light[which], np.sum(tools.force[which] * way, axis=1), np.sum(tools.v[which] * way, axis=1)
    return Free(which, way, mass, force, v, dt * (v + dt * force / mass))


@kernel(inline=True)
def felt(pushed, s, move, way, e):
    """Of piece s, that moves by `move` (D,) against a tool along e: (gap, stiffness of the gap, of the spring along the surface; n.e; way.e; what the
    spring's slope is short of its stiffness, over way). way (D,) <- the spring's stretch."""
    gap, slip = pressed(pushed, s, move, way)
    push, hold, slides = springs(pushed, s, gap, slip)
    across, along = 0.0, 0.0
    for c in range(len(e)):
        across += pushed.normal[s, c] * e[c]
        along += way[c] * e[c]
    return gap, push, hold, across, along, hold * along / (slip * slip) if slides and slip > 0.0 else 0.0


@kernel
def settle(nodes, pushed, free, u, dt):
    """d of every tool at displacements u, to free.d; pushed.given follows it. Returns what they cost [J]."""
    total, D, P = 0.0, u.shape[1], len(pushed.owner)
    weight, move, way, base = np.empty(nodes.w.shape[1]), np.empty(D), np.empty(D), np.empty((P, D))
    for s in range(P):
        for c in range(D):
            pushed.given[s, c] = pushed.told[s, c]
        place(nodes, pushed, s, u, weight, move)
        for c in range(D):
            base[s, c] = move[c]
    for q in range(len(free.d)):
        e, inert, d, low, high = free.way[q], free.mass[q] / (dt * dt), free.d[q], -math.inf, math.inf
        for _ in range(SWEEPS):
            rise, curve, size = inert * (d - dt * free.v[q]) - free.force[q], inert, abs(free.force[q]) + inert * abs(dt * free.v[q])
            for s in range(P):
                if pushed.free[s] != free.number[q]:
                    continue
                for c in range(D):
                    move[c] = base[s, c] - d * e[c]
                gap, push, hold, across, along, less = felt(pushed, s, move, way, e)
                force = push * gap * across + hold * along
                rise, size = rise - force, size + abs(force)
                curve += push * across * across + hold * (1.0 - across * across) - less * along
            if abs(rise) <= SETTLED * size:
                break
            if rise > 0.0:
                high = d
            else:
                low = d
            new = d - rise / curve
            if not low < new < high:
                new = 0.5 * (low + high)
            if new == d:
                break
            d = new
        free.d[q] = d
        total += 0.5 * inert * (d - dt * free.v[q]) ** 2 - free.force[q] * d
        for s in range(P):
            if pushed.free[s] == free.number[q]:
                for c in range(D):
                    pushed.given[s, c] = pushed.told[s, c] + d * e[c]
    return total


@kernel
def couple(nodes, pushed, free, u, dt, c, k):
    """c (Q, A, D) and k (Q,) at u and the d of `settle`."""
    D, M = u.shape[1], nodes.w.shape[1]
    weight, move, way = np.empty(M), np.empty(D), np.empty(D)
    c[:] = 0.0
    for q in range(len(k)):
        e = free.way[q]
        k[q] = free.mass[q] / (dt * dt)
        for s in range(len(pushed.owner)):
            if pushed.free[s] != free.number[q]:
                continue
            place(nodes, pushed, s, u, weight, move)
            _, push, hold, across, _, less = felt(pushed, s, move, way, e)
            p = pushed.owner[s]
            for a in range(D):
                pull = (push - hold) * across * pushed.normal[s, a] + hold * e[a] - less * way[a]
                k[q] += pull * e[a]
                for m in range(M):
                    c[q, nodes.node[p, m], a] -= weight[m] * sign(nodes, p, m, a) * pull


def move_on(scene, free: Free, dt: float) -> bool:
    """Where tools stand after the step, and how fast they go; false where one has gone too far."""
    if not len(free.d):
        return True
    tools = scene.meeting.touching.tools
    tools.shift[free.number] += free.d[:, None] * free.way
    tools.v[free.number] = free.d[:, None] / dt * free.way
    return bool(np.abs(free.d).max() <= FAR * scene.space.h)
