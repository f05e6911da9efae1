"""Small tensors against numpy, in both precisions and at the awkward places."""

from fractions import Fraction

import numpy as np
import pytest

from mpm import tensors
from mpm.jit import kernel

EPS = {np.float64: 2.3e-16, np.float32: 1.2e-7}
SPREAD = [0.0, 1.0, 1.0 + 1e-15, 1e-3, -1.0, 1e-9, 1e-17, 1e-25, -3e-22, 0.999999, 1e-160]


@kernel
def eigen2_many(a, value, axis):
    for k in range(a.shape[0]):
        l1, l2, c, s = tensors.eigen2(a[k, 0], a[k, 1], a[k, 2])
        value[k, 0], value[k, 1] = l1, l2
        axis[k, 0, 0], axis[k, 0, 1], axis[k, 1, 0], axis[k, 1, 1] = c, s, -s, c


@kernel
def eigen3_many(a, value, axis):
    for k in range(a.shape[0]):
        l1, l2, l3, ax, ay, az, bx, by, bz, cx, cy, cz = tensors.eigen3(a[k, 0], a[k, 1], a[k, 2], a[k, 3], a[k, 4], a[k, 5])
        value[k, 0], value[k, 1], value[k, 2] = l1, l2, l3
        axis[k, 0, 0], axis[k, 0, 1], axis[k, 0, 2] = ax, ay, az
        axis[k, 1, 0], axis[k, 1, 1], axis[k, 1, 2] = bx, by, bz
        axis[k, 2, 0], axis[k, 2, 1], axis[k, 2, 2] = cx, cy, cz


def full(a):
    """Symmetric matrices of packed components (xx, yy, xy) or (xx, yy, zz, xy, yz, xz)."""
    a = np.asarray(a, dtype=np.float64)
    order = [[0, 2], [2, 1]] if a.shape[-1] == 3 else [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
    return a[..., order]


def samples(width, dtype):
    """Random tensors, tensors of a few digits, nearly equal values, tiny and huge ratios."""
    rng = np.random.default_rng(3)
    grid = np.array(np.meshgrid(*[SPREAD[::2] if width == 6 else SPREAD] * width)).reshape(width, -1).T
    near = np.concatenate([np.ones((4000, width - width // 2)), np.zeros((4000, width // 2))], axis=1) if width == 6 else np.ones((4000, 3)) * [1, 1, 0]
    near = near + rng.standard_normal(near.shape) * 10.0 ** rng.uniform(-20, -1, (4000, 1))
    return np.concatenate([rng.standard_normal((4000, width)), near, grid]).astype(dtype)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(("width", "solve"), [(3, eigen2_many), (6, eigen3_many)])
def test_eigen_reproduces_the_tensor(width, solve, dtype):
    """Orthonormal axes that give the tensor back bound the error of the values too (numpy's eigvalsh loses digits on some of these)."""
    a = samples(width, dtype)
    n = 2 if width == 3 else 3
    value, axis = np.zeros((len(a), n), dtype), np.zeros((len(a), n, n), dtype)
    solve(a, value, axis)
    matrix, size = full(a), np.abs(a).max(axis=1).astype(float)
    value, axis = value.astype(float), axis.astype(float)
    again = np.einsum("kn,kni,knj->kij", value, axis, axis)
    tolerance = (8 if n == 2 else 24) * EPS[dtype]
    assert np.all(np.abs(again - matrix).max(axis=(1, 2)) <= tolerance * size + 1e-24)
    assert np.abs(np.einsum("kni,kmi->knm", axis, axis) - np.eye(n)).max() < tolerance


def test_eigen_of_diagonal_tensors_is_exact():
    assert tensors.eigen2(0.3, -0.1, 0.0) == (0.3, -0.1, 1.0, 0.0)
    assert tensors.eigen2(0.25, 0.25, 0.0) == (0.25, 0.25, 1.0, 0.0)
    assert tensors.eigen3(3.0, 2.0, 1.0, 0.0, 0.0, 0.0) == (3.0, 2.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def test_precision_follows_the_argument():
    one = np.float32(1.0)

    @kernel
    def kinds(x):
        return tensors.eigen2(x, x, x)[0], tensors.eigen3(x, x, x, x, x, x)[0], tensors.push2((x, x, x, x), (x, x, x, x, x))[0]

    kinds(one)
    if hasattr(kinds, "nopython_signatures"):
        assert str(kinds.nopython_signatures[0].return_type) == "UniTuple(float32 x 3)"
    assert all(np.asarray(x).dtype == np.float32 for x in tensors.turn(one, one, one)) or hasattr(kinds, "nopython_signatures")


def test_compose_inverts_eigen_and_is_exact_for_equal_values():
    rng = np.random.default_rng(5)
    for a in rng.standard_normal((50, 6)):
        l1, l2, c, s = tensors.eigen2(a[0], a[1], a[3])
        assert np.allclose(tensors.compose2(l1, l2, c, s), (a[0], a[1], a[3]), rtol=0, atol=3e-15)
        assert tensors.compose2(0.1, 0.1, c, s) == (0.1, 0.1, 0.0)
        e = tensors.eigen3(*a)
        assert np.allclose(tensors.compose3(*e[:9]), a, rtol=0, atol=8e-15)
        assert tensors.compose3(0.1, 0.1, 0.1, *e[3:9]) == (0.1, 0.1, 0.1, 0.0, 0.0, 0.0)


def increments(rng, size):
    """The same random A in three packings, with its 3x3 matrix."""
    a = rng.standard_normal((3, 3)) * size
    flat = np.zeros((3, 3))
    flat[:2, :2], flat[2, 2] = a[:2, :2], a[2, 2]
    return [
        (tensors.push1, tensors.dilation1, (a[0, 0],), np.diag([a[0, 0], 0, 0]), [0, 1, 2]),
        (tensors.push2, tensors.dilation2, (*flat[:2, :2].ravel(), a[2, 2]), flat, [0, 1, 2, 3]),
        (tensors.push3, tensors.dilation3, tuple(a.ravel()), a, [0, 1, 2, 3, 4, 5]),
    ]


def exact(matrix):
    """Fractions, so that nothing of order one cancels."""
    return np.array([[Fraction(float(x)) for x in row] for row in matrix], dtype=object)


def det(m):
    return sum(m[0, i] * (m[1, (i + 1) % 3] * m[2, (i + 2) % 3] - m[1, (i + 2) % 3] * m[2, (i + 1) % 3]) for i in range(3))


@pytest.mark.parametrize("size", [0.3, 1e-4, 1e-9])
def test_push_and_dilation_against_fractions(size):
    rng = np.random.default_rng(7)
    at = ([0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2])
    one = exact(np.eye(3))
    for _ in range(20):
        b = rng.standard_normal(6) * size
        for push, dilation, A, matrix, keep in increments(rng, size):
            state = np.where(np.isin(np.arange(6), keep), b, 0.0)
            F = one + exact(matrix)
            trial = (F.dot(one + exact(full(state))).dot(F.T) - one)[at][keep].astype(float)
            assert np.abs(np.array(push(tuple(state[keep]), A)) - trial).max() < 4e-15 * size * (1 + size) ** 3
            assert abs(dilation(A) - float(det(F) - 1)) < 2e-15 * size * (1 + size) ** 3


def test_rigid_rotation_keeps_principal_strains():
    angle = 0.37
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    B = (0.02, -0.01, 0.005, 0.003)
    turned = tensors.push2(B, (*(R - np.eye(2)).ravel(), 0.0))
    assert np.allclose(sorted(tensors.eigen2(B[0], B[1], B[3])[:2]), sorted(tensors.eigen2(turned[0], turned[1], turned[3])[:2]), rtol=0, atol=5e-16)
    assert turned[2] == B[2]
