"""Stills of snapshots: fields on the grid and particles, at the times and of the point that a user asks for."""

import numpy as np
import pytest
import xarray as xr

from mpm.movies import still
from mpm.plots import UnknownFigure, figures


def test_snapshots_of_the_grid(tree, tmp_path):
    root = tree({}, {"temperature_mean": 300.0}, config={"grid": {"dimension": 2}})
    y, x = np.linspace(0, 0.02, 5), np.linspace(0, 0.01, 4)
    field = 300 + np.arange(3)[:, None, None] + np.zeros((3, 5, 4))
    field[:, 0, 0] = np.nan
    attrs = {"units": "K", "long_name": "temperature"}
    root["grid"] = xr.Dataset({"temperature": (("snapshot", "y", "x"), field, attrs)}, {"snapshot": [0.0, 1, 2], "y": y, "x": x})
    root.to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    fig = still(tmp_path)
    assert [ax.get_title() for ax in fig.axes[:3]] == ["t = 0 s", "t = 1 s", "t = 2 s"]
    assert (fig.axes[0].get_xlabel(), fig.axes[0].get_ylabel(), fig.axes[3].get_ylabel()) == ("x [mm]", "y [mm]", "Temperature [°C]")
    assert figures(tmp_path) == [tmp_path / "overview.png"]
    with pytest.raises(UnknownFigure, match="there is no figure 'snapshot'"):
        figures(tmp_path, "snapshot")


def test_snapshots_of_particles(tree, tmp_path):
    root = tree({"kappa": [0.1, 0.2]}, {"temperature_mean": [300.0, 301.0]}, status=[4, 0], config={"grid": {"dimension": 2}})
    position = np.random.default_rng(0).random((30, 2))
    rows = {"position": (("obs", "direction"), position), "J": ("obs", np.arange(30.0), {"units": "1", "long_name": "volume ratio det F"})}
    rows |= {"row_size": (("kappa", "snapshot"), [[10, 0], [10, 10]]), "row_start": (("kappa", "snapshot"), [[0, 10], [10, 20]])}
    root["particles"] = xr.Dataset(rows, {"snapshot": [0.0, 1.0]})
    root.to_netcdf(tmp_path / "sweep.nc", engine="h5netcdf")
    fig = still(tmp_path)
    np.testing.assert_allclose(fig.axes[1].collections[0].get_offsets(), position[20:])
    assert "κ = 0.2 W/m/K" in fig.get_suptitle()
