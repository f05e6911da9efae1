"""Contact walls of an implicit step: pieces of surface that a wall pushes back, by a penalty on their gaps.

Pi += sum k S <-gap>^2/2,   gap = (x_s + u(x_s) - wall) n,   k = STIFFNESS (K + 4 mu/3)/h,   u(x_s) = sum (w + grad w.(x_s - x_p)) u: exact for linear u
A wall on which nothing slides (stick) also holds the pieces that touch it as the step begins: k S |u_t|^2/2.
Gaps are `m g/(k S)` deep under weight: STIFFNESS = 10 keeps that below a hundredth of a cell of elastic compression.
Fails when   a piece crosses more than half a cell in one step: Newton's moves are kept shorter than that.
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions, extents
from mpm.implicit.assemble import sign
from mpm.jit import kernel
from mpm.state import PAD

STIFFNESS, NEAR = 10.0, 2.0  # NEAR cells: pieces farther from a wall are not asked


class Pushed(NamedTuple):
    """P pairs of a piece and a wall that may touch in this step."""

    piece: np.ndarray  # (P,) number of the piece
    owner: np.ndarray  # (P,) particle
    arm: np.ndarray  # (P, D) from the particle to the piece [m]
    axis: np.ndarray  # (P,) direction of the wall's normal
    inward: np.ndarray  # (P,) +1: the wall is below, -1: above
    gap: np.ndarray  # (P,) at the start [m]
    stiff: np.ndarray  # (P,) k S [N/m]
    grip: np.ndarray  # (P,) of what holds it along the wall [N/m]
    row: np.ndarray  # (P,) number of the wall, 2 axis + side


def may_touch(space, skin, stops, stiffness: float) -> Pushed:
    """Pairs of pieces and walls; stops (3, 2) is the friction of walls: 0, or inf (nothing slides), below 0 no contact."""
    D, found = directions(space), []
    for axis, side in np.argwhere(stops[:D] >= 0):
        plane = (extents(space)[axis] - 1 - 2 * PAD) * space.h if side else 0.0
        inward = -1.0 if side else 1.0
        gap = inward * (skin.x[:, axis] - plane)
        s = np.flatnonzero((gap < NEAR * space.h) & (skin.area > 0) & (inward * skin.normal[:, axis] < 0.5))
        push = stiffness * skin.area[s]
        grip = np.where((gap[s] < 0) & np.isinf(stops[axis, side]), push, 0.0)
        found.append((s, skin.owner[s], skin.x[s] - skin.home[s], np.full(len(s), axis), np.full(len(s), inward), gap[s], push, grip,
                      np.full(len(s), 2 * axis + side)))  # fmt: skip
    if not found:
        none, whole = np.zeros(0), np.zeros(0, np.int64)
        return Pushed(whole, whole, np.zeros((0, D)), whole, none, none, none, none, whole)
    return Pushed(*(np.concatenate(column) for column in zip(*found, strict=True)))


@kernel
def push_back(space, nodes, pushed, u, r, band, want, depth):
    """The walls' part of the potential; of residual and lower band where wanted. depth (P,) is how deep each piece is in its wall [m]."""
    total, D, M = 0.0, directions(space), nodes.w.shape[1]
    weight = np.empty(M)
    for s in range(pushed.owner.shape[0]):
        p, axis = pushed.owner[s], pushed.axis[s]
        for k in range(M):
            weight[k] = nodes.w[p, k]
            for c in range(D):
                weight[k] += nodes.g[p, k, c] * pushed.arm[s, c]
        for c in range(D):
            move = 0.0
            for k in range(M):
                move += weight[k] * sign(nodes, p, k, c) * u[nodes.node[p, k], c]
            if c == axis:
                gap = pushed.gap[s] + pushed.inward[s] * move
                depth[s] = max(-gap, 0.0)
                stiff, by = (pushed.stiff[s] if gap < 0.0 else 0.0), gap * pushed.inward[s]
            else:
                stiff, by = pushed.grip[s], move
            total += 0.5 * stiff * by * by
            if not want or stiff == 0.0:
                continue
            for k in range(M):
                part = stiff * weight[k] * sign(nodes, p, k, c)
                r[nodes.node[p, k], c] += part * by
                i = nodes.eq[nodes.node[p, k], c]
                for m in range(M):
                    j = nodes.eq[nodes.node[p, m], c]
                    if i >= j >= 0:
                        band[j, i - j] += part * weight[m] * sign(nodes, p, m, c)
    return total
