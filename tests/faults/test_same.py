"""R9: the same bits from any number of workers, here or on Dask, in any order, with a cold compile cache or a warm one; real physics."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from mpm.config import load
from mpm.sweep.api import execute
from mpm.sweep.compare import NOT_RESULTS
from mpm.sweep.engine import Options
from mpm.sweep.verify import files

CONFIGS = Path(__file__).parents[2] / "configs"
LOOKS = {"output.snapshots": {"every": 0.01, "grid": ["temperature", "velocity"], "particles": ["position", "temperature", "J"]}, "time.end": 0.02}
SCENES = {
    "moving": ("smoke.yaml", LOOKS, {"kappa": [0.2, 0.4], "beta": [100, 500]}),
    "rigid": ("scenes/slab.yaml", {}, {"beta": [0.1, 1, 10, ".inf"]}),
    "points": ("scenes/dough_rheometer.yaml", {"output.every": 0.5}, {"p0": [0.5, 0.6, 0.85], "eta": [5e3, 1e4, 2e4]}),
}


def swept(name, out, turned=False, **options):
    """A sweep of a scene, along its axes or (`turned`) against them; the dataset in the axes' own order."""
    file, settings, axes = SCENES[name]
    chosen = {f"sweep.axes.{axis}": values[::-1] if turned else values for axis, values in axes.items()}
    result = execute(load(CONFIGS / file, settings | chosen), out, Options(**{"jobs": 1} | options))
    assert result.exit_code == 0, result.lines
    assert len(list(files(out))) > 1
    return bits(out / "sweep.nc", list(axes), turned)


def bits(path, axes, turned):
    """Every array of a dataset by name, as type, shape and bytes; particles as one array a point, whatever the order of the points."""
    found = {}
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        tree = tree.load()
    for node in tree.subtree:
        data = node.to_dataset()
        back = {axis: slice(None, None, -1) for axis in axes if turned and axis in data.dims}
        data = data.isel(back)
        if node.name == "particles" and "row_size" in data:
            sizes, starts = data.row_size.values.ravel(), data.row_start.values.ravel()
            rows = np.concatenate([np.arange(start, start + size) for start, size in zip(starts, sizes, strict=True)])
            data = data.isel(obs=rows).drop_vars("row_start")
        for name, variable in data.variables.items():
            if str(name) not in NOT_RESULTS:
                values = np.ascontiguousarray(variable.values)
                found[f"{node.path}/{name}"] = (values.dtype.kind, values.shape, values.tolist() if values.dtype.kind == "O" else values.tobytes())
    return found


def different(one, two):
    return [name for name in {**one, **two} if one.get(name) != two.get(name)]


@pytest.mark.parametrize("name", ["rigid", pytest.param("points", marks=pytest.mark.wide)])
def test_two_workers_and_another_order_give_the_same_bits(tmp_path, name):
    whole = swept(name, tmp_path / "whole", jobs=0)
    assert different(whole, swept(name, tmp_path / "turned", turned=True, jobs=2)) == []


def test_another_number_is_seen(tmp_path):
    """The comparison is sharp: one bit of one value, and another order that is not put back."""
    whole = swept("rigid", tmp_path, jobs=0)
    name = "/series/temperature_centre"
    kind, shape, data = whole[name]
    assert different(whole, whole | {name: (kind, shape, data[:-1] + bytes([data[-1] ^ 1]))}) == [name]
    assert name in different(whole, bits(tmp_path / "sweep.nc", ["beta"], turned=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENES))
def test_the_same_bits_any_way(tmp_path, monkeypatch, table, name):
    whole = swept(name, tmp_path / "whole", jobs=0)
    ways = {f"{jobs} workers": {"jobs": jobs} for jobs in (1, 2, 4)}
    ways |= {"other order": {"turned": True, "jobs": 2}, "Dask": {"jobs": 2, "scheduler": "local"}}
    ways["Dask, through the folder"] = ways["Dask"] | {"shared": True}
    told = [f"{way}: {names}" for way, more in ways.items() if (names := different(whole, swept(name, tmp_path / way, **more)))]
    monkeypatch.setenv("MPM_CACHE_DIR", str(tmp_path / "cache"))  # workers compile into it
    for way in ("cold cache", "warm cache"):
        if names := different(whole, swept(name, tmp_path / way, jobs=2)):
            told.append(f"{way}: {names}")
    assert list((tmp_path / "cache").rglob("*.nbc"))
    said = f"{len(whole)} arrays bitwise equal in all {len(ways) + 2} ways" if not told else "; ".join(told)
    table(f"1, 2, 4 workers, other order, Dask over the wire and through the folder, cold and warm cache: {name}", said)
    assert not told
