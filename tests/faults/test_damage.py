"""R5: no flipped bit and no lost tail in a finished result goes unseen; what is damaged runs again, and only that."""

import json
import random

import pytest
from scenes import config, fields, go, many

from mpm.records.checkpoint import Checkpoint
from mpm.sweep.compare import compare
from mpm.sweep.engine import Options
from mpm.sweep.lock import Refused
from mpm.sweep.store import Store
from mpm.sweep.verify import files, verify, wrong


def folder(tmp_path):
    """A folder with every kind of file that carries a checksum."""
    out = tmp_path / "out"
    go(many(40), out)
    go(fields([2.5, 17.0, 13.0]), out, rerun="stale")
    Checkpoint(Store(out).checkpoint("a" * 16), "a" * 16).save({"step": 3})
    kinds = {kind for kind, _ in files(out)}
    assert kinds == {"experiment", "dataset", "point", "batch", "checkpoint"}
    return out


def seen(out, change, times):
    """How often a change of a random file at random is seen."""
    rng, found, there = random.Random(7), 0, [(kind, path, path.read_bytes()) for kind, path in files(out)]
    for _ in range(times):
        kind, path, data = rng.choice(there)
        path.write_bytes(change(data, rng))
        found += bool(wrong(kind, path)[1])
        path.write_bytes(data)
    assert not any(wrong(kind, path)[1] for kind, path, _ in there)
    return found


def flip(data, rng):
    at = rng.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]


def cut(data, rng):
    return data[: rng.randrange(len(data))]


@pytest.mark.parametrize("change, times", [(flip, 300), (cut, 100)], ids=["flipped bits", "truncations"])
def test_no_damage_is_silent(tmp_path, change, times):
    assert seen(folder(tmp_path), change, times) == times


@pytest.mark.slow
@pytest.mark.parametrize("change, times", [(flip, 10_000), (cut, 1_000)], ids=["flipped bits", "truncations"])
def test_no_damage_is_silent_at_length(tmp_path, change, times, table):
    found = seen(folder(tmp_path), change, times)
    table(f"{times} {'flipped bits' if change is flip else 'truncations'} in finished results", f"{times - found} silent")
    assert found == times


def test_what_is_damaged_is_set_aside_and_runs_again_alone(tmp_path, marks):
    whole, out = tmp_path / "whole", tmp_path / "out"
    for place in (whole, out):
        go(fields([2.5, 17.0, 5.0]), place)
    before = len(marks())
    path = next(path for kind, path in files(out) if kind == "point")
    path.write_bytes(flip(path.read_bytes(), random.Random(1)))
    (out / "points" / ".left.tmp").write_bytes(b"half")
    looked = verify(out, check=True)
    assert not looked.sound and looked.damaged[0]["aside"] == "" and len(marks()) == before
    found = verify(out, Options(jobs=0, runner="fake_runner"))
    assert found.sound and found.due == [path.stem] and found.ran == 1 and found.left == 1
    assert len([row for row in marks()[before:] if row[0] == "run"]) == 1 and path.with_suffix(".damaged").exists()
    assert compare(whole, out) == [] and verify(out).damaged == []


def test_a_damaged_batch_costs_its_points_and_a_damaged_dataset_none(tmp_path, marks):
    whole, out = tmp_path / "whole", tmp_path / "out"
    for place in (whole, out):
        go(many(60), place)
    before = len(marks())
    batch = [path for kind, path in files(out) if kind == "batch"][-1]
    batch.write_bytes(batch.read_bytes()[:-1])
    (out / "sweep.nc").write_bytes(flip((out / "sweep.nc").read_bytes(), random.Random(2)))
    found = verify(out, Options(jobs=0, runner="fake_runner"))
    ran = len([row for row in marks()[before:] if row[0] == "run"])
    assert found.sound and 0 < found.ran == ran < 60 and {one["what"] for one in found.damaged} == {"batch", "dataset"}
    assert compare(whole, out) == []


def test_the_same_command_and_status_see_a_damaged_summary(tmp_path):
    """The line of a file, which is all that a resumed sweep reads of it, has a checksum of its own."""
    out = tmp_path / "out"
    go(fields([2.5, 5.0]), out)
    path = next(path for kind, path in files(out) if kind == "point")
    path.write_bytes(path.read_bytes().replace(b'"status": 0', b'"status": 1'))
    result = go(fields([2.5, 5.0]), out)
    assert result.ran == 1 and result.counts["ok"] == 2


def test_damaged_experiment_json_is_refused_and_set_aside(tmp_path):
    out = tmp_path / "out"
    go(config([2.5, 5.0]), out)
    path = out / "experiment.json"
    assert json.loads(path.read_bytes())["sha256"]
    path.write_bytes(path.read_bytes().replace(b"1000.0", b"1001.0", 1))
    with pytest.raises(Refused, match=r"experiment.json is damaged \(it does not match its checksum\)"):
        go(config([2.5, 5.0]), out)
    found = verify(out)
    assert not found.sound and not path.exists()
    assert go(config([2.5, 5.0]), out).ran == 0


def test_nothing_to_verify(tmp_path):
    with pytest.raises(Refused, match="holds no results"):
        verify(tmp_path)
