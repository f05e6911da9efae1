"""What a body's stress puts on the nodes near its contacts: products of lines against the sum over whole stencils, mirrors and hoop stress included."""

import numpy as np
import pytest

from mpm.basis import inverse_moment
from mpm.boundary import CONTACT, SLIP, STICK, directions, extents
from mpm.boundary.walls import held
from mpm.contact.found import BODY, new_contacts
from mpm.contact.skin import hoop, new_skin
from mpm.contact.spots import along, new_spots, seen
from mpm.contact.sums import fall_short, hold_good, make_room, new_sums, pieces_within, recall
from mpm.state import PAD, Axisymmetric, Cubic, Line, Particles, Plane, Quadratic, Volume
from mpm.transfer import Bspline, Mls, uses_basis_gradient

pytestmark = pytest.mark.plain
H, CELLS, N, C = 0.1, 8, 60, 3
SIZE = CELLS + 1 + 2 * PAD
SPACES = {"line": (Line, 1), "plane": (Plane, 2), "axisymmetric": (Axisymmetric, 2), "volume": (Volume, 3)}


def spot(space, gradient, walls, home, spots):
    """Nodes (M,), weights, gradients (D, M) and signs (D, M) around a particle at `home`."""
    (line, place, mirror), D, shape, reach = spots, directions(space), extents(space), seen(space)
    M = reach**D
    at, w, G, way, sign = np.empty(M, np.int64), np.empty(M), np.empty((D, M)), np.empty((D, M)), np.empty((D, M))
    mirrored = along(space, walls, home, spots)
    own = uses_basis_gradient(gradient)
    scale = 0.0 if own else inverse_moment(space.basis) / space.h**2
    at[0], w[0], size = 0, 1.0, 1
    for c in range(D):
        G[c, 0], way[c, 0] = 1.0, 0.0
    for a in range(D):  # products, one direction after another, from the last on: what is read is not yet written over
        for m in range(size - 1, -1, -1):
            n, weight = at[m] * shape[a], w[m]
            for k in range(reach):
                at[m * reach + k], w[m * reach + k] = n + place[a, k], weight * line[0, a, k]
        for c in range(D):
            row = 1 if own and c == a else 0
            for m in range(size - 1, -1, -1):
                slope, there = G[c, m], way[c, m]
                for k in range(reach):
                    if own:
                        G[c, m * reach + k] = slope * line[row, a, k]
                    way[c, m * reach + k] = line[2, a, k] if c == a else there
        size *= reach
    for c in range(D):
        for m in range(size):
            sign[c, m] = 1.0
            if not own:
                G[c, m] = scale * w[m] * way[c, m]
    if mirrored:
        flip(walls, mirror, sign)
    return at, w, G, sign


def flip(walls, mirror, sign):
    """Signs of nodes that stand for ghosts, or lie on a mirror's own plane."""
    (D, M), reach = sign.shape, mirror.shape[2]
    for m in range(M):
        rest, stride = m, M
        for a in range(D):
            stride //= reach
            k = rest // stride
            rest -= k * stride
            if mirror[0, a, k] >= 0:
                for c in range(D):
                    if held(walls[a, mirror[0, a, k]], a, c):
                        sign[c, m] *= 0.0 if mirror[1, a, k] == 1 else -1.0


@pytest.mark.parametrize("basis", [Quadratic(), Cubic()])
@pytest.mark.parametrize("gradient", [Mls(), Bspline()])
@pytest.mark.parametrize("name", SPACES)
def test_sums_over_particles_and_pieces(name, gradient, basis):
    (kind, D), rng = SPACES[name], np.random.default_rng(3)
    space = kind(H, *[SIZE] * D, basis)
    x = H * CELLS * rng.random((N, D))
    x[:C] = H * (0.2 + 1.5 * rng.random((C, D)))  # those that touch, in a corner of mirrors
    particles = Particles(x, *np.zeros((3, N)), 1 + rng.random(N), np.ones(N), rng.random(N))
    walls = np.full((3, 2), CONTACT)
    walls[0, 0], walls[D - 1, 0] = SLIP, STICK
    normal = rng.normal(size=(C, D))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    skin = new_skin(D, np.array([0, C]))
    skin.x[:], skin.normal[:], skin.area[:] = x[:C] + 0.02 * rng.normal(size=(C, D)), normal, H ** (D - 1) * (1 + rng.random(C))
    skin.home[:], skin.owner[:] = x[:C], np.arange(C)
    contacts = new_contacts(C, D, skin.after)
    contacts.body[:], contacts.balanced[:], contacts.home[:, 0] = [0, -1], [1, 0], x[:C]
    contacts.against[:] = BODY + 1
    number, fields = np.full(SIZE**D, -1), np.zeros(1, int)

    sums = make_room(space, walls[None], fields, new_sums(space, 1), contacts, C, number)
    assert (number == -1).all() and hold_good(space, walls[None], fields, sums, contacts, C, number)
    recall(sums, 0, number)
    for some in ((0, 20), (20, N)):
        fall_short(space, gradient, particles, 0, walls, skin, pieces_within(space, skin, sums), sums, number, some)

    r, T = np.zeros((SIZE**D, D)), np.zeros((SIZE**D, D, D))
    spots, marked = new_spots(space), set()
    for p in range(N):
        at, w, G, sign = spot(space, gradient, walls, x[p], spots)
        marked |= set(at.tolist()) if p < C else set()
        for m, n in enumerate(at):
            r[n] += particles.V0[p] * particles.J[p] * G[:, m] * sign[:, m]
            r[n, 0] += particles.V0[p] * particles.J[p] * w[m] / x[p, 0] * sign[0, m] if hoop(space) else 0.0
    for s in range(C):
        at, w, G, sign = spot(space, gradient, walls, x[s], spots)
        for m, n in enumerate(at):
            r[n] -= skin.area[s] * normal[s] * (w[m] + G[:, m] @ (skin.x[s] - x[s])) * sign[:, m]
            T[n] += skin.area[s] * w[m] * np.outer(normal[s], normal[s])
    assert extents(space)[0] == SIZE and directions(space) == D and set(np.flatnonzero(number >= 0)) == marked
    nodes = sorted(marked)
    assert sums.lack[number[nodes], :D] == pytest.approx(r[nodes], abs=1e-12 * np.abs(r).max())
    diagonal, others = np.einsum("ncc->nc", T[nodes]), np.stack([T[nodes, a, b] for a, b in ((1, 2), (0, 2), (0, 1)) if b < D], axis=-1) if D > 1 else None
    assert sums.diagonal[number[nodes], :D] == pytest.approx(diagonal, abs=1e-12 * np.abs(T).max())
    assert others is None or sums.beside[number[nodes]][:, 3 - others.shape[1] : 3] == pytest.approx(others, abs=1e-12 * np.abs(T).max())
