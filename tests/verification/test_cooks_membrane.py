"""Cook's membrane at nu = 0.499: the reference against the literature, the particles against the reference, and locking without F-bar."""

import numpy as np
import pytest

from mpm.config import load
from mpm.verification import cooks_membrane, exact_solution
from mpm.verification.cooks_membrane import TIP, deflection, static


def lame(E, nu):
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


def test_reference_is_the_literature():
    """Plane stress E = 1, nu = 1/3, unit force: 23.96 (Cook 1974 and many after). Plane stress is plane strain with lam* = 2 lam mu/(lam + 2 mu)."""
    lam, mu = lame(1.0, 1 / 3)
    tips = [deflection(static(2 * lam * mu / (lam + 2 * mu), mu, n), TIP[None])[0, 1] / 16 for n in (8, 16, 32)]
    assert tips[-1] == pytest.approx(23.96, abs=0.01) and np.all(np.diff(tips) > 0)


def test_reference_at_nu_0499_does_not_lock():
    """8 to 32 elements a side: within 0.7 %, half of it a halving (the corner is singular); a field that bends as an incompressible one does."""
    tips = [deflection(static(*lame(250.0, 0.499), n), TIP[None])[0, 1] for n in (8, 16, 32)]
    assert tips[0] > 0.993 * tips[-1] and (tips[2] - tips[1]) < 0.6 * (tips[1] - tips[0])
    assert deflection(static(*lame(250.0, 0.4999), 32), TIP[None])[0, 1] == pytest.approx(tips[-1], rel=2e-3)


@pytest.mark.slow
def test_tip_with_fbar(points):
    (run,) = points("cooks_membrane", "grid.cell", (4.0,), {"output.every": 5.0})
    assert abs(run.finals["error_tip"]) < 0.02 and run.finals["error_displacement"] < 0.025
    assert np.ptp(run.series["tip_displacement"][-2:]) < 2e-3 * run.series["tip_displacement"][-1]  # at rest


@pytest.mark.slow
def test_half_the_cell_and_locking(points):
    """Tip with F-bar -1.5 and -0.5 %, without -12.6 and -5.3 %: what F-bar does with a cell takes a quarter of it without."""
    free, locked = (
        [run.finals["error_tip"] for run in points("cooks_membrane", "grid.cell", (4.0, 2.0), {"output.every": 5.0, "method.locking": locking})]
        for locking in ({"fbar": {"own": 0}}, None)
    )
    assert abs(free[1]) < 0.006 and np.log2(free[0] / free[1]) > cooks_membrane.ORDER
    assert locked[0] < -0.11 and locked[1] < -0.045


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"loads.0.traction.nominal": [0, 3.0]}, "small deflections"),
        ({"loads.0.side": "top"}, "on side right"),
        ({"walls.left": "slip"}, "walls: {left: stick}"),
        ({"method.offset": [0.25, 0.25]}, "no offset"),
    ],
)
def test_another_scene_is_refused(shipped, changes, words):
    with pytest.raises(ValueError, match=words):
        exact_solution(shipped("cooks_membrane", changes))


def test_loads_are_no_part_of_other_problems():
    held = {"grid": {"dimension": 1, "size": [2], "cell": 0.25}, "bodies": {"bar": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "unit"}},
            "materials": {"unit": {"density": 1, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}}, "time": {"end": 1},
            "loads": [{"of": "bar", "drag": {"rate": 1}}], "exact": {"hencky_bar": {"amplitude": 0.05}}}  # fmt: skip
    with pytest.raises(ValueError, match="without loads"):
        exact_solution(load(held))
