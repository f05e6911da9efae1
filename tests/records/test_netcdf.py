import errno
import os
import random

import numpy as np
import pytest
import xarray as xr

from mpm.records import netcdf
from mpm.records.netcdf import CHUNK, Array, DamagedFile, Group, chunks, seal, summary, to_bytes, unseal, write_whole


def example():
    root = Group({"kappa": Array(("kappa",), np.array([0.2, 0.5]), {"units": "W/m/K"}), "status": Array(("kappa",), np.array([0, 4], dtype=np.int8))})
    root.variables["error"] = Array(("kappa",), np.array(["", "diverged: θ"], dtype=object))
    root.variables["cell"] = Array((), 1e-3)
    series = Group({"time": Array(("time",), np.arange(3.0)), "temperature_mean": Array(("kappa", "time"), np.arange(6.0).reshape(2, 3), {"units": "K"})})
    return to_bytes({"/": root, "series": series, "grid": Group()}, {"title": "é", "versions": {"numpy": "2"}, "smoke": True, "count": 3})


def test_groups_read_back_with_units_and_json_attributes(tmp_path):
    write_whole(tmp_path / "a.nc", seal(example(), {"counts": 1}))
    with xr.open_datatree(tmp_path / "a.nc") as tree:
        assert tree["series"].temperature_mean.sel(kappa=0.5).values.tolist() == [3, 4, 5]
        assert tree.error.values.tolist() == ["", "diverged: θ"] and float(tree.cell) == 1e-3
        assert tree.attrs["versions"] == '{"numpy": "2"}' and tree.attrs["smoke"] == "true" and tree.attrs["count"] == 3
        assert tree.kappa.attrs["units"] == "W/m/K"
        assert tree["series"].temperature_mean.encoding["fletcher32"] and tree["series"].temperature_mean.encoding["shuffle"]


def test_disagreeing_dimensions_are_refused():
    with pytest.raises(ValueError, match="dimension x"):
        Group({"a": Array(("x",), np.zeros(2)), "b": Array(("x",), np.zeros(3))}).sizes()
    with pytest.raises(ValueError, match="shape"):
        Group({"a": Array(("x",), np.zeros((2, 2)))}).sizes()


def test_chunks_are_one_a_dimension_of_whole_frames_and_a_megabyte_or_more():
    shapes = {"a": ("p", "q", "snapshot", "y", "x"), "row_size": ("p", "q", "snapshot"), "p": ("p",), "position": ("obs", "direction"), "body": ("obs",)}
    sizes = {"p": 13, "q": 7, "snapshot": 31, "y": 100, "x": 90, "obs": 3_000_001, "direction": 3}
    kinds = {"a": np.float32, "body": np.int64}
    group = Group({name: Array(dims, np.broadcast_to(kinds.get(name, float)(0), [sizes[dim] for dim in dims])) for name, dims in shapes.items()})
    lengths = chunks(group)
    assert (lengths["y"], lengths["x"], lengths["direction"]) == (100, 90, 3) and lengths["p"] == lengths["q"] == 1
    assert 4 * 9000 * lengths["snapshot"] >= CHUNK > 4 * 9000 * (lengths["snapshot"] - 5) and 8 * 3 * lengths["obs"] >= CHUNK
    for name in ("snapshot", "obs"):
        last = (sizes[name] - 1) % lengths[name] + 1
        assert last * {"snapshot": 4 * 9000, "obs": 24}[name] >= CHUNK
    small = chunks(Group({"status": Array(("p", "q"), np.zeros((13, 7), np.int8)), "steps": Array(("p", "q"), np.zeros((13, 7)))}))
    assert small == {"p": 13, "q": 7}


def test_no_flipped_bit_and_no_truncation_is_silent(tmp_path):
    data = seal(example(), {"status": 0, "error": "x" * 5000})
    assert unseal(data)[1]["status"] == 0
    rng = random.Random(1)
    for _ in range(300):
        place = rng.randrange(8 * len(data))
        flipped = bytearray(data)
        flipped[place // 8] ^= 1 << place % 8
        with pytest.raises(DamagedFile):
            unseal(bytes(flipped))
    for _ in range(50):
        with pytest.raises(DamagedFile):
            unseal(data[: rng.randrange(len(data))])


def test_summary_reads_a_long_line_and_tells_a_missing_end(tmp_path):
    path = tmp_path / "p.nc"
    assert summary(path) is None
    write_whole(path, seal(b"body" * 5000, {"error": "y" * 9000}))
    assert len(summary(path)["error"]) == 9000
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(DamagedFile):
        summary(path)
    path.write_bytes(b"")
    with pytest.raises(DamagedFile):
        summary(path)


@pytest.mark.parametrize("call", ["write", "fsync", "replace"])
def test_a_failing_write_leaves_the_old_file_and_no_other(tmp_path, monkeypatch, call):
    path = tmp_path / "p.nc"
    write_whole(path, b"old")

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(netcdf.os, call, full)
    with pytest.raises(OSError, match=r"cannot write 3 bytes: No space left.*free") as caught:
        write_whole(path, b"new")
    assert caught.value.filename == str(path) and caught.value.errno == errno.ENOSPC
    monkeypatch.undo()
    assert path.read_bytes() == b"old" and os.listdir(tmp_path) == ["p.nc"]


def test_a_file_is_durable_before_it_has_its_name_and_the_name_before_it_is_told(tmp_path, monkeypatch):
    """fsync of the data, then the rename, then fsync of the folder: a crash in between leaves the old file or the new one."""
    happened = []
    sync, replace = os.fsync, os.replace

    def noted(descriptor):
        happened.append("folder" if os.path.samestat(os.fstat(descriptor), os.stat(tmp_path)) else "data")
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", noted)
    monkeypatch.setattr(os, "replace", lambda *names: (happened.append("rename"), replace(*names)))
    write_whole(tmp_path / "a.nc", b"whole")
    assert happened == ["data", "rename", "folder"]
