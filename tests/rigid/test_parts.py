"""The parts of rigid heat: band factorisation, stencils, splines, tableaux, Chebyshev steps, enthalpy tables, the choice of method."""

import numpy as np
import pytest

from mpm.materials.laws import Bump, Constant, Logistic, table
from mpm.materials.roles import enthalpy
from mpm.rigid import Method, RigidBody, outlook, solve
from mpm.rigid.band import back_substitute, factorise, fill, make_band
from mpm.rigid.geometry import evaluated, geometry, row_sums
from mpm.rigid.nodes import apply, interpolate, make_nodes
from mpm.rigid.sdirk import TABLEAUS
from mpm.rigid.tables import make_table, temperatures
from mpm.scene import Ball, Box, Cylinder


def dense(stencil, diff):
    n = stencil.shape[1]
    matrix = np.zeros((n, n))
    for row, k in zip(stencil, diff, strict=True):
        matrix[np.arange(n - k) + k, np.arange(n - k)] = row[: n - k]
    return matrix + np.tril(matrix, -1).T


BODIES = [Box((0.11,), (1.03,)), Ball((0.1, 0.2), 0.9), Box((0.0, 0.0), (3.0, 0.3)), Ball((0.0, 0.1, 0.2), 0.4)]


@pytest.mark.parametrize("shape", BODIES, ids=repr)
def test_stencils_and_band(shape):
    made = geometry(shape, False, 0.15, (0.0,) * shape.dimension, ("all",))
    diff, rng = made.nodes.diff, np.random.default_rng(0)
    mass, stiffness = dense(made.mass, diff), dense(made.stiffness, diff)
    x, y = rng.normal(size=made.nodes.size), np.empty(made.nodes.size)
    apply(made.stiffness, diff, x, y)
    np.testing.assert_allclose(y, stiffness @ x, atol=1e-12)
    np.testing.assert_allclose(row_sums(made.stiffness, diff), 0, atol=1e-13)
    size, reach = made.nodes.size, int(diff[-1])
    band = make_band(size, reach)
    fill(band, diff, made.mass, 1.0, made.stiffness, 0.3, ~made.active)
    assert factorise(band, size, reach) == -1
    full = mass + 0.3 * stiffness + np.diag(~made.active * 1.0)
    b = full @ x
    back_substitute(band, reach, b)
    np.testing.assert_allclose(full @ b, full @ x, atol=1e-13 * np.abs(full).max())
    fill(band, diff, made.mass, -1.0, made.stiffness, 0.0, ~made.active)
    assert factorise(band, size, reach) >= 0


def test_matrices_integrate_polynomials():
    """1.M 1 is the area, u.K u the Dirichlet integral of a linear field, 1.B 1 the rim."""
    made = geometry(Ball((0.1, 0.2), 0.9), False, 0.2, (0.0, 0.0), ("all",))
    count, first = made.nodes.count, made.nodes.first
    place = np.stack(np.meshgrid(*[0.2 * (first[k] + np.arange(count[k])) for k in range(2)], indexing="ij"), axis=-1)
    flat = sum(np.arange(count[k]).reshape([-1 if j == k else 1 for j in range(2)]) * made.nodes.stride[k] for k in range(2)).ravel()
    u = np.empty(made.nodes.size)
    u[flat] = (place @ [2.0, -1.0]).ravel()
    work = np.empty_like(u)
    apply(made.stiffness, made.nodes.diff, u, work)
    assert u @ work == pytest.approx(5 * np.pi * 0.81, rel=1e-9)
    assert made.volume.sum() == pytest.approx(np.pi * 0.81, rel=1e-10)
    assert made.area[0].sum() == pytest.approx(np.pi * 1.8, rel=1e-12)
    x = np.random.default_rng(1).uniform(-0.4, 0.6, (20, 2))
    np.testing.assert_allclose(interpolate(*evaluated(made.nodes, x), u), x @ [2.0, -1.0], atol=1e-13)


def test_the_longest_direction_changes_slowest():
    nodes, _ = make_nodes([0.0, 0.0], [0.3, 5.0], 0.1, np.zeros(2))
    assert nodes.stride[1] > nodes.stride[0] == 1


@pytest.mark.parametrize("kind", TABLEAUS)
def test_tableau(kind):
    """Consistency, stiff accuracy, dense output that meets the step and has order 3 (order 4's) or 2 on y' = y."""
    t = TABLEAUS[kind]
    c, b = t.a.sum(1), t.a[-1]
    assert c[-1] == pytest.approx(1)
    np.testing.assert_allclose(np.diag(t.a), t.gamma)
    np.testing.assert_allclose(t.weights(np.array([0.0, 1.0])), [0 * b, b], atol=1e-13)
    assert t.error.sum() == pytest.approx(0, abs=1e-14)
    for k in range(1, kind + 1):
        assert b @ c ** (k - 1) == pytest.approx(1 / k, abs=1e-13)
    s = np.linspace(0.1, 1, 7)
    errors = []
    for dt in (0.2, 0.1):
        k = np.linalg.solve(np.eye(len(b)) - dt * t.a, np.ones(len(b)))
        errors.append(np.abs(1 + dt * t.weights(s) @ k - np.exp(s * dt)).max())
    assert np.log2(errors[0] / errors[1]) > {4: 3.7, 2: 2.7}[kind]


def test_order_of_chebyshev_steps():
    """Declared order 2, whatever the number of stages."""
    body = [RigidBody(Box((-1.0,), (1.0,)), 1.0, 1.0, 1.0, Logistic(1.0, 2.0, 0.7, 0.2), (("all", 1.0, 0.0),))]
    fields = [
        solve(body, 1, 1 / 8, [0.04], end=1.0, method=Method("explicit", step=1 / n)).sample(np.linspace(-0.9, 0.9, 9)[:, None]) for n in (8, 16, 32, 1024)
    ]
    errors = [np.abs(field - fields[-1]).max() for field in fields[:-1]]
    assert np.log2(errors[0] / errors[2]) / 2 > 1.7


@pytest.mark.parametrize(
    "alpha", [Constant(2000.0), Bump(2247.0, 2.46e5, 372.75, 1.5), Logistic(2e3, 3e3, 350.0, 2.0), table([300.0, 350.0, 420.0], [2e3, 4e3, 2e3])], ids=repr
)
def test_enthalpy_tables(alpha):
    made = make_table(alpha, Logistic(0.2, 0.5, 350.0, 10.0), 300.0, 290.0, 460.0)
    theta = np.linspace(285.0, 465.0, 401)
    h = np.array([enthalpy(alpha, t) - enthalpy(alpha, 300.0) for t in theta])
    np.testing.assert_allclose(temperatures(made, h), theta - 300.0, atol=1e-5)
    assert abs(temperatures(made, np.zeros(1))[0]) < 1e-15
    far = temperatures(made, np.array([1e7, 2e7, 3e7]))
    assert far[2] - far[1] == pytest.approx(far[1] - far[0])


def test_a_law_without_inverse_is_refused():
    with pytest.raises(ValueError, match="alpha must be positive"):
        make_table(Logistic(1.0, -1.0, 350.0, 5.0), Constant(1.0), 300.0, 290.0, 400.0)


def test_outlook_agrees_with_the_run():
    for alpha, beta in ((2247.0, 13.0), (Bump(2247.0, 2.46e5, 372.75, 1.5), 13.0), (Bump(2247.0, 2.46e5, 372.75, 1.5), np.inf)):
        body = [RigidBody(Cylinder(0.036, 0.035, (0.0, 0.004)), 297.15, 301.0, 0.35, alpha, (("all", beta, 463.15),))]
        found = outlook(body, "axisymmetric", 2e-3, end=60.0)
        run = solve(body, "axisymmetric", 2e-3, end=60.0)
        assert found["unknowns"] == run.unknowns
        assert found["methods"] == run.facts["heat_method"]
        assert found["limits"] == run.limits
        assert 0 < found["seconds"] < 20
        assert found["memory_bytes"] > 1000
