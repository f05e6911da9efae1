"""The table's parts: what is refined, the fitted order, a line for a config that is quick to run."""

import pytest

import mpm
from mpm.benchmarks.verification import FOLDER, ProblemRow, measure, refinement


@pytest.mark.parametrize(
    ("name", "path", "values"),
    [("hencky_bar", "grid.cell", (0.125, 0.0625, 0.03125)), ("free_fall", "time.step", (0.08, 0.04, 0.02)), ("thermal_expansion", "time.step", None)],
)
def test_what_is_refined(name, path, values):
    found, steps, points = refinement(mpm.load(FOLDER / f"{name}.yaml"))
    assert found == path and len(points) == len(steps) == 3
    assert values is None or steps == pytest.approx(values)
    assert steps[0] > steps[1] > steps[2]


def test_order_is_fitted_where_one_is_declared():
    line = ProblemRow("it", "apic", "grid.cell", (0.4, 0.2, 0.1), "error_l2", (0.16, 0.04, 0.01), 1.8, 1.0)
    assert line.order() == pytest.approx(2.0)
    assert "| 0.16, 0.04, 0.01 | 2.00 | 1.80 |" in line.text()
    assert ProblemRow("it", "apic", "grid.cell", (0.4, 0.2, 0.1), "error_l2", (1e-15, 0.0, 1e-15), None, 1.0).order() is None


def test_a_line_of_a_material_point():
    line = measure(FOLDER / "relaxation.yaml")
    assert line.method == "material point" and line.order() > line.declared


def test_every_config_has_an_exact_solution():
    assert all(mpm.load(path).exact is not None for path in FOLDER.glob("*.yaml"))


def test_named_rows_are_measured_again_and_the_others_stay(tmp_path, monkeypatch):
    from mpm.benchmarks import verification

    text = verification.HEAD + "| adiabat | kept |\n| relaxation | old |\n" + verification.WAVE + "| the wave |\n"
    assert verification.written(text) == ({"adiabat": "| adiabat | kept |", "relaxation": "| relaxation | old |"}, "| the wave |\n")
    for name in ("adiabatic.yaml", "relaxation.yaml"):
        (tmp_path / name).write_text((FOLDER / name).read_text())
    (tmp_path / "README.md").write_text(text.replace("| adiabat |", "| adiabatic |"))
    monkeypatch.setattr(verification, "FOLDER", tmp_path)
    verification.main(["relaxation"])
    made = (tmp_path / "README.md").read_text()
    assert "| adiabatic | kept |" in made and "| relaxation | material point |" in made and made.endswith("| the wave |\n")
    with pytest.raises(SystemExit, match="no config nothing"):
        verification.main(["nothing"])


@pytest.mark.slow
def test_table_of_transfers():
    """The best is within 0.2 % of the frequency and 5 % of the damping; PIC is last, and the promise is not for it."""
    from mpm.benchmarks.wave import table

    found, text = table()
    assert found[0].promised() and not found[-1].promised() and "pic" in (found[-1].velocity, found[-1].temperature)
    assert text.count("\n| ") == len(found) and "apic/apic" in text.splitlines()[-1]
