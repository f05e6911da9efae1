"""How wide a contact is where its force is largest: the pieces that carry an impulse, against the cell.

across   2-D A,   axisymmetric 2 sqrt(2 A) about the axis,   3-D 2 sqrt(A/pi)         of the area A that is pressed (by radian where it is round)
A ball between plates is off in its force over approach by -8 to +11 % where the contact is 1.4 to 3.4 cells across, by -4 to +3 % from 2.8 to 6.8
(tests/contact/test_narrow.py); its pressure is that of two or three pieces.
A face that lies flat, more than half of what looks that way, is no such contact however few cells wide it is.
Of explicit steps: impulses of single pieces are kept for the next step. Implicit ones keep how far pieces are stretched instead, and are not judged.
"""

from collections.abc import Iterator

import numpy as np

from mpm.boundary import directions
from mpm.contact.found import BODY, FACING
from mpm.contact.skin import POINT
from mpm.contact.stretched import normals
from mpm.state import Axisymmetric, Surface
from mpm.warned import warning

NARROW = 3.0  # cells


def look(met, since: float) -> None:
    """Keep force [N] and width [cells] of what each body presses on, where the force is the largest so far. `since`: the last record [s]."""
    if since <= 0.0 or directions(met.space) == 1:
        return
    forces = np.linalg.norm(met.touching.pushed, axis=2) / since  # (B, K)
    for b, to in np.argwhere(forces > met.hardest[..., 0]):
        if across := width(met, b, to):
            met.hardest[b, to] = forces[b, to], across


def width(met, b: int, to: int) -> float:
    """Cells across of what body b presses on; inf where a face lies flat on it, 0 where no piece carries an impulse."""
    touching, body, surface = met.touching, met.bodies[b], met.bodies[b].surface
    if not isinstance(surface, Surface):
        return 0.0
    first = touching.first[b]
    pressed = touching.warm[first : first + len(surface.area), touching.rows[to]].any(axis=1)  # of a body that comes in, the pieces that are there
    if not pressed.any():
        return 0.0
    normal = normals(body)
    area = np.linalg.norm(normal, axis=1)
    pressed &= area > 2 * POINT * met.space.h ** (directions(met.space) - 1)
    way = normal[pressed].sum(axis=0)
    alike = normal @ way > -FACING * area * np.linalg.norm(way)
    A = float(area[pressed].sum())
    if A > 0.5 * area[alike].sum():
        return np.inf
    if isinstance(met.space, Axisymmetric):
        return 2 * np.sqrt(2 * A) / met.space.h
    return (A if len(way) == 2 else 2 * np.sqrt(A / np.pi)) / met.space.h


def warned(met) -> Iterator[str]:
    """A warning for every narrow contact of a run; of two bodies, where both sides are that press."""
    B, widths = len(met.names), {}
    for b, to in np.argwhere(met.hardest[..., 0] > 0.0):
        other = to - BODY
        name = met.sides[to] if to < BODY else met.names[other] if other < B else met.tool_names[other - B]
        pair = (met.names[b], name) if not 0 <= other < b else (name, met.names[b])
        widths[pair] = max(widths.get(pair, 0.0), met.hardest[b, to, 1])
    for (one, name), across in widths.items():
        if across < NARROW:
            yield warning("narrow", f"{one} touches {name} over {across:.1f} cells where the force is largest")
