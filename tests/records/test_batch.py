import json

import numpy as np
import pytest

from mpm.records.batch import fits, pack_batch, read_batch
from mpm.records.netcdf import DamagedFile, summary
from mpm.records.point import Record


def record(k, samples=4, names=("a", "b")):
    times = np.arange(samples) * 0.5
    series = {name: np.sin(times + k + i) for i, name in enumerate(names)}
    finals = {name: float(k + i) for i, name in enumerate(names)}
    return Record(f"{k:016x}", 0, steps=k, times=times, series=series, finals=finals, facts={"k": k}, config={"kappa": k})


def same(one, two):
    assert one.line == two.line and one.facts == two.facts and one.config == two.config
    assert one.times.tobytes() == two.times.tobytes()
    assert list(one.series) == list(two.series) and all(one.series[name].tobytes() == two.series[name].tobytes() for name in one.series)
    assert one.finals == two.finals


def test_records_come_back_bit_for_bit_whatever_they_share(tmp_path):
    records = [record(1), record(2), record(3, samples=7), record(4, names=("c",)), Record("ff" * 8, 4, "diverged: ü"), record(5)]
    (tmp_path / "b.nc").write_bytes(pack_batch(records))
    for one, two in zip(records, read_batch(tmp_path / "b.nc"), strict=True):
        same(one, two)
    assert [line["run_id"] for line in summary(tmp_path / "b.nc")["points"]] == [one.run_id for one in records]
    assert json.dumps(summary(tmp_path / "b.nc"))


def test_a_flipped_bit_anywhere_is_told(tmp_path):
    data = pack_batch([record(k) for k in range(3)])
    for place in range(0, len(data), 97):
        (tmp_path / "b.nc").write_bytes(data[:place] + bytes([data[place] ^ 4]) + data[place + 1 :])
        with pytest.raises(DamagedFile):
            read_batch(tmp_path / "b.nc")


def test_fields_stay_in_files_of_their_own():
    with_fields = record(1)
    with_fields.grid = {"temperature": np.zeros((1, 3))}
    assert fits(record(1)) and not fits(with_fields)
