"""The study of reductions: a line, the table's sentence, and that it goes on where it stopped."""

import json

import pytest

from mpm.benchmarks import reduction
from mpm.benchmarks.reduction import FOLDER, ReductionRow, kept, summary


def test_a_line_of_the_study():
    line = ReductionRow("a", ("temperature_mean",), "lumped", ("inside",), 0.005, ("estimate",), 0.002, 2.0, 0.01, 0.01)
    assert line.held and line.saving == 200
    assert line.text() == "| a | temperature_mean | lumped | inside | 0.005 | estimate | 0.002 | 2 | 0.01 | 200 |"
    bad = ReductionRow("b", (), "full", (), 0.0, (), float("inf"), 1.0, 1.0, 0.01)
    assert "1 of 2; ten times as fast or more: 1; error below what was predicted: 1" in summary([line, bad])


def test_twelve_scenes_leave_their_model_open():
    import mpm

    found = [mpm.load(path) for path in FOLDER.glob("*.yaml")]
    assert len(found) == 12 and all(one.model.kind == "auto" and one.model.tolerance == 0.01 for one in found)


def test_what_was_measured_is_kept(tmp_path, monkeypatch):
    calls = []

    def fake(path):
        calls.append(path.stem)
        return ReductionRow(path.stem, ("temperature_mean",), "lumped", (), 0.1, (), 0.0, 1.0, 0.5, 0.01)

    monkeypatch.setattr(reduction, "measure", fake)
    store, path = tmp_path / "results" / "kept.json", FOLDER / "pipe.yaml"
    assert kept(path, store) == kept(path, store) and calls == ["pipe"]
    known = json.loads(store.read_text())
    known["pipe"]["key"] = "of another source"
    store.write_text(json.dumps(known))
    kept(path, store)
    assert calls == ["pipe", "pipe"]


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_smaller_model_answers_within_the_tolerance(path):
    """What `python -m mpm.benchmarks.reduction` measures, without its rounds of timing: something is dropped, the answer stays within 1 %, as foretold."""
    import mpm
    from mpm.reduce.difference import gap
    from mpm.reduce.offers import asked, driving

    full = mpm.load(path, {"model": "full"})
    small, whole = mpm.run_point(mpm.load(path)), mpm.run_point(full)
    said, error = small.facts["model"], max(gap(whole, small, asked(full), driving(full)).values())
    assert said["dropped"] and said["name"] != "full"
    assert error <= said["tolerance"] == 0.01
    assert error <= max(said["predicted"], 2e-5)  # a symmetry is exact but for the steps, which are not the same
