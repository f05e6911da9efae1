import numpy as np
import pytest
import xarray as xr

from mpm.sweep.compare import compare, values
from mpm.sweep.store import Refused


@pytest.mark.parametrize("x, y, rtol, atol, said", [
    ([1.0, np.nan], [1.0, np.nan], 0, 0, ""),
    ([1.0, 2.0], [1.0, 2.0 + 1e-12], 0, 0, "1 of 2 differ, most at x=1: 2.0 and 2.000000000001"),
    ([1.0, 2.0], [1.0, 2.0 + 1e-12], 1e-9, 0, ""),
    ([0.0], [1e-9], 1e-3, 0, "1 of 1 differ, most at x=0: 0.0 and 1e-09"),
    ([0.0], [1e-9], 0, 1e-8, ""),
    ([1.0], [np.nan], 1, 1, "1 of 1 differ, most at x=0: 1.0 and nan"),
    (["a", "b"], ["a", "c"], 0, 0, "1 of 2 differ, first at x=1: b and c"),
    ([np.inf], [np.inf], 0, 0, ""),
])  # fmt: skip
def test_values(x, y, rtol, atol, said):
    assert values(np.array(x), np.array(y), rtol, atol, lambda at: f"x={at[0]}") == said


def test_what_counts_and_what_does_not(tmp_path):
    def write(name, **more):
        data = {"temperature_mean": ("kappa", [1.0, 2.0]), "wall_time": ("kappa", [more.pop("wall", 0.1)] * 2)} | more.pop("also", {})
        xr.Dataset(data, {"kappa": [0.2, 0.5]}, {"title": "a", "started": "now"} | more).to_netcdf(tmp_path / name, engine="h5netcdf")
        return tmp_path / name

    one = write("one.nc")
    assert compare(one, write("two.nc", wall=0.3, started="then")) == []
    assert compare(one, write("two.nc", title="b")) == ["attribute title: a and b"]
    assert compare(one, write("two.nc", also={"extra": ("kappa", [0, 0])})) == ["/extra: only in the second"]
    assert compare(write("three.nc", also={"extra": ("kappa", [0, 0])}), one) == ["/extra: only in the first"]


def test_other_sizes_are_told_once_and_configs_by_path(tmp_path):
    def write(name, count, end, text):
        attrs = {"config": text, "config_resolved": f'{{"time": {{"end": {end}}}, "title": "a"}}'}
        data = {"temperature_mean": ("kappa", np.arange(count)), "steps": ("kappa", np.arange(count)), "alpha": ((), 1.0)}
        xr.Dataset(data, {"kappa": np.arange(count)}, attrs).to_netcdf(tmp_path / name, engine="h5netcdf")
        return tmp_path / name

    one = write("one.nc", 3, 1.0, "end: 1")
    assert compare(one, write("two.nc", 3, 1.0, "end: 1  # s")) == []
    said = ["/: kappa has 3 and 2 values", "/: 3 variables along kappa were not compared", "config: time.end: 1.0 -> 2.0"]
    assert compare(one, write("two.nc", 2, 2.0, "end: 2")) == said


def test_a_point_is_named_by_its_values_and_never_by_a_hash(tmp_path):
    def write(name, last, digest):
        data = {"temperature_mean": (("kappa", "beta"), [[1.0, 2.0], [3.0, last]]), "run_id": (("kappa", "beta"), [["a", "b"], ["c", digest]])}
        xr.Dataset(data, {"kappa": [0.2, 0.35], "beta": [5.0, np.inf]}).to_netcdf(tmp_path / name, engine="h5netcdf")
        return tmp_path / name

    said = [
        "/temperature_mean: 1 of 4 differ, most at kappa=0.35 beta=inf: 4.0 and 5.0",
        "/run_id: 1 of 4 points are of another config or version of the physics",
    ]
    assert compare(write("one.nc", 4.0, "0f3a"), write("two.nc", 5.0, "77aa")) == said


def test_nothing_to_compare(tmp_path):
    with pytest.raises(Refused, match=r"neither sweep\.nc nor run\.nc"):
        compare(tmp_path, tmp_path)
    with pytest.raises(Refused, match="does not exist"):
        compare(tmp_path / "a", tmp_path)


def test_what_is_no_dataset_is_refused(tmp_path):
    (tmp_path / "a.nc").write_bytes(b"nothing of the kind")
    with pytest.raises(Refused, match=r"a\.nc is not a whole NetCDF-4 file"):
        compare(tmp_path / "a.nc", tmp_path / "a.nc")
