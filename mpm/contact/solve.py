"""The impulses of a step: projected Gauss-Seidel over the contacts, from those of the step before.

A = sum W_A^2/m_i + sum W_B^2/m_j, the same for every direction;   lambda_n <- max(0, lambda_n - (u_n + max(g/dt, -PUSH c))/A),
lambda_t <- lambda_t - u_t/A, cut to mu lambda_n.   Ends when no contact changes its speed by more than CLOSE c, or after SWEEPS.
Overlap, where a scene has any, is pushed out at PUSH of the speed of sound c at most. Sweeps run forwards and backwards in turn, one thread's work.
"""

import numpy as np

from mpm.boundary import directions
from mpm.jit import kernel

PUSH, CLOSE, SWEEPS = 0.01, 1e-7, 60
SURE = 0.1  # cells: closer gaps are always in the sweeps


@kernel
def press(space, contacts, count, at, coef, fields, nodes, force, now, dt, sound, warm, rows):
    """Impulses (count, D) [kg m/s] on the A side, applied to the nodes (and to the changes in `force`, where it has rows).

    warm (P, against, D): impulses of the step before; rows (against,): where they are kept. Returned: those of contacts far off are zero.
    """
    D, M = directions(space), at.shape[2]
    impulse, inverse, live, lively = np.zeros((count, D)), np.zeros(count), np.empty(count, np.int64), 0
    u = np.empty(D)
    for i in range(count):
        most = 0.0
        for c in range(D):
            total = 0.0
            for k in range(2):
                if contacts.body[i, k] >= 0:
                    f = fields[contacts.body[i, k]]
                    for m in range(M):
                        mass = nodes[f, now, at[i, k, m], D]
                        if mass > 0.0:
                            total += coef[i, k, c, m] ** 2 / mass
            most = max(most, total)
        speed(contacts, i, at, coef, fields, nodes, now, u)
        closing, before = 0.0, 0.0
        for c in range(D):
            closing += min(u[c] * contacts.normal[i, c], 0.0)
            if contacts.piece[i] >= 0:
                before += warm[contacts.piece[i], rows[contacts.against[i]], c] * contacts.normal[i, c]
        if most > 0.0 and (before > 0.0 or contacts.gap[i] + 1.5 * dt * closing < SURE * space.h):
            inverse[i], live[lively] = 1.0 / most, i
            lively += 1
    for k in range(lively):
        begin(contacts, live[k], at, coef, fields, nodes, force, now, warm, rows, impulse, u)
    for sweep in range(SWEEPS):
        worst = 0.0
        for k in range(lively):
            i = live[k if sweep % 2 == 0 else lively - 1 - k]
            worst = max(worst, one(contacts, i, at, coef, fields, nodes, force, now, dt, sound, inverse[i], impulse, u))
        if worst <= CLOSE * sound:
            break
    return impulse


@kernel
def speed(contacts, i, at, coef, fields, nodes, now, u):
    """u of contact i."""
    for c in range(len(u)):
        total = 0.0
        for k in range(2):
            if contacts.body[i, k] >= 0:
                f, way = fields[contacts.body[i, k]], 1.0 if k == 0 else -1.0
                for m in range(at.shape[2]):
                    total += way * coef[i, k, c, m] * nodes[f, now, at[i, k, m], c]
        u[c] = total


@kernel
def push(contacts, i, at, coef, fields, nodes, force, now, change):
    """Put a change of impulse on the nodes of both sides."""
    D = len(change)
    for k in range(2):
        if contacts.body[i, k] < 0:
            continue
        f, way = fields[contacts.body[i, k]], 1.0 if k == 0 else -1.0
        for m in range(at.shape[2]):
            n = at[i, k, m]
            mass = nodes[f, now, n, D]
            if mass > 0.0:
                for c in range(D):
                    step = way * coef[i, k, c, m] * change[c] / mass
                    nodes[f, now, n, c] += step
                    if force.shape[2] > 0:
                        force[f, now, n, c] += step


@kernel
def begin(contacts, i, at, coef, fields, nodes, force, now, warm, rows, impulse, change):
    """The impulse of the step before, within the cone of this one."""
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
        impulse[i, c] = change[c]
    push(contacts, i, at, coef, fields, nodes, force, now, change)


@kernel
def one(contacts, i, at, coef, fields, nodes, force, now, dt, sound, inverse, impulse, u):
    """Relax one contact; by how much its speed changed."""
    D, n, mu = len(u), contacts.normal[i], contacts.mu[i]
    speed(contacts, i, at, coef, fields, nodes, now, u)
    along, un = 0.0, 0.0
    for c in range(D):
        along += impulse[i, c] * n[c]
        un += u[c] * n[c]
    pressed = max(0.0, along - (un + max(contacts.gap[i] / dt, -PUSH * sound)) * inverse)
    square = 0.0
    for c in range(D):  # u becomes the new impulse, then its change
        u[c] = impulse[i, c] - along * n[c] - (u[c] - un * n[c]) * inverse
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
        push(contacts, i, at, coef, fields, nodes, force, now, u)
    return largest / inverse
