"""The compile cache is named by room: an edit empties just the caches that can contain what was edited."""

import importlib.util
import shutil
from pathlib import Path

import pytest

from mpm.fingerprint import contained, rooms

PACKAGE = Path(__file__).parent.parent / "mpm"


def fingerprints(folder):
    """Of every room of a copy of the package, by its own code, which remembers nothing of before."""
    spec = importlib.util.spec_from_file_location("fingerprint_of_a_copy", folder / "mpm" / "fingerprint.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return {room: module.fingerprint(f"mpm.{room}") for room in module.rooms()}


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(PACKAGE, folder / "mpm", ignore=shutil.ignore_patterns("__pycache__"))
    return folder, fingerprints(folder)


@pytest.mark.parametrize("room", [room for room in rooms() if room != "__init__"])
def test_an_edit_changes_just_the_rooms_that_contain_it(copy, room):
    folder, before = copy
    path = next(folder / "mpm" / place for place in rooms()[room])
    text = path.read_text()
    try:
        path.write_text(text + "# an edit\n")
        after = fingerprints(folder)
    finally:
        path.write_text(text)
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {name for name in before if room in contained(name)} and room in changed


def test_the_step_contains_no_guard_no_plot_and_no_observer():
    above = {"guards", "observe", "simulation", "runner", "scene", "config", "records", "sweep", "plots", "rigid", "point", "diagnostics", "costs"}
    assert not contained("integrate") & above
    assert not contained("rigid") & (above - {"rigid"} | {"integrate", "transfer", "boundary"})
    assert {"transfer", "materials", "heat", "basis", "boundary", "lanes", "jit", "linking", "state"} <= contained("integrate")
