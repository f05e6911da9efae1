"""How far the surfaces of two bodies that press on each other have been stretched: pieces stand apart then, and nothing else knows where bodies meet.

growth   |J F^-T A|/|A| of a piece, the largest of a body; of a pair the smaller of the two, the largest over the run
Pieces begin 1/particles of a cell apart and look for one another within REACH. One body whose pieces are dense is still met by its own; against walls and tools
particles stand for pieces (find.py), so neither is warned of.
"""

from collections.abc import Iterator

import numpy as np

from mpm.contact.found import BODY
from mpm.contact.skin import POINT
from mpm.state import Surface
from mpm.warned import warning

GROWN = 3.0  # times: pieces of h/2 are then farther apart than REACH


def normals(body) -> np.ndarray:
    """Present area times outward normal of the pieces of a body (S, D) [m^(D-1)]."""
    surface = body.surface
    F = surface.F[surface.row[surface.owner]].astype(float)
    return body.particles.J[surface.owner, None] * np.linalg.solve(F.transpose(0, 2, 1), surface.area[..., None].astype(float))[..., 0]


def growth(met, b: int) -> float:
    """Of the piece of body b that grew most."""
    if not isinstance(met.bodies[b].surface, Surface):
        return 1.0
    area = met.bodies[b].surface.area.astype(float)
    now, begun = (np.linalg.norm(one, axis=1) for one in (normals(met.bodies[b]), area))
    face = begun > 2 * POINT * met.space.h ** (area.shape[1] - 1)
    return float(np.max(now[face] / begun[face], initial=1.0))


def look(met) -> None:
    """Keep the growth of the pairs that pressed on each other since the last record."""
    B = len(met.names)
    pressed = np.argwhere(np.triu(met.touching.pushed[:, BODY : BODY + B].any(axis=2), 1))
    found = {b: growth(met, b) for b in np.unique(pressed)}
    for a, b in pressed:
        met.grown[a, b] = max(met.grown[a, b], min(found[a], found[b]))


def warned(met) -> Iterator[str]:
    """A warning for every pair of which both are stretched too far."""
    for a, b in np.argwhere(met.grown > GROWN):
        yield warning("pieces", f"{met.names[a]} and {met.names[b]} press on each other, and the surfaces of both are stretched {met.grown[a, b]:.2g} times")
