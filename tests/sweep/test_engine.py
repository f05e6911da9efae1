import os
import threading
from pathlib import Path

import fake_runner as fake
import numpy as np
import pytest

from mpm.config import load
from mpm.sweep import processes
from mpm.sweep.api import collect_folder, execute, sweep, tree_of
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.executors import BrokenWorkers
from mpm.sweep.report import Reporter
from mpm.sweep.store import Refused, Store

ROOT = Path(__file__).parents[2]


def go(config, out, jobs=0, **more):
    return execute(load(config), out, Options(jobs=jobs, runner="fake_runner", **more))


class Ears(Reporter):
    def __init__(self):
        self.told = []

    def finished(self, label, line, again):
        self.told.append((label, line["status"], again))

    def note(self, text):
        self.told.append(text)


@pytest.mark.parametrize("jobs", [0, 1, 2])
def test_every_point_runs_once_and_is_labelled(config, tmp_path, marks, jobs):
    result = go(config([0.2, 0.5, 1.0]), tmp_path / "out", jobs)
    assert result.exit_code == 0 and result.ran == 3 and result.counts["ok"] == 3
    assert sorted(what for _, what, _ in (row for row in marks() if row[0] == "run")) == ["0.2", "0.5", "1.0"]
    assert len([row for row in marks() if row[0] == "warm"]) == (jobs == 2)
    tree = tree_of(tmp_path / "out" / "sweep.nc")
    assert tree.temperature_mean.dims == ("kappa",) and tree.temperature_mean.values.tolist() == [300.2, 300.5, 301.0]
    assert tree["series"].temperature_centre.sel(kappa=0.5, time=10).item() == 305


def test_the_same_command_again_runs_nothing_and_writes_nothing(config, tmp_path, marks):
    out = tmp_path / "out"
    go(config([0.2, 0.5]), out)
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.name != "lock"}
    again = go(config([0.2, 0.5]), out)
    assert again.ran == 0 and again.exit_code == 0 and not again.collected
    assert before == {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.name != "lock"}


def test_an_added_value_runs_only_what_is_new(config, tmp_path, marks):
    go(config([0.2, 0.5]), tmp_path / "out")
    assert go(config([0.2, 0.3, 0.5, 0.7]), tmp_path / "out").ran == 2
    assert [what for _, what, _ in marks()] == ["0.2", "0.5", "0.3", "0.7"]
    assert tree_of(tmp_path / "out" / "sweep.nc").temperature_mean.values.tolist() == [300.2, 300.3, 300.5, 300.7]


def test_an_edited_parameter_is_refused_by_key_and_runs_when_told(config, tmp_path):
    go(config([0.2, 0.5]), tmp_path / "out")
    edited = config([0.2, 0.5], time={"end": 12})
    with pytest.raises(Refused, match=r"time\.end: 10\.0 -> 12\.0"):
        go(edited, tmp_path / "out")
    assert go(edited, tmp_path / "out", rerun="stale").ran == 2
    assert go(config([0.2, 0.5]), tmp_path / "out", rerun="stale").ran == 0  # the old points were kept


def test_other_source_is_stale(config, tmp_path, monkeypatch):
    go(config([0.2, 0.5]), tmp_path / "out")
    assert go(config([0.2, 0.5]), tmp_path / "out", rerun="stale").ran == 0
    monkeypatch.setattr("mpm.sweep.queue.source_hash", lambda: "other")
    ears = Ears()
    assert execute(load(config([0.2, 0.5, 0.7])), tmp_path / "out", Options(jobs=0, runner="fake_runner"), ears).ran == 1
    assert ears.told[0] == "2 of the points that are there were made by other source; --rerun stale runs them again"
    assert go(config([0.2, 0.5]), tmp_path / "out", rerun="stale").ran == 2
    assert go(config([0.2, 0.5]), tmp_path / "out", rerun="all").ran == 2


def test_a_failing_point_costs_itself_alone(config, tmp_path):
    result = go(config([0.2, fake.RAISES, fake.DIVERGES, 1.0]), tmp_path / "out")
    assert result.exit_code == 3 and {name: n for name, n in result.counts.items() if n} == {"ok": 2, "failed": 1, "diverged": 1}
    tree = tree_of(tmp_path / "out" / "sweep.nc")
    assert tree.status.values.tolist() == [0, 1, 4, 0]
    assert tree.error.values[1].startswith("failed: ValueError: no such luck (fake_runner.py:")
    assert tree.error.values[2] == "diverged: det F <= 0 at particle 812, t = 0.0134 s, step 2680"
    assert np.isnan(tree.temperature_mean.values).tolist() == [False, True, True, False]
    kept = tree["series"].temperature_centre.sel(kappa=fake.DIVERGES).values
    assert kept[4] == 300 + 4 * fake.DIVERGES and np.isnan(kept[5:]).all()


def test_rerun_failed_runs_those_only(config, tmp_path, marks):
    go(config([0.2, fake.DIVERGES]), tmp_path / "out")
    assert go(config([0.2, fake.DIVERGES]), tmp_path / "out").ran == 0
    assert go(config([0.2, fake.DIVERGES]), tmp_path / "out", rerun="failed").ran == 1
    assert [what for _, what, _ in marks()] == ["0.2", "17.0", "17.0"]


def test_all_failing_is_four_and_fail_fast_leaves_the_rest_pending(config, tmp_path):
    assert go(config([fake.DIVERGES]), tmp_path / "all").exit_code == 4
    fast = go(config([fake.DIVERGES, 0.2, 0.5]), tmp_path / "fast", max_failures=1)
    assert fast.exit_code == 3 and fast.counts["pending"] == 2
    assert tree_of(tmp_path / "fast" / "sweep.nc").status.values.tolist() == [4, 6, 6]
    assert go(config([fake.DIVERGES, 0.2, 0.5]), tmp_path / "fast").counts["pending"] == 0


def test_a_worker_that_stands_still_while_it_starts_is_replaced_and_told(config, tmp_path, marks, monkeypatch):
    assert processes.STALL < 60
    monkeypatch.setattr(processes, "STALL", 1.5)
    ears, options = Ears(), Options(jobs=1, runner="stalling_runner")
    result = execute(load(config([0.2])), tmp_path / "out", options, ears)
    assert result.exit_code == 0 and "a worker did nothing for 2 s while it was starting; it is replaced" in ears.told


def test_a_file_under_the_name_of_another_point_is_found_at_load(config, tmp_path, marks):
    go(config([0.2, 0.5]), tmp_path / "out")
    one, two = sorted((tmp_path / "out").glob("points/*/*.nc"))
    two.write_bytes(one.read_bytes())
    (tmp_path / "out" / "sweep.nc").unlink()
    collect_folder(tmp_path / "out")
    found = tree_of(tmp_path / "out" / "sweep.nc")
    assert sorted(found.status.values.tolist()) == [0, 6]
    again = go(config([0.2, 0.5]), tmp_path / "out")
    assert again.ran == 1 and two.with_suffix(".damaged").exists()
    assert tree_of(tmp_path / "out" / "sweep.nc").temperature_mean.values.tolist() == [300.2, 300.5]


def test_a_worker_that_dies_costs_its_point(config, tmp_path, marks):
    result = go(config([fake.DIES, fake.EXITS, 0.2, 0.5]), tmp_path / "out", jobs=2, retries=1)
    tree = tree_of(tmp_path / "out" / "sweep.nc")
    assert tree.status.values.tolist() == [3, 3, 0, 0] and result.exit_code == 3
    assert tree.error.values[0].startswith("killed: worker ended by signal 9 (SIGKILL")
    assert tree.error.values[1] == "killed: worker ended with code 5: out of tea"
    assert tree.attempts.values.tolist() == [2, 2, 1, 1]
    assert len([row for row in marks() if row[1] == "14.0"]) == 2


def test_a_point_that_dies_once_is_tried_again(config, tmp_path, marks):
    result = go(config([fake.DIES_ONCE, 0.2]), tmp_path / "out", jobs=1)
    assert result.exit_code == 0 and result.counts["ok"] == 2
    assert tree_of(tmp_path / "out" / "sweep.nc").attempts.values.tolist() == [2, 1]


@pytest.mark.parametrize("kappa, error", [(fake.SLOW, "timeout: stopped at t = "), (fake.HANGS, "timeout: no answer after 0.3 s")])
def test_timeout_stops_gently_then_hard(config, tmp_path, kappa, error, monkeypatch):
    monkeypatch.setattr("mpm.sweep.engine.GRACE", 0.5)
    result = go(config([kappa, 0.2]), tmp_path / "out", jobs=2, timeout=0.3)
    tree = tree_of(tmp_path / "out" / "sweep.nc")
    assert tree.status.values.tolist() == [2, 0] and tree.error.values[0].startswith(error) and result.exit_code == 3
    assert np.isfinite(tree["series"].temperature_centre.values[0, :3]).all() == (kappa == fake.SLOW)


def test_time_budget_leaves_pending_points_and_goes_on(config, tmp_path):
    first = go(config([0.2, fake.SLOW, 0.5]), tmp_path / "out", jobs=1, time_budget=4)
    assert first.exit_code == 75 and first.counts["pending"] == 2 and first.counts["ok"] == 1
    assert tree_of(tmp_path / "out" / "sweep.nc").status.values.tolist() == [0, 6, 6]


def test_resumed_equals_uninterrupted(config, tmp_path):
    whole = config([0.2, fake.DIVERGES, 0.5, 1.0], output={"every": 1, "probes": {"centre": [0.01]}, "snapshots": {"every": 2, "grid": ["temperature"]}})
    go(whole, tmp_path / "one")
    go(whole, tmp_path / "two", max_failures=1)
    store = Store(tmp_path / "two")
    victim = next(path for path in store.out.glob("points/*/*.nc"))
    victim.write_bytes(victim.read_bytes()[:-100])
    resumed = go(whole, tmp_path / "two", jobs=2)
    assert resumed.ran == 3 and list(store.out.glob("points/*/*.damaged"))
    assert compare(tmp_path / "one", tmp_path / "two") == []


def test_workers_that_cannot_start_are_told(config, tmp_path):
    with pytest.raises(BrokenWorkers, match=r"ended before they were ready.*no_such_runner"):
        execute(load(config([0.2])), tmp_path, Options(jobs=1, runner="no_such_runner"))


def test_a_full_disk_stops_the_sweep_and_keeps_what_is_there(config, tmp_path, monkeypatch):
    from mpm.records import netcdf

    real, left = os.write, [4]

    def write(descriptor, data):
        left[0] -= 1
        if left[0] < 0:
            raise OSError(28, "No space left on device")
        return real(descriptor, data)

    monkeypatch.setattr(netcdf.os, "write", write)
    with pytest.raises(OSError, match=r"cannot write .* No space left on device \(\d+ bytes free\)"):
        go(config([0.2, 0.5, 1.0, 2.0, 3.0]), tmp_path / "out")
    monkeypatch.undo()
    again = go(config([0.2, 0.5, 1.0, 2.0, 3.0]), tmp_path / "out")
    assert again.exit_code == 0 and 0 < again.ran < 5


def test_a_file_in_the_place_of_the_folder_is_refused(config, tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(Refused, match="out is no folder; choose another place"):
        go(config([0.2]), tmp_path / "out")
    assert (tmp_path / "out").read_text() == "mine"


def test_events_are_told_as_they_happen(config, tmp_path):
    ears = Ears()
    execute(load(config([fake.DIES, 0.2])), tmp_path, Options(jobs=1, retries=1, runner="fake_runner"), ears)
    assert ears.told == [("kappa=14", 3, True), ("kappa=0.2", 0, False), ("kappa=14", 3, False)]


def test_python_face_in_a_thread(config, tmp_path):
    trees = []
    work = threading.Thread(target=lambda: trees.append(sweep(load(config([0.2])), tmp_path, jobs=0, runner="fake_runner")))
    work.start()
    work.join()
    assert trees[0].status.values.tolist() == [0]


def test_a_dataset_of_what_is_there_while_running(config, tmp_path, monkeypatch):
    monkeypatch.setattr("mpm.sweep.background_collect.EVERY", 0.0)
    seen = []

    class Eyes(Reporter):
        def beat(self, running):
            if (tmp_path / "sweep.nc").exists():
                seen.append(tree_of(tmp_path / "sweep.nc").status.values.tolist())

    execute(load(config([0.2, 0.5, 1.0])), tmp_path, Options(jobs=0, runner="fake_runner"), Eyes())
    assert [0, 6, 6] in seen


def test_a_point_that_dies_is_tried_four_times_in_all_unless_told(config, tmp_path, marks):
    result = go(config([fake.DIES, 0.2]), tmp_path / "out", jobs=1)
    assert result.counts["killed"] == 1 and len([row for row in marks() if row[1] == str(fake.DIES)]) == 4
    assert tree_of(tmp_path / "out" / "sweep.nc").attempts.values.tolist()[0] == 4
