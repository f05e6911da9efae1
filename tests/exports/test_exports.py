"""Exports hold what the dataset holds, to float32: read back by the formats' own libraries where they are installed, by h5py and pandas always."""

import csv
import functools
import subprocess
import sys

import fake_runner
import h5py
import numpy as np
import pandas
import pytest
import xarray

import mpm
from mpm.exports import ExportError
from mpm.exports.space import spatial
from mpm.exports.tables import longer
from mpm.opened import Results, UnknownPoint
from mpm.sweep import engine
from mpm.sweep.alone import run_in

SHOTS = {"every": 0.1, "grid": ["temperature", "velocity"],
         "particles": ["position", "velocity", "temperature", "stress", "strain", "velocity_gradient", "mass", "J"]}  # fmt: skip


@pytest.fixture(scope="module")
def folder(core, tmp_path_factory):
    """A run of a dimension."""

    @functools.cache
    def made(dimension):
        place = tmp_path_factory.mktemp("run") / str(dimension)
        moving = core.experiment(dimension, {"bodies.body.velocity": [0.1] * core.DIRECTIONS[dimension]}, output={"every": 0.1, "snapshots": SHOTS})
        run_in(moving, place, lambda *_: False, print)
        return place

    return made


def fake(tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    return mpm.sweep(mpm.load(fake_runner.slab({"kappa": [1.0, 17.0, 2.0]}, probes={"centre": [0.01]})), out=tmp_path / "s", jobs=0)


def test_tensors_in_three_directions():
    """Axisymmetric: r, z, hoop and rz become x, z, y and xz."""
    assert spatial("stress", np.array([[1.0, 2, 3, 4]]), "axisymmetric").tolist() == [[1, 3, 2, 0, 0, 4]]
    assert spatial("stress", np.array([[1.0, 2, 3, 4]]), 2).tolist() == [[1, 2, 3, 4, 0, 0]]
    assert spatial("velocity", np.array([[1.0, 2]]), "axisymmetric").tolist() == [[1, 0, 2]]
    assert spatial("velocity_gradient", np.array([[1.0, 2, 3, 4]]), "axisymmetric").tolist() == [[1, 0, 2, 0, 0, 0, 3, 0, 4]]
    assert spatial("id", np.arange(3), 3).dtype == np.int32 and spatial("position", np.arange(2.0), 1).tolist() == [[0, 0, 0], [1, 0, 0]]


def test_points_by_name(tmp_path, monkeypatch):
    fake(tmp_path, monkeypatch)
    with Results(tmp_path / "s") as found:
        assert [point.at for point in found.points(["kappa=all"])] == [{"kappa": k} for k in range(3)]
        assert found.points(["kappa=2.01"])[0].stem == "kappa=2" and found.points()[0].at == {"kappa": 0}
        assert len(found.points(["kappa=1"])[0].shots) == 6
        for wrong in ("beta=3", "kappa", "kappa=5", "kappa=x"):
            with pytest.raises(UnknownPoint):
                found.points([wrong])


def test_tables_have_every_point_and_every_number(tmp_path, monkeypatch):
    tree = fake(tmp_path, monkeypatch)
    mpm.export(tmp_path / "s", to=tmp_path / "wide.csv")
    wide = pandas.read_csv(tmp_path / "wide.csv")
    assert wide["status"].tolist() == ["ok", "diverged", "ok"] and wide["kappa [W/m/K]"].tolist() == [1, 17, 2]
    np.testing.assert_array_equal(wide["temperature_mean [K]"], tree.temperature_mean.values)
    mpm.export(tmp_path / "s", to=tmp_path / "long.csv", long=True)
    long = pandas.read_csv(tmp_path / "long.csv")
    curve = long[(long.variable == "temperature_centre") & (long["kappa [W/m/K]"] == 2)]
    np.testing.assert_array_equal(curve["value"], tree["series"].temperature_centre.sel(kappa=2).values)
    assert set(curve["units"]) == {"K"} and not long[long["kappa [W/m/K]"] == 17].variable.isin(["temperature_mean"]).any()
    with pytest.raises(ExportError, match="holds all points"):
        mpm.export(tmp_path / "s", "kappa=1", tmp_path / "a.csv")
    with pytest.raises(ExportError, match="suffix"):
        mpm.export(tmp_path / "s", to=tmp_path / "a.vtu")


def test_a_long_table_of_a_dataset_without_series(tmp_path, monkeypatch):
    fake(tmp_path, monkeypatch)
    with Results(tmp_path / "s") as found:
        found.view.series = None
        table, units = longer(found)
    assert table["time"].isna().all() and "temperature_mean" in set(table.variable) and units["kappa"] == "W/m/K"


def test_texts_are_no_formulas_in_a_spreadsheet(tmp_path, monkeypatch):
    from mpm.exports import tables

    fake(tmp_path, monkeypatch)
    before = tables.wider
    monkeypatch.setattr(tables, "wider", lambda found: (before(found)[0].assign(error=["=1+1", "@x", ""]), {}))
    mpm.export(tmp_path / "s", to=tmp_path / "a.csv")
    with open(tmp_path / "a.csv") as file:
        assert [row["error"] for row in csv.DictReader(file)] == ["'=1+1", "'@x", ""]


def test_vtkhdf_of_a_line_by_h5py(core, tmp_path):
    run_in(core.experiment(1, output={"every": 0.1, "snapshots": SHOTS}), tmp_path / "r", lambda *_: False, print)
    particles, grid = mpm.export(tmp_path / "r", to=tmp_path / "a.vtkhdf")
    assert grid.name == "a.grid.vtkhdf"
    with h5py.File(particles) as file, Results(tmp_path / "r") as found:
        root, shots = file["VTKHDF"], found.points()[0].shots
        assert root.attrs["Type"] == b"PolyData" and root["Steps"].attrs["NSteps"] == len(shots) == 6
        assert len(root["Vertices/Connectivity"]) == root["NumberOfPoints"][0]  # once, for all steps
        for k in range(6):
            begin, count = root["Steps/PointOffsets"][k], root["NumberOfPoints"][k]
            np.testing.assert_array_equal(root["Points"][begin : begin + count, 0], shots[k].particles["position"][:, 0].astype(np.float32))
            np.testing.assert_array_equal(root["PointData/id"][begin : begin + count], shots[k].particles["id"])


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
def test_vtk_reads_what_the_dataset_holds(folder, dimension, tmp_path):
    vtk = pytest.importorskip("vtk", reason="VTK's reader is not installed")
    from vtk.util.numpy_support import vtk_to_numpy

    particles, grid = mpm.export(folder(dimension), to=tmp_path / "a.vtkhdf")
    with Results(folder(dimension)) as found:
        shots = found.points()[0].shots
        for path in (particles, grid):
            reader = vtk.vtkHDFReader()
            reader.SetFileName(str(path))
            reader.UpdateInformation()
            assert reader.GetNumberOfSteps() == len(shots)
            for k in range(len(shots)):
                reader.SetStep(k)
                reader.Update()
                data, frame = reader.GetOutput(), shots[k]
                assert reader.GetTimeValue() == pytest.approx(frame.time)
                fields = frame.particles if path == particles else frame.grid
                for name, values in fields.items():
                    if path == particles:
                        wanted = spatial(name, values, dimension)
                        got = data.GetPoints().GetData() if name == "position" else data.GetPointData().GetArray(name)
                    else:
                        wanted, got = values.ravel(), data.GetPointData().GetArray(name)
                    np.testing.assert_array_equal(vtk_to_numpy(got), wanted, err_msg=name)
                assert path == grid or data.GetNumberOfVerts() == len(frame.particles["position"])


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
def test_usd_reads_what_the_dataset_holds(folder, dimension, tmp_path):
    pxr = pytest.importorskip("pxr", reason="OpenUSD is not installed")
    from pxr import Usd, UsdGeom

    assert pxr
    (path,) = mpm.export(folder(dimension), to=tmp_path / "a.usdc")
    stage = Usd.Stage.Open(str(path))
    points = UsdGeom.Points(stage.GetPrimAtPath("/particles"))
    with Results(folder(dimension)) as found:
        shots = found.points()[0].shots
        for k, when in enumerate(shots.times):
            fields = {name: spatial(name, values, dimension) for name, values in shots[k].particles.items()}
            np.testing.assert_array_equal(np.array(points.GetPointsAttr().Get(when * 24)), fields["position"])
            np.testing.assert_array_equal(np.array(points.GetIdsAttr().Get(when * 24)), fields["id"])
            for name in ("temperature", "strain", "velocity", "body"):
                got = np.array(UsdGeom.PrimvarsAPI(points).GetPrimvar(name).Get(when * 24))
                np.testing.assert_array_equal(got.ravel(), fields[name].ravel())


@pytest.mark.slow
def test_parquet_and_zarr_read_what_the_dataset_holds(tmp_path, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    pytest.importorskip("zarr", reason="zarr is not installed")
    tree = fake(tmp_path, monkeypatch)
    mpm.export(tmp_path / "s", to=tmp_path / "a.parquet")
    table = parquet.read_table(tmp_path / "a.parquet")
    np.testing.assert_array_equal(table["temperature_mean"].to_numpy(), tree.temperature_mean.values)
    assert table.schema.field("temperature_mean").metadata[b"units"] == b"K"
    mpm.export(tmp_path / "s", to=tmp_path / "a.zarr")
    mpm.export(tmp_path / "s", to=tmp_path / "a.zarr")  # over what is there
    with xarray.open_datatree(tmp_path / "a.zarr", engine="zarr") as back:
        for name in ("/", "series", "grid"):
            for variable, values in tree[name].to_dataset().data_vars.items():
                np.testing.assert_array_equal(back[name][variable].values, values.values)


@pytest.mark.parametrize("chunk", [1, 7, 10, 40])
def test_rows_are_the_same_whatever_chunks_they_lie_in(chunk, tmp_path):
    from mpm.opened import Shots

    shots, sizes = Shots.__new__(Shots), np.array([5, 8, 1, 12, 14])
    shots.near, ends = {}, np.cumsum(sizes)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        row = file.create_dataset("a", data=np.arange(40.0), chunks=(chunk,))
        for k in (0, 1, 2, 3, 4, 2, 0, 4):
            assert shots.read("a", row, int(ends[k] - sizes[k]), int(ends[k])).tolist() == list(range(ends[k] - sizes[k], ends[k]))


def test_snapshots_of_a_run_need_no_xarray(folder, tmp_path):
    """To import it takes longer than to write them."""
    code = f"import sys, mpm; mpm.export({str(folder(2))!r}, to={str(tmp_path / 'a.vtkhdf')!r}); sys.exit('xarray' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0 and (tmp_path / "a.vtkhdf").exists()


def test_exports_do_without_matplotlib(tmp_path, monkeypatch):
    fake(tmp_path, monkeypatch)
    code = f"import sys, mpm; mpm.export({str(tmp_path / 's')!r}, to={str(tmp_path / 'a.csv')!r}); sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
