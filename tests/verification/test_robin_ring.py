"""The series of the hollow cylinder satisfies equation, boundary and start; the errors of a ring in the plane and of an axisymmetric pipe."""

import numpy as np
import pytest

from mpm.verification import exact_solution, robin_ring

A, B = 0.5, 1.3


def line(r, centre=(1.47, 1.53)):
    return np.stack([centre[0] + r, np.full(len(r), centre[1])], axis=1)


@pytest.mark.parametrize("beta", [0.1, 10.0, ".inf"])
def test_series_solves_the_problem(shipped, beta):
    theta, e = exact_solution(shipped("robin_ring", {"beta": beta})), 1e-4
    r, t = np.linspace(A + 0.1, B - 0.1, 7), 0.02
    now = theta(line(r), t)
    above, below = theta(line(r + e), t), theta(line(r - e), t)
    laplace = (above - 2 * now + below) / e**2 + (above - below) / (2 * e) / r
    assert (theta(line(r), t + 1e-5) - theta(line(r), t - 1e-5)) / 2e-5 == pytest.approx(laplace, abs=1e-4)
    inner, outer = theta(line(np.array([A, A + e, A + 2 * e])), t) - 300, theta(line(np.array([B, B - e, B - 2 * e])), t) - 300
    for at in (inner, outer):
        slope = (-3 * at[0] + 4 * at[1] - at[2]) / (2 * e)
        assert (at[0] == pytest.approx(0, abs=1e-9)) if beta == ".inf" else (slope == pytest.approx(beta * at[0], rel=1e-4))
    assert theta(line(r), 1e-4) == pytest.approx(301.0, abs=1e-6)


@pytest.mark.parametrize("name", ["robin_ring", "robin_ring_axisymmetric"])
def test_order(core, points, name):
    errors = [run.finals["error_l2"] for run in points(name, "grid.cell", (0.25, 0.125, 0.0625))]
    assert core.order(errors) > robin_ring.ORDER and errors[-1] < 5e-5


def test_another_scene_is_refused(shipped):
    with pytest.raises(ValueError, match="needs a ring"):
        exact_solution(shipped("robin_ring_axisymmetric", {"bodies.pipe.shape.box.lower": [0.0, 0.25]}))
