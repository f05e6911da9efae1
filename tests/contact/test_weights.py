"""What a body's stress puts on the nodes near its contacts: products of lines against the sum over whole stencils, mirrors and hoop stress included."""

import numpy as np
import pytest

from mpm.boundary import CONTACT, SLIP, STICK, directions, extents
from mpm.contact.found import new_contacts
from mpm.contact.skin import Skin, hoop
from mpm.contact.spots import new_spots, spot
from mpm.contact.weights import fall_short, mark
from mpm.state import PAD, Axisymmetric, Cubic, Line, Particles, Plane, Quadratic, Volume
from mpm.transfer import Bspline, Mls

pytestmark = pytest.mark.plain
H, CELLS, N, C = 0.1, 8, 60, 3
SIZE = CELLS + 1 + 2 * PAD
SPACES = {"line": (Line, 1), "plane": (Plane, 2), "axisymmetric": (Axisymmetric, 2), "volume": (Volume, 3)}


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
    skin = Skin(x[:C] + 0.02 * rng.normal(size=(C, D)), normal, H ** (D - 1) * (1 + rng.random(C)), x[:C], np.arange(C), np.zeros(C, int), np.array([0, C]))
    contacts = new_contacts(C, D)
    contacts.body[:], contacts.balanced[:], contacts.home[:, 0] = [0, -1], [1, 0], x[:C]
    number = np.full(SIZE**D, -1)

    box, short = mark(space, 0, walls, contacts, C, number)
    for some in ((0, 20), (20, N)):
        fall_short(space, gradient, particles, 0, walls, skin, box, number, short, some)

    r, T = np.zeros((SIZE**D, D)), np.zeros((SIZE**D, D, D))
    spots, marked = new_spots(space), set()
    at, w, G, _, sign = spots[:5]
    for p in range(N):
        spot(space, gradient, walls, x[p], spots)
        marked |= set(at.tolist()) if p < C else set()
        for m, n in enumerate(at):
            r[n] += particles.V0[p] * particles.J[p] * G[:, m] * sign[:, m]
            r[n, 0] += particles.V0[p] * particles.J[p] * w[m] / x[p, 0] * sign[0, m] if hoop(space) else 0.0
    for s in range(C):
        spot(space, gradient, walls, x[s], spots)
        for m, n in enumerate(at):
            r[n] -= skin.area[s] * normal[s] * (w[m] + G[:, m] @ (skin.x[s] - x[s])) * sign[:, m]
            T[n] += skin.area[s] * w[m] * np.outer(normal[s], normal[s])
    assert extents(space)[0] == SIZE and directions(space) == D and set(np.flatnonzero(number >= 0)) == marked
    nodes = sorted(marked)
    assert short[0][number[nodes], :D] == pytest.approx(r[nodes], abs=1e-12 * np.abs(r).max())
    assert short[1][number[nodes]] == pytest.approx(T[nodes], abs=1e-12 * np.abs(T).max())
