"""Verification problems in float32: no worse than float64 by more than rounding; what does not move is not touched."""

import pytest

import mpm
from mpm.benchmarks.single import FOLDER, Pair, in_precision, measure, moving, written


def test_a_row():
    pair = Pair("it", "apic", "grid.cell", (0.2, 0.1), (0.04, 0.01), (0.041, 0.0129), (0.0173, 0.0173), (100, 100))
    assert pair.walk() == pytest.approx((1e-3, 1e-3), rel=2e-3) and pair.holds()
    assert pair.text() == "| it | apic | grid.cell 0.2, 0.1 | 0.04, 0.01 | 0.041, 0.0129 | 0.0173, 0.0173 | 0.000999, 0.000999 | 2.00 | 1.67 |"
    assert not Pair("it", "apic", "grid.cell", (0.2, 0.1), (0.04, 0.01), (0.041, 0.02), (0.0173, 0.0173), (100, 100)).holds()
    assert written("| config | method |\n|---|---|\n| it | apic |\n") == {"it": "| it | apic |"}


@pytest.mark.parametrize("name", ["hencky_bar", "hydrostatic_column"])
@pytest.mark.plain
def test_one_direction(name):
    assert measure(FOLDER / f"{name}.yaml", 1).holds()


@pytest.mark.parametrize("name", ["robin_cylinder", "relaxation"])
def test_what_does_not_move_computes_in_float64(name):
    """The same bits."""
    experiment = mpm.load(FOLDER / f"{name}.yaml", {"sweep": None})
    double, single = (mpm.run(in_precision(experiment, precision)) for precision in ("float64", "float32"))
    assert name not in moving()
    assert double["series"].to_dataset().drop_attrs().identical(single["series"].to_dataset().drop_attrs())


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.yaml")))
def test_every_problem_that_moves(name):
    if name not in moving():
        pytest.skip("always in float64")
    assert measure(FOLDER / f"{name}.yaml").holds()
