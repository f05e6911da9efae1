"""Gradient and Hessian of the whole potential against finite differences, with every term of it in play: particles that flow, ghosts, walls, inertia, drag."""

import numpy as np
import pytest

import mpm
from mpm.contact.skin import lay_skins, new_skin
from mpm.implicit.contact import STIFFNESS, may_touch
from mpm.implicit.newton import Problem
from mpm.implicit.nodes import new_nodes
from mpm.scene.build import build


def problem(disc, dimension, seed=3):
    plane = {"grid": {"dimension": 2, "size": [8e-3, 8e-3], "cell": 1e-3},
             "bodies": {"disc": {"shape": {"box": {"lower": [1e-3, 0.02e-3], "upper": [4.3e-3, 2.7e-3]}}, "material": "dough"}}}  # fmt: skip
    scene = build(mpm.load(disc | (plane if dimension == 2 else {})))
    body, rng = scene.bodies[0], np.random.default_rng(seed)
    body.particles.B[:] = rng.normal(scale=0.02, size=body.particles.B.shape)
    body.particles.v[:] = rng.normal(scale=1e-4, size=body.particles.v.shape)
    nodes = new_nodes(scene.space, scene.gradient, body.particles, scene.implicit.walls, scene.gravity[-1], 4e3)
    skin = new_skin(2, np.array([0, len(body.surface.owner)]))
    lay_skins(scene.space, scene.bodies, skin)
    skin.x[:, 1] -= 0.05e-3  # some in the wall
    pushed = may_touch(scene.space, skin, scene.implicit.stops, STIFFNESS * 1e4 / scene.space.h)
    assert len(pushed.owner) and len(nodes.lines) and (pushed.grip > 0).any()
    u = rng.normal(scale=2e-5, size=nodes.v.shape) * (nodes.eq >= 0)
    return Problem(scene.space, body, nodes, pushed, 0.4, 3.0), u


@pytest.mark.parametrize("dimension", ["axisymmetric", pytest.param(2, marks=pytest.mark.slow)])
def test_gradient_and_hessian(disc, dimension):
    found, u = problem(disc, dimension)
    n, depth, eq = found.nodes.unknowns, np.zeros(len(found.pushed.owner)), found.nodes.eq
    free = eq >= 0

    def at(change, want=True):
        r, band, moved = np.zeros(u.shape), np.zeros((n, found.nodes.band + 1)), u.copy()
        moved[free] += change[eq[free]]
        Pi, gradient = found.potential(moved, r, band, depth, want), np.zeros(n)
        gradient[eq[free]] = r[free]
        return Pi, gradient, band

    _, r, band = at(np.zeros(n))
    whole = np.zeros((n, n))
    for j in range(n):
        for k in range(min(found.nodes.band + 1, n - j)):
            whole[j + k, j] = whole[j, j + k] = band[j, k]
    rng = np.random.default_rng(11)
    step = 1e-9
    for _ in range(8):
        way = rng.normal(size=n)
        rise = (at(step * way, False)[0] - at(-step * way, False)[0]) / (2 * step)
        assert rise == pytest.approx(r @ way, rel=1e-6, abs=1e-6 * np.abs(r).max())
        slope = (at(step * way)[1] - at(-step * way)[1]) / (2 * step)
        np.testing.assert_allclose(slope, whole @ way, rtol=0, atol=1e-6 * np.abs(whole @ way).max())
