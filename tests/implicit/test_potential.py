"""Gradient and Hessian of the whole potential against finite differences, with every term of it in play: particles that flow, ghosts, walls, inertia, drag."""

import numpy as np
import pytest

import mpm
from mpm.implicit.contact import STIFFNESS, may_touch
from mpm.implicit.free import Free, couple
from mpm.implicit.matrix import Band, new_matrix, product
from mpm.implicit.newton import Problem
from mpm.implicit.nodes import new_nodes
from mpm.scene.build import build
from mpm.simulation import Clock


def problem(disc, dimension, locking, seed=3):
    plane = {"grid": {"dimension": 2, "size": [8e-3, 8e-3], "cell": 1e-3},
             "bodies": {"disc": {"shape": {"box": {"lower": [1e-3, 0.02e-3], "upper": [4.3e-3, 2.7e-3]}}, "material": "dough"}}}  # fmt: skip
    disc["method"]["locking"] = locking
    space = {"grid": {"dimension": 3, "size": [8e-3] * 3, "cell": 1e-3}, "gravity": [0, 1, -9.81],
             "bodies": {"disc": {"shape": {"box": {"lower": [1e-3, 0.5e-3, 0.02e-3], "upper": [3.3e-3, 2.6e-3, 2.7e-3]}}, "material": "dough"}},
             "loads": [{"of": "disc", "side": "top", "traction": {"nominal": [0, 5, -20]}}]}  # fmt: skip
    scene = build(mpm.load(disc | {2: plane, 3: space}.get(dimension, {})))
    body, rng = scene.bodies[0], np.random.default_rng(seed)
    body.particles.B[:] = rng.normal(scale=0.02, size=body.particles.B.shape)
    body.particles.v[:] = rng.normal(scale=1e-4, size=body.particles.v.shape)
    nodes = new_nodes(scene.space, scene.gradient, body, scene.implicit.walls, scene.gravity[-1], 4e3)
    pushed = may_touch(scene, Clock(scene), 0.4, STIFFNESS * 1e4 / scene.space.h)
    pushed = pushed._replace(gap=pushed.gap - 0.05e-3)  # some in the wall
    pushed.limit[pushed.gap < 0] = np.resize([np.inf, 1e-3, 5e-5, 0.0], (pushed.gap < 0).sum())  # some hold, some slide
    pushed.stretch[:, 0] = rng.normal(scale=1e-6, size=len(pushed.gap))
    pushed.told[:, 1] = pushed.given[:, 1] = 1e-6
    pushed.free[::2] = 0
    way = np.array([[0.28, 0.96, 0.0][: nodes.v.shape[1]]])
    free = Free(np.array([0]), way / np.linalg.norm(way), *np.array([[2.0], [1e-4], [1e-5], [0.0]]))
    assert len(nodes.lines) and np.unique(pushed.limit).size == 4
    u = rng.normal(scale=2e-5, size=nodes.v.shape) * (nodes.eq >= 0)
    return Problem(scene.space, body, nodes, pushed, free, 0.4, 3.0), u


def dense(matrix, eq):
    """The whole matrix by unknowns."""
    n = eq.max() + 1
    whole = np.zeros((n, n))
    if isinstance(matrix, Band):
        for j in range(n):
            for k in range(min(matrix.values.shape[1], n - j)):
                whole[j + k, j] = whole[j, j + k] = matrix.values[j, k]
        return whole
    out = np.zeros(eq.shape)
    for j in range(n):
        one = np.where(eq == j, 1.0, 0.0)
        product(matrix, one, out)
        whole[eq[eq >= 0], j] = out[eq >= 0]
    return whole


def bordered(found, u):
    """What a free tool takes off the matrix: c c^T/k."""
    c, k, eq = np.zeros((1, *u.shape)), np.zeros(1), found.nodes.eq
    couple(found.nodes, found.pushed, found.free, u, found.dt, c, k)
    column = np.zeros(found.nodes.unknowns)
    column[eq[eq >= 0]] = c[0][eq >= 0]
    assert np.abs(column).max() > 0 and abs(found.free.d[0]) > 1e-6
    return np.outer(column, column) / k[0]


FBAR = {"fbar": {"own": 0.1}}


@pytest.mark.parametrize(
    ("dimension", "locking"),
    [
        pytest.param("axisymmetric", None, marks=pytest.mark.plain),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in [(2, None), (2, FBAR), ("axisymmetric", FBAR), (3, None), (3, FBAR)]),
    ],
)
def test_gradient_and_hessian(disc, dimension, locking):
    found, u = problem(disc, dimension, locking)
    n, depth, eq = found.nodes.unknowns, np.zeros(len(found.pushed.owner)), found.nodes.eq
    free = eq >= 0

    def at(change, want=True):
        r, matrix, moved = np.zeros(u.shape), new_matrix(found.space, found.nodes), u.copy()
        moved[free] += change[eq[free]]
        Pi, gradient = found.potential(moved, r, matrix, depth, want), np.zeros(n)
        gradient[eq[free]] = r[free]
        return Pi, gradient, matrix

    _, r, matrix = at(np.zeros(n))
    whole = dense(matrix, eq) - bordered(found, u)
    rng = np.random.default_rng(11)
    step = 1e-9
    for _ in range(8):
        way = rng.normal(size=n)
        rise = (at(step * way, False)[0] - at(-step * way, False)[0]) / (2 * step)
        assert rise == pytest.approx(r @ way, rel=1e-6, abs=1e-6 * np.abs(r).max())
        slope = (at(step * way)[1] - at(-step * way)[1]) / (2 * step)
        np.testing.assert_allclose(slope, whole @ way, rtol=0, atol=1e-6 * np.abs(whole @ way).max())
