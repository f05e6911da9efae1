"""What a mechanical step works with, so that its functions take few arguments: the method, the nodes, and where in a block of steps it is."""

from typing import Any, NamedTuple

import numpy as np

from mpm.boundary import directions
from mpm.integrate.fbar import any_averages
from mpm.jit import kernel
from mpm.transfer import new_chunk, uses_basis_gradient, wants_change


class Method(NamedTuple):
    """How fields pass between particles and nodes: with the bodies, all that a step is compiled for."""

    space: Any  # mpm.state.Line, Plane, Axisymmetric or Volume
    gradient: Any  # mpm.transfer.Mls or Bspline
    scheme: Any  # mpm.transfer.Apic, Flip or Xpic


def method_of(scene) -> Method:
    return Method(scene.space, scene.gradient, scene.scheme)


class Buffers(NamedTuple):
    """Two sets of nodes: steps gather from the one and scatter on to the other, in turn. All is zero, and nothing marked, before and after a block."""

    nodes: np.ndarray  # (2, n, columns(D)) momentum, then velocity; mass
    force: np.ndarray  # the same, of impulses, then of changes of velocity; of no nodes unless the scheme wants them apart
    boxes: np.ndarray  # (2, 3, 2) nodes touched: begin <= node < end
    blocks: np.ndarray  # (2, marks) blocks of nodes touched (mpm.boundary.blocks)


class Grids(NamedTuple):
    """Nodes of F velocity fields: `Buffers` of each."""

    nodes: np.ndarray  # (F, 2, n, columns)
    force: np.ndarray  # (F, 2, n or 0, columns)
    boxes: np.ndarray  # (F, 2, 3, 2)
    blocks: np.ndarray  # (F, 2, marks)


@kernel
def field_buffers(grids, f):
    """The nodes of one field."""
    return Buffers(grids.nodes[f], grids.force[f], grids.boxes[f], grids.blocks[f])


class Moment(NamedTuple):
    """Where in a block of steps of the run."""

    now: int  # the set of nodes to gather from
    dt: float  # for which what is scattered will act [s]
    step: int  # of the block; -1 at its opening
    begun: int  # steps of the run before the block
    opening: bool  # particles are only scattered
    last: bool  # particles are only gathered to
    sparse: bool  # whether chunks mark the blocks that they touch


@kernel
def scratch(method, bodies, like):
    """A chunk for the particles of all bodies, in the precision of `like`."""
    own = uses_basis_gradient(method.gradient) or any_averages(bodies)
    return new_chunk(directions(method.space), like, own, wants_change(method.scheme))
