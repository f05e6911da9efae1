"""What a transfer is asked, and the scratch that its chunks pass through; the package docstring has the contract."""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel, role
from mpm.lanes import EIGHT, peek, poke
from mpm.transfer.stencils import CHUNK, ROWS

APART = 3  # cache lines between arrays of a chunk


class Mls(NamedTuple):
    """Gradient by moving least squares: grad(w) replaced with 4/h^2 w d (docs/physics.md 3)."""


class Bspline(NamedTuple):
    """Gradient of the basis itself."""


class Values(NamedTuple):
    """No gradient: of a gather, values alone count."""


class Chunk(NamedTuple):
    """Scratch of one chunk. In: what to scatter; out: what was gathered."""

    m: np.ndarray  # (n,) mass
    a: np.ndarray  # (D, n) value: momentum
    A: np.ndarray  # (D, D, n) slope
    G: np.ndarray  # (D, D, n) tensor on grad(w); read with the B-spline gradient only
    v: np.ndarray  # (D, n) gathered velocity
    change: np.ndarray  # (D, n) gathered change of velocity; the same array as v where a scheme does not want it apart
    C: np.ndarray  # (D, D, n) gathered slope
    L: np.ndarray  # (D, D, n) gathered gradient; the same array as C where they are the same
    u: np.ndarray  # (D, n) velocity that the particle keeps; the same array as v where a scheme keeps that
    U: np.ndarray  # (D, D, n) slope that it keeps; the same array as C where a scheme keeps that
    f: np.ndarray  # (D, n) impulse that acts on w (hoop stress)
    S: np.ndarray  # (D, D, n) impulse that acts on grad(w) (stress), scaled so that with the MLS gradient it adds to the slope
    e: np.ndarray  # (12, n) trial strain tensor, and what the response of a particle needs beside it; rows of integrate/strain.py and react.py
    place: np.ndarray  # (D, n) positions
    s: np.ndarray  # (D, ROWS, n) quadratic stencils (stencils.py)
    reach: np.ndarray  # (3, 2) nodes that a gather or a scatter touches
    none: np.ndarray  # (n,) zeros: the mass of an impulse
    uv: np.ndarray  # (9, n) products of the weights of the first two directions, in volumes
    begins: np.ndarray  # (n,) where a particle's stencil begins among the numbers of the nodes
    packed: np.ndarray  # (n, 4 D + 4), or (n, 8 D + 4) with the basis gradient: what rows.py packs, a particle a row


@role(inline=True)
def scatter(space, gradient, x, first, chunk, count, nodes, box):
    """Add `count` particles from `first`, where `lay_down` or `aim` found them, on to `nodes`; `box` (D, 2) grows to the nodes touched."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role(inline=True)
def gather(space, gradient, x, first, chunk, count, nodes):
    """Fill v, C, L of the chunk from the nodal velocities, where `lay_down` or `aim` found it."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role(inline=True)
def aim(space, chunk, count):
    """Stencils of the positions in chunk.place, for all that is scattered and gathered there."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role
def scatter_scalar(space, x, first, count, a, A, G, nodes):
    """node += w (a + A d) + G grad(w) of a scalar field: a (n,), A and G (D, n), nodes (n_nodes,). B-spline gradient."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role
def gather_scalar(space, x, first, count, nodes, value, slope, grad):
    """value (n,), slope (D, n) and B-spline gradient (D, n) of a scalar field."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@role(inline=True)
def carry(scheme, particles, first, chunk, count, last):
    """Particle velocity and slope, in u and U, from what was gathered.

    On to the particles themselves after the `last` of a run of steps, and wherever the scheme needs them there.
    """
    raise TypeError(f"no transfer scheme {type(scheme).__name__}")


@role(inline=True)
def spread(scheme, space, gradient, x, first, chunk, count, nodes, force, box):
    """Scatter momentum and impulses of a chunk: together on `nodes`, or apart where the scheme needs the change of velocity."""
    raise TypeError(f"no transfer scheme {type(scheme).__name__}")


@role(inline=True)
def collect(scheme, space, gradient, x, first, chunk, count, nodes, force):
    """Gather v, C, L of a chunk, and `change`, sum w (v_i+ - v_i), where the scheme asks for it."""
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
@uses_basis_gradient.register(Values)
def uses_basis_gradient_values_or_mls(gradient):
    return False


@uses_basis_gradient.register(Bspline)
def uses_basis_gradient_bspline(gradient):
    return True


@role
def uses_slopes(gradient):
    """Whether slopes and gradients are gathered: a constant at compile time."""
    raise TypeError(f"no gradient {type(gradient).__name__}")


@uses_slopes.register(Mls)
@uses_slopes.register(Bspline)
def uses_slopes_bspline_or_mls(gradient):
    return True


@uses_slopes.register(Values)
def uses_slopes_values(gradient):
    return False


def columns(D):
    """Numbers of a node: momentum (then velocity), mass, and room up to four, so that a row of nodes is lanes (rows.py)."""
    return 2 if D == 1 else 4


@kernel
def new_chunk(D, like, own_gradient, own_velocity):
    """Scratch for D directions in the precision of `like`; with a gradient that is not the slope, a kept velocity that is not the gathered one.

    All of it from one pool, every array at the start of a cache line and APART lines more from the one before: else loads of eight numbers cross
    lines, and equal rows of two arrays lie multiples of 4096 bytes apart: `mpm bench --dtype f64` then took 68 to 85 ns a particle-step from process to
    process, with this 69 to 73.
    """
    line = 64 // like.itemsize
    wide = (8 if own_gradient else 4) * D + 4
    rows = 24 + 8 * D + 7 * D * D + D * ROWS + wide  # of CHUNK numbers: at least as many as are taken below
    pool = np.zeros(rows * CHUNK + 19 * (APART + 1) * line, like.dtype)
    at = -pool.ctypes.data % 64 // like.itemsize
    n, step, vector, tensor = CHUNK, APART * line, D * CHUNK, D * D * CHUNK
    m, at = pool[at : at + n], at + n + step
    none, at = pool[at : at + n], at + n + step
    a, at = pool[at : at + vector].reshape(D, n), at + vector + step
    v, at = pool[at : at + vector].reshape(D, n), at + vector + step
    f, at = pool[at : at + vector].reshape(D, n), at + vector + step
    place, at = pool[at : at + vector].reshape(D, n), at + vector + step
    A, at = pool[at : at + tensor].reshape(D, D, n), at + tensor + step
    T, at = pool[at : at + tensor].reshape(D, D, n), at + tensor + step
    C, at = pool[at : at + tensor].reshape(D, D, n), at + tensor + step
    S, at = pool[at : at + tensor].reshape(D, D, n), at + tensor + step
    work, at = pool[at : at + 12 * n].reshape(12, n), at + 12 * n + step
    stencils, at = pool[at : at + D * ROWS * n].reshape(D, ROWS, n), at + D * ROWS * n + step
    products, at = pool[at : at + 9 * n].reshape(9, n), at + 9 * n + step
    packed, at = pool[at : at + wide * n].reshape(n, wide), at + wide * n + step
    L, u, U, change = C, v, C, v
    if own_gradient:
        L, at = pool[at : at + tensor].reshape(D, D, n), at + tensor + step
    if own_velocity:
        u, at = pool[at : at + vector].reshape(D, n), at + vector + step
        U, at = pool[at : at + tensor].reshape(D, D, n), at + tensor + step
        change = pool[at : at + vector].reshape(D, n)
    return Chunk(m, a, A, T, v, change, C, L, u, U, f, S, work, place, stencils, np.zeros((3, 2), np.int64), none, products, np.zeros(CHUNK, np.int64), packed)


@kernel(inline=True)
def lay_down(space, x, first, count, chunk):
    """Positions of a chunk's particles in chunk.place, and their stencils."""
    to_rows(x, first, count, chunk.place)
    aim(space, chunk, count)


@kernel(inline=True)
def to_rows(x, first, count, place):
    """Vectors (N, D) of a chunk's particles as rows (D, n). Lanes behind the last particle repeat it. By dimension: LLVM sees strides that are constants."""
    D, n = x.shape[1], CHUNK
    if D == 3:
        for p in range(count):
            at = 3 * (first + p)
            poke(place, p, peek(x, at))
            poke(place, n + p, peek(x, at + 1))
            poke(place, 2 * n + p, peek(x, at + 2))
    elif D == 2:
        for p in range(count):
            at = 2 * (first + p)
            poke(place, p, peek(x, at))
            poke(place, n + p, peek(x, at + 1))
    else:
        for p in range(count):
            poke(place, p, peek(x, first + p))
    for p in range(count, (count + EIGHT - 1) // EIGHT * EIGHT):
        for d in range(D):
            poke(place, d * n + p, peek(x, (first + count - 1) * D + d))


@kernel(inline=True)
def pick_up(x, first, count, place):
    """The inverse of `to_rows`."""
    D, n = x.shape[1], CHUNK
    if D == 3:
        for p in range(count):
            at = 3 * (first + p)
            poke(x, at, peek(place, p))
            poke(x, at + 1, peek(place, n + p))
            poke(x, at + 2, peek(place, 2 * n + p))
    elif D == 2:
        for p in range(count):
            at = 2 * (first + p)
            poke(x, at, peek(place, p))
            poke(x, at + 1, peek(place, n + p))
    else:
        for p in range(count):
            poke(x, first + p, peek(place, p))


@kernel(inline=True)
def fetch(particles, first, chunk, count):
    """The kept velocity and slope of a chunk's particles."""
    for p in range(count):
        for c in range(chunk.u.shape[0]):
            chunk.u[c, p] = particles.v[first + p, c]
            for d in range(chunk.u.shape[0]):
                chunk.U[c, d, p] = particles.C[first + p, c, d]


@kernel(inline=True)
def deliver(particles, first, chunk, count):
    """The inverse of `fetch`."""
    for p in range(count):
        for c in range(chunk.u.shape[0]):
            particles.v[first + p, c] = chunk.u[c, p]
            for d in range(chunk.u.shape[0]):
                particles.C[first + p, c, d] = chunk.U[c, d, p]
