"""The Hencky bar in uniaxial strain against spectral solutions (docs/physics.md 7, problem 5): order 2 for the motion of a body and of its free end."""

import numpy as np
import pytest

V = 0.05  # speed of the first mode at X = 1


def bar(core, length, cell, gradient="mls", transfer="apic"):
    """rho = lam + 2 mu = 1, held at 0 and free at its end, or (length 2) held at both; four particles a cell, Courant number 0.3."""
    size = 2.0 if length == 2.0 else cell * (np.ceil(length / cell) + 3)
    return core.experiment(
        grid={"dimension": 1, "size": [size], "cell": cell},
        bodies={"body": {"shape": {"box": {"lower": [0], "upper": [length]}}, "material": "solid"}},
        materials={"solid": {"density": 1, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}},
        surfaces=[],
        time={"end": 3.0, "safety": 0.6},
        output={"every": 0.5, "snapshots": {"every": 0.5, "particles": ["position"]}},
        method=core.methods(transfer, gradient) | {"particles": 4},
    )


def swing(scene):
    p = scene.bodies[0].particles
    p.v[:, 0] = V * np.sin(np.pi * p.x[:, 0] / 2)
    p.C[:, 0, 0] = V * np.pi / 2 * np.cos(np.pi * p.x[:, 0] / 2)


def error(core, length, cell, **method):
    """Relative error of the displacements of X = 1 and X = 1/2 at the times of the table."""
    _, run = core.play(bar(core, length, cell, **method), swing)
    assert run.outcome.ok
    X = run.particles[0]["position"][:, 0]
    found, exact = [], []
    for row in core.table("bar_fixed_V0.05.csv" if length == 2.0 else "bar_free_V0.05.csv"):
        if row["t"] <= 3.0:
            u = run.particles[int(np.argmin(np.abs(run.snapshot_times - row["t"])))]["position"][:, 0] - X
            slope = (u[-1] - u[-2]) / (X[-1] - X[-2])  # the last particle sits a little before the free end
            found += [np.interp(0.5, X, u), np.interp(1.0, X, u) + slope * max(1.0 - X[-1], 0.0)]
            exact += [row["u(X=0.5)"], row["u(X=1)"]]
    return np.linalg.norm(np.subtract(found, exact)) / np.linalg.norm(exact)


def test_free_end_anywhere_in_a_cell(core):
    worst = [max(error(core, 1.0, 1 / (n + shift)) for shift in (0, 1 / 3, 2 / 3)) for n in (8, 16, 32)]
    assert core.order(worst) > 1.9 and worst[-1] < 7e-4


def test_held_at_both_ends(core):
    errors = [error(core, 2.0, 1 / n) for n in (8, 16, 32)]
    assert core.order(errors) > 1.8 and errors[-1] < 1.2e-3


@pytest.mark.slow
@pytest.mark.parametrize(("transfer", "gradient", "order"), [("apic", "bspline", 1.7), ("flip", "mls", 1.7), ("flip", "bspline", 1.7)])
def test_free_end_with_other_transfers(core, transfer, gradient, order):
    worst = [max(error(core, 1.0, 1 / (n + shift), transfer=transfer, gradient=gradient) for shift in (0, 1 / 3, 2 / 3)) for n in (8, 16, 32)]
    assert core.order(worst) > order and worst[-1] < 1.5e-3
