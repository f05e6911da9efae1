import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from mpm.records.point import Record
from mpm.records.variables import TIMEOUT
from mpm.sweep.lock import Lock, Refused, owner
from mpm.sweep.store import Store, differences


def experiment(**changes):
    key = {"materials": {"dough": {"density": 300.0, "heat": {"fourier": {"kappa": 0.35}}}}, "time": {"end": 10.0}} | changes
    return SimpleNamespace(name="loaf", title="Loaf", source="text", key=lambda: key, resolved=lambda: key)


KAPPA = "materials.dough.heat.fourier.kappa"


def test_points_lie_in_shards_and_come_back(tmp_path):
    store = Store(tmp_path)
    store.save(Record("ab34", 0, steps=3))
    store.save(Record("cd56", 4, "diverged: det F <= 0"))
    assert store.path("ab34") == tmp_path / "points" / "ab" / "ab34.nc"
    lines, damaged = store.lines(["ab34", "cd56", "ef78"])
    assert list(lines) == ["ab34", "cd56"] and not damaged
    assert lines["cd56"]["error"] == "diverged: det F <= 0" and store.load("ab34").steps == 3


def test_a_truncated_point_is_told_and_set_aside(tmp_path):
    store = Store(tmp_path)
    store.save(Record("ab34", 0))
    store.path("ab34").write_bytes(store.path("ab34").read_bytes()[:-40])
    assert store.lines(["ab34"]) == ({}, ["ab34"])
    assert store.set_aside("ab34").suffix == ".damaged"
    assert store.lines(["ab34"]) == ({}, [])


def test_other_values_on_the_axes_are_the_same_experiment(tmp_path):
    store = Store(tmp_path)
    store.claim(experiment(), [KAPPA], smoke=False, take_over=False)
    other = experiment(materials={"dough": {"density": 300.0, "heat": {"fourier": {"kappa": 0.2}}}})
    store.claim(other, [KAPPA, "time.end"], smoke=False, take_over=False)
    assert store.experiment()["swept"] == [KAPPA, "time.end"]


def test_another_experiment_is_refused_by_key_unless_taken_over(tmp_path):
    store = Store(tmp_path)
    store.claim(experiment(), [KAPPA], smoke=False, take_over=False)
    before = (tmp_path / "experiment.json").read_bytes()
    other = experiment(time={"end": 20.0, "safety": 0.5})
    with pytest.raises(Refused, match=r"another experiment \(loaf\):\n  time.end: 10.0 -> 20.0\n  time.safety: absent -> 0.5\n"):
        store.claim(other, [KAPPA], smoke=False, take_over=False)
    assert (tmp_path / "experiment.json").read_bytes() == before
    store.claim(other, [KAPPA], smoke=False, take_over=True)
    assert store.experiment()["key"]["time"] == {"end": 20.0, "safety": 0.5}


def test_a_smoke_folder_gives_way_to_the_full_run_but_not_the_reverse(tmp_path):
    store = Store(tmp_path)
    store.claim(experiment(time={"end": 1.0}), [], smoke=True, take_over=False)
    store.claim(experiment(), [], smoke=False, take_over=False)
    with pytest.raises(Refused, match=r"time\.end"):
        store.claim(experiment(time={"end": 1.0}), [], smoke=True, take_over=False)


@pytest.mark.parametrize("old, new, without, said", [
    ({"a": 1, "b": {"c": 1}}, {"a": 2, "b": {"c": 2}}, {"b"}, ["a: 1 -> 2"]),
    ({"b": {"c": 1, "d": 1}}, {"b": {"c": 2, "d": 2}}, {"b.c"}, ["b.d: 1 -> 2"]),
    ({"b": 0.35}, {"b": {"bump": {"base": 1}}}, {"b.bump.base"}, []),
    ({"s": [{"name": "top", "beta": 1}, {"beta": 2}]}, {"s": [{"name": "top", "beta": 3}, {"beta": 4}]}, {"s.top.beta"}, ["s.1.beta: 2 -> 4"]),
    ({"size": [1, 2]}, {"size": [1, 3]}, set(), ["size: [1, 2] -> [1, 3]"]),
    ({}, {"measured": "x" * 100}, set(), ['measured: absent -> "' + "x" * 76 + "..."]),
    ({"a": 1}, {"a": 1}, set(), []),
])  # fmt: skip
def test_differences_are_paths(old, new, without, said):
    assert differences(old, new, without) == said


def test_one_writer_a_folder_and_the_dead_hold_nothing(tmp_path):
    code = f"""
import signal
from pathlib import Path
from mpm.sweep.lock import Lock
with Lock(Path({str(tmp_path)!r})):
    print("held", flush=True)
    signal.pause()
"""
    other = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2])
    assert other.stdout.readline() == "held\n"
    assert owner(tmp_path)["pid"] == other.pid
    with pytest.raises(Refused, match=f"in use by process {other.pid} on "), Lock(tmp_path):
        pass
    other.kill()
    other.wait()
    other.stdout.close()
    assert owner(tmp_path) is None
    with Lock(tmp_path):
        assert json.loads((tmp_path / "lock").read_text())["pid"] == os.getpid()
    assert owner(tmp_path) is None and (tmp_path / "lock").read_text() == ""


def test_a_damaged_description_is_refused_in_words(tmp_path):
    (tmp_path / "experiment.json").write_text('{"format": 1, ')
    with pytest.raises(Refused, match="damaged"):
        Store(tmp_path).experiment()


def test_a_new_folder_is_durable_before_what_is_in_it(tmp_path, monkeypatch):
    from mpm.sweep import store as module

    synced = []
    monkeypatch.setattr(module, "sync_folder", synced.append)
    place = tmp_path / "out" / "points" / "a.h5"
    Store(tmp_path / "out").put(place, b"whole")
    assert place.read_bytes() == b"whole" and set(synced) == {tmp_path, tmp_path / "out"}


def test_the_same_claim_leaves_the_file_alone_whatever_versions_are_installed(tmp_path, monkeypatch):
    """A finished folder that is only read stays as it is."""
    store = Store(tmp_path)
    store.claim(experiment(), [KAPPA], smoke=False, take_over=False)
    file = tmp_path / "experiment.json"
    before = file.read_bytes(), file.stat().st_ino
    monkeypatch.setattr("mpm.sweep.store.versions", lambda: {"numpy": "0"})
    store.claim(experiment(), [KAPPA], smoke=False, take_over=False)
    assert (file.read_bytes(), file.stat().st_ino) == before
    store.claim(experiment(), [KAPPA, "time.end"], smoke=False, take_over=False)
    assert store.experiment()["versions"] == {"numpy": "0"} and store.experiment()["swept"] == [KAPPA, "time.end"]


def test_who_joins_says_nothing_new_of_the_same_experiment(tmp_path):
    """A point that is run alone in a sweep's folder leaves the sweep's axes there."""
    store = Store(tmp_path)
    store.claim(experiment(), [KAPPA], smoke=False, take_over=False)
    store.claim(experiment(), [], smoke=False, take_over=False, join=True)
    assert store.experiment()["swept"] == [KAPPA]
    store.claim(experiment(time={"end": 1.0}), [], smoke=False, take_over=True, join=True)
    assert store.experiment()["key"]["time"] == {"end": 1.0}


def test_one_point_has_a_file_of_its_own_and_several_share_one(tmp_path):
    store = Store(tmp_path)
    store.save_batch([Record("ab34", 0)], "batch-00000001-0")
    store.save_batch([Record("cd56", 0), Record("ef78", 0)], "batch-00000002-0")
    files = sorted(path.relative_to(tmp_path).parts[0] for path in tmp_path.rglob("*.nc"))
    assert files == ["batches", "points"] and list(store.lines(["ab34", "cd56", "ef78"])[0]) == ["ab34", "cd56", "ef78"]


@pytest.mark.parametrize(("status", "copied"), [(0, False), (TIMEOUT, True)])
def test_frames_of_a_point_that_may_go_on_are_copied(tmp_path, monkeypatch, status, copied):
    told = []
    record = SimpleNamespace(run_id="ab34", status=status, frames=SimpleNamespace(settle=lambda path, copy: told.append((path, copy))))
    monkeypatch.setattr("mpm.records.point.pack", lambda record: b"")
    Store(tmp_path).save(record)
    assert told == [(tmp_path / "points" / "ab" / "ab34.frames", copied)]
