"""Transfers: between particles and nodes, and nothing else.

A transfer is a pair of linear maps; it knows no physics. With weights w, offsets d = x_node - x_particle:
    scatter   node += w (a + A d) + G grad(w)           a value, a slope and a tensor a particle
    gather    value = sum w u,   slope = 4/h^2 sum w u d,   gradient = sum u grad(w)
Momentum, forces, heat, conduction and surface exchange are all of this form (physics.md 3).

Roles     scatter(space, gradient, x, first, chunk, nodes, box), gather(space, gradient, x, first, chunk, nodes): vectors, by dimension
          scatter_scalar, gather_scalar: one scalar field, for heat
          carry(scheme, ...): what a particle keeps of what it gathered (apic.py, flip.py)
Shapes    chunk arrays (component, particle of the chunk); nodes (node, D + 1): momentum (then velocity) and mass
May use   mpm.basis, mpm.jit, mpm.state                      May not  see laws
To add    a scheme: a file with a NamedTuple and its `carry`; a dimension: a file like plane.py
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel, role

CHUNK = 128  # particles that pass together: their scratch (43 kB in 3-D float64) stays in the first-level cache


class Mls(NamedTuple):
    """Gradient by moving least squares: grad(w) replaced with 4/h^2 w d (physics.md 3)."""


class Bspline(NamedTuple):
    """Gradient of the basis itself."""


class Chunk(NamedTuple):
    """Scratch of one chunk. In: what to scatter; out: what was gathered."""

    m: np.ndarray  # (n,) mass
    a: np.ndarray  # (D, n) momentum
    A: np.ndarray  # (D, D, n) its slope
    G: np.ndarray  # (D, D, n) tensor on grad(w); used with the B-spline gradient only
    v: np.ndarray  # (D, n) gathered velocity
    C: np.ndarray  # (D, D, n) gathered slope
    L: np.ndarray  # (D, D, n) gathered gradient; the slope itself with the MLS gradient


@role
def scatter(space, gradient, x, first, chunk, count, nodes, box):
    """Add `count` particles from `first` on to `nodes`; `box` (D, 2) grows to the nodes touched."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role
def gather(space, gradient, x, first, chunk, count, nodes):
    """Fill v, C, L of the chunk from the nodal velocities."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role
def scatter_scalar(space, x, first, count, a, A, G, nodes):
    """node += w (a + A d) + G grad(w) of a scalar field: a (n,), A and G (D, n), nodes (n_nodes,). B-spline gradient."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role
def gather_scalar(space, x, first, count, nodes, value, slope, grad):
    """value (n,), slope (D, n) and B-spline gradient (D, n) of a scalar field."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role
def carry(scheme, particles, first, chunk, count, change):
    """Particle velocity and slope from what was gathered; `change` (D, n) is sum w (v_i+ - v_i) where the scheme asks for it."""
    raise TypeError(f"no transfer scheme {type(scheme).__name__}")


@role
def uses_basis_gradient(gradient):
    """Whether forces and velocity gradients use grad(w) itself: a constant at compile time."""
    raise TypeError(f"no gradient {type(gradient).__name__}")


@uses_basis_gradient.register(Mls)
def _(gradient):
    return False


@uses_basis_gradient.register(Bspline)
def _(gradient):
    return True


@kernel
def new_chunk(D, like):
    """Scratch for D directions in the precision of `like`."""
    return Chunk(np.zeros(CHUNK, like.dtype), np.zeros((D, CHUNK), like.dtype), np.zeros((D, D, CHUNK), like.dtype), np.zeros((D, D, CHUNK), like.dtype),
                 np.zeros((D, CHUNK), like.dtype), np.zeros((D, D, CHUNK), like.dtype), np.zeros((D, D, CHUNK), like.dtype))


@kernel(inline=True)
def locate(x, inverse):
    """Index of the first of the three nodes in a padded array, and f = x/h - nearest node."""
    s = x * inverse
    nearest = np.floor(s + 0.5)
    return int(nearest) + 1, s - nearest  # + PAD - 1
