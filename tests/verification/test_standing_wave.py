"""The coupled wave: amplitudes against the table, the fit of frequency and damping, and what a run makes of them."""

import json
from pathlib import Path

import numpy as np
import pytest

from mpm.verification import exact_solution, standing_wave

REFERENCE = Path(__file__).parents[1] / "reference"


def test_solution_against_the_table(core, shipped):
    motion = exact_solution(shipped("standing_wave", {"exact.standing_wave.amplitude": 0.01}))
    middle, end = np.array([[0.5]]), np.array([[0.0]])
    for row in core.table("coupled_standing_wave.csv"):
        assert motion.fields["displacement"](middle, row["t"]) == pytest.approx([row["U (u=U sin kX)"]], abs=1e-15)
        assert motion.fields["velocity"](middle, row["t"]) == pytest.approx([row["V=dU/dt"]], abs=1e-15)
        assert motion.fields["temperature"](end, row["t"]) - 1 == pytest.approx([row["T (dTheta=T cos kX)"]], abs=1e-15)


def test_roots_and_their_fit(shipped):
    roots = [[float(part) for part in root] for root in json.loads((REFERENCE / "coupled_standing_wave.json").read_text())["roots"]]
    A, _ = standing_wave.rates(shipped("standing_wave"))
    assert sorted(np.linalg.eigvals(A).imag) == pytest.approx(sorted(root[1] for root in roots), abs=1e-12)
    assert sorted(np.linalg.eigvals(A).real) == pytest.approx(sorted(root[0] for root in roots), abs=1e-12)
    t = np.arange(0, 8.05, 0.1)
    U = np.exp(-0.02 * t) * (0.3 * np.sin(3.1 * t) + 0.01 * np.cos(3.1 * t)) - 0.01 * np.exp(-0.5 * t)
    assert standing_wave.fit(t, U, np.array([0.01, 3.2, 0.4])) == pytest.approx([0.02, 3.1, 0.5], rel=1e-6)


def test_frequency_and_damping(core, points):
    runs = points("standing_wave", "grid.cell", (0.0625, 0.03125))
    assert core.order([run.finals["error_displacement"] for run in runs]) > standing_wave.ORDER
    assert abs(runs[-1].finals["error_frequency"]) < 2e-3 and abs(runs[-1].finals["error_damping"]) < 0.05


@pytest.mark.slow
@pytest.mark.parametrize(("velocity", "temperature"), [("apic", "apic"), ("flip", "flip"), ("flip", "apic"), ("xpic", "apic")])
def test_frequency_and_damping_at_64_cells(points, velocity, temperature):
    (run,) = points("standing_wave", "grid.cell", (1 / 64,), {"method.transfer": {velocity: {}}, "method.temperature": {temperature: {}}})
    assert abs(run.finals["error_frequency"]) < 1e-3 and abs(run.finals["error_damping"]) < 0.01


@pytest.mark.slow
def test_pic_damps_ten_times_too_much(points):
    (run,) = points("standing_wave", "grid.cell", (1 / 64,), {"method.transfer": {"pic": {}}})
    assert run.finals["error_damping"] > 5


@pytest.mark.parametrize(("changes", "words"), [({"bodies.bar.temperature": 2}, "reference"), ({"grid.size": [1.5]}, "fills the domain")])
def test_another_scene_is_refused(shipped, changes, words):
    with pytest.raises(ValueError, match=words):
        exact_solution(shipped("standing_wave", changes))
