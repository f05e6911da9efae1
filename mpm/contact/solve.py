"""The impulses of a step: projected Gauss-Seidel over the contacts, from those of the step before.

A = sum W_A^2/m_i + sum W_B^2/m_j, the same for every direction;   lambda_n <- max(0, lambda_n - (u_n + max(g/dt, -PUSH c))/A),
lambda_t <- lambda_t - u_t/A, cut to mu lambda_n.   Ends when no contact changes its speed by more than CLOSE c, or after SWEEPS.
A tool that forces move adds its 1/M to A, and takes the reaction along its direction.
Overlap, where a scene has any, is pushed out at PUSH of the speed of sound c at most. Sweeps run forwards and backwards in turn, one thread's work.
"""

from typing import Any, NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.contact.tools import carry, lightness, recoil
from mpm.jit import kernel

PUSH, CLOSE, SWEEPS = 0.01, 1e-7, 60
COARSE = 2e-6  # CLOSE of nodes in float32
SURE = 0.1  # cells: closer gaps are always in the sweeps


class Problem(NamedTuple):
    """What the impulses of a step are looked for with. F fields, C contacts, M nodes of a contact."""

    contacts: Any
    at: np.ndarray  # (C, 2, M) nodes
    coef: np.ndarray  # (C, 2, D, M) W
    fields: np.ndarray  # (B,)
    nodes: np.ndarray  # (F, n, columns) velocity and mass
    force: np.ndarray  # (F, n or 0, columns) change of velocity in the step
    tools: Any
    impulse: np.ndarray  # (C, D) on the A side [kg m/s]


@kernel
def press(space, problem, count, dt, sound, warm, rows):
    """The impulses of contacts 0..count, applied to the nodes (and to the changes in `force`, where it has rows) and to free tools.

    warm (P, against, D): impulses of the step before; rows (against,): where they are kept. Those of contacts far off are zero.
    """
    D, contacts, nodes = directions(space), problem.contacts, problem.nodes
    inverse, live, lively = np.zeros(count), np.empty(count, np.int64), 0
    u = np.empty(D)
    for i in range(count):
        most = 0.0
        for c in range(D):
            total = lightness(problem.tools, contacts.free[i])
            for k in range(2):
                if contacts.body[i, k] >= 0:
                    f = problem.fields[contacts.body[i, k]]
                    for m in range(problem.at.shape[2]):
                        mass = nodes[f, problem.at[i, k, m], D]
                        if mass > 0.0:
                            total += problem.coef[i, k, c, m] ** 2 / mass
            most = max(most, total)
        speed(problem, i, u)
        closing, before = 0.0, 0.0
        for c in range(D):
            closing += min(u[c] * contacts.normal[i, c], 0.0)
            if contacts.piece[i] >= 0:
                before += warm[contacts.piece[i], rows[contacts.against[i]], c] * contacts.normal[i, c]
        if most > 0.0 and (before > 0.0 or contacts.gap[i] + 1.5 * dt * closing < SURE * space.h):
            inverse[i], live[lively] = 1.0 / most, i
            lively += 1
    for k in range(lively):
        begin(problem, live[k], warm, rows, u)
    close = (COARSE if nodes.itemsize == 4 else CLOSE) * sound
    for sweep in range(SWEEPS):
        worst = 0.0
        for k in range(lively):
            worst = max(worst, one(problem, live[k if sweep % 2 == 0 else lively - 1 - k], dt, sound, inverse, u))
        if worst <= close:
            break


@kernel
def speed(problem, i, u):
    """u of contact i."""
    contacts = problem.contacts
    for c in range(len(u)):
        total = 0.0
        for k in range(2):
            if contacts.body[i, k] >= 0:
                f, way = problem.fields[contacts.body[i, k]], 1.0 if k == 0 else -1.0
                for m in range(problem.at.shape[2]):
                    total += way * problem.coef[i, k, c, m] * problem.nodes[f, problem.at[i, k, m], c]
        u[c] = total - contacts.given[i, c]
    carry(problem.tools, contacts.free[i], u)


@kernel
def push(problem, i, change):
    """Put a change of impulse on both sides."""
    D, contacts = len(change), problem.contacts
    for k in range(2):
        if contacts.body[i, k] < 0:
            continue
        f, way = problem.fields[contacts.body[i, k]], 1.0 if k == 0 else -1.0
        for m in range(problem.at.shape[2]):
            n = problem.at[i, k, m]
            mass = problem.nodes[f, n, D]
            if mass > 0.0:
                for c in range(D):
                    step = way * problem.coef[i, k, c, m] * change[c] / mass
                    problem.nodes[f, n, c] += step
                    if problem.force.shape[1] > 0:
                        problem.force[f, n, c] += step
    recoil(problem.tools, contacts.free[i], change)


@kernel
def begin(problem, i, warm, rows, change):
    """The impulse of the step before, within the cone of this one."""
    contacts = problem.contacts
    if contacts.piece[i] < 0:
        return
    old, along, square = warm[contacts.piece[i], rows[contacts.against[i]]], 0.0, 0.0
    for c in range(len(change)):
        along += old[c] * contacts.normal[i, c]
    if not along > 0.0:
        return
    for c in range(len(change)):
        change[c] = old[c] - along * contacts.normal[i, c]
        square += change[c] ** 2
    most = contacts.mu[i] * along
    share = 1.0 if square <= most * most else most / square**0.5
    for c in range(len(change)):
        change[c] = share * change[c] + along * contacts.normal[i, c]
        problem.impulse[i, c] = change[c]
    push(problem, i, change)


@kernel
def one(problem, i, dt, sound, inverse, u):
    """Relax one contact; by how much its speed changed."""
    contacts, impulse = problem.contacts, problem.impulse
    D, n, mu = len(u), contacts.normal[i], contacts.mu[i]
    speed(problem, i, u)
    along, un = 0.0, 0.0
    for c in range(D):
        along += impulse[i, c] * n[c]
        un += u[c] * n[c]
    pressed = max(0.0, along - (un + max(contacts.gap[i] / dt, -PUSH * sound)) * inverse[i])
    square = 0.0
    for c in range(D):  # u becomes the new impulse, then its change
        u[c] = impulse[i, c] - along * n[c] - (u[c] - un * n[c]) * inverse[i]
        square += u[c] ** 2
    share = 0.0
    if pressed > 0.0 and mu > 0.0 and square > 0.0:
        share = 1.0 if mu == np.inf or square <= (mu * pressed) ** 2 else mu * pressed / square**0.5
    largest = 0.0
    for c in range(D):
        new = share * u[c] + pressed * n[c]
        u[c] = new - impulse[i, c]
        impulse[i, c] = new
        largest = max(largest, abs(u[c]))
    if largest > 0.0:
        push(problem, i, u)
    return largest / inverse[i]
