import json
import subprocess
import sys

import pytest

import mpm
from mpm.sweep.api import default_out
from mpm.sweep.queue import EXIT, exit_code


def test_python_gives_the_same_as_the_shell(config, tmp_path, monkeypatch):
    monkeypatch.setattr("mpm.sweep.engine.RUNNER", "fake_runner")
    experiment = mpm.load(config([0.2, 0.5]), {"time.end": 5})
    one = mpm.run(experiment)
    assert one.temperature_mean.item() == 300.2 and one["series"].time[-1] == 5
    tree = mpm.sweep(experiment, out=tmp_path / "out", jobs=1)
    assert tree.temperature_mean.sel(kappa=0.5).item() == 300.5 and list(tree.children) == ["series", "grid", "particles"]
    tree["series"].temperature_centre.sel(kappa=0.4, method="nearest")
    assert mpm.sweep(experiment, out=tmp_path / "out").identical(tree)
    (tmp_path / "a.yaml").write_text(json.dumps(config([0.2, 0.5])))
    assert mpm.run(config([0.2, 0.5])).temperature_mean.item() == mpm.run(tmp_path / "a.yaml").temperature_mean.item() == 300.2  # a dict, a file
    with pytest.raises(mpm.ConfigError, match="unknown key 'gird'"):
        mpm.run({"gird": {}})


def test_sweep_is_a_function_and_a_package():
    code = "import mpm, mpm.sweep.cases; assert callable(mpm.sweep) and mpm.sweep.cases.plan; from mpm import sweep; assert callable(sweep)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_importing_mpm_is_light():
    code = "import sys, mpm; print(sorted({'numba', 'numpy', 'xarray', 'pydantic'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "[]\n"


def test_default_out(config):
    assert str(default_out(mpm.load(config([1.0])))) == "results/experiment"


ENDS = [
    (3, 0, 0, "", 0),
    (2, 1, 0, "", 3),
    (0, 3, 0, "", 4),
    (0, 1, 2, "failures", 3),
    (1, 0, 2, "broken", 1),
    (3, 0, 0, "interrupted", 130),
    (0, 0, 3, "terminated", 143),
    (2, 1, 1, "budget", 75),
    (0, 0, 0, "", 0),
]


@pytest.mark.parametrize("ok, bad, pending, stopped, code", ENDS)
def test_exit_codes(ok, bad, pending, stopped, code):
    found = {"ok": ok, "failed": 0, "timeout": 0, "killed": 0, "diverged": bad, "skipped": 0, "pending": pending}
    assert exit_code(found, stopped) == code
    assert set(EXIT.values()) == {130, 143, 75}
