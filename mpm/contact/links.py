"""Where heat passes between bodies: pieces that touched a face of another body in the heat step, and the nodes of both that it goes through.

link   from piece s of A to the particle of B nearest to it: H S_s/2 (T_A - T_B) for the share of the heat step in touch, and the like from B's pieces:
       half of the face in each pass, so both faces of a flat contact count once. T through w~, linear-exact.
H      the pair's conductance, at most PERFECT kappa/h (of the better conductor): a resistance of h/100
"""

from typing import NamedTuple

import numpy as np

from mpm.boundary import directions, extents
from mpm.contact.find import find_all
from mpm.contact.found import BODY, NEAR
from mpm.contact.pairs import Pairs
from mpm.contact.skin import lay_skins
from mpm.contact.spots import seen
from mpm.contact.tools import NoTools
from mpm.integrate.heat_matrix import nodes_of
from mpm.jit import kernel

PERFECT = 100.0  # of kappa/h


class Links(NamedTuple):
    """L links; side 0 is A, side 1 is B."""

    body: np.ndarray  # (L, 2)
    rate: np.ndarray  # (L,) H S/2 times the share in touch [W/K]
    at: np.ndarray  # (L, 2, M) flat nodes, images of mirrored ones
    t: np.ndarray  # (L, 2, M) w~


@kernel
def find_links(space, bodies, touching, skin, walls, conductance, dt):
    """The links of a heat step of dt; skin: its own. walls (B, 3, 2): mirrors of temperature; conductance (B, B) [W/(m2 K)]. Welded bodies always touch."""
    D = directions(space)
    M = seen(space) ** D
    lay_skins(space, bodies, skin, skin.every, skin.first)
    stops, pairs = np.full_like(touching.stops, -1.0), Pairs(conductance - 1e-300)
    contacts, count = find_all(space, bodies, skin, stops, pairs, NoTools(), touching.room, NEAR, touching.number[:0])
    links = Links(np.empty((count, 2), np.int64), np.empty(count), np.empty((count, 2, M), np.int64), np.empty((count, 2, M)))
    L, at, w, g, d = 0, np.zeros((D, M), np.int64), np.zeros(M), np.zeros((D, M)), np.zeros((D, M))
    shape = extents(space)
    for i in range(count):
        s, a, b = contacts.piece[i], contacts.body[i, 0], contacts.body[i, 1]
        if s < 0 or b < 0 or not contacts.balanced[i, 0]:
            continue
        share = 1.0 if touching.fields[a] == touching.fields[b] else min(touching.touched[s, touching.rows[BODY + b]] / dt, 1.0)
        if share <= 0.0:
            continue
        links.body[L, 0], links.body[L, 1] = a, b
        links.rate[L] = 0.5 * conductance[a, b] * skin.area[s] * share
        for k in range(2):
            nodes_of(space, contacts.home[i, k : k + 1], 0, walls[contacts.body[i, k]], at, w, g, d)
            for m in range(M):
                n, t = 0, w[m]
                for c in range(D):
                    n = n * shape[c] + at[c, m]
                    t += g[c, m] * (contacts.point[i, k, c] - contacts.home[i, k, c])
                links.at[L, k, m], links.t[L, k, m] = n, t
        L += 1
    return Links(links.body[:L], links.rate[:L], links.at[:L], links.t[:L])
