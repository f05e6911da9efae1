import math

import fake_runner as fake
import numpy as np
import pytest

from mpm.config import load
from mpm.records.point import Record
from mpm.sweep import batch_size
from mpm.sweep.api import execute, tree_of
from mpm.sweep.batch_size import MOST_POINTS, BatchSize
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.store import Store

TINY = [round(0.01 * k, 2) for k in range(1, 201)]


def go(config, out, jobs=0, **more):
    return execute(load(config), out, Options(jobs=jobs, runner="fake_runner", **more))


def test_own_files_beat_batches_and_later_batches_earlier_ones(tmp_path):
    store = Store(tmp_path)
    names = store.batch_names()
    store.save_batch([Record("aa11", 0, steps=1), Record("bb22", 0, steps=1), Record("cc33", 0, steps=1)], next(names))
    store.save_batch([Record("bb22", 0, steps=2), Record("cc33", 0, steps=2)], next(names))
    store.save(Record("cc33", 0, steps=3))
    wanted = {"aa11": 1, "bb22": 2, "cc33": 3}
    for seen in (store, Store(tmp_path)):
        lines, damaged = seen.lines([*wanted, "dd44"])
        assert {run_id: line["steps"] for run_id, line in lines.items()} == wanted and not damaged
        assert {run_id: record.steps for run_id, record in seen.load_all([*wanted, "dd44"])} == wanted
        assert next(seen.batch_names()).startswith("batch-00000002-") and seen.own([*wanted]) == {"cc33"}


def test_a_damaged_batch_is_set_aside_and_its_points_are_due(tmp_path):
    store, older, name = Store(tmp_path), "batch-00000006-aa", "batch-00000007-aa"
    store.save_batch([Record("aa11", 0, steps=6), Record("cc33", 0)], older)
    store.save_batch([Record("aa11", 0, steps=7), Record("bb22", 0)], name)
    path = store.path(name)
    path.write_bytes(path.read_bytes()[:-30])
    lines, damaged = Store(tmp_path).lines(["aa11", "bb22"])
    assert damaged == [name] and list(lines) == ["aa11"]
    assert store.set_aside(name).suffix == ".damaged" and store.lines(["aa11", "bb22"])[1] == []
    assert store.load("aa11").steps == 6 and next(store.batch_names()).startswith("batch-00000008-")


def test_rerun_points_with_files_of_their_own_stay_there(config, tmp_path, monkeypatch):
    monkeypatch.setattr(batch_size, "BATCH", 0.0)
    go(config(TINY[:20]), tmp_path)
    monkeypatch.setattr(batch_size, "BATCH", 1.0)
    assert go(config(TINY[:40]), tmp_path, rerun="all").ran == 40
    assert len(list(tmp_path.glob("points/*/*.nc"))) >= 20 and list(tmp_path.glob("batches/*/*.nc"))
    assert go(config(TINY[:40]), tmp_path).ran == 0


def test_sizes_follow_the_pace():
    now = BatchSize()
    assert now.batch(1000, 2) == 1
    now.heard(0.002, 1)
    assert now.batch(1000, 2) == 4  # grows by four at most
    now.heard(0.002, 4)
    assert now.batch(1000, 2) == 16
    now.heard(0.01, 64)
    assert now.batch(1000, 2) == MOST_POINTS and now.batch(20, 2) == 5 and now.batch(1, 2) == 1
    now.heard(10.0, 1)
    assert now.batch(1000, 2) == 1


def test_tiny_points_share_files_and_give_the_same_dataset(config, tmp_path, marks, monkeypatch):
    whole = config([*TINY, fake.RAISES, fake.DIVERGES])
    assert go(whole, tmp_path / "batches").ran == 202
    assert len(list((tmp_path / "batches").glob("batches/*/*.nc"))) > 1 and len(list((tmp_path / "batches").glob("*/*/*.nc"))) < 40
    assert len(marks()) == 202 and go(whole, tmp_path / "batches").ran == 0
    monkeypatch.setattr(batch_size, "BATCH", 0.0)
    go(whole, tmp_path / "alone")
    assert len(list((tmp_path / "alone").glob("points/*/*.nc"))) == 202
    assert compare(tmp_path / "batches", tmp_path / "alone") == []


@pytest.mark.parametrize("bad, status, more", [(fake.DIES, 3, {"retries": 1}), (fake.HANGS, 2, {"timeout": 0.3})])
def test_in_a_batch_only_the_point_at_fault_pays(config, tmp_path, marks, bad, status, more, monkeypatch):
    monkeypatch.setattr("mpm.sweep.engine.GRACE", 0.2)
    tries = go(config([*TINY[:100], bad, *TINY[100:]]), tmp_path, jobs=1, **more)
    assert tries.exit_code == 3 and tries.ran == 201 + (bad == fake.DIES)
    found = tree_of(tmp_path / "sweep.nc")
    assert np.count_nonzero(found.status) == 1 and found.status.sel(kappa=bad) == status
    assert found.attempts.sel(kappa=bad) == (2 if bad == fake.DIES else 1) and found.attempts.where(found.status == 0).max() == 1
    assert len([row for row in marks() if row[1] == str(bad)]) == 2 + (bad == fake.DIES)  # once in its batch, then alone


def test_nothing_runs_after_the_failures_that_are_allowed(config, tmp_path, marks):
    go(config([*TINY[:100], fake.RAISES, *TINY[100:]]), tmp_path, max_failures=1)
    assert marks()[-1][1] == str(fake.RAISES)


def test_a_material_point_gives_the_same_bits_alone_and_in_a_batch(tmp_path, monkeypatch):
    experiment = load("configs/scenes/dough_rheometer.yaml", {"output.every": 1.0})
    real, calls = __import__("mpm.runner").runner.run_points, []
    monkeypatch.setattr("mpm.runner.run_points", lambda experiments: calls.append(len(experiments)) or real(experiments))
    monkeypatch.setattr(BatchSize, "batch", lambda *_: 9)
    execute(experiment, tmp_path / "together", Options(jobs=0))
    monkeypatch.setattr(BatchSize, "batch", lambda *_: 1)
    execute(experiment, tmp_path / "alone", Options(jobs=0))
    assert calls == [9] and compare(tmp_path / "together", tmp_path / "alone") == []
    assert not math.isnan(tree_of(tmp_path / "alone" / "sweep.nc").stress_zz.values.sum())
