"""`mpm new` and `mpm docs`: what they write loads from where it lies, names no file that is not there, and overwrites nothing."""

import itertools
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from mpm_cli.main import main

import mpm
from mpm.config.cautions import cautions
from mpm.starting.bare import DIMENSIONS, PHYSICS, bare, whole
from mpm.starting.scenes import names, scenes

ROOT = Path(__file__).parents[2]
BARE = sorted({(dimension, tuple(whole(list(some)))) for dimension in DIMENSIONS for r in (1, 2, 3, 4) for some in itertools.combinations(PHYSICS, r)})


@pytest.mark.parametrize("name", names())
def test_a_scene_stands_alone(name, tmp_path, capsys):
    """The copy is the same experiment as the shipped file: same run id, same points; all it reads lies beside it."""
    assert main(["new", name, "-o", str(tmp_path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert sorted(map(Path, told["files"])) == sorted(tmp_path.iterdir())
    copied, shipped = mpm.load(tmp_path / f"{name}.yaml"), mpm.load(next(ROOT.glob(f"configs/[sv]*/{name}.yaml")))
    assert copied.run_id == shipped.run_id and copied.sweep == shipped.sweep and copied.fit == shipped.fit
    assert "../" not in (tmp_path / f"{name}.yaml").read_text(encoding="utf-8")


def test_the_menu_names_every_scene(capsys):
    assert main(["new"]) == 0
    said = capsys.readouterr().out
    assert set(re.findall(r"^  (\w+)", said, re.MULTILINE)) == {*scenes(), "bare"}
    assert len(scenes()) == len(list((ROOT / "configs/scenes").glob("*.yaml")))


def test_what_comes_next_is_what_the_config_is_for(tmp_path, capsys):
    for name, command in {"loaf": "sweep", "loaf_fit": "fit", "dough_creep": "run"}.items():
        main(["new", name, "-o", str(tmp_path)])
        assert f"next: mpm {command} {tmp_path / name}.yaml" in capsys.readouterr().out


def test_nothing_is_overwritten_unless_told(tmp_path, capsys):
    (tmp_path / "zhang-datta-2006.csv").write_text("mine")
    assert main(["new", "loaf", "-o", str(tmp_path)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["zhang-datta-2006.csv"] and (tmp_path / "zhang-datta-2006.csv").read_text() == "mine"
    assert main(["new", "loaf", "-o", str(tmp_path), "--force"]) == 0
    assert main(["new", "loaf", "-o", str(tmp_path)]) == 0  # the same again is nothing new
    assert mpm.load(tmp_path / "loaf.yaml")


REFUSED = [
    (["lof"], "did you mean 'loaf'"),
    (["bare", "--physics", "heat,magic"], "'magic'"),
    (["--dimension", "4"], "'4'"),
    (["loaf", "--dimension", "2"], "bare config"),
]


@pytest.mark.parametrize("said, answer", REFUSED)
def test_refusals(said, answer, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", *said]) == 2 and answer in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("dimension, physics", BARE, ids=lambda value: value if isinstance(value, str) else "+".join(value))
def test_a_bare_config_loads_without_a_word(dimension, physics, tmp_path):
    (tmp_path / "bare.yaml").write_text(bare(dimension, list(physics)))
    experiment = mpm.load(tmp_path / "bare.yaml")
    assert mpm.load(tmp_path / "bare.yaml", smoke=True) and not list(cautions(experiment))
    material = experiment.materials["dough"]
    assert {name for name in PHYSICS if getattr(material, name) is not None} == set(physics)
    assert str(experiment.grid.dimension) == dimension and len(mpm.plan(experiment).cases) > 1


@pytest.mark.slow
@pytest.mark.parametrize("physics", [["heat"], ["elastic"], ["heat", "flow", "expansion"]], ids="+".join)
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_a_bare_config_runs_without_warnings(dimension, physics, tmp_path):
    (tmp_path / "bare.yaml").write_text(bare(dimension, physics))
    run = mpm.run_point(mpm.plan(mpm.load(tmp_path / "bare.yaml")).cases[0].experiment)
    assert run.outcome.ok and not run.facts.get("warnings")


def test_docs_are_where_they_are_said_to_be(capsys):
    assert main(["docs", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert Path(told["scenes"], "loaf.yaml").is_file() and Path(told["schema"]).is_file()
    for page in told["pages"]:
        assert main(["docs", page]) == 0
        assert capsys.readouterr().out == (Path(told["docs"]) / f"{page}.md").read_text(encoding="utf-8").rstrip() + "\n"
    assert main(["docs", "nowhere"]) == 2


@pytest.mark.slow
def test_from_a_wheel_with_no_checkout(tmp_path):
    """A wheel in an empty environment and an empty home, far from the checkout: a scene, its sweep, and the docs."""
    wheels, home, work = tmp_path / "wheels", tmp_path / "home", tmp_path / "work"
    home.mkdir()
    work.mkdir()
    python = tmp_path / "venv/bin/python"
    clean = {"PATH": "/usr/bin:/bin", "HOME": str(home), "TERM": "dumb", "LANG": "C.UTF-8"} | {k: v for k, v in os.environ.items() if k.startswith("PIP_")}
    subprocess.run([sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", wheels, ROOT], check=True, timeout=300)
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True, timeout=120)
    subprocess.run([python, "-m", "pip", "install", "-q", next(wheels.glob("mpm-*.whl"))], check=True, timeout=500, env=clean)

    def run(command):
        done = subprocess.run(command, shell=True, cwd=work, env=clean, capture_output=True, text=True, timeout=500, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    for command in ("{0} new loaf && {0} sweep loaf.yaml -q", "{0} docs physics", "{0} new loaf_fit && {0} plan loaf_fit.yaml"):
        run(command.format(python.parent / "mpm"))
    read = "d = xr.open_dataset('results/loaf/sweep.nc'); assert d.status.shape == (3, 6) and (d.status == 0).all()"
    assert str(tmp_path) in run(f'{python} -c "import mpm, xarray as xr; {read}; print(mpm.__file__)"')
