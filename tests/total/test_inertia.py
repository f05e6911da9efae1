"""Inertia in the total frame: waves to order 4, momentum and its moment kept, and a step that stays stable where cells are cut."""

import math

import numpy as np
import pytest

import mpm
from mpm.scene.build import build
from mpm.simulation import simulate
from mpm.total.inertia import follow, impel
from mpm.total.reference import mirror
from mpm.total.step import force_all
from mpm.transfer import new_chunk

NU = 0.3


def scene(shape, dimension=2, cell=0.1, nu=NU, walls=(), size=2.0, **method):
    D = {1: 1, 2: 2, "axisymmetric": 2, 3: 3}[dimension]
    basis = method.pop("basis", "quadratic")
    return build(mpm.load({
        "grid": {"dimension": dimension, "size": [size] * D, "cell": cell, "basis": basis}, "bodies": {"body": {"shape": shape, "material": "m", **method}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": nu}}}}, "walls": dict(walls),
        "time": {"end": 1}, "output": {"every": 1}, "method": {"frame": "total"},
    }))  # fmt: skip


def accelerated(scene, u):
    """What nodes at a small displacement u (n, D) are accelerated by (n, D)."""
    (body,), (reference,), D = scene.bodies, scene.references, u.shape[1]
    reference.u[:, :D] = u
    mirror(reference.u, reference)
    force_all(scene.space, body, reference, new_chunk(D, reference.f, True, False), 0.0, np.zeros(32))
    n = reference.active
    reference.p[n, :D] = reference.f[n, :D] / reference.m[n, None]
    for node, axis in reference.held:
        reference.p[node, axis] = 0.0
    follow(reference)
    return reference.v[:, :D].copy()


def places(scene):
    shape = scene.space[1 : 1 + scene.references[0].X.shape[1]]
    return (np.stack(np.unravel_index(np.arange(math.prod(shape)), shape), axis=-1) - 2) * scene.space.h


@pytest.mark.parametrize(("D", "basis"), [
    (1, "quadratic"), *(pytest.param(*one, marks=pytest.mark.wide) for one in ((2, "quadratic"), (2, "cubic"), (3, "quadratic")))
])  # fmt: skip
def test_waves_are_right_to_order_four(D, basis):
    """A wave of pressure across a box between walls that slip, oblique where there is more than one direction: its frequency, by the cell."""
    k, M, off = np.pi * np.array([2.0, 1.0, 1.0][:D]), (1 - NU) / ((1 + NU) * (1 - 2 * NU)), []
    walls = [(side, "slip") for side in ("left", "right", "bottom", "top", "front", "back")[: 2 * D]]
    for cell in (0.125, 0.0625):
        made = scene({"box": {"lower": [0.0] * D, "upper": [1.0] * D}}, dimension=D, cell=cell, walls=walls, size=1.0, basis=basis)
        x, n = places(made), made.references[0].active
        across = [np.prod([np.sin(k[b] * x[:, b]) if a == b else np.cos(k[b] * x[:, b]) for b in range(D)], axis=0) for a in range(D)]
        u = 1e-7 * k * np.stack(across, axis=1)
        square = -np.sum(accelerated(made, u)[n] * u[n]) / np.sum(u[n] ** 2)
        off.append(np.sqrt(square / (M * np.sum(k**2))) - 1)
    assert abs(off[1]) < (0.028 if basis == "quadratic" else 0.04) * np.sum(k**2) ** 2 * 0.0625**4
    assert np.log2(off[0] / off[1]) > 3.7


def test_momentum_and_its_moment_are_kept():
    """An L that flies, turns and rings; at the start its nodes move as a rigid body, cut cells or not."""
    corner = {"polygon": {"vertices": [[0.53, 0.57], [1.22, 0.57], [1.22, 0.83], [0.79, 0.83], [0.79, 1.31], [0.53, 1.31]]}}
    experiment = mpm.load({
        "grid": {"dimension": 2, "size": [2, 2], "cell": 0.1},
        "bodies": {"body": {"shape": corner, "material": "m", "velocity": [0.02, 0.01], "angular_velocity": 0.3}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": NU}}}},
        "time": {"end": 3}, "output": {"every": 1}, "method": {"frame": "total"},
    })  # fmt: skip
    made = build(experiment)
    (reference,), X = made.references, places(made)
    n, m = reference.active, reference.m[reference.active]

    def moments():
        x, p = X[n] + reference.u[n, :2], reference.p[n, :2]
        return np.array([*(m @ p), m @ (x[:, 0] * p[:, 1] - x[:, 1] * p[:, 0])])

    centre = np.average(reference.X, axis=0, weights=made.bodies[0].particles.V0)
    rigid = np.array([0.02, 0.01]) + 0.3 * (X[n] - centre)[:, ::-1] * [-1, 1]
    assert reference.v[n, :2] == pytest.approx(rigid, abs=1e-14)
    before = moments()
    run = simulate(made)
    total = run.series["energy_total"]
    assert run.outcome.ok and moments() == pytest.approx(before, rel=1e-12)
    assert total == pytest.approx(total[0], rel=2e-3)


BALL = {"ball": {"centre": [1.03, 1.07], "radius": 0.44}}
LEFT = {"box": {"lower": [0.0, 0.55], "upper": [0.61, 0.9504]}}
AXIS = {"box": {"lower": [0.0, 0.0], "upper": [0.47, 0.9101]}}


@pytest.mark.parametrize(("made", "most"), [
    ((BALL, 2), 0.75), ((LEFT, 2, 0.1, 0.0, {"left": "stick"}), 0.8),
    *(pytest.param(*one, marks=pytest.mark.wide) for one in (
        ((AXIS, "axisymmetric", 0.1, 0.0, {"bottom": "slip"}), 0.8),
        (({"box": {"lower": [0.55], "upper": [1.0503]}}, 1), 0.76),
        (({"ball": {"centre": [1.03, 1.07, 1.01], "radius": 0.34}}, 3, 0.1, 0.0), 0.8),
        (({"box": {"lower": [0.0, 0.0, 0.53], "upper": [0.31, 0.4504, 0.8]}}, 3, 0.1, 0.0, {"left": "slip", "front": "stick"}), 0.85))),
])  # fmt: skip
@pytest.mark.parametrize("basis", ["quadratic", pytest.param("cubic", marks=pytest.mark.wide)])
def test_the_step_stays_stable_where_cells_are_cut(made, most, basis):
    """The highest frequency by power iteration, over that at which the step taken would be unstable. nu = 0 leaves least room (docs/physics.md 14)."""
    made = scene(*made, basis=basis)
    reference, D, nu = made.references[0], made.references[0].X.shape[1], made.bodies[0].elastic
    limit = reference.courant * made.space.h / np.sqrt(D * nu.lam + 2 * nu.mu)
    u, n = np.zeros((len(reference.m), D)), reference.active
    u[n] = np.random.default_rng(1).standard_normal((len(n), D))
    for _ in range(300):
        u *= 1e-8 / np.abs(u).max()
        found = accelerated(made, u)
        square, u = np.linalg.norm(found) / np.linalg.norm(u), found
    assert 0.5 < 0.5 * limit * np.sqrt(square) < (most if basis == "quadratic" else most + 0.09)


def test_momentum_of_a_motion_is_found_to_round_off():
    made = scene(LEFT, walls={"left": "stick"})
    (reference,) = made.references
    n = reference.active
    reference.v[n, :2] = np.random.default_rng(2).standard_normal((len(n), 2))
    given = reference.v.copy()
    impel(reference)
    assert reference.v == pytest.approx(given, abs=1e-14)
