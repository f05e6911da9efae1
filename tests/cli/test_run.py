"""`mpm run` keeps a folder as `mpm sweep` does."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_runner as fake
import pytest
import xarray as xr

from mpm import compiling
from mpm.sweep import engine, lock

FAKES = str(Path(__file__).parents[1] / "fakes")
CODE = f"import sys; sys.path.insert(0, {FAKES!r}); from mpm.sweep import engine; engine.RUNNER = 'fake_runner'; from mpm_cli.main import main; "
CODE += "sys.exit(main(sys.argv[1:]))"
TWO = """\
title: two bodies side by side

grid: {dimension: 1, size: [24 mm], cell: 1 mm}
bodies:
  a: {shape: {box: {lower: [0], upper: [8 mm]}}, material: m, temperature: 300}
  b: {shape: {box: {lower: [8 mm], upper: [16 mm]}}, material: m, temperature: 350}
materials:
  m: {density: 1000, heat: {fourier: {kappa: 1, alpha: 200}}, elastic: {hencky: {E: 1 kPa, nu: 0.3}}}
time: {end: 0.05}
output: {every: 0.005, observables: [temperature.mean]}
method: {rigid: explicit}
"""
WHERE = ("-o", "out with space", "--set", "title=a b")


@pytest.fixture
def marks(tmp_path, monkeypatch):
    monkeypatch.setenv("FAKE_MARKS", str(tmp_path))
    return lambda what: [line.split()[1] for line in (tmp_path / "marks").read_text().splitlines() if line.split()[0] == what]


def stopped(folder, marks, blow, *arguments):
    """A command that is told to leave once it has run for a while: exit code, and what it said."""
    before = len(marks("from")) if (folder / "marks").exists() else 0
    process = subprocess.Popen([sys.executable, "-c", CODE, *arguments], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    end = time.monotonic() + 60
    while time.monotonic() < end and (not (folder / "marks").exists() or len(marks("from")) == before):
        time.sleep(0.05)
    time.sleep(0.3)
    process.send_signal(blow)
    return process.communicate(timeout=60)[0], process.returncode


def files(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file() and path.name != "lock"}


def test_finished_is_finished(mpm, write, marks, tmp_path):
    config = write([0.2, 0.5])
    first = mpm("run", config, "-o", "out")
    before = files(tmp_path / "out")
    code, out, err = mpm("run", config, "-o", "out")
    assert first[0] == code == 0 and err == "" and "it was there already" in out and marks("run") == ["0.2"] and files(tmp_path / "out") == before
    assert out.splitlines()[1:] == first[1].splitlines()[1:]  # the same numbers, from the file
    assert mpm.document("run", config, "-o", "out")["ran"] is False
    assert mpm("run", config, "-o", "out", "--set", "kappa=0.5")[0] == mpm("run", config, "-o", "out", "--rerun", "all")[0] == 0
    assert marks("run") == ["0.2", "0.5", "0.2"]
    with xr.open_dataset(tmp_path / "out" / "run.nc") as data:
        assert float(data.kappa) == 0.2


def test_damage_is_set_aside_and_the_dataset_made_again(mpm, write, marks, tmp_path):
    config, path = write([0.2]), tmp_path / "out" / "run.nc"
    mpm("run", config, "-o", "out")
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    code, out, _ = mpm("verify", "out")
    assert code == 1 and "the same `mpm run` makes run.nc again" in out and not path.exists() and not (tmp_path / "out" / "sweep.nc").exists()
    assert mpm("run", config, "-o", "out")[0] == 0 and len(path.read_bytes()) == len(whole) and marks("run") == ["0.2"]


def test_a_failed_point_is_finished_too(mpm, write, marks):
    config = write([fake.DIVERGES])
    assert mpm("run", config, "-o", "out")[0] == mpm("run", config, "-o", "out")[0] == 4 and marks("run") == ["17.0"]
    assert mpm("run", config, "-o", "out", "--rerun", "failed")[0] == 4 and marks("run") == ["17.0", "17.0"]


SCENES = {  # a valid config that no method here can run: (what is changed, where it is told)
    "moving": ("upper: [8 mm]", "upper: [12 mm]", "6:7: bodies.b.shape: bodies a and b overlap at the start"),
    "rigid": (", elastic: {hencky: {E: 1 kPa, nu: 0.3}}", "", "11:10: method.rigid: a and b touch and pass heat"),
    "method": ("{rigid: explicit}", "{transfer: {xpic: {order: 3}}}", "11:10: method.transfer: xpic does not know bodies that meet"),
}


@pytest.mark.parametrize("kind", SCENES)
def test_a_scene_that_no_method_runs_is_refused_before_anything_is_compiled_or_written(mpm, tmp_path, monkeypatch, kind):
    before, after, said = SCENES[kind]
    monkeypatch.setattr(engine, "RUNNER", "mpm.runner")
    monkeypatch.setattr(compiling, "begun", lambda: pytest.fail("compiled"))
    (tmp_path / "two.yaml").write_text(TWO.replace(before, after))
    code, out, err = mpm("run", "two.yaml", "-o", "out")
    assert code == 2 and out == "" and "two.yaml:" in err and said in err and [path.name for path in tmp_path.iterdir()] == ["two.yaml"]


def test_what_implicit_steps_counted_is_told_of_a_whole_run_only():
    """A run that was stopped has no numbers at its end: NaN."""
    from mpm_cli.run import implicit

    names = ("steps_rejected", "steps_failed", "newton_iterations", "newton_shifts", "wall_depth", "kinetic_over_work")
    assert implicit(7, dict.fromkeys(names, float("nan"))) == "" and implicit(7, {}) == ""
    assert "7 steps (0 more made again for their error, 0 cut), 0 iterations" in implicit(7, dict.fromkeys(names, 0.0))


def test_another_experiment_is_refused_and_changes_nothing(mpm, write, tmp_path):
    mpm("run", write([0.2]), "-o", "out")
    before = files(tmp_path / "out")
    code, out, err = mpm("run", write([0.2], end=20), "-o", "out")
    assert code == 2 and out == "" and "time.end: 10.0 -> 20.0" in err and files(tmp_path / "out") == before
    assert mpm("run", write([0.2], end=20), "-o", "out", "--rerun", "stale")[0] == 0


def test_run_and_sweep_share_points(mpm, write, marks, tmp_path):
    config = write([0.2, 0.5])
    mpm("run", config, "-o", "out", "--set", "kappa=0.5")
    code, out, _ = mpm("sweep", config, "-o", "out", "-j", "1")
    assert code == 0 and "2 points, 1 already there" in out
    said = (tmp_path / "out" / "experiment.json").read_bytes()
    mpm("run", config, "-o", "out")
    assert marks("run") == ["0.5", "0.2"] and (tmp_path / "out" / "experiment.json").read_bytes() == said


@pytest.mark.parametrize("blow, code", [(signal.SIGINT, 130), pytest.param(signal.SIGHUP, 143, marks=pytest.mark.wide)])
def test_a_stop_is_no_timeout_says_how_to_go_on_and_replaces_nothing_whole(mpm, write, marks, tmp_path, blow, code):
    config, out = write([fake.BRIEF]), tmp_path / "out with space"
    said, ended = stopped(tmp_path, marks, blow, "run", config, *WHERE)
    assert ended == code and f"to go on: mpm run {config} -o 'out with space' --set 'title=a b'" in said
    with xr.open_dataset(out / "run.nc") as data:
        assert data.status == 6 and data.error.item().startswith("pending: stopped at t = ")
    with xr.open_dataset(out / "run.nc", group="series") as data:
        assert data.time.size == 3
    again = mpm("run", config, *WHERE)
    assert again[0] == 0 and "the run goes on from what was saved at 20" in again[1] and int(marks("from")[-1]) > 0
    before = (out / "run.nc").read_bytes()
    said, ended = stopped(tmp_path, marks, blow, "run", config, *WHERE, "--rerun", "all")
    assert ended == code and said.splitlines()[-2].endswith("--set 'title=a b'") and (out / "run.nc").read_bytes() == before


def test_a_stopped_sweep_says_the_whole_command(write, marks, tmp_path):
    words = ["sweep", write([fake.BRIEF, 0.2]), *WHERE, "-j", "1", "--scheduler", "local", "--results", "shared", "--rerun=all"]
    said, ended = stopped(tmp_path, marks, signal.SIGTERM, *words)
    assert ended == 143 and f"to go on: mpm sweep {words[1]} -o 'out with space' --set 'title=a b' -j 1 --scheduler local --results shared\n" in said


def test_an_empty_folder_name_is_refused(mpm, write, tmp_path):
    config = write([0.2])
    for command in (["run", config, "-o", ""], ["sweep", config, "-o", ""], ["plan", config, "-o", ""], ["chart", config, "-o", " "], ["status", ""],
                    ["collect", "", "-o", "x"], ["plot", ".", "-o", ""], ["sweep", config, "--scheduler", ""]):  # fmt: skip
        code, out, err = mpm(*command)
        assert code == 2 and out == "" and "it is empty" in err
    assert [path.name for path in tmp_path.iterdir()] == ["slab.yaml"]


def test_a_finished_folder_that_cannot_be_written_is_verified_and_collected_elsewhere(mpm, write, tmp_path, monkeypatch):
    config = write([0.2, 0.5])
    mpm("sweep", config, "-o", "out", "-j", "1")
    before, real = files(tmp_path / "out"), os.open

    def read_only(path, flags, *more, **named):
        if flags & (os.O_WRONLY | os.O_RDWR) and "out" in Path(path).parts:
            raise OSError(errno.EROFS, "Read-only file system", str(path))
        return real(path, flags, *more, **named)

    monkeypatch.setattr(os, "open", read_only)
    code, out, _ = mpm("verify", "out")
    assert code == 0 and "it is only looked at" in out and "all as they were written" in out
    code, out, _ = mpm("collect", "out", "-o", "elsewhere")
    assert code == 0 and str(Path("elsewhere/sweep.nc")) in out and mpm("compare", "out", "elsewhere")[0] == 0
    assert mpm("collect", "out", "-o", "elsewhere/mine.nc")[0] == 0 and mpm("status", "out")[0] == 0
    code, _, err = mpm("sweep", config, "-o", "out", "-j", "1")
    assert code == 1 and err == "error: out: Read-only file system; choose another folder with --out\n"
    victim = next((tmp_path / "out").glob("points/*/*.nc"))
    victim.write_bytes(victim.read_bytes()[:-1])
    assert mpm("verify", "out")[0] == 1 and victim.exists() and {*files(tmp_path / "out")} == {*before}
    monkeypatch.undo()
    with lock.Lock(tmp_path / "out"):
        monkeypatch.setattr(os, "open", read_only)
        with pytest.raises(lock.Refused, match="in use by process"), lock.lock_where_possible(tmp_path / "out"):
            pass
