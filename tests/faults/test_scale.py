"""R15: many points in one sweep (tests/sweep/scale.py): flat memory, few files, and what each point costs besides itself."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "sweep"))
import scale


def test_a_thousand_points(tmp_path, monkeypatch):
    """Short form, with a runner that takes no time; the time itself is not asserted, as the machine may be busy."""
    monkeypatch.chdir(tmp_path)
    found = scale.measure(1000, jobs=1, runner="null_runner")
    assert found["points"] == 992 and found["files"] < 100 and found["bytes_a_point"] < 3000
    assert found["memory_most_MB"] - found["memory_first_MB"] < 3 and found["collect_MB"] < 300


@pytest.mark.slow
def test_10_000_points_of_the_slab(tmp_path, monkeypatch, table):
    monkeypatch.chdir(tmp_path)
    found = scale.measure(10_000)
    told = f"overhead {found['overhead_ms']:.2f} ms a point beside {found['alone_ms']:.2f} ms of its own; parent {found['memory_first_MB']:.0f} MB at the first"
    told += f" point, {found['memory_last_MB']:.0f} at the last; {found['files']} files; collect {found['collect_s']:.1f} s, open {found['open_s']:.2f} s"
    table("10 000 points of the slab, one worker", told)
    grown = (found["memory_most_MB"] - found["memory_first_MB"]) * 1e6 / found["points"]  # B a point; 54 are its summary's
    assert found["overhead_ms"] < 2 and grown < 300 and found["collect_s"] < 30 and found["open_s"] < 1
