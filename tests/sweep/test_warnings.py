"""Warnings of the points of a sweep: in the dataset, in counts, after a second look at the disk, from batches, from a cluster."""

import fake_runner as fake
import numpy as np

from mpm.config import load
from mpm.sweep import batch_size, engine
from mpm.sweep.api import execute, folder_plan, run_one, tree_of
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.queue import counts_in_words, warned
from mpm.sweep.status import in_words, status
from mpm.warned import KINDS, flags, kinds

TWO = {"points": 1, "volume": 1, "temperature": 1}


def go(config, out, **more):
    return execute(load(config), out, Options(**({"jobs": 0, "runner": "fake_runner"} | more)))


def test_the_dataset_has_them_as_text_and_as_flags(config, tmp_path):
    result = go(config([0.2, fake.WARNS, fake.DIVERGES]), tmp_path)
    assert result.warned == TWO and result.exit_code == 3
    found = tree_of(tmp_path / "sweep.nc")
    assert found.warnings.values.tolist() == ["", "\n".join(fake.WARNINGS), ""]
    assert found.warnings.attrs["flag_meanings"].split() == found.warning_flags.attrs["flag_meanings"].split() == list(KINDS)
    assert found.warning_flags.dtype == np.int32 and found.warning_flags.values.tolist() == [0, flags(fake.WARNINGS), 0]
    masks = dict(zip(KINDS, found.warning_flags.attrs["flag_masks"].tolist(), strict=True))
    assert found.warning_flags.values[1] == masks["volume"] | masks["temperature"]
    assert found.advice.values.tolist()[:2] == ["", ""] and "time.safety" in found.advice.values[2]


def test_one_point_has_them_too(config, monkeypatch):
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    data, record = run_one(load(config([fake.WARNS])))[:2]
    assert record.warnings == fake.WARNINGS and tree_of(data).warnings.item() == "\n".join(fake.WARNINGS)


def test_they_are_counted_from_disk_and_named_by_status(config, tmp_path):
    go(config([0.2, fake.WARNS, fake.DIVERGES]), tmp_path)
    again = go(config([0.2, fake.WARNS, fake.DIVERGES]), tmp_path)
    assert again.ran == 0 and again.warned == TWO
    found = status(tmp_path)
    assert found["warnings"] == TWO and [row["kind"] for row in found["warned"]] == ["volume", "temperature"]
    words = in_words(found)
    assert "2 ok, 1 of them with warnings: volume 1, temperature 1; 1 diverged" in words and "1 x warning: volume, as kappa=10;" in words


def test_batches_and_dask_keep_them(config, tmp_path, monkeypatch):
    points = config([fake.WARNS, *np.round(0.1 + 0.01 * np.arange(30), 2).tolist()])
    monkeypatch.setattr(batch_size, "BATCH", 1.0)
    go(points, tmp_path / "own")
    assert list((tmp_path / "own").glob("batches/*/*.nc"))
    result = go(points, tmp_path / "dask", scheduler="local", jobs=1)
    assert result.warned == TWO and compare(tmp_path / "own", tmp_path / "dask") == []
    _, _, seen, _, lines, _ = folder_plan(tmp_path / "own")
    assert warned(seen, lines) == TWO


def test_words():
    counts = {"ok": 32, "failed": 0, "timeout": 0, "killed": 0, "diverged": 1, "skipped": 0, "pending": 0}
    assert counts_in_words(counts, {"points": 9, "temperature": 4, "volume": 7}) == "32 ok, 9 of them with warnings: volume 7, temperature 4; 1 diverged"
    assert counts_in_words(counts, {}) == "32 ok, 1 diverged"
    assert kinds(["torn: a: b; c", "volume: x; y", "torn: z; w"]) == ("volume", "torn") and flags([]) == 0
