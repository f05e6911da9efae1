"""Conjugate gradients where a factorisation is too large: the same answer, the same ledger; spheres in three dimensions and as axisymmetric bodies."""

import numpy as np
import pytest

import mpm.rigid.run
from mpm.rigid import Method, RigidBody, solve
from mpm.rigid.linear import LinearSteps
from mpm.scene import Ball, Box

CENTRE = np.array([0.013, 0.021, 0.037])


def body(shape, bi):
    return [RigidBody(shape, 301.0, 1.0, 1.0, 1.0, (("all", bi, 300.0),))]


def sphere(bi, n, space=3, **options):
    centre = CENTRE if space == 3 else np.array([0.0, 0.021])
    return solve(body(Ball(tuple(centre), 1.0), bi), space, 1 / n, end=0.2, times=[0.1, 0.2], method=Method(**options))


def balanced(run):
    return np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()


@pytest.mark.parametrize(("space", "bi"), [(2, 10.0), (2, np.inf), (3, 10.0)])
def test_it_gives_what_a_factorisation_gives(monkeypatch, space, bi):
    """Fixed steps: nothing but the solver differs. Its tolerance is 1e-4 of the step's 1e-6."""
    runs, shape = [], Ball(tuple(CENTRE[:space]), 1.0)
    for large in (np.inf, 0.0):
        monkeypatch.setattr(mpm.rigid.run, "LARGE", large)
        monkeypatch.setattr(mpm.rigid.run, "LESS", large)
        runs.append(solve(body(shape, bi), space, 1 / 3, end=0.2, times=[0.1, 0.2], method=Method(tolerance=1e-6, step=0.05)))
    direct, iterated = runs
    x, _ = direct.points()
    assert np.abs(direct.sample(x, 0) - iterated.sample(x, 0)).max() < 1e-6 and balanced(direct) and balanced(iterated)
    solver = iterated.bodies[0][1].solver
    assert solver.count[0] == 4 * 5 and solver.count[1] < (12 if np.isfinite(bi) else 100) * solver.count[0]


def test_large_bodies_are_solved_by_it():
    """Also where nobody asked for a method, and `outlook` says the memory of stencils, not of a factor."""
    ten = mpm.rigid.run.outlook(body(Ball(tuple(CENTRE), 1.0), 10.0), 3, 1 / 10, end=0.2)
    assert ten["methods"] == ["LinearSteps"] and ten["memory_bytes"] < 1e8
    run = sphere(10.0, 6)
    assert isinstance(run.bodies[0][1], LinearSteps) and hasattr(run.bodies[0][1].solver, "stencil") and balanced(run)


@pytest.mark.parametrize("bi", [1.0, 10.0])
def test_a_sphere_is_the_same_in_three_dimensions_and_axisymmetric(series, bi):
    """Apart by no more than the errors of both, each against the series."""
    flat, full = sphere(bi, 6, "axisymmetric"), sphere(bi, 6)
    errors = [series.rms(run, lambda r: 300 + series.sphere(r, 0.2, bi), lambda x, c=c: np.linalg.norm(x - c, axis=1))
              for run, c in ((flat, np.array([0.0, 0.021])), (full, CENTRE))]  # fmt: skip
    x, w = full.points()
    y = x - CENTRE
    other = flat.sample(np.stack([np.hypot(y[:, 0], y[:, 1]), y[:, 2] + 0.021], axis=-1), 0)
    apart = np.sqrt(np.average((full.sample(x, 0) - other) ** 2, weights=w))
    assert apart < sum(errors) < 2e-4
    # A content a radian, turned about the axis, is that of the whole.
    assert 2 * np.pi * flat.series["heat"][-1] == pytest.approx(full.series["heat"][-1], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("bi", [1.0, 10.0])
def test_a_sphere_of_twelve_cells_a_radius(series, bi):
    """Order 3: the error of six cells falls by five at least."""
    run = sphere(bi, 12, tolerance=1e-5)
    assert run.unknowns > 11_000 and balanced(run)
    assert series.rms(run, lambda r: 300 + series.sphere(r, 0.2, bi), lambda x: np.linalg.norm(x - CENTRE, axis=1)) < 1e-5


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_the_ledger_of_explicit_steps_behind_a_fixed_temperature(tolerance):
    """A thousand stages a step; 3e-11 before the recurrence went over increments."""
    run = solve(body(Box((-1.0,), (1.0,)), np.inf), 1, 1 / 32, [0.3 / 32], end=0.2, times=[0.1, 0.2], method=Method("explicit", tolerance=tolerance))
    assert np.abs(run.series["heat_ledger"]).max() < 1e-13 * np.abs(run.series["heat_exchanged"]).max()
