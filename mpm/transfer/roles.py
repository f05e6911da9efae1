"""What a transfer is asked, and the scratch that its chunks pass through; the package docstring has the contract."""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel, role

CHUNK = 64  # particles that pass together: their scratch (28 kB in 3-D float64) stays in the first-level cache


class Mls(NamedTuple):
    """Gradient by moving least squares: grad(w) replaced with 4/h^2 w d (physics.md 3)."""


class Bspline(NamedTuple):
    """Gradient of the basis itself."""


class Chunk(NamedTuple):
    """Scratch of one chunk. In: what to scatter; out: what was gathered."""

    m: np.ndarray  # (n,) mass
    a: np.ndarray  # (D, n) value: momentum
    A: np.ndarray  # (D, D, n) slope
    G: np.ndarray  # (D, D, n) tensor on grad(w); read with the B-spline gradient only
    v: np.ndarray  # (D, n) gathered velocity
    C: np.ndarray  # (D, D, n) gathered slope
    L: np.ndarray  # (D, D, n) gathered gradient; the slope itself with the MLS gradient
    f: np.ndarray  # (D, n) impulse that acts on w (hoop stress)
    S: np.ndarray  # (D, D, n) impulse that acts on grad(w) (stress), scaled so that with the MLS gradient it adds to the slope
    e: np.ndarray  # (9, n) trial strain tensor, then its values and two axes: a loop over particles of its own vectorises


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
def spread(scheme, space, gradient, x, first, chunk, count, nodes, force, box):
    """Scatter momentum and impulses of a chunk: together on `nodes`, or apart where the scheme needs the change of velocity."""
    raise TypeError(f"no transfer scheme {type(scheme).__name__}")


@role
def collect(scheme, space, gradient, x, first, chunk, count, nodes, force, change):
    """Gather v, C, L of a chunk, and `change` (D, n) where the scheme asks for it."""
    raise TypeError(f"no transfer scheme {type(scheme).__name__}")


@role
def wants_change(scheme):
    """Whether the scheme needs the nodal change of velocity apart: a constant at compile time."""
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
    def vector():
        return np.zeros((D, CHUNK), like.dtype)

    def tensor():
        return np.zeros((D, D, CHUNK), like.dtype)

    work = np.zeros((9, CHUNK), like.dtype)
    return Chunk(np.zeros(CHUNK, like.dtype), vector(), tensor(), tensor(), vector(), tensor(), tensor(), vector(), tensor(), work)
