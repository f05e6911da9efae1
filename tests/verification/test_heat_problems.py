"""NAFEMS T3 and T4, the Gaussian in a box, melting: shipped configs against their exact solutions, with the declared order."""

import csv
from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.verification import exact_solution, gaussian_box, nafems_t3, nafems_t4, stefan

ROOT = Path(__file__).parents[2] / "configs" / "verification"
CELSIUS = 273.15


def runs(name, cells, **changes):
    """One run a cell of a shipped config."""
    return [mpm.run_point(mpm.load(ROOT / f"{name}.yaml", {"sweep": None, "grid.cell": cell} | changes)) for cell in cells]


def at(experiment, point, t):
    return float(exact_solution(experiment)(np.array([point], dtype=float), t)[0])


def test_t3_with_ten_cells(core):
    found = runs("nafems_t3", (0.01, 0.005, 0.0025), **{"method.rigid": {"implicit": {"tolerance": 1e-6}}})
    assert all(abs(run.finals["temperature_target"] - CELSIUS - 36.60) < 0.1 for run in found)
    assert core.order([run.finals["error_l2"] for run in found]) > nafems_t3.ORDER
    assert all(abs(run.finals["heat_ledger"]) < 1e-12 * run.finals["heat_exchanged"] for run in found)


MOVING = {"E": 1.0, "nu": 0.0}  # a bar of particles at rest


def test_t3_with_ten_cells_of_particles(core):
    """Steps of order 2 at the automatic pace. The bar is off by 1.4 K rms then, of 100; the order is that of the cell.

    At ten cells 36.48 is where two errors meet, as heat goes 1.7 cells deep in a period: lumped mass at the free end gives 35.9 (affine FLIP, steps of
    0.05 s, rms 1.9), and APIC's damping, by the step, adds to it (37.9 in steps of 0.5 s). (Read by the slope of one particle, not by a fit of its
    neighbours, it was 36.52.) So the target is asked of forty cells. On the nodes, with consistent mass, ten cells are off by 0.06.
    """
    coupled = {f"materials.steel.{name}": core.config()["materials"]["solid"][name] for name in ("expansion", "heating")}  # of zero: no compilation of its own
    changes = {"materials.steel.elastic": {"hencky": MOVING}, "method.heat": {"implicit": {"order": 2}}} | coupled
    found = runs("nafems_t3", (0.01, 0.005, 0.0025), **changes)
    assert abs(found[-1].finals["temperature_target"] - CELSIUS - 36.60) < 0.1 and abs(found[0].finals["temperature_target"] - CELSIUS - 36.60) < 0.2
    errors = [run.finals["error_l2"] for run in found]
    assert core.order(errors) > nafems_t3.ORDER and errors[-1] < 0.13
    assert all(abs(run.finals["heat_ledger"]) < 1e-12 * run.finals["heat_exchanged"] for run in found)


def test_t3_series():
    assert at(mpm.load(ROOT / "nafems_t3.yaml", {"sweep": None, "method.offset": [0]}), [0.09], 32.0) - CELSIUS == pytest.approx(36.604, abs=2e-3)


def test_t4(core):
    found = runs("nafems_t4", (0.1, 0.05))
    assert abs(found[1].finals["temperature_target"] - CELSIUS - 18.25) < 0.1
    assert core.order([run.finals["error_l2"] for run in found]) > nafems_t4.ORDER
    assert at(mpm.load(ROOT / "nafems_t4.yaml", {"sweep": None}), [0.7, 0.3], 0.0) - CELSIUS == pytest.approx(18.254, abs=2e-3)


def test_gaussian(core):
    found = runs("gaussian_box", (0.0625, 0.03125, 0.015625), **{"method.rigid": {"implicit": {"tolerance": 1e-6}}})
    assert core.order([run.finals["error_l2"] for run in found]) > gaussian_box.ORDER
    assert all(abs(run.series["heat_total"] - run.series["heat_total"][0]).max() < 1e-12 * 100 for run in found)


def gaussian_of_particles(cells, heat, steps):
    """Errors of a Gaussian in particles at rest."""
    changes = {"materials.unit.elastic": {"hencky": MOVING}, "method.heat": heat, "output.every": 0.02}
    return [runs("gaussian_box", (cell,), **changes, **{"method.heat_step": step})[0].finals["error_l2"] for cell, step in zip(cells, steps, strict=True)]


@pytest.mark.plain
def test_gaussian_of_particles_is_of_order_one_in_the_step_and_two_in_the_cell(core):
    """Backward Euler: 1.08, 0.567, 0.302 K of 100; what the cell leaves, 0.033, is below a tenth of them."""
    assert core.order(gaussian_of_particles([1 / 64] * 3, {"implicit": {"order": 1}}, [0.004, 0.002, 0.001])) > 0.9
    assert core.order(gaussian_of_particles([1 / 16, 1 / 32, 1 / 64], {"explicit": {}}, [0.002] * 3)) > gaussian_box.ORDER


def test_gaussian_agrees_with_the_table():
    experiment = mpm.load(ROOT / "gaussian_box.yaml", {"sweep": None, "method.offset": [0]})
    with open(Path(__file__).parents[1] / "reference" / "gaussian_box_1d.csv", newline="") as file:
        rows = [tuple(map(float, row)) for row in list(csv.reader(file))[1:]]
    assert len(rows) > 10
    for t, x, phi in rows:
        assert at(experiment, [0.5 + x], t) == pytest.approx(300 + 100 * phi, abs=1e-11 * 100)


def test_melting(core):
    found = [run for cell, width in ((0.05, 4), (0.025, 2), (0.0125, 1)) for run in runs("stefan", (cell,), width=width)]
    assert core.order([run.finals["error_l2"] for run in found]) > stefan.ORDER
    assert all(abs(run.finals["heat_ledger"]) < 1e-12 * run.finals["heat_exchanged"] for run in found)


@pytest.mark.parametrize("step", ["auto", 0.05, 1.0])
def test_all_latent_heat_is_taken_up_whatever_the_step(step):
    """From 300 K to 400 K through a bump of 100 J/kg, 1 kg/m3 of 1 J/(kg K): what is not sensible heat is latent."""
    changes = {"exact": None, "time.end": 10, "output.every": 10, "time.step": step, "grid.cell": 0.1}
    run = mpm.run_point(mpm.load(ROOT / "stefan.yaml", {"sweep": None, **changes}))
    assert run.outcome.ok and run.finals["temperature_min"] == pytest.approx(400.0, abs=0.1)
    assert run.finals["heat_exchanged"] - (run.finals["temperature_mean"] - 300) == pytest.approx(100.0, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("nafems_t3", {"surfaces.1.fixed.temperature": 373.15}, "fixed to a sine"),
        ("nafems_t3", {"bodies.bar.temperature": 280}, "one temperature"),
        ("nafems_t4", {"surfaces.2.convection.beta": 7}, "same constant convection"),
        ("gaussian_box", {"exact.gaussian_box.centre": [1, 1]}, "one number a direction"),
        ("stefan", {"alpha": 1}, "bump"),
        ("stefan", {"surfaces.0.fixed.temperature": 320}, "hotter"),
        ("stefan", {"time.end": 0.1}, "half space"),
    ],
)
def test_other_scenes_are_refused(name, changes, words):
    with pytest.raises(ValueError, match=words):
        exact_solution(mpm.load(ROOT / f"{name}.yaml", {"sweep": None, **changes}))
