"""What pyproject.toml says to need is enough: fresh environments of exactly the least versions, and of the newest on other Pythons, run the smoke sweeps.

Slow: each environment is some 600 MB of packages, and compiles for itself.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LEAST = re.compile(r"([\w.-]+)>=([\d.]+)")
LOOK = """
import sys
import xarray as xr
for name in ("smoke", "loaf", "dask"):
    with xr.open_datatree(f"{sys.argv[1]}/{name}/sweep.nc", engine="h5netcdf", chunks={}) as tree:
        assert (tree.status == 0).all() and tree["series"].to_dataset().chunks, tree.error.values
    assert "kappa" in xr.open_dataset(f"{sys.argv[1]}/{name}/sweep.nc", group="series", engine="h5netcdf").coords
print("read")
"""


EXTRAS = ("cluster", "posterior", "sensitivity", "mp4", "usd", "parquet")  # zarr has a least xarray of its own


def wanted(extras=EXTRAS):
    """Requirements, those of the extras too."""
    return [*PROJECT["dependencies"], *(one for extra in extras for one in PROJECT["optional-dependencies"][extra])]


def interpreter(version):
    """A Python of this version, if there is one."""
    here = sys.executable if f"{sys.version_info[0]}.{sys.version_info[1]}" == version else shutil.which(f"python{version}")
    kept = sorted((Path.home() / ".pyenv" / "versions").glob(f"{version}.*/bin/python"))
    return here or (str(kept[-1]) if kept else None)


def test_every_requirement_has_a_least_version():
    assert all(LEAST.fullmatch(one) for one in wanted((*EXTRAS, "zarr")))
    least = dict(LEAST.fullmatch(one).groups() for one in wanted())
    assert least["typer"] == "0.19" and least["pint"] == "0.24.4"  # the first that work


@pytest.mark.slow
@pytest.mark.parametrize("version, exactly", [("3.11", True), ("3.12", False), ("3.13", False)])
def test_a_fresh_environment_runs_the_smoke_sweeps(tmp_path, version, exactly):
    if (python := interpreter(version)) is None:
        pytest.skip(f"there is no Python {version} here")
    needs = [one.replace(">=", "==") if exactly else one for one in wanted()]
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")} | {"MPM_CACHE_DIR": str(tmp_path / "cache")}

    def run(*command, folder=tmp_path):
        done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    (tmp_path / "source").mkdir()
    for name in ("pyproject.toml", "README.md", "mpm", "cli"):  # a build leaves files beside its source
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, tmp_path / "source" / name)
    run(python, "-m", "venv", tmp_path / "venv")
    run(tmp_path / "venv/bin/python", "-m", "pip", "install", "-q", tmp_path / "source", *needs)
    mpm = tmp_path / "venv/bin/mpm"
    run(mpm, "sweep", ROOT / "configs/smoke.yaml", "-o", "smoke")
    run(mpm, "sweep", ROOT / "configs/scenes/loaf.yaml", "--smoke", "-o", "loaf")
    run(mpm, "sweep", ROOT / "configs/scenes/loaf.yaml", "--smoke", "-o", "dask", "--scheduler", "local")
    assert run(mpm, "compare", "loaf", "dask") == "same\n"
    run(mpm, "export", "loaf", "--to", "loaf.parquet")
    run(mpm, "fit", ROOT / "configs/scenes/loaf_fit.yaml", "--smoke", "--posterior", "60", "-o", "fit")
    run(tmp_path / "venv/bin/python", "-c", "import SALib.analyze.rbd_fast, av; from pxr import Usd")
    assert run(tmp_path / "venv/bin/python", "-c", LOOK, tmp_path) == "read\n"
