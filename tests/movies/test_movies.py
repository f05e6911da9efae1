"""Movies and stills: as many frames as asked, that differ, in every format; the field, the points and the walls that were asked for."""

import dataclasses

import fake_runner
import numpy as np
import pytest
from PIL import Image

import mpm
from mpm.movies import MovieError, still
from mpm.movies.stage import flat
from mpm.opened import UnknownPoint
from mpm.sweep import engine
from mpm.sweep.alone import run_in

SHOTS = {"every": 0.1, "particles": ["position", "temperature", "velocity"]}


@pytest.fixture
def run(core, tmp_path):
    run_in(core.experiment(1, {"bodies.body.velocity": [0.5]}, output={"every": 0.1, "snapshots": SHOTS}), tmp_path / "r", lambda *_: False, print)
    return tmp_path / "r"


@pytest.fixture
def sweep(tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    mpm.sweep(mpm.load(fake_runner.slab({"kappa": [1.0, 2.0, 3.0]})), out=tmp_path / "s", jobs=0)
    return tmp_path / "s"


@pytest.mark.parametrize("suffix", ["webp", "gif"])
def test_a_movie_has_the_frames_that_were_asked_for(run, tmp_path, suffix):
    told = []
    path = mpm.movie(run, to=tmp_path / f"a.{suffix}", of="velocity", every=2, size=(320, 200), told=lambda *at: told.append(at))
    with Image.open(path) as image:
        assert image.size == (320, 200) and image.n_frames == 3
        seen = []
        for k in range(3):
            image.seek(k)
            seen.append(np.array(image.convert("RGB")))
    assert told == [(1, 3), (2, 3), (3, 3)] and not np.array_equal(seen[0], seen[2])


@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_speed_is_seconds_of_the_run_a_second(sweep, tmp_path, speed):
    path = mpm.movie(sweep, to=tmp_path / "a.gif", speed=40 * speed)  # a snapshot every 2 s
    with Image.open(path) as image:
        assert image.info["duration"] == pytest.approx(1000 * 2 / (40 * speed), abs=5)


def test_points_side_by_side_and_what_cannot_be_shown(run, sweep, tmp_path):
    assert mpm.movie(sweep, "kappa=all", tmp_path / "a.webp").exists()
    figure = still(sweep, ["kappa=1", "kappa=3"], tmp_path / "a.png", at=[0, 8])
    assert [ax.get_title() for ax in figure.axes[:4]] == [f"κ = {k} W/m/K, t = {t} s" for k in (1, 3) for t in (0, 8)]
    with pytest.raises(MovieError, match="there are temperature"):
        still(run, of="stress")
    with pytest.raises(MovieError, match=r"\.webp"):
        mpm.movie(run, to="a.avi")
    with pytest.raises(UnknownPoint):
        still(sweep, "kappa=9")


def test_snapshots_without_positions_are_no_picture(core, tmp_path):
    run_in(core.experiment(1, output={"every": 0.5, "snapshots": {"every": 0.5, "particles": ["mass"]}}), tmp_path / "m", lambda *_: False, print)
    with pytest.raises(MovieError, match="add position"):
        still(tmp_path / "m")
    run_in(core.experiment(1, output={"every": 0.5}), tmp_path / "n", lambda *_: False, print)
    with pytest.raises(UnknownPoint, match="no snapshots"):
        still(tmp_path / "n")


def test_near_particles_are_in_front_and_what_is_above_is_above():
    places = flat(np.array([[0, 0, 0], [0, 1, 0], [0, 0, 1.0]]), 3)
    assert places[0, 2] > places[1, 2] and places[2, 1] > places[0, 1]  # the eye stands at negative y, and above


@pytest.mark.slow
def test_mp4(run, tmp_path):
    av = pytest.importorskip("av", reason="PyAV is not installed")
    path = mpm.movie(run, to=tmp_path / "a.mp4", size=(321, 200))
    with av.open(str(path)) as container:
        frames = list(container.decode(video=0))
    assert len(frames) == 6 and (frames[0].width, frames[0].height) == (320, 200)


def test_tools_are_drawn_where_they_stand_and_leave(tmp_path, monkeypatch):
    from mpm.outcome import Outcome, Run

    def run_point(experiment, beat=None, keeper=None):
        times, x = np.array([0.0, 0.5, 1.0]), np.array([[0.03, 0.01], [0.05, 0.02]], np.float32)
        run = Run(Outcome("completed"), times, {}, {}, steps=1, wall_time=0.01, facts={})
        run.snapshot_times = times
        run.particles = [{"position": x, "stress_mises": x[:, 0], "body": np.zeros(2, np.int32), "id": np.arange(2, dtype=np.int32)} for _ in times]
        return run

    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    monkeypatch.setattr(fake_runner, "run_point", run_point)
    press = {"shape": {"box": {"lower": [0.02, 0.03], "upper": [0.06, 0.04]}}, "motion": {"velocity": [0, -0.01]}, "until": 0.9}
    config = {
        "grid": {"dimension": 2, "size": [0.1, 0.1], "cell": 0.005},
        "bodies": {"b": {"shape": {"box": {"lower": [0.02, 0], "upper": [0.06, 0.025]}}, "material": "m"}},
        "materials": {"m": {"density": 1000, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}}},
        "tools": {"press": press},
        "time": {"end": 1},
        "output": {"every": 0.5, "snapshots": {"every": 0.5, "particles": ["position", "stress_mises"]}},
    }
    run_in(mpm.load(config), tmp_path / "p", lambda *_: False, print)
    panels = still(tmp_path / "p", at=[0, 0.5, 1.0]).axes[:3]
    loops = [[line for line in ax.lines if len(line.get_xdata()) == 5] for ax in panels]
    assert [len(found) for found in loops] == [1, 1, 0]
    lower = [found[0].get_ydata().min() for found in loops[:2]]
    assert lower == pytest.approx([30, 25])  # mm


def test_points_with_grids_of_their_own_side_by_side(tmp_path, monkeypatch):
    """Two handmade points: on 11 nodes and on 6."""
    before = fake_runner.run_point

    def run_point(experiment, beat=None, keeper=None):
        record, nodes = before(experiment, beat, keeper), round(0.05 / experiment.grid.cell) + 1
        snapshots = len(record.snapshot_times)
        return dataclasses.replace(record, axes={"x": np.linspace(0, 0.05, nodes)}, grid={"temperature": np.full((snapshots, nodes), 300.0, np.float32)})

    monkeypatch.setattr(fake_runner, "run_point", run_point)
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    mpm.sweep(mpm.load(fake_runner.slab({"grid.cell": [0.005, 0.01]})), out=tmp_path / "s", jobs=0)
    figure = still(tmp_path / "s", ["cell=all"], of="temperature", at=[0])
    assert [len(ax.collections[0].get_offsets()) for ax in figure.axes[:2]] == [11, 6]


def test_a_wall_that_is_near_belongs_to_the_picture():
    from mpm.movies.stage import with_walls

    box = np.array([[8.5, 0.5], [15.5, 7.5]])
    assert with_walls(box, {"grid": {"size": [24, 12]}}, False).tolist() == [[8.5, 0.0], [15.5, 7.5]]
    assert with_walls(np.array([[-7.0, 0.5], [7.0, 7.5]]), {"grid": {"size": [7.2, 12]}}, True).tolist() == [[-7.2, 0.0], [7.2, 7.5]]
    assert with_walls(box, {"grid": {"size": [24, 12, 9]}}, False) is box and with_walls(box, {}, False) is box


def test_no_colour_is_lost_on_white_paper():
    from mpm.movies.stage import COLOURS

    linear = [np.where(c <= 0.03928, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) for c in COLOURS(np.linspace(0, 1, 256))[:, :3]]
    assert 1.05 / (max(one @ [0.2126, 0.7152, 0.0722] for one in linear) + 0.05) > 1.4  # contrast to white (WCAG); of the end of inferno 1.05
