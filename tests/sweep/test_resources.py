import os
from collections import namedtuple
from pathlib import Path

import pytest

from mpm.config import load
from mpm.costs import count_particles, memory, memory_at_most
from mpm.sweep import resources
from mpm.sweep.api import execute, tree_of
from mpm.sweep.engine import Options
from mpm.sweep.resources import Resources, available, resident

ROOT = Path(__file__).parents[2]
CUBE = {
    "grid": {"dimension": 3, "size": [0.1, 0.1, 0.1], "cell": 0.01},
    "bodies": {"ball": {"shape": {"ball": {"centre": [0.05, 0.05, 0.05], "radius": 0.03}}, "material": "m", "temperature": 300}},
    "materials": {"m": {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}}},
    "time": {"end": 1e-4},
}


def go(config, out, jobs=0, reporter=None, **more):
    return execute(load(config), out, Options(jobs=jobs, runner="fake_runner", **more), reporter)


def test_what_needs_more_than_is_allowed_is_refused_with_its_estimate_and_runs_when_allowed(config, tmp_path, marks):
    material = {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}
    points = config([0.2, 0.5]) | {"materials": {"m": material}, "sweep": {"axes": {"cell": [1e-3, 1e-8]}}}
    result = go(points, tmp_path, memory=1e9)
    found = tree_of(tmp_path / "sweep.nc")
    assert found.status.values.tolist() == [0, 1] and result.exit_code == 3 and len(marks()) == 1
    assert "failed: needs about" in found.error.values[1] and "and 1 GB are allowed (--memory)" in found.error.values[1]
    assert "--rerun failed" in result.lines[found.run_id.values[1]]["advice"]
    assert go(points, tmp_path, memory=1e9).ran == 0


@pytest.mark.parametrize(("current", "free"), [(60.0, 40.0), (None, 100.0)])
def test_what_a_control_group_allows_is_less_what_it_uses(monkeypatch, current, free):
    monkeypatch.setattr(resources, "read", lambda path: {"memory.max": 100.0, "memory.current": current}[path.name])
    assert available() == free


def test_points_wait_for_memory_that_others_have(tmp_path):
    there = Resources(tmp_path, None, far=False)
    there.free = there.limit = 10.0
    assert there.fits(11) and there.refusal(11) and not there.refusal(10)
    there.given["a"] = 6
    assert there.fits(4) and not there.fits(5)


def test_a_full_disk_stops_before_it_is_full_and_goes_on(config, tmp_path, marks, monkeypatch):
    state, told = {"free": 10**9}, []
    Disk = namedtuple("Disk", "f_bavail f_frsize")
    monkeypatch.setattr(resources.os, "statvfs", lambda folder: Disk(state["free"], 1))

    class Fills(fake_reporter()):
        def finished(self, label, line, again):
            state["free"] = 1000

        def note(self, text):
            told.append(text)

    points = config([0.2, 0.5, 1.0])
    result = go(points, tmp_path, reporter=Fills())
    assert result.exit_code == 1 and result.ran == 1 and f"{tmp_path}: " in result.stopped and "1000 bytes are free" in result.stopped and told
    state["free"] = 10**9
    assert go(points, tmp_path).exit_code == 0 and len(marks()) == 3


def fake_reporter():
    from mpm.sweep.report import Reporter

    return Reporter


def test_a_sweep_that_may_not_fit_is_warned_of(config, tmp_path, monkeypatch):
    there = Resources(tmp_path, None, far=False)
    assert there.warning(10, load(config([0.2]))) == ""
    assert "may need up to" in there.warning(10**12, load(config([0.2]))) and "goes on where it was" in there.warning(10**12, load(config([0.2])))


def test_memory_of_this_machine_and_process():
    assert 1e8 < available() < 1e14 and 1e7 < resident(os.getpid()) < 1e11 and resident(2**22 - 1) == 0


@pytest.mark.parametrize("shape, volume", [({"box": {"lower": [0.02] * 3, "upper": [0.08] * 3}}, 0.06**3), (None, 4 / 3 * 3.14159 * 0.03**3)])
def test_particles_are_counted_about(shape, volume):
    config = CUBE if shape is None else CUBE | {"bodies": {"ball": CUBE["bodies"]["ball"] | {"shape": shape}}}
    for cell in (0.01, 0.0025):
        experiment = load(config, {"grid.cell": cell})
        count = count_particles(experiment)
        rim = 0.0 if shape else 60 * cell / 2  # cells that a ball's surface cuts
        assert volume * (1 - 1e-9) <= count * (cell / 2) ** 3 <= volume * (1 + 1e-9 + rim)
        assert memory(experiment) <= memory_at_most(experiment)


def test_the_dataset_that_will_be_written_anew_counts_as_wanted(tmp_path, monkeypatch):
    experiment = load(CUBE)
    (tmp_path / "sweep.nc").write_bytes(b"0" * 5000)
    needed = resources.SPARE + 3 * resources.output(experiment) + 5000
    for free, fits in ((needed, True), (needed - 1, False)):
        monkeypatch.setattr(resources, "free_disk", lambda folder, free=free: free)
        assert (Resources(tmp_path, None, far=False).short(3, experiment) == "") == fits
