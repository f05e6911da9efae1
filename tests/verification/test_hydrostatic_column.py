"""Equilibrium under its own weight: the closed form satisfies its equation, tends to the linear one, and a run stays in it to order 2."""

import numpy as np
import pytest

from mpm.verification import exact_solution, hydrostatic_column

X = np.linspace(0, 1, 41)[:, None]


def test_solution_carries_the_weight(shipped):
    motion = exact_solution(shipped("hydrostatic_column", {"gravity": [-0.35]}))
    tau = motion.fields["stress"](X, 0.0)[:, 0]
    assert tau / np.exp(tau) == pytest.approx(-0.35 * (1 - X[:, 0]), abs=1e-13)  # P = tau/F, M = R0 = 1
    x = X[:, 0] + motion.fields["displacement"](X, 0.0)
    from scipy.integrate import quad

    assert x[0] == pytest.approx(0, abs=1e-15)
    for k in (10, 40):
        whole, _ = quad(lambda s: np.exp(motion.fields["stress"](np.array([[s]]), 0.0)[0, 0]), 0, X[k, 0], epsabs=1e-13)
        assert x[k] == pytest.approx(whole, rel=1e-11)


def test_small_load_is_linear(shipped):
    u = exact_solution(shipped("hydrostatic_column", {"gravity": [-1e-4]})).fields["displacement"](X, 0.0)
    assert u == pytest.approx(-1e-4 * (X[:, 0] - X[:, 0] ** 2 / 2), abs=2e-8)


@pytest.mark.parametrize("shift", [0, 1 / 3])
def test_order(core, points, shift):
    """The free end on a grid line, and a third of a cell beyond."""
    errors = []
    for n in (8, 16, 32):
        cell = 1 / (n + shift)
        (run,) = points("hydrostatic_column", "grid.cell", [cell], {"grid.size": [cell * (n + 4)]})
        errors.append(run.finals["error_displacement"])
    assert core.order(errors) > hydrostatic_column.ORDER and errors[-1] < 2e-4


def test_another_scene_is_refused(shipped):
    with pytest.raises(ValueError, match="free upper end"):
        exact_solution(shipped("hydrostatic_column", {"gravity": [0.2]}))
