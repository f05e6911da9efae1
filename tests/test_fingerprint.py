"""The compile cache is named by room: an edit empties just the caches that can contain what was edited."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mpm.fingerprint import contained, rooms

PACKAGE = Path(__file__).parent.parent / "mpm"
CODE = "import json; from mpm.fingerprint import fingerprint, rooms; print(json.dumps({room: fingerprint(f'mpm.{room}') for room in rooms()}))"


def fingerprints(folder):
    import json

    done = subprocess.run([sys.executable, "-P", "-c", f"import sys; sys.path.insert(0, {str(folder)!r}); {CODE}"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


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
