import json
import sys
import types
from pathlib import Path

import pytest

from mpm.sweep import apart, engine

FAKES = str(Path(__file__).parents[1] / "fakes")
if FAKES not in sys.path:
    sys.path.insert(0, FAKES)

CONFIG = """\
title: A slab for the fake runner
grid: {{dimension: 1, size: [0.1], cell: 1e-3}}
bodies:
  slab: {{shape: {{box: {{lower: [0], upper: [0.05]}}}}, material: m, temperature: 300}}
materials:
  m: {{density: 1000, heat: {{fourier: {{kappa: 1.0, alpha: 1000}}}}}}
time: {{end: {end}}}
output: {{every: 1, probes: {{centre: [0.01]}}}}
sweep:
  axes: {{kappa: {kappas}}}
smoke: {{time.end: 2}}
"""


@pytest.fixture
def write(tmp_path):
    """Write a config for the fake runner; its path."""

    def make(kappas, end=10, name="slab"):
        path = tmp_path / f"{name}.yaml"
        path.write_text(CONFIG.format(kappas=list(kappas), end=end))
        return str(path)

    return make


@pytest.fixture
def mpm(tmp_path, monkeypatch, capsys):
    """Run a command in this process with the fake runner and a figure that is one byte: exit code, stdout, stderr."""
    import fake_plots

    plots = types.ModuleType("mpm.plots")
    plots.__path__ = [str(Path(__file__).parents[2] / "mpm" / "plots")]
    plots.KINDS, plots.UnknownFigure = ("overview", "series", "finals"), ValueError
    plots.overview = lambda tree, path: path.write_bytes(b"p")
    plots.figures = lambda out, names, path, svg: [Path(path or out / f"{name}.{'svg' if svg else 'png'}") for name in names or ["overview"]]
    monkeypatch.setitem(sys.modules, "mpm.plots", plots)
    monkeypatch.setattr(apart, "apart", lambda code, *words: fake_plots.here(*words))
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")

    def run(*arguments):
        from mpm_cli.main import main

        code = main([str(argument) for argument in arguments])
        told = capsys.readouterr()
        return code, told.out, told.err

    run.document = lambda *arguments: json.loads(run(*arguments, "--json")[1])
    return run
