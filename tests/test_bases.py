"""Every basis: what transfers lean on, in one direction and in all, walls included. In plain Python but for the bar."""

import math

import numpy as np
import pytest

from mpm.basis import BASES, inverse_moment, second_moment, stencil
from mpm.boundary import KINDS, directions, extents
from mpm.boundary.walls import fold, unfold
from mpm.diagnostics import kinetic
from mpm.state import PAD, Axisymmetric, Line, Particles, Plane, Volume
from mpm.transfer import Bspline, Chunk, Mls, columns, gather, gather_scalar, lay_down, new_chunk, scatter, scatter_scalar

H, N = 0.3, 5
S = np.concatenate([np.linspace(0, 3, 97), [1e-17, 2.5 - 1e-12, 3 - 1e-12]])
over_bases = pytest.mark.parametrize("name", BASES)
SPACES = [lambda basis: Line(H, 12, basis), lambda basis: Plane(H, 11, 12, basis), lambda basis: Volume(H, 10, 11, 12, basis)]
over_spaces = pytest.mark.parametrize("make", SPACES, ids=["1", "2", "3"])


def gradient_of(name):
    """What mpm.scene.build takes: the two are one on hat functions."""
    return Bspline() if name == "linear" else Mls()


@over_bases
def test_partition_of_unity_and_linear_reproduction(name):
    basis = BASES[name]()
    for s in S:
        first, w, g, d, b = (np.array(part) for part in stencil(basis, s))
        assert np.allclose(first + np.arange(len(w)) - PAD - s, d, rtol=0, atol=1e-15 * (1 + s))
        assert min(w) >= 0 and abs(w.sum() - 1) < 1e-15 and abs(w @ d) < 1e-15
        assert abs(g.sum()) < 1e-15 and abs(g @ d - 1) < 2e-15
        assert abs(b.sum()) < 2e-15 and abs(b @ d - 1) < 2e-15
        assert w @ d**2 == pytest.approx(second_moment(basis, s), abs=2e-15)
        if name != "linear":
            assert np.allclose(b, inverse_moment(basis) * w * d, rtol=0, atol=1e-15) and inverse_moment(basis) * second_moment(basis, s) == pytest.approx(1)


@over_bases
def test_derivatives(name):
    basis, step = BASES[name](), 1e-6
    for s in (0.2, 0.45, 0.7, 1.9):
        (_, low, _, _, _), (_, high, _, _, _) = stencil(basis, s - step), stencil(basis, s + step)
        assert np.allclose((np.array(high) - low) / (2 * step), stencil(basis, s)[2], atol=1e-9)


def places(space, seed=1):
    D = directions(space)
    return np.random.default_rng(seed).uniform(0, 1, (N, D)) * (np.array(extents(space)[:D]) - 2 * PAD - 1) * H


def noise(D, seed=2):
    rng = np.random.default_rng(seed)
    chunk = new_chunk(D, np.zeros(1), True, True)
    chunk.m[:N] = rng.uniform(1, 2, N)
    for field in (chunk.a, chunk.A):
        field[..., :N] = rng.standard_normal((*field.shape[:-1], N))
    return chunk


def scattered(space, gradient, x, chunk):
    D = directions(space)
    nodes, box = np.zeros((math.prod(extents(space)), columns(D))), np.array([[10**9, -1]] * D)
    lay_down(space, x, 0, N, chunk)
    scatter(space, gradient, x, 0, chunk, N, nodes, box)
    return nodes


def nodes_at(space):
    axes = [(np.arange(n) - PAD) * H for n in extents(space)[: directions(space)]]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)


@over_bases
@over_spaces
def test_transfers_reproduce_linear_fields_and_keep_momentum(name, make):
    space = make(BASES[name]())
    D, x, rng, gradient = directions(space), places(space), np.random.default_rng(3), gradient_of(name)
    constant, slope = rng.standard_normal(D), rng.standard_normal((D, D))
    u = np.zeros((math.prod(extents(space)), columns(D)))
    u[:, :D] = constant + nodes_at(space) @ slope.T
    chunk = noise(D)
    lay_down(space, x, 0, N, chunk)
    gather(space, gradient, x, 0, chunk, N, u)
    assert np.allclose(chunk.v[:, :N].T, constant + x @ slope.T, atol=1e-13)
    for gathered in (chunk.C, chunk.L):
        assert np.allclose(gathered[..., :N], slope[..., None], atol=1e-12)
    value, fitted, grad = np.zeros(N), np.zeros((D, N)), np.zeros((D, N))
    gather_scalar(space, x, 0, N, u[:, 0].copy(), value, fitted, grad)
    assert np.allclose(value, chunk.v[0, :N]) and np.allclose(fitted, slope[0][:, None]) and np.allclose(grad, slope[0][:, None])
    nodes = scattered(space, gradient, x, chunk)
    assert nodes[:, D].sum() == pytest.approx(chunk.m.sum(), rel=1e-14)
    assert np.allclose(nodes[:, :D].sum(axis=0), chunk.a[:, :N].sum(axis=1), rtol=0, atol=1e-13)
    moment = H * H * np.broadcast_to(second_moment(space.basis, x / H), x.shape)
    turning = np.einsum("pc,dp->cd", x, chunk.a[:, :N]) + np.einsum("pc,dcp->cd", moment, chunk.A[..., :N])
    assert np.allclose(np.einsum("nc,nd->cd", nodes_at(space), nodes[:, :D]), turning, rtol=0, atol=1e-12)


@over_bases
@over_spaces
def test_gather_is_the_transpose_of_scatter(name, make):
    """With the B-spline gradient, and for one scalar: <scatter, u> = <a, v> + <A, moment C> + <G, L>."""
    space = make(BASES[name]())
    D, x, chunk = directions(space), places(space), noise(directions(space))
    chunk.G[..., :N] = np.random.default_rng(4).standard_normal((D, D, N))
    nodes = scattered(space, Bspline(), x, chunk)
    u = np.random.default_rng(5).standard_normal(nodes.shape)
    lay_down(space, x, 0, N, chunk)
    gather(space, Bspline(), x, 0, chunk, N, u)
    moment = H * H * np.broadcast_to(second_moment(space.basis, x / H), x.shape).T
    expected = np.sum(chunk.a * chunk.v) + np.sum(moment * chunk.A[..., :N] * chunk.C[..., :N]) + np.sum(chunk.G * chunk.L)
    assert np.sum(nodes[:, :D] * u[:, :D]) == pytest.approx(expected, rel=1e-11)
    one = np.zeros(len(nodes))
    scatter_scalar(space, x, 0, N, chunk.a[0].copy(), chunk.A[0].copy(), chunk.G[0].copy(), one)
    assert np.allclose(one, nodes[:, 0], atol=1e-13)


@over_bases
@pytest.mark.parametrize("kind", ["slip", "stick"])
def test_a_wall_is_the_mirrored_body(name, kind):
    """Folded nodes equal those of the body and its mirror image, on both sides, and reflection continues them outside: for the widest basis too."""
    cells, wide = 4, 12
    small, large = Line(H, cells + 1 + 2 * PAD, BASES[name]()), Line(H, wide + 1 + 2 * PAD, BASES[name]())
    x = np.array([0.0, 0.004, 0.6, 1.7, 3.996]) * H
    chunk = noise(1)
    nodes = scattered(small, gradient_of(name), x[:, None], chunk)
    box = np.array([[0, len(nodes)], [0, 1], [0, 1]])
    fold(nodes, 1, (len(nodes), 1, 1), box, np.full((3, 2), KINDS[kind]))
    expected = np.zeros((wide + 1 + 2 * PAD, 2))
    for sign, centre in ((1, 0.0), (-1, 0.0), (-1, 2.0 * cells)):
        image = Chunk(*(field.copy() for field in chunk))
        image.a[:] *= sign
        expected += scattered(large, gradient_of(name), sign * x[:, None] + (centre + 4) * H, image)
    inside, there = slice(PAD, PAD + cells + 1), slice(PAD + 4, PAD + 4 + cells + 1)
    own = np.ones((cells + 1, 2))
    own[0, 1] = own[-1, 1] = 0.5  # the wall's own node has its half only; its velocity is held
    own[0, 0] = own[-1, 0] = 0.0
    assert np.allclose((nodes[inside] * (own > 0))[1:-1], expected[there][1:-1], atol=1e-13)
    assert np.allclose(nodes[[PAD, PAD + cells], 1], 0.5 * expected[[PAD + 4, PAD + 4 + cells], 1], atol=1e-13)
    nodes[:, 0] = (np.arange(len(nodes)) - PAD) * H  # an odd field about the left wall
    unfold(nodes, 1, (len(nodes), 1, 1), box, np.array([[KINDS[kind], KINDS["contact"]]] * 3))
    v = Chunk(*(field.copy() for field in chunk))
    gather(small, gradient_of(name), x[:, None], 0, v, N - 1, nodes)
    assert np.allclose(v.v[0, : N - 1], x[: N - 1], atol=1e-14) and np.allclose(v.L[0, 0, : N - 1], 1.0, atol=1e-12)


@over_bases
def test_kinetic_energy_counts_the_affine_part(name):
    """A spinning cloud has the kinetic energy of its nodes where they are as many as particles ask for: sum m (v^2 + moment C^2)/2."""
    space = Axisymmetric(H, 11, 12, BASES[name]())
    x, chunk = places(space), noise(2)
    p = Particles(x, chunk.a[:, :N].T.copy(), chunk.A[..., :N].transpose(2, 0, 1).copy(), np.zeros((N, 4)), np.ones(N), chunk.m[:N].copy(), np.ones(N))
    expected = 0.0
    for i in range(N):  # alone: a particle's affine velocity at the nodes it sees
        (i0, wx, *_), (j0, wy, *_) = stencil(space.basis, x[i, 0] / H), stencil(space.basis, x[i, 1] / H)
        for a in range(len(wx)):
            for b in range(len(wy)):
                d = np.array([i0 + a - PAD, j0 + b - PAD]) * H - x[i]
                expected += 0.5 * p.m[i] * wx[a] * wy[b] * np.sum((p.v[i] + p.C[i] @ d) ** 2)
    assert kinetic(space, p) == pytest.approx(expected, rel=1e-13)
