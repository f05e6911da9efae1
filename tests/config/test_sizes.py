"""Sizes that no machine takes are refused when the config is read, in every command, with the size that would do."""

import time

import pytest

from mpm.config import ConfigError, load
from mpm.sweep.cases import plan


@pytest.mark.parametrize(
    ("scene", "path", "value", "message", "allowed"),
    [
        ("loaf", "grid.cell", "10 um", "there would be about 1.26e+07 unknowns in rigid bodies, and at most 2 000 000 are possible", "above 2.5e-05 [m]"),
        ("fine", "grid.cell", "10 um", "there would be about 4.1e+09 particles, and at most 1 000 000 000 are possible", "above 2e-05 [m]"),
        ("block", "time.step", 1e-15, "the run would take 1e+14 steps", "at least 1e-13 [s], or auto"),
        ("block", "method.heat_step", "1e-30 s", "the run would take 1e+29 steps", "at least 1e-13 [s], or auto"),
        ("block", "time.end", 1e30, None, None),
        ("block", "time.end", 1e300, "the time is out of all scale", "1e-40 to 1e+40 [s]"),
        ("loaf", "materials.dough.density", 1e-300, "the density is out of all scale", "1e-40 to 1e+40 [kg/m**3]"),
    ],
)
def test_sizes(scene, path, value, message, allowed, request):
    began = time.process_time()
    try:
        data = request.getfixturevalue("block" if scene == "fine" else scene)
        plan(load(data | ({"method": {"particles": 16}} if scene == "fine" else {}), {path: value}))
        told = []
    except ConfigError as error:
        told = [(one.path, one.message, one.allowed) for one in error.problems if "billion" not in one.message]
    assert time.process_time() - began < 2.0
    assert told == ([(path, message, allowed)] if message else [])


def test_sides_stand_on_grid_lines_where_bodies_move(block, loaf):
    with pytest.raises(ConfigError) as told:
        load(block, {"grid.cell": block["grid"]["size"][0] / 2.5})
    (problem,) = [one for one in told.value.problems if one.path == "grid.size.0"]
    assert "is no whole number of cells" in problem.message
    better = float(problem.allowed.rpartition("grid.cell of ")[2].split()[0])
    load(block, {"grid.cell": better})
    load(loaf, {"grid.cell": "3 mm"})  # 44 mm: no wall acts on what does not move


def test_points_of_a_sweep_too(loaf):
    with pytest.raises(ConfigError, match=r"the point cell = 5e-06 is wrong: grid.cell: there would be about .* unknowns"):
        plan(load({**loaf, "sweep": {"axes": {"grid.cell": ["2 mm", "5 um"]}}}))


def test_a_point_that_needs_more_memory_than_is_free_is_planned_without_being_made(block, tmp_path, monkeypatch):
    from mpm.sweep import resources
    from mpm.sweep.plan_report import in_words, outlook

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(resources, "available", lambda: 1e9)
    experiment = load(block, {"grid.cell": "20 um"})
    found = outlook(experiment, None, 1)
    words = in_words(found)
    assert "of memory, and 1 GB are free: neither steps nor seconds are estimated" in words and found["seconds"] is None and found["smaller"] is None
    assert 3e9 < found["memory_bytes"] < 10e9  # 16 million particles of some 376 bytes
