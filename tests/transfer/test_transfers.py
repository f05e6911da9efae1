"""Transfers as linear maps: what they keep, what they reproduce, and that gather is the transpose of scatter. Called in plain Python."""

import math

import numpy as np
import pytest

from mpm.boundary import directions, extents
from mpm.state import PAD, Axisymmetric, Cubic, Line, Plane, Quadratic, Volume
from mpm.transfer import (
    Apic,
    Bspline,
    Chunk,
    Flip,
    Mls,
    collect,
    columns,
    gather,
    gather_scalar,
    give,
    lay_down,
    new_chunk,
    scatter,
    scatter_scalar,
    spread,
    take,
    wants_change,
)

H = 0.3
SPACES = [Line(H, 12), Plane(H, 11, 12), Axisymmetric(H, 11, 12), Volume(H, 10, 11, 12)]
GRADIENTS = [Mls(), Bspline()]
over_spaces = pytest.mark.parametrize("space", SPACES, ids=lambda space: type(space).__name__)
over_gradients = pytest.mark.parametrize("gradient", GRADIENTS, ids=lambda gradient: type(gradient).__name__)
N = 7


def positions(space, seed=1):
    D = directions(space)
    reach = (np.array(extents(space)[:D]) - 2 * PAD - 1) * H
    return np.random.default_rng(seed).uniform(0, 1, (N, D)) * reach


def nodes_at(space):
    """Coordinates (n, D) of all nodes."""
    D = directions(space)
    axes = [(np.arange(n) - PAD) * H for n in extents(space)[:D]]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)


def chunk_of(D, seed=2):
    """A chunk filled with noise in its first N places."""
    rng = np.random.default_rng(seed)
    chunk = new_chunk(D, np.zeros(1), True, True)
    chunk.m[:N] = rng.uniform(1, 2, N)
    for field in (chunk.a, chunk.A, chunk.f, chunk.S):
        field[..., :N] = rng.standard_normal((*field.shape[:-1], N))
    return chunk


def empty_box(D):
    return np.array([[10**9, -1]] * D)


def scattered(space, gradient, x, chunk):
    D = directions(space)
    nodes = np.zeros((math.prod(extents(space)), columns(D)))
    lay_down(space, x, 0, N, chunk)
    scatter(space, gradient, x, 0, chunk, N, nodes, empty_box(D))
    return nodes


@over_spaces
def test_scatter_keeps_mass_momentum_and_angular_momentum(space):
    D, x, chunk = directions(space), positions(space), chunk_of(directions(space))
    nodes, at = scattered(space, Mls(), x, chunk), nodes_at(space)
    assert nodes[:, D].sum() == pytest.approx(chunk.m.sum(), rel=1e-14)
    assert np.allclose(nodes[:, :D].sum(axis=0), chunk.a[:, :N].sum(axis=1), rtol=0, atol=1e-13)
    # sum x_i p_i = sum x_p a_p + h^2/4 A: its antisymmetric part is angular momentum.
    expected = np.einsum("pc,dp->cd", x, chunk.a[:, :N]) + H * H / 4 * chunk.A[..., :N].sum(axis=2).T
    assert np.allclose(np.einsum("nc,nd->cd", at, nodes[:, :D]), expected, rtol=0, atol=1e-12)


@over_spaces
@over_gradients
def test_gather_is_exact_for_linear_fields(space, gradient):
    D, x, rng = directions(space), positions(space), np.random.default_rng(3)
    constant, slope = rng.standard_normal(D), rng.standard_normal((D, D))
    nodes = np.zeros((math.prod(extents(space)), columns(D)))
    nodes[:, :D] = constant + nodes_at(space) @ slope.T
    chunk = chunk_of(D)
    lay_down(space, x, 0, N, chunk)
    gather(space, gradient, x, 0, chunk, N, nodes)
    assert np.allclose(chunk.v[:, :N].T, constant + x @ slope.T, atol=1e-13)
    for gathered in (chunk.C, chunk.L):
        assert np.allclose(gathered[..., :N], slope[..., None], atol=1e-12)


@over_spaces
@over_gradients
def test_stress_does_no_work_on_a_rigid_motion(space, gradient):
    """A symmetric impulse adds neither momentum nor angular momentum, and its virial is its sum, with either gradient."""
    D, x, chunk = directions(space), positions(space), chunk_of(directions(space))
    chunk.m[:], chunk.a[:], chunk.A[:] = 0.0, 0.0, 0.0
    S = chunk.S[..., :N] + chunk.S[..., :N].transpose(1, 0, 2)
    if isinstance(gradient, Bspline):
        chunk.G[..., :N] = S
    else:
        chunk.A[..., :N] = 4 / H**2 * S
    nodes = scattered(space, gradient, x, chunk)[:, :D]
    assert np.allclose(nodes.sum(axis=0), 0, atol=1e-11)
    virial = np.einsum("nc,nd->dc", nodes_at(space), nodes)
    assert np.allclose(virial, S.sum(axis=2), atol=1e-11)


@over_spaces
@over_gradients
def test_gather_is_the_transpose_of_scatter(space, gradient):
    """<scatter(a, A, G), u> = <a, v> + <A, d u> + <G, grad u> for any nodal u: forces and velocity gradients belong together."""
    D, x, chunk = directions(space), positions(space), chunk_of(directions(space))
    chunk.G[..., :N] = np.random.default_rng(4).standard_normal((D, D, N)) if isinstance(gradient, Bspline) else 0.0
    nodes = scattered(space, gradient, x, chunk)
    u = np.random.default_rng(5).standard_normal(nodes.shape)
    lay_down(space, x, 0, N, chunk)
    gather(space, gradient, x, 0, chunk, N, u)
    expected = np.sum(chunk.a * chunk.v) + H * H / 4 * np.sum(chunk.A * chunk.C) + np.sum(chunk.G * chunk.L)
    assert np.sum(nodes[:, :D] * u[:, :D]) == pytest.approx(expected, rel=1e-11)


@over_spaces
def test_one_scalar_field_as_vectors(space):
    """scatter_scalar and gather_scalar agree with the vector pair, component by component."""
    D, x, chunk = directions(space), positions(space), chunk_of(directions(space))
    chunk.G[..., :N] = np.random.default_rng(4).standard_normal((D, D, N))
    nodes = scattered(space, Bspline(), x, chunk)
    u = np.random.default_rng(5).standard_normal(nodes.shape)
    lay_down(space, x, 0, N, chunk)
    gather(space, Bspline(), x, 0, chunk, N, u)
    for c in range(D):
        one = np.zeros(len(nodes))
        scatter_scalar(space, x, 0, N, chunk.a[c].copy(), chunk.A[c].copy(), chunk.G[c].copy(), one)
        assert np.allclose(one, nodes[:, c], atol=1e-13)
        value, slope, grad = np.zeros(N), np.zeros((D, N)), np.zeros((D, N))
        gather_scalar(space, x, 0, N, u[:, c].copy(), value, slope, grad)
        assert np.allclose(value, chunk.v[c, :N]) and np.allclose(slope, chunk.C[c, :, :N]) and np.allclose(grad, chunk.L[c, :, :N])


@pytest.mark.parametrize("space", SPACES[1:], ids=lambda space: type(space).__name__)
def test_many_particles_of_a_scalar_field_at_once(space):
    """Eight and more over lanes are each alone: scattered, value, slope and gradient, on walls and where two follow one another in a cell; no node beyond."""
    D, rng, many = directions(space), np.random.default_rng(6), 19
    reach, n = (np.array(extents(space)[:D]) - 2 * PAD - 1) * H, math.prod(extents(space))
    x = rng.uniform(0, 1, (many, D)) * reach
    x[0], x[1], x[5], x[-1] = 0.0, 0.01 * H, x[4] + 1e-3 * H, reach
    a, A, G, u = rng.standard_normal(many), rng.standard_normal((D, many)), rng.standard_normal((D, many)), rng.standard_normal(n)
    together, alone = np.zeros(n), np.zeros(n)
    value, slope, grad = np.zeros(many), np.zeros((D, many)), np.zeros((D, many))
    scatter_scalar(space, x, 0, many, a, A, G, together)
    gather_scalar(space, x, 0, many, u, value, slope, grad)
    for p in range(many):
        one, two, three = np.zeros(1), np.zeros((D, 1)), np.zeros((D, 1))
        scatter_scalar(space, x, p, 1, a[p : p + 1].copy(), A[:, p : p + 1].copy(), G[:, p : p + 1].copy(), alone)
        gather_scalar(space, x, p, 1, u, one, two, three)
        assert np.allclose([value[p], *slope[:, p], *grad[:, p]], [*one, *two[:, 0], *three[:, 0]], rtol=0, atol=1e-13)
    assert np.allclose(together, alone, rtol=0, atol=1e-13) and np.array_equal(together != 0, alone != 0)


@over_spaces
def test_the_box_holds_the_nodes_touched_and_no_more(space):
    D, x, chunk = directions(space), positions(space), chunk_of(directions(space))
    nodes, box = np.zeros((math.prod(extents(space)), columns(D))), empty_box(D)
    lay_down(space, x, 0, N, chunk)
    scatter(space, Mls(), x, 0, chunk, N, nodes, box)
    mass = nodes[:, D].reshape(extents(space)[:D])
    for axis in range(D):
        touched = np.flatnonzero(mass.any(axis=tuple(k for k in range(D) if k != axis)))
        assert box[axis, 0] <= touched[0] <= box[axis, 0] + 1 and box[axis, 1] - 2 <= touched[-1] < box[axis, 1]


@over_spaces
@over_gradients
@pytest.mark.parametrize("scheme", [Apic(), Flip(0.1, 0.0), Flip(0.1, 1.0)], ids=["apic", "flip", "flip affine"])
def test_schemes_scatter_the_same_momentum_and_force(space, gradient, scheme):
    """APIC scatters momentum and impulse together, FLIP apart: their sum is the same, and `collect` splits the change off."""
    D, x, chunk = directions(space), positions(space), chunk_of(directions(space))
    copy = Chunk(*(field.copy() for field in chunk))
    copy.a[:] += copy.f
    copy.G[:] = copy.S if isinstance(gradient, Bspline) else 0.0
    copy.A[:] += 0.0 if isinstance(gradient, Bspline) else copy.S
    expected = scattered(space, gradient, x, copy)
    nodes, force = np.zeros_like(expected), np.zeros_like(expected)
    lay_down(space, x, 0, N, chunk)
    spread(scheme, space, gradient, x, 0, chunk, N, nodes, force, empty_box(D))
    assert np.allclose(nodes + force, expected, atol=1e-12)
    assert np.any(force) == wants_change(scheme)
    lay_down(space, x, 0, N, chunk)
    collect(scheme, space, gradient, x, 0, chunk, N, nodes, force)
    lay_down(space, x, 0, N, copy)
    gather(space, gradient, x, 0, copy, N, nodes)
    assert np.allclose(chunk.v, copy.v, atol=1e-13) and np.allclose(chunk.C, copy.C, atol=1e-12) and np.allclose(chunk.L, copy.L, atol=1e-12)
    if wants_change(scheme):
        gather(space, gradient, x, 0, copy, N, force)
        assert np.allclose(chunk.change, copy.v, atol=1e-13)


@pytest.mark.plain
@over_spaces
@pytest.mark.parametrize("basis", [Quadratic(), Cubic()])
def test_on_fixed_weights_the_same_sums_with_less(space, basis):
    """`take` and `give` are `gather` and `scatter` of a value and a tensor on the basis gradient."""
    D, x, space = directions(space), positions(space), space._replace(basis=basis)
    u = np.random.default_rng(6).standard_normal((math.prod(extents(space)), columns(D)))
    chunk, other = chunk_of(D), chunk_of(D)
    chunk.m[:], chunk.A[:] = 0.0, 0.0
    chunk.G[..., :N] = np.random.default_rng(7).standard_normal((D, D, N))
    for one in (chunk, other):
        lay_down(space, x, 0, N, one)
    gather(space, Bspline(), x, 0, other, N, u)
    take(space, x, 0, chunk, N, u)
    nodes = np.zeros_like(u)
    give(space, x, 0, chunk, N, nodes)
    for field in ("v", "L"):
        np.testing.assert_allclose(getattr(chunk, field)[..., :N], getattr(other, field)[..., :N], rtol=0, atol=1e-12)
    np.testing.assert_allclose(nodes, scattered(space, Bspline(), x, chunk), rtol=0, atol=1e-12)
