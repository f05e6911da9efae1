"""What stands on the nodes of an implicit step in the total frame (mpm.total): weights of the reference shape, laid once for the run.

Unknown is the step's displacement, as in the updated frame: with grad w = F_n^-T grad_X w of the start, f = 1 + sum u grad w = F_{n+1} F_n^-1, so potential,
residual and tangent are the same code. Which nodes stand in which row never changes. Nodes keep u and v from step to step: nothing is transferred.
No ghost penalty: points are exact for what a cut cell holds, so its nodes keep their proportions; and the penalty, on the step's displacements, would let
a body creep to rest over many steps, 1e-4 of its displacement short (a cantilever that bends far).
After a step and after an extrapolation the elastic strain is that of the nodes' displacement, b = F (1 + P) F^T, P = F_p^-1 F_p^-T - 1 what flow has left;
with F-bar, F times exp(extra), extra = (1 - own)(<ln J> - ln J)/3 over knot spans. So an elastic answer at rest depends on neither the steps nor the path.
"""

import numpy as np

from mpm.boundary import CONTACT, STICK, directions, extents
from mpm.implicit.nodes import Nodes, arrange, in_order
from mpm.implicit.spans import Spans, new_spans
from mpm.integrate.traction import share, within
from mpm.state import PAD
from mpm.total.reference import Skin, displacement_at, gradients_at
from mpm.total.step import leaning, product, sampled

ORDER = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # entries of a symmetric tensor


def lasting_nodes(space, body, reference) -> Nodes:
    """Nodes of a body at its reference shape, gradients grad_X w; without velocities and forces."""
    X, D = reference.X, directions(space)
    active, places = in_order(space, reference.active)
    held = np.zeros((len(reference.m), D), bool)
    held[reference.held[:, 0], reference.held[:, 1]] = True
    none, on = np.zeros((len(active), D)), laid(space, reference, X)
    spans = new_spans(body.locking, space, body.particles._replace(x=X), on[2].shape[1])
    carried, no_ghosts = (reference.m[active], none, none), (np.zeros((0, 4), np.int64), np.zeros(0))
    return arrange(space, places, held[active], on, carried, no_ghosts, spans)


def laid(space, reference, X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of points X (P, D) of the reference shape: nodes of the grid (P, M), flips, weights, gradients grad_X w (P, M, D); walls are folded in."""
    D, shape = directions(space), extents(space)
    first, w, g = sampled(space, X)
    node, lean = first[:, :, None] + np.arange(w.shape[2]), leaning(space)
    flip = np.zeros(node.shape, np.int8)
    for axis, side in np.argwhere(reference.walls[:D] < CONTACT):
        wall = PAD if side == 0 else shape[axis] - 1 - PAD
        on, beyond = node[:, axis] == wall, node[:, axis] < wall if side == 0 else node[:, axis] > wall
        node[:, axis] = np.where(beyond, 2 * wall - node[:, axis], node[:, axis])
        if reference.walls[axis, side] == STICK:  # zero on the wall, slopes free (mpm.total.reference)
            for one in (w, g):
                behind = np.sum(one[:, axis] * beyond, axis=1, keepdims=True)
                one[:, axis] = np.where(beyond, -one[:, axis], one[:, axis]) + np.where(on, lean * behind, 0.0)
        else:
            flip[:, axis] |= beyond
    flat, turn = node[:, 0], flip[:, 0]
    for a in range(1, D):
        flat = (flat[:, :, None] * shape[a] + node[:, a, None, :]).reshape(len(X), -1)
        turn = (turn[:, :, None] | flip[:, a, None, :] << a).reshape(len(X), -1)
    gradient = np.stack([product(np.where(np.arange(D)[None, :, None] == a, g, w)) for a in range(D)], axis=2)
    return flat, turn, product(w), gradient


def home(space, nodes: Nodes) -> np.ndarray:
    """Numbers of the nodes on the grid (A,)."""
    return np.ravel_multi_index(tuple(nodes.places.T), extents(space))


def begin_step(space, reference, lasting: Nodes, gravity: np.ndarray, dt: float) -> tuple[Nodes, np.ndarray, float]:
    """(nodes of a step of dt, forces of tractions by reference area at its end (A, D) [N], rate of drag in its middle [1/s])."""
    D, at = directions(space), home(space, lasting)
    H, _ = gradients_at(space, reference, reference.X)
    g = np.einsum("pke,ped->pkd", lasting.g, np.linalg.inv(np.eye(D) + H))
    push = reference.m[:, None] * gravity
    push[reference.near] *= 1.0 - reference.less
    v, t, pull = np.where(lasting.eq >= 0, reference.v[at, :D], 0.0), reference.t[0], np.zeros((len(at), D))
    still = reference.skin.still if isinstance(reference.skin, Skin) else reference.load
    if len(still):
        pull += share(reference.ramp, t + dt, 1.0) * still[at, :D]
    return lasting._replace(g=g, v=v, push=push[at]), pull, reference.drag * within(reference.ramp, t + 0.5 * dt, 0.0)


def end_step(space, body, reference, nodes: Nodes, u: np.ndarray, dt: float) -> None:
    """Nodes, and what flow leaves, after particles have their new strain."""
    D, at = directions(space), home(space, nodes)
    reference.u[at, :D] += u
    reference.v[at, :D] = u / dt
    reference.t[0] += dt
    if len(reference.plastic):
        back, extra = np.linalg.inv(np.eye(3) + moved(space, reference)), extra_of(space, body, reference, nodes.spans)
        scale = np.exp(-2.0 * extra)[:, None, None]
        b = np.eye(3) + tensors(body.particles.B)
        reference.plastic[:] = entries(scale * (back @ b @ back.transpose(0, 2, 1)) - np.eye(3), reference.plastic.shape[1])


def recover(space, body, reference, nodes: Nodes) -> None:
    """Particles as the displacement of the nodes and what flow has left say."""
    particles, H = body.particles, moved(space, reference)
    F = np.eye(3) + H
    J = np.linalg.det(F)
    particles.x[:] = reference.X + displacement_at(space, reference, reference.X)
    particles.J[:] = J
    if J.min() <= 0:
        return
    extra = extra_of(space, body, reference, nodes.spans)
    b = H + H.transpose(0, 2, 1) + H @ H.transpose(0, 2, 1)
    if len(reference.plastic):
        b += F @ tensors(reference.plastic) @ F.transpose(0, 2, 1)
    more = np.expm1(2.0 * extra)[:, None, None]
    particles.B[:] = entries(b + more * (np.eye(3) + b), particles.B.shape[1])
    particles.J[:] = J * np.exp(3.0 * extra)


def moved(space, reference) -> np.ndarray:
    """F - 1 (N, 3, 3) of the particles."""
    (plane, hoop), D = gradients_at(space, reference, reference.X), directions(space)
    H = np.zeros((len(plane), 3, 3))
    H[:, :D, :D] = plane
    H[:, 2, 2] += hoop
    return H


def extra_of(space, body, reference, spans) -> np.ndarray:
    """What F-bar adds to each logarithmic strain (N,); 0 where nothing is averaged."""
    if not isinstance(spans, Spans):
        return np.zeros(len(reference.X))
    grown, V0 = np.log(np.linalg.det(np.eye(3) + moved(space, reference))), body.particles.V0
    return (1.0 - spans.own) * ((np.bincount(spans.of, V0 * grown) / spans.volume)[spans.of] - grown) / 3.0


def tensors(B: np.ndarray) -> np.ndarray:
    """(N, 3, 3) from the entries (N, K) of symmetric tensors."""
    full = np.zeros((len(B), 3, 3))
    for value, (i, j) in zip(B.T, ORDER, strict=False):
        full[:, i, j] = full[:, j, i] = value
    return full


def entries(full: np.ndarray, K: int) -> np.ndarray:
    """The first K entries (N, K) of symmetric tensors."""
    return np.stack([full[:, i, j] for i, j in ORDER[:K]], axis=1)
