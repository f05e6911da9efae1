"""Small datasets of every shape that figures meet."""

import json

import numpy as np
import pytest
import xarray as xr

from mpm.records.variables import describe

PARAMETERS = {
    "kappa": ("W/m/K", "heat conductivity", "materials.dough.heat.fourier.kappa"),
    "beta": ("W/m2/K", "heat-transfer coefficient; .inf fixes the temperature of the surface", "surfaces.0.convection.beta"),
    "pan_convection_beta": ("W/m2/K", "heat-transfer coefficient; may change over time", "surfaces.pan.convection.beta"),
    "air_convection_beta": ("W/m2/K", "heat-transfer coefficient; may change over time", "surfaces.air.convection.beta"),
    "eta": ("Pa*s", "viscosity of the overstress", "materials.dough.flow.ellipse.eta"),
    "cell": ("m", "edge of a cell", "grid.cell"),
    "transfer": ("1", "transfer of velocity", "method.transfer"),
}
DIVERGED = "diverged: det F <= 0 at particle 812, t = 0.0134 s, step 2680"


def described(name, dims, values):
    row = describe(name)
    return dims, values, {"units": row.units, "long_name": row.long_name}


@pytest.fixture
def tree():
    """Make a tree: axes by name (or `sample=True`), finals and series by name; a point that is not ok is NaN."""

    def make(axes=None, finals=None, series=None, status=None, error=None, sample=False, config=None, time=None, measured=None, title="A title"):
        axes = axes or {}
        dims = ["sample"] if sample else list(axes)
        shape = [len(next(iter(axes.values())))] if sample else [len(values) for values in axes.values()]
        coords = {}
        for name, values in axes.items():
            units, long_name, path = PARAMETERS[name]
            coords[name] = ("sample" if sample else name, np.asarray(values), {"units": units, "long_name": long_name, "config_path": path})
        status = np.zeros(shape, np.int8) if status is None else np.asarray(status, np.int8)
        error = np.full(shape, "", dtype=object) if error is None else np.asarray(error, dtype=object)
        data = {"status": described("status", dims, status), "error": described("error", dims, error)}
        for name, values in (finals or {}).items():
            data[name] = described(name, dims, np.where(status == 0, values, np.nan))
        nodes = {"/": xr.Dataset(data, coords, {"title": title, "smoke": "false", "config_resolved": json.dumps(config or {})})}
        if series:
            time = np.linspace(0, 100, next(iter(series.values())).shape[-1]) if time is None else time
            group = {name: described(name, [*dims, "time"], values) for name, values in series.items()}
            group |= {name: described(name, (dim,), values) for name, (dim, values) in (measured or {}).items() if name != dim}
            times = {dim: (dim, np.linspace(10, 90, len(values)), {"units": "s"}) for dim, values in (measured or {}).values()}
            nodes["/series"] = xr.Dataset(group, {"time": described("time", ("time",), time)} | times)
        return xr.DataTree.from_dict(nodes)

    return make


@pytest.fixture
def loaf(tree):
    """Two axes, a time to a threshold, two probes, measured curves; two points diverged, one pending, one that never gets there."""
    kappa, beta = np.array([0.2, 0.35, 0.5]), np.geomspace(5, 50, 4)
    k, b = np.meshgrid(kappa, beta, indexing="ij")
    reached = 40 + 100 / (k * b)
    reached[0, 0] = np.nan
    status, error = np.zeros(k.shape, np.int8), np.full(k.shape, "", dtype=object)
    status[2, 3] = status[1, 3] = 4
    error[2, 3], error[1, 3] = DIVERGED, DIVERGED.replace("812", "7")
    status[0, 2] = 6
    time = np.linspace(0, 100, 21)
    warm = 300 + 80 * (1 - np.exp(-time * (k * b)[..., None] / 100))
    warm[2, 3, 9:] = np.nan
    config = {"output": {"probes": {"centre": [0], "crust": [1]}, "observables": ["time_to.centre.95_degC"]}}
    return tree(
        {"kappa": kappa, "beta": beta},
        {"time_to_centre_95_degC": reached, "misfit_centre": np.abs(k - 0.35) + np.abs(b - beta[1])},
        {"temperature_centre": warm, "temperature_crust": warm + 5},
        status,
        error,
        config=config,
        time=time,
        measured={"measured_temperature_centre": ("measured_time_centre", np.array([310.0, 330, 350]))},
    )
