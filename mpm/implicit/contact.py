"""Contact walls and tools of an implicit step: pieces of surface that they push back, by a penalty on their gaps, and hold along them, by springs that slide.

    Pi += sum k S <-gap>^2/2 + H(|s|),   gap = n.(x_s + u(x_s) - obstacle),   k = STIFFNESS (lam + 2 mu)/h,   u(x_s) = sum (w + grad w.(x_s - x_p)) u
    s = s^n + u_t less the obstacle's,   H = k S s^2/2 up to |s| = F/(k S), F|s| - F^2/(2 k S) beyond,   F = friction times the normal force
u(x_s) is exact for linear u. s^n, the stretch that a spring keeps, makes sticking hold for good. F is that of the last answer: a step is solved until
it is its own (CLOSER), and inf where nothing slides, for pieces that touch as the step begins
(TOUCHES: a body that is put on its wall is held from the first step on). Obstacles move by what they are told in the step.
Gaps are `m g/(k S)` deep under weight: STIFFNESS = 10 keeps that below a hundredth of a cell of elastic compression.
Fails when   a piece crosses more than half a cell in one step (Newton's moves are kept shorter than that), or turns about a tool by more than its faces.
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.contact.find import find_all
from mpm.contact.found import BODY, FACING
from mpm.contact.skin import POINT, lay_skins, new_skin
from mpm.contact.step import TOUCH, Touching
from mpm.contact.tools import Tools, place_tools
from mpm.implicit.matrix import add
from mpm.implicit.trial import sign
from mpm.jit import kernel

STIFFNESS, NEAR, TOUCHES, CLOSER = 10.0, 2.0, 1e-6, 1e-4  # cells: pieces farther from an obstacle are not asked; nearer touch it


class Pushed(NamedTuple):
    """P pairs of a piece and a wall or tool that may touch in this step."""

    piece: np.ndarray  # (P,) number of the piece
    owner: np.ndarray  # (P,) particle
    arm: np.ndarray  # (P, D) from the particle to the piece [m]
    against: np.ndarray  # (P,) see mpm.contact.found
    normal: np.ndarray  # (P, D) out of the obstacle
    told: np.ndarray  # (P, D) by how much the obstacle moves there as it is told [m]
    given: np.ndarray  # (P, D) by how much it moves: told, and what forces move a free tool (mpm.implicit.free)
    free: np.ndarray  # (P,) number of a tool that a force moves; -1
    gap: np.ndarray  # (P,) at the start [m]
    stiff: np.ndarray  # (P,) k S [N/m]
    area: np.ndarray  # (P,) S
    faces: np.ndarray  # (P,) whether the piece is a face that looks at the obstacle: heat passes through it where it touches
    mu: np.ndarray  # (P,) friction
    limit: np.ndarray  # (P,) F [N]
    stretch: np.ndarray  # (P, D) s^n [m]


def nothing(D: int) -> Pushed:
    """No pairs."""
    none, whole, ways = np.zeros(0), np.zeros(0, np.int64), np.zeros((0, D))
    return Pushed(whole, whole, ways, whole, ways, ways, ways.copy(), whole, none, none, none, none > 0, none, none, ways)


def may_touch(scene, clock, dt: float, stiffness: float) -> Pushed:
    """Pairs of pieces and obstacles of a scene at the start of a step of dt."""
    met, D = scene.meeting, directions(scene.space)
    if met is None:
        return nothing(D)
    touching = met.touching
    if met.drive is not None:
        met.drive.lay(clock.time, dt, 1)
        place_tools(touching.tools, 0, dt, 0.0)
    skin = new_skin(D, touching.first)
    lay_skins(scene.space, scene.bodies, skin, skin.every, skin.first)
    found, count = find_all(scene.space, scene.for_motion, skin, touching.stops, touching.pairs, touching.tools, touching.room, NEAR, touching.number[:0])
    piece = found.piece[:count]
    cosine = np.sum(found.normal[:count] * skin.normal[piece], axis=1)
    s = np.flatnonzero((piece >= 0) & (cosine < 0.5))
    faces = (cosine[s] < FACING) & (skin.area[piece[s]] > 2 * POINT * scene.space.h ** (D - 1))
    piece, normal, against, mu, gap = (column[s] for column in (found.piece, found.normal, found.against, found.mu, found.gap))
    stiff, stretch = stiffness * skin.area[piece], touching.warm[piece, touching.rows[against]]
    stretch = stretch - np.sum(stretch * normal, axis=1)[:, None] * normal
    fast = np.isinf(mu)
    limit = np.where(fast, np.where(gap < TOUCHES * scene.space.h, np.inf, 0.0), np.where(fast, 0.0, mu) * stiff * np.maximum(-gap, 0.0))
    told = dt * found.given[s]
    return Pushed(piece, skin.owner[piece], skin.x[piece] - skin.home[piece], against, normal, told, told.copy(), found.free[s], gap, stiff,
                  skin.area[piece], faces, mu, limit, stretch)  # fmt: skip


@kernel(inline=True)
def place(nodes, pushed, s, u, weight, move):
    """weight (M,) of the nodes for piece s, and move (D,) by how much it moves, less its obstacle."""
    for k in range(nodes.w.shape[1]):
        weight[k] = nodes.w[pushed.owner[s], k]
        for c in range(u.shape[1]):
            weight[k] += nodes.g[pushed.owner[s], k, c] * pushed.arm[s, c]
    for c in range(u.shape[1]):
        move[c] = -pushed.given[s, c]
        for k in range(nodes.w.shape[1]):
            move[c] += weight[k] * sign(nodes, pushed.owner[s], k, c) * u[nodes.node[pushed.owner[s], k], c]


@kernel(inline=True)
def pressed(pushed, s, move, way):
    """(gap, |s|) of piece s; way (D,) <- s."""
    along, square = 0.0, 0.0
    for c in range(len(move)):
        along += pushed.normal[s, c] * move[c]
    for c in range(len(move)):
        way[c] = pushed.stretch[s, c] + move[c] - along * pushed.normal[s, c]
        square += way[c] * way[c]
    return pushed.gap[s] + along, np.sqrt(square)


@kernel(inline=True)
def springs(pushed, s, gap, size):
    """(stiffness of the gap, of the spring along the surface, whether that slides) of piece s."""
    full, limit = pushed.stiff[s], pushed.limit[s]
    slides = full * size > limit
    return full if gap < 0.0 else 0.0, 0.0 if limit == 0.0 else limit / size if slides else full, slides


@kernel
def push_back(nodes, pushed, u, r, matrix, want, depth):
    """The obstacles' part of the potential; of residual and matrix where wanted. depth (P,) is how deep each piece is in its obstacle [m]."""
    total, D, M = 0.0, u.shape[1], nodes.w.shape[1]
    weight, move, way, slope = np.empty(M), np.empty(D), np.empty(D), np.empty((D, D))
    for s in range(pushed.owner.shape[0]):
        place(nodes, pushed, s, u, weight, move)
        gap, size = pressed(pushed, s, move, way)
        depth[s] = max(-gap, 0.0)
        full, limit = pushed.stiff[s], pushed.limit[s]
        stiff, hold, slides = springs(pushed, s, gap, size)
        total += 0.5 * stiff * gap * gap
        if limit > 0.0:
            total += limit * (size - 0.5 * limit / full) if slides else 0.5 * full * size * size
        if not want or (stiff == 0.0 and hold == 0.0):
            continue
        for c in range(D):
            for d in range(D):
                slope[c, d] = (stiff - hold) * pushed.normal[s, c] * pushed.normal[s, d] + (hold if c == d else 0.0)
                if slides and size > 0.0:
                    slope[c, d] -= hold * way[c] * way[d] / (size * size)
        p = pushed.owner[s]
        for k in range(M):
            n = nodes.node[p, k]
            for c in range(D):
                part = weight[k] * sign(nodes, p, k, c)
                r[n, c] += part * (stiff * gap * pushed.normal[s, c] + hold * way[c])
                for m in range(M):
                    for d in range(D):
                        add(matrix, nodes, n, c, nodes.node[p, m], d, part * weight[m] * sign(nodes, p, m, d) * slope[c, d])
    return total


@kernel
def let_slide(nodes, pushed, u, gap, force, slip):
    """What a step leaves: gap (P,) [m], force (P, D) of obstacles on pieces [N], slip (P, D) of springs [m], and s^{n+1} in pushed.stretch."""
    D = u.shape[1]
    weight, move, way = np.empty(nodes.w.shape[1]), np.empty(D), np.empty(D)
    for s in range(pushed.owner.shape[0]):
        place(nodes, pushed, s, u, weight, move)
        gap[s], size = pressed(pushed, s, move, way)
        full, limit = pushed.stiff[s], pushed.limit[s]
        held = 0.0 if gap[s] >= 0.0 or limit == 0.0 else limit / (full * size) if full * size > limit else 1.0
        for c in range(D):
            slip[s, c] = (1.0 - held) * way[c]
            force[s, c] = full * (max(-gap[s], 0.0) * pushed.normal[s, c] - held * way[c])
            pushed.stretch[s, c] = held * way[c]


def keep_books(scene, nodes, pushed: Pushed, u: np.ndarray, depth: np.ndarray, dt: float) -> float:
    """Stretches for the next step, times in touch, what the records want to know (mpm.contact.step.Touching); returns the work of tools [J]."""
    met = scene.meeting
    if met is None:
        return 0.0
    touching: Touching = met.touching
    gap, force, slip = np.zeros(len(pushed.gap)), np.zeros(pushed.arm.shape), np.zeros(pushed.arm.shape)
    let_slide(nodes, pushed, u, gap, force, slip)
    rows, touches = touching.rows[pushed.against], pushed.faces & (gap <= TOUCH * scene.space.h)
    touching.warm[:] = 0.0
    touching.warm[pushed.piece, rows] = pushed.stretch
    np.add.at(touching.touched, (pushed.piece[touches], rows[touches]), dt)
    np.add.at(touching.pushed[0], pushed.against, dt * force)
    np.add.at(touching.spread[0], pushed.against[touches], dt * pushed.area[touches])
    B = len(touching.first) - 1
    x = scene.bodies[0].particles.x[pushed.owner] + pushed.arm
    if isinstance(touching.tools, Tools):
        tool = pushed.against - BODY - B
        x = np.where((tool >= 0)[:, None], x - touching.tools.centre[np.maximum(tool, 0)], x)
    out = [np.pad(one, ((0, 0), (0, 3 - one.shape[1]))) for one in (x, dt * force)]
    np.add.at(touching.turned[0], pushed.against, np.cross(*out))
    work = float(np.sum(force * pushed.given))
    touching.worked[0] += work
    along = np.sum(force * pushed.normal, axis=1)[:, None] * pushed.normal
    touching.rubbed[0] -= np.sum((force - along) * slip)
    np.maximum.at(touching.deepest[0], pushed.against, depth)
    return work
