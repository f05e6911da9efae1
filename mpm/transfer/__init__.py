"""Transfers: between particles and nodes, and nothing else.

A transfer is a pair of linear maps; it knows no physics. With weights w, offsets d = x_node - x_particle:
    scatter   node += w (a + A d) + G grad(w)           a value, a slope and a tensor a particle
    gather    value = sum w u,   slope = sum w u d/(sum w d^2),   gradient = sum u grad(w)
Momentum, forces, heat, conduction and surface exchange are all of this form (docs/physics.md 3).

Roles     aim: stencils of a chunk's positions, once for all that is scattered or gathered there (quadratic bases; others find theirs as they go)
          scatter, gather: vectors, by dimension (line.py, plane.py, volume.py), then by basis: quadratic ones by rows of lanes (rows.py)
          scatter_scalar, gather_scalar: one scalar field, for heat (quadratic ones of eight particles up to a chunk: scalars.py)
          carry(scheme, ...): what a particle keeps of what it gathered; spread, collect: what a scheme scatters and gathers (apic.py, flip.py, xpic.py)
Shapes    chunk arrays (component, particle of the chunk); nodes (node, columns(D)): momentum (then velocity), mass, room
May use   mpm.basis, mpm.boundary, mpm.jit, mpm.lanes, mpm.state                      May not  see laws
To add    a scheme: a file with a NamedTuple and its `carry`; a dimension: a file like plane.py

Further files
    fixed      nodes to particles and back by the basis and its own gradient alone: what a body on fixed weights asks at every step
    packing    chunks packed for the rows of a stencil, and unpacked
    roles      what a transfer is asked, and the scratch that its chunks pass through
    scalars    scatter and gather of one scalar field by quadratic B-splines, rows as four lanes
    stencils   stencils of a chunk of particles for quadratic B-splines, eight particles at once
"""

from mpm.transfer import line, plane, volume  # registers the dimensions
from mpm.transfer.apic import Apic
from mpm.transfer.fixed import give, take
from mpm.transfer.flip import Flip
from mpm.transfer.roles import (
    CHUNK,
    Bspline,
    Chunk,
    Mls,
    carry,
    collect,
    columns,
    deliver,
    fetch,
    gather,
    gather_scalar,
    lay_down,
    new_chunk,
    pick_up,
    scatter,
    scatter_scalar,
    spread,
    uses_basis_gradient,
    wants_change,
)  # fmt: skip
from mpm.transfer.xpic import Xpic

__all__ = [
    "CHUNK", "Apic", "Bspline", "Chunk", "Flip", "Mls", "Xpic", "carry", "collect", "columns", "deliver", "fetch", "gather", "gather_scalar", "give",
    "lay_down", "line", "new_chunk", "pick_up", "plane", "scatter", "scatter_scalar", "spread", "take", "uses_basis_gradient", "volume", "wants_change",
]  # fmt: skip
