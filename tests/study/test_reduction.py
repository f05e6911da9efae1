"""The study of reductions: a line, the table's sentence, and that it goes on where it stopped."""

import json

from mpm.study import reduction
from mpm.study.reduction import FOLDER, Line, kept, summary


def test_a_line_of_the_study():
    line = Line("a", ("temperature_mean",), "lumped", ("inside",), 0.005, ("estimate",), 0.002, 2.0, 0.01, 0.01)
    assert line.held and line.saving == 200
    assert line.text() == "| a | temperature_mean | lumped | inside | 0.005 | estimate | 0.002 | 2 | 0.01 | 200 |"
    bad = Line("b", (), "full", (), 0.0, (), float("inf"), 1.0, 1.0, 0.01)
    assert "1 of 2; ten times as fast or more: 1; error below what was predicted: 1" in summary([line, bad])


def test_twelve_scenes_leave_their_model_open():
    import mpm

    found = [mpm.load(path) for path in FOLDER.glob("*.yaml")]
    assert len(found) == 12 and all(one.model.kind == "auto" and one.model.tolerance == 0.01 for one in found)


def test_what_was_measured_is_kept(tmp_path, monkeypatch):
    calls = []

    def fake(path):
        calls.append(path.stem)
        return Line(path.stem, ("temperature_mean",), "lumped", (), 0.1, (), 0.0, 1.0, 0.5, 0.01)

    monkeypatch.setattr(reduction, "measure", fake)
    store, path = tmp_path / "results" / "kept.json", FOLDER / "pipe.yaml"
    assert kept(path, store) == kept(path, store) and calls == ["pipe"]
    known = json.loads(store.read_text())
    known["pipe"]["key"] = "of another source"
    store.write_text(json.dumps(known))
    kept(path, store)
    assert calls == ["pipe", "pipe"]
