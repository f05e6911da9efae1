"""mpm fit as a user meets it: exit codes, files, the same command again, a budget, what is wrong."""

import json
from types import SimpleNamespace

import pytest
import xarray as xr

from mpm.plots.fit import draw

SCENE = """\
grid: {dimension: 1, size: [0.05], cell: 0.004}
bodies: {slab: {shape: {box: {lower: [0.005], upper: [0.045]}}, temperature: 298.15, material: dough}}
materials: {dough: {density: 500, heat: {fourier: {kappa: 0.3, alpha: 2800}}}}
surfaces: [{of: slab, convection: {beta: 15, outside: 473.15}}]
time: {end: 1200}
output:
  every: 60
  probes: {centre: [0.025], face: [0.044]}
  measured:
    centre: {samples: [[300, 308.1], [600, 330.7], [900, 351.4], [1200, 369.3]], sigma: 0.5 K}
    face: {samples: [[300, 360.5], [600, 378.1], [900, 391.8], [1200, 403.6]], sigma: 0.5 K}
fit: {parameters: {kappa: {log: [0.1, 1]}, beta: {log: [5, 60]}}}
"""


@pytest.fixture
def mpm(capsys):
    """Run a command in this process, with the real runner."""

    def run(*arguments):
        from mpm_cli.main import main

        code, told = main([str(argument) for argument in arguments]), capsys.readouterr()
        return SimpleNamespace(returncode=code, stdout=told.out, stderr=told.err)

    return run


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "slab.yaml").write_text(SCENE)
    return tmp_path / "slab.yaml"


def test_it_answers_writes_and_does_nothing_twice(mpm, scene, tmp_path):
    done = mpm("fit", scene, "-o", tmp_path / "out", "-j", "1", "--json", "--hold-out", "face")
    found = json.loads(done.stdout)
    assert done.returncode == found["exit_code"] == 0
    assert found["parameters"]["kappa"]["units"] == "W/m/K"
    assert any("face, held out" in text for text in found["sentences"])
    tree = xr.open_datatree(tmp_path / "out" / "fit.nc")
    assert {"best", "covariance", "correlation", "interval", "misfit"} <= set(tree.data_vars)
    assert tree["evaluations"].sizes["point"] == found["points"] == found["ran"]
    assert (tmp_path / "out" / "fit.png").stat().st_size > 10_000
    assert_an_open_band_is_told_and_not_drawn(tree.load())
    again = json.loads(mpm("fit", scene, "-o", tmp_path / "out", "-j", "1", "--json", "--hold-out", "face").stdout)
    assert again["ran"] == 0 and again["parameters"] == found["parameters"]


def assert_an_open_band_is_told_and_not_drawn(tree):
    """Where two points determine nothing a band of 1e7 K would leave of the curves a line."""
    tree["curves"] = tree["curves"].to_dataset().assign(band_centre=("time", [0.0] + 20 * [1e7]))
    panel = draw(tree).axes[0]
    low, high = panel.get_ylim()
    assert 0 < low < high < 150
    told = [text.get_text() for text in panel.get_legend().get_texts()]
    assert [text.endswith("; the data leave its band open") for text in told] == [True, False]


def test_a_budget_stops_it_and_the_same_command_goes_on(mpm, scene, tmp_path):
    done = mpm("fit", scene, "-o", tmp_path / "out", "-j", "1", "--time-budget", "0.1s", "--json")
    assert done.returncode == 75 and "to go on: mpm fit" in done.stderr
    assert json.loads(done.stdout)["stopped"] == "budget"
    assert mpm("fit", scene, "-o", tmp_path / "out", "-j", "1").returncode == 0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("fit: {parameters", "chart: {methods: {}} #", "the config has no `fit:` section"),
        ("kappa: {log: [0.1, 1]}", "kapa: [0.1, 1]", "fit.parameters.kapa"),
        ("kappa: {log: [0.1, 1]}", "kappa: [1, 0.1]", "the range must rise"),
        (", sigma: 0.5 K}\nfit", "}\nfit", "some of the curves have a sigma, and some have none"),
    ],
)
def test_what_is_wrong_is_told(mpm, scene, tmp_path, old, new, words):
    scene.write_text(SCENE.replace(old, new))
    done = mpm("fit", scene, "-o", tmp_path / "out")
    assert done.returncode == 2 and words in done.stderr and not (tmp_path / "out").exists()
