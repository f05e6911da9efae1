"""Boundaries: what the faces of the domain do to nodal fields.

Walls stand on grid lines. A slip or stick wall is a mirror: what particles put on the ghost node outside is folded on to its image
inside, and nodal velocities are continued outside by reflection, so a linear field is exact up to the wall (setting wall nodes to
zero alone would flatten it there). It is bonded: it acts on bodies that started at it, and never lets go. At a contact wall nodes are free, and what
holds a body is the gap of its surface (mpm.contact).

May use   mpm.jit, mpm.lanes, mpm.state                        May not  see particles or laws
To add    a kind: a number here, its rule in walls.py, its name in config

Further files
    blocks   which nodes hold material
"""

from mpm.jit import role
from mpm.state import Axisymmetric, Line, Plane, Volume

SLIP, STICK, CONTACT, STOP = range(4)  # mirrors; free nodes; nodes that may not move outwards, as peers have them (mpm bench)
KINDS = {"slip": SLIP, "stick": STICK, "contact": CONTACT}


@role
def extents(space):
    """Nodes in three directions, one where the space has no such direction."""
    raise TypeError(f"no extents for {type(space).__name__}")


@role
def directions(space):
    """D, a constant at compile time."""
    raise TypeError(f"no directions for {type(space).__name__}")


@extents.register(Line)
def extents_line(space):
    return space.n0, 1, 1


@extents.register(Plane)
@extents.register(Axisymmetric)
def extents_axisymmetric_or_plane(space):
    return space.n0, space.n1, 1


@extents.register(Volume)
def extents_volume(space):
    return space.n0, space.n1, space.n2


@directions.register(Line)
def directions_line(space):
    return 1


@directions.register(Plane)
@directions.register(Axisymmetric)
def directions_axisymmetric_or_plane(space):
    return 2


@directions.register(Volume)
def directions_volume(space):
    return 3
