import numpy as np
import pytest
import xarray as xr

from mpm.config import load
from mpm.outcome import INVERTED, outcome
from mpm.records.netcdf import to_bytes
from mpm.records.point import Record
from mpm.sweep import shards, table
from mpm.sweep.api import collect_folder, execute, run_one, tree_of
from mpm.sweep.cases import plan
from mpm.sweep.collect import dataset
from mpm.sweep.engine import Options
from mpm.sweep.verify import verify

SNAPSHOTS = {"every": 1, "probes": {"centre": [0.01]}, "snapshots": {"every": 2, "grid": ["temperature"], "particles": ["position", "body"]}}
ELASTIC = {"m": {"density": 1000, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}}
MOVES = {"output": SNAPSHOTS, "materials": ELASTIC}  # what has particles


def go(config, out, **more):
    return execute(load(config), out, Options(jobs=0, runner="fake_runner", **more))


def test_every_variable_has_units_and_a_long_name_and_attributes_tell_the_origin(config, tmp_path):
    go(config([0.2, 17.0], **MOVES), tmp_path)
    tree = tree_of(tmp_path / "sweep.nc")
    for node in tree.subtree:
        for name, variable in node.to_dataset(inherit=False).variables.items():
            assert variable.attrs["units"] and variable.attrs["long_name"], name
    assert tree["series"].time.dtype == float and tree["series"].time.attrs["units"] == "s"
    assert tree.status.attrs["flag_meanings"] == "ok failed timeout killed diverged skipped pending" and tree.status.dtype == np.int8
    assert tree.status.attrs["flag_values"].tolist() == list(range(7))
    assert tree.kappa.attrs["config_path"] == "materials.m.heat.fourier.kappa"
    for name in ("Conventions", "title", "config", "config_resolved", "versions", "source_hash", "git_revision", "machine", "threads", "started", "finished"):
        assert name in tree.attrs
    assert float(tree.alpha) == 1000 and tree.alpha.attrs["units"] == "J/kg/K" and float(tree.end) == 10


def test_grid_and_ragged_particles(config, tmp_path):
    go(config([0.2, 17.0, 0.5], **MOVES), tmp_path)
    tree = tree_of(tmp_path / "sweep.nc")
    grid, particles = tree["grid"].to_dataset(), tree["particles"].to_dataset()
    assert grid.temperature.dims == ("kappa", "snapshot", "x") and grid.temperature.dtype == np.float32 and grid.snapshot.values.tolist() == [0, 2, 4, 6, 8, 10]
    assert (grid.temperature.sel(kappa=0.5) == np.float32(0.5)).all() and np.isnan(grid.temperature.sel(kappa=17.0)[-1]).all()
    assert particles.row_size.values.tolist() == [[2, 3, 4, 5, 6, 7], [2, 3, 4, 0, 0, 0], [2, 3, 4, 5, 6, 7]]
    assert particles.row_size.attrs["sample_dimension"] == "obs" and particles.position.dims == ("obs", "direction")
    row = particles.sel(kappa=0.5).isel(snapshot=3)
    rows = slice(int(row.row_start), int(row.row_start) + int(row.row_size))
    assert particles.position[rows].values.ravel().tolist() == [0.5] * 5


def test_grids_that_differ_and_fields_that_are_too_large_stay_in_the_points(config, tmp_path, monkeypatch):
    points = config([0.2], **MOVES)
    cases = plan(load(points | {"sweep": {"axes": {"cell": [1e-3, 2e-3]}}}))
    grids = [np.linspace(0, 1, 3), np.linspace(0, 1, 5)]
    records = {
        case.run_id: Record(case.run_id, 0, snapshot_times=np.zeros(1), axes={"x": grid}, grid={"temperature": np.zeros((1, len(grid)), np.float32)})
        for case, grid in zip(cases.cases, grids, strict=True)
    }
    about = {"title": "", "name": "a", "source": "", "smoke": False, "swept": [], "resolved": {}}
    tree = tree_of(to_bytes(*dataset(cases, about, records)))
    assert tree["grid"].file.values.tolist() == [f"points/{case.run_id[:2]}/{case.run_id}.nc" for case in cases.cases]
    monkeypatch.setattr(table, "LIMIT", 10)
    go(points, tmp_path)
    tree = tree_of(tmp_path / "sweep.nc")
    for group in ("grid", "particles"):
        assert list(tree[group].data_vars) == ["file"] and (tmp_path / tree[group].file.item(0)).exists()


def test_series_that_are_too_large_go_into_files_of_their_own(config, tmp_path, monkeypatch):
    axes = {"axes": {"kappa": [0.2, 0.5, 17.0, 1.0, 1.5], "alpha": [1000, 2000]}}
    go(config([1], sweep=axes), tmp_path / "one")
    monkeypatch.setattr(table, "SERIES", 10)
    monkeypatch.setattr(shards, "SHARD", 2 * 2 * 2 * 11 * 8)  # two values of kappa
    go(config([1], sweep=axes), tmp_path / "cut")
    whole, cut = tree_of(tmp_path / "one" / "sweep.nc")["series"].to_dataset(), tree_of(tmp_path / "cut" / "sweep.nc")["series"].to_dataset()
    assert cut.file.values.tolist() == ["series/0000.nc"] * 2 + ["series/0001.nc"] * 2 + ["series/0002.nc"] and not {*cut.data_vars} & {*whole.data_vars}
    parts = [xr.load_dataset(tmp_path / "cut" / file) for file in dict.fromkeys(cut.file.values.tolist())]
    joined = xr.concat(parts, "kappa")
    assert joined.kappa.values.tolist() == axes["axes"]["kappa"] and joined.alpha.values.tolist() == [1000, 2000]
    for name in whole.data_vars:
        np.testing.assert_array_equal(joined[name], whole[name])
    (tmp_path / "cut" / "series" / "0001.nc").write_bytes(b"damaged")
    found = verify(tmp_path / "cut")
    assert found.sound and [one["what"] for one in found.damaged] == ["series"] and verify(tmp_path / "cut").damaged == []
    assert [path.suffix for path in sorted((tmp_path / "cut" / "series").iterdir())] == [".nc", ".damaged", ".nc", ".nc"]
    monkeypatch.setattr(shards, "SHARD", 10**9)
    (tmp_path / "cut" / "sweep.nc").unlink()
    collect_folder(tmp_path / "cut")
    assert [path.name for path in (tmp_path / "cut" / "series").glob("*.nc")] == ["0000.nc"]


def test_zip_sample_points_and_where(config, tmp_path):
    sweep = {"axes": {"alpha": [1000, 2000]}, "zip": [{"kappa": [0.2, 0.3], "density": [900, 950]}], "where": "kappa < 0.25 or alpha > 1500"}
    result = go(config([1], sweep=sweep), tmp_path / "zip")
    with xr.open_dataset(tmp_path / "zip" / "sweep.nc") as data:
        assert data.temperature_mean.dims == ("alpha", "kappa") and data.status.values.tolist() == [[0, 5], [0, 0]]
        assert data.m_density.dims == ("kappa",) and data.m_density.attrs["config_path"] == "materials.m.density"
        assert np.isnan(data.temperature_mean.values[0, 1])
    assert result.exit_code == 0 and result.counts["skipped"] == 1
    go(config([1], sweep={"sample": {"sobol": {"count": 4, "seed": 1, "ranges": {"kappa": [0.1, 1.0]}}}}), tmp_path / "sobol")
    with xr.open_dataset(tmp_path / "sobol" / "sweep.nc") as data:
        assert data.temperature_mean.dims == ("sample",) and data.kappa.dims == ("sample",) and "kappa" in data.coords
        np.testing.assert_allclose(data.temperature_mean, 300 + data.kappa)


SWEEPS = [
    {"axes": {"kappa": [0.2, 17.0, 0.5], "alpha": [1000, 2000]}},
    {"sample": {"sobol": {"count": 4, "seed": 1, "ranges": {"kappa": [0.1, 1.0]}}}},
    {"zip": [{"kappa": [0.2, 0.3], "density": [900, 950]}], "axes": {"alpha": [1000, 2000]}},
]


@pytest.mark.parametrize("sweep", SWEEPS)
def test_a_group_opened_alone_has_its_axes(config, tmp_path, sweep):
    go(config([1], sweep=sweep, **MOVES), tmp_path)
    root, tree = xr.load_dataset(tmp_path / "sweep.nc"), tree_of(tmp_path / "sweep.nc")
    swept = {name for name, variable in root.coords.items() if variable.dims}
    for name in ("series", "grid", "particles"):
        alone = xr.load_dataset(tmp_path / "sweep.nc", group=name)
        assert swept <= {*alone.coords} and all(alone.variables[axis].identical(root.variables[axis]) for axis in swept)
        assert all(variable.attrs["units"] and variable.attrs["long_name"] for variable in alone.variables.values())
        assert {*tree[name].to_dataset().data_vars} == {*alone.data_vars} and not swept & {*alone.data_vars}


@pytest.mark.parametrize("sweep", SWEEPS)
def test_a_dataset_can_be_read_in_chunks(config, tmp_path, monkeypatch, sweep):
    """One chunking a group, or xarray refuses to say what it is; small chunks here, so that there are several."""
    monkeypatch.setattr("mpm.records.netcdf.CHUNK", 50)
    go(config([1], sweep=sweep, **MOVES), tmp_path)
    whole = tree_of(tmp_path / "sweep.nc")
    with xr.open_datatree(tmp_path / "sweep.nc", chunks={}) as tree:
        assert all(node.to_dataset().chunks is not None for node in tree.subtree)
        assert tree["grid"].to_dataset().chunks["x"] == (5,) and len(tree["grid"].to_dataset().chunks["snapshot"]) > 1
        assert tree.identical(whole)


def test_advice_is_in_the_dataset(config, tmp_path):
    go(config([0.2, 17.0]), tmp_path)
    advice = xr.load_dataset(tmp_path / "sweep.nc").advice
    assert advice.dims == ("kappa",) and advice.values[0] == "" and advice.values[1] == outcome(INVERTED).advice != ""


def test_half_done_is_a_valid_file_and_collect_finds_what_is_there(config, tmp_path):
    go(config([17.0, 0.2, 0.5]), tmp_path, max_failures=1)
    with xr.open_dataset(tmp_path / "sweep.nc") as data:
        assert data.status.values.tolist() == [4, 6, 6] and data.run_id.values[2] != "" and data.attempts.values.tolist() == [1, 0, 0]
        assert data.error.where(data.status != 0, drop=True).to_series().iloc[0].startswith("diverged")
    path, written, counts = collect_folder(tmp_path)
    assert path == tmp_path / "sweep.nc" and not written and counts["pending"] == 2
    path.write_bytes(path.read_bytes()[:-10])
    assert collect_folder(tmp_path)[1]


def test_a_point_damaged_inside_is_pending_and_told(config, tmp_path):
    go(config([0.2, 0.5]), tmp_path)
    victim = next(tmp_path.glob("points/*/*.nc"))
    data = bytearray(victim.read_bytes())
    data[300] ^= 1
    victim.write_bytes(data)
    (tmp_path / "sweep.nc").unlink()
    collect_folder(tmp_path)
    with xr.open_dataset(tmp_path / "sweep.nc") as found:
        assert sorted(found.status.values.tolist()) == [0, 6] and f"{victim.stem}.nc is damaged" in "".join(found.error.values)


@pytest.mark.parametrize("kappa, status", [(0.2, 0), (17.0, 4), (13.0, 1)])
def test_one_run_has_the_same_groups(config, kappa, status, monkeypatch):
    monkeypatch.setattr("mpm.sweep.engine.RUNNER", "fake_runner")
    data, record = run_one(load(config([kappa, 0.3], **MOVES)))
    tree = tree_of(data)
    assert list(tree.children) == ["series", "grid", "particles"] and tree.status.item() == status == record.status
    assert np.isfinite(tree.temperature_mean.item()) == (status == 0) if status != 1 else "temperature_mean" not in tree
    assert float(tree.kappa) == kappa
