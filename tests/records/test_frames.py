"""Frames: what a run streams to its own file is what it would have held, whatever cuts it; a file that is torn or changed says so."""

import errno
import os

import numpy as np
import pytest
import xarray

import mpm
from mpm.records import frames
from mpm.records.checkpoint import Checkpoint
from mpm.records.frames import Entries, Stream, Unwritten
from mpm.records.large import Parts, write_sealed
from mpm.records.netcdf import Array, DamagedFile, Group, summary, unseal
from mpm.runner import run_point
from mpm.sweep.alone import run_in
from mpm.sweep.verify import verify


def frame(k, count=50):
    rng = np.random.default_rng(k)
    particles = {"position": rng.random((count + k, 2)), "id": np.arange(count + k, dtype=np.int32)}
    return 0.1 * k, {"temperature": rng.random((3, 4)).astype(np.float32)}, particles


def equal(one, two):
    assert one[0] == two[0] and one[1].keys() == two[1].keys() and one[2].keys() == two[2].keys()
    for mine, theirs in zip(one[1:], two[1:], strict=True):
        for name, values in mine.items():
            np.testing.assert_array_equal(values, theirs[name])
            assert values.dtype == theirs[name].dtype


@pytest.fixture
def stream(tmp_path, monkeypatch):
    monkeypatch.setattr(frames, "SPILL", 2000)
    return Stream(tmp_path / "deep" / "a.frames")


def test_small_ones_stay_in_memory_and_large_ones_are_in_the_file(stream, monkeypatch):
    stream.add(*frame(0))
    assert not stream.path.exists() and len(stream) == 1
    for k in (1, 2, 3):
        stream.add(*frame(k))
    assert not stream.held and len(stream) == 4 and stream.times.tolist() == [frame(k)[0] for k in range(4)]
    entries = Entries(stream.path)
    for k in (3, 0, 2, -1):
        equal(entries[k], frame(k % 4))
        equal(stream[k % 4], frame(k % 4))
    np.testing.assert_array_equal(entries.part(2, "position"), frame(2)[2]["position"])
    with pytest.raises(IndexError):
        entries[4]


def test_reading_one_reads_that_one(stream):
    """All bytes of the other bodies may be anything."""
    for k in range(4):
        stream.add(*frame(k))
    ends = Entries(stream.path).ends
    data = bytearray(stream.path.read_bytes())
    data[10] ^= 255
    data[ends[2] + 10] ^= 255
    stream.path.write_bytes(data)
    entries = Entries(stream.path)
    equal(entries[1], frame(1))
    equal(entries[2], frame(2))
    for k in (0, 3):
        with pytest.raises(DamagedFile):
            entries[k]


def test_memory_says_how_many_there_are_and_what_came_later_is_made_again(stream):
    for k in range(3):
        stream.add(*frame(k))
    kept = stream.memory()
    whole = stream.path.read_bytes()
    assert not kept["held"] and len(kept["ends"]) == 3
    stream.add(*frame(7))
    with open(stream.path, "ab") as file:
        file.write(b"torn")
    with pytest.raises(DamagedFile):
        Entries(stream.path)
    again = Stream(stream.path)
    assert again.kept(kept)
    again.recall(kept)
    again.add(*frame(3))
    assert stream.path.read_bytes().startswith(whole) and len(Entries(stream.path)) == 4
    equal(Entries(stream.path)[3], frame(3))
    stream.path.write_bytes(whole[:-1])
    assert not again.kept(kept)


def test_a_full_disk_is_told_and_what_was_there_stays(stream, monkeypatch):
    for k in range(2):
        stream.add(*frame(k))

    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("builtins.open", full)
    with pytest.raises(Unwritten, match=r"cannot write \d+ bytes: No space left"):
        stream.append(*frame(2))
    monkeypatch.undo()
    assert len(Entries(stream.path)) == 2


def test_a_dataset_in_parts_is_that_of_one_piece_and_a_full_disk_leaves_nothing(tmp_path, monkeypatch):
    rows = [np.random.default_rng(k).random((40 + k, 3)) for k in range(5)]
    whole = np.concatenate(rows)
    groups = {"/": Group(), "particles": Group({"x": Array(("obs", "direction"), Parts(whole.shape, whole.dtype, lambda: iter(rows)), {"units": "m"})})}
    path = tmp_path / "big.nc"
    write_sealed(path, groups, {"title": "parts"}, {"digest": "d"})
    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        np.testing.assert_array_equal(tree["particles"].x.values, whole)
        assert tree.attrs["title"] == "parts"
    assert summary(path) == {"digest": "d"} and unseal(path.read_bytes(), path)[1] == {"digest": "d"}

    from mpm.records import large

    room = [3000]

    class Full(large.Careful):
        def write(self, data):
            room[0] -= len(data)
            if room[0] < 0 and self.error is None:
                self.error = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return super().write(data)

    monkeypatch.setattr(large, "Careful", Full)
    with pytest.raises(OSError, match="No space left") as told:
        write_sealed(tmp_path / "other.nc", groups, {}, {})
    assert told.value.filename == str(tmp_path / "other.nc") and [item.name for item in tmp_path.iterdir()] == ["big.nc"]


OUTPUT = {"every": 0.1, "snapshots": {"every": 0.05, "grid": ["temperature"], "particles": ["position", "velocity", "mass"]}}


def test_a_run_that_streams_gives_the_dataset_that_one_in_memory_gives_cut_or_not(core, tmp_path, monkeypatch):
    experiment = core.experiment(1, output=OUTPUT)
    plain = run_point(experiment)
    assert {"body", "id"} < plain.particles[0].keys() and plain.particles[0]["id"].tolist() == list(range(len(plain.particles[0]["id"])))
    monkeypatch.setattr(frames, "SPILL", 200)
    asked = []
    assert run_in(experiment, tmp_path / "whole", lambda *_: bool(asked.append(1)), print).record.status == 0

    def stop(*_):
        asked.pop()
        return len(asked) == 3

    cut = run_in(experiment, tmp_path / "cut", stop, print)
    assert cut.kept and list((tmp_path / "cut" / "checkpoints").glob("*.frames"))
    assert run_in(experiment, tmp_path / "cut", lambda *_: False, print).record.status == 0
    files = [next(folder.rglob("*.frames")) for folder in (tmp_path / "whole", tmp_path / "cut")]
    assert files[0].read_bytes() == files[1].read_bytes() and not list((tmp_path / "cut").glob("checkpoints/*"))
    for folder in ("whole", "cut"):
        tree = mpm.sweep.api.tree_of(tmp_path / folder / "run.nc")
        np.testing.assert_array_equal(tree["grid"].temperature.values, plain.grid["temperature"])
        for when, fields in zip(plain.snapshot_times, plain.particles, strict=True):
            shown = mpm.particles(tree, snapshot=when)
            for name in fields.keys() - {"id"}:
                np.testing.assert_array_equal(shown[name].values, fields[name])
    assert verify(tmp_path / "whole", check=True).sound
    data = bytearray(files[0].read_bytes())
    data[20] ^= 1
    files[0].write_bytes(data)
    found = verify(tmp_path / "whole", check=True)
    assert [one["what"] for one in found.damaged] == ["frames"]


def test_a_checkpoint_without_its_frames_is_not_gone_on_with(tmp_path, monkeypatch):
    monkeypatch.setattr(frames, "SPILL", 100)
    keeper = Checkpoint(tmp_path / "a.checkpoint", "a", 0.0)
    for k in range(3):
        keeper.frames.add(*frame(k, 500))
    keeper.save({"recorder": {"frames": keeper.frames.memory()}})
    assert (tmp_path / "a.checkpoint").stat().st_size < 2000 < (tmp_path / "a.frames").stat().st_size
    assert Checkpoint(tmp_path / "a.checkpoint", "a").found is not None
    (tmp_path / "a.frames").unlink()
    told = []
    assert Checkpoint(tmp_path / "a.checkpoint", "a", note=told.append).found is None and "from its start" in told[0]
