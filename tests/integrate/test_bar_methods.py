"""The free Hencky bar (docs/physics.md 7, problem 5) with the other bases and transfers: order 2, but for hat functions and PIC. All of it slow."""

import itertools
from pathlib import Path

import numpy as np
import pytest

import mpm

pytestmark = pytest.mark.slow
HELD = Path(__file__).parents[2] / "configs" / "verification" / "hencky_bar_held.yaml"
V = 0.05  # speed of the first mode at X = 1


def error(core, n, basis="quadratic", transfer="apic"):
    """Relative error of u(1), worst of three cell sizes that put the end anywhere in a cell: four particles a cell, Courant number 0.3."""
    return max(displacement_error(core, 1 / (n + shift), basis, transfer) for shift in (0, 1 / 3, 2 / 3))


def swung(core, cell, basis, transfer, safety=0.6):
    """The scene and the run of the bar."""

    def swing(scene):
        p = scene.bodies[0].particles
        p.v[:, 0] = V * np.sin(np.pi * p.x[:, 0] / 2)
        if transfer == "apic" or "affine_flip" in transfer:
            p.C[:, 0, 0] = V * np.pi / 2 * np.cos(np.pi * p.x[:, 0] / 2)

    experiment = core.experiment(
        grid={"dimension": 1, "size": [cell * (np.ceil(1 / cell) + 8)], "cell": cell, "basis": basis},
        bodies={"body": {"shape": {"box": {"lower": [0], "upper": [1.0]}}, "material": "solid"}},
        materials={"solid": {"density": 1, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}},
        surfaces=[],
        time={"end": 3.0, "safety": safety},
        output={"every": 0.5, "snapshots": {"every": 0.5, "particles": ["position"]}},
        method={"transfer": transfer, "particles": 4},
    )
    return core.play(experiment, swing)


def displacement_error(core, cell, basis, transfer):
    _, run = swung(core, cell, basis, transfer)
    if not run.outcome.ok:
        return np.inf
    X = run.particles[0]["position"][:, 0]
    found, exact = [], []
    for row in core.table("bar_free_V0.05.csv"):
        if row["t"] <= 3.0:
            u = run.particles[int(np.argmin(np.abs(run.snapshot_times - row["t"])))]["position"][:, 0] - X
            found.append(u[-1] + (u[-1] - u[-2]) / (X[-1] - X[-2]) * (1.0 - X[-1]))
            exact.append(row["u(X=1)"])
    return np.linalg.norm(np.subtract(found, exact)) / np.linalg.norm(exact)


@pytest.mark.parametrize(
    ("basis", "transfer", "bound"),
    [("cubic", "apic", 1.2e-3), ("quadratic", {"xpic": {"order": 2}}, 1.4e-3), ("quadratic", {"affine_flip": {"blend": 0.02}}, 9e-4)],
    ids=["cubic", "xpic", "affine flip"],
)
def test_second_order(core, basis, transfer, bound):
    errors = [error(core, n, basis, transfer) for n in (8, 16, 32)]
    assert core.order(errors) > 1.85 and errors[-1] < bound


def test_hat_functions_do_not_converge():
    """Cell crossing (docs/physics.md 15, mode 1): between two walls, where every run ends well, refinement makes it worse. 0.083, 0.158, 0.273."""
    runs = [mpm.run_point(mpm.load(HELD, {"grid.basis": "linear", "grid.cell": 1 / n})) for n in (16, 32, 64)]
    errors = [run.finals["error_displacement"] for run in runs]
    assert all(run.outcome.ok for run in runs)
    assert errors[0] > 0.05 and all(fine > 1.4 * coarse for coarse, fine in itertools.pairwise(errors))


@pytest.mark.parametrize("shift", [0, 1 / 3, 2 / 3])
def test_hat_functions_at_a_free_end_have_no_stable_step(core, shift):
    """A node that only the tip of a particle's hat reaches has next to no mass: its acceleration has no bound, whatever the wave's limit says, and the run
    says so. A step of a thirtieth holds here; none holds everywhere."""
    fails, holds = (swung(core, 1 / (64 + shift), "linear", "apic", safety)[1] for safety in (0.6, 0.02))
    assert fails.outcome.kind in ("inverted", "overstretched") and "particle" in str(fails.outcome) and holds.outcome.ok


def test_pic_damps(core):
    """Order 1 at a fixed Courant number, and 50 times APIC's error."""
    errors = [error(core, n, transfer="pic") for n in (8, 16, 32)]
    assert 0.7 < core.order(errors) < 1.2 and errors[-1] > 20 * error(core, 32)
