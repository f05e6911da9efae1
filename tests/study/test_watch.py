"""mpm bench --compare: both copies are whole, ratios are of neighbours in time, and what cannot be compared is said."""

import shutil
import subprocess

import pytest

from mpm.study import watch
from mpm.study.bench import BenchError

HEAD = ["git", "-C", str(watch.ROOT), "rev-parse", "HEAD"]
needs_git = pytest.mark.skipif(
    shutil.which("git") is None or subprocess.run(HEAD, capture_output=True, check=False).returncode != 0, reason="no git, or no checkout of it"
)


@needs_git
def test_a_revision_is_unpacked_as_a_checkout_is_copied(tmp_path):
    here, there = watch.copied(tmp_path / "here"), watch.unpacked("HEAD", tmp_path / "there")
    for place in (here, there):
        assert (place / "mpm" / "study" / "watch.py").exists() or place == there
        assert (place / "mpm_cli" / "main.py").exists()
        assert all((place / row.split()[1]).exists() for row in watch.ROWS.values() if row.startswith("run"))


@needs_git
@pytest.mark.parametrize("revision", ["no-such-revision", "--output=archive.tar"])
def test_what_is_no_revision_is_refused(tmp_path, revision):
    with pytest.raises(BenchError, match=f"--compare {revision}"):
        watch.unpacked(revision, tmp_path)
    assert not list(tmp_path.iterdir())


def test_ratios_are_of_each_round(monkeypatch):
    """The machine slows down by 4 during the rounds: the ratio stays 1.5."""
    pace = iter([1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 4.0, 4.0])  # compiling, then three rounds
    monkeypatch.setattr(watch, "timed", lambda place, row: {"took": next(pace) * {"here": 2.0, "there": 3.0}[place], "unit": "s", "work": 7})
    row = watch.in_turn("a scene", "here", "there", 3)
    assert (row["ratio"], row["low"], row["high"]) == (1.5, 1.5, 1.5)
    assert (row["here"], row["there"], row["note"]) == (4.0, 6.0, "")
    assert watch.line(row) == "| a scene | 4 | 6 | s | 1.500 | 1.500 to 1.500 |  |"


def test_other_work_and_failures_are_told(monkeypatch):
    monkeypatch.setattr(watch, "timed", lambda place, row: {"took": 1.0, "unit": "s", "work": place})
    assert watch.in_turn("a scene", "here", "there", 1)["note"] == "other work: here here, there there"
    monkeypatch.setattr(watch, "timed", lambda place, row: {"failed": "no such key"} if place == "there" else {"took": 1.0, "unit": "s", "work": 1})
    row = watch.in_turn("a scene", "here", "there", 1)
    assert row == {"row": "a scene", "note": "there: no such key"}
    assert "no such key" in watch.line(row)


def test_a_name_without_rows_is_refused():
    with pytest.raises(BenchError, match="elastic 3-D f32"):
        next(watch.compare("HEAD", only="no such scene"))


@pytest.mark.slow
@needs_git
def test_a_checkout_beside_itself():
    (row,) = watch.compare("HEAD", 3, "rigid")
    assert row["note"] == ""
    assert row["low"] <= row["ratio"] <= row["high"]
