"""R13: many processes on an empty compile cache at once, and cache files that are cut or wrong: nobody crashes, and all get the same numbers.

And a compile cache that is not its user's alone: nothing in it is loaded.
"""

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from mpm import cache

ROOT = Path(__file__).parents[2]
CODE = "import numpy as np; from mpm.diagnostics import enthalpies; from mpm.materials.laws import Constant; print(enthalpies(Constant(2.0), np.arange(3.0)))"


def start(cache):
    env = {**os.environ, "MPM_CACHE_DIR": str(cache), "NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    return subprocess.Popen([sys.executable, "-c", CODE], cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def outcome(process):
    out, err = process.communicate(timeout=600)
    return process.returncode, out, err[-600:]


def test_cut_and_wrong_cache_files_are_made_anew(tmp_path):
    rng = random.Random(1)
    good = outcome(start(tmp_path))
    assert good[0] == 0 and good[1] == "[0. 2. 4.]\n", good
    made = [path for path in tmp_path.rglob("*") if path.suffix in (".nbi", ".nbc")]
    assert made
    for change in (lambda data: data[: rng.randrange(len(data))], lambda data: b"", lambda data: data[:40] + bytes([data[40] ^ 4]) + data[41:]):
        for path in made:
            path.write_bytes(change(path.read_bytes()))
        assert outcome(start(tmp_path))[:2] == good[:2]
        assert outcome(start(tmp_path))[:2] == good[:2]


def link(folder):
    (folder.parent / "theirs").mkdir(mode=0o700)
    folder.symlink_to(folder.parent / "theirs")


def open_to_others(folder):
    folder.mkdir()
    folder.chmod(0o750)


def of_somebody(folder):
    if os.geteuid():
        pytest.skip("only root can give a folder away")
    folder.mkdir(mode=0o700)
    os.chown(folder, 12345, 12345)


@pytest.mark.parametrize("spoil, why", [(link, "it is a link"), (open_to_others, "others can enter it"), (of_somebody, "it belongs to user 12345")])
def test_a_cache_that_is_not_its_users_alone_is_not_looked_into(tmp_path, monkeypatch, capsys, spoil, why):
    monkeypatch.setenv("MPM_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "words", [])
    spoil(tmp_path / "name")
    before = os.lstat(tmp_path / "name").st_mtime_ns
    found = cache.private("name")
    assert found == tmp_path / "name-2" and found.stat().st_mode & 0o7777 == 0o700 and why in capsys.readouterr().err
    assert cache.private("name") == found and capsys.readouterr().err == "" and os.lstat(tmp_path / "name").st_mtime_ns == before
    assert cache.private("good") == tmp_path / "good"


def test_a_place_where_others_could_exchange_the_cache_is_not_used(tmp_path, monkeypatch):
    monkeypatch.setenv("MPM_CACHE_DIR", str(tmp_path / "cache"))
    assert cache.private("name") == tmp_path / "cache" / "name"
    (tmp_path / "cache").chmod(0o777)
    assert cache.private("name").parent != tmp_path / "cache" and "others can write there" in cache.words[-1]
    cache.remove()
    monkeypatch.setenv("MPM_CACHE_DIR", str(tmp_path / "cache"))
    (tmp_path / "cache").chmod(0o1777)
    assert cache.private("name") == tmp_path / "cache" / "name"


SWEEP = """
import sys
sys.path[:0] = {paths!r}
from scenes import config, go
from mpm import cache
assert go(config([0.2, 0.5]), {out!r}, jobs=2).exit_code == 0
print(len(cache.made), [path.is_dir() for _, path in cache.made])
"""


def test_no_temporary_cache_stays(tmp_path):
    """Where the place for it cannot be written, a sweep and its workers share one temporary place, which ends with the sweep."""
    (tmp_path / "file").touch()
    (tmp_path / "tmp").mkdir()
    (tmp_path / "marks").touch()
    code = SWEEP.format(paths=[str(Path(__file__).parent), str(Path(__file__).parents[1] / "fakes"), *sys.path], out=str(tmp_path / "out"))
    env = os.environ | {"MPM_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path / "tmp"), "FAKE_MARKS": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout == "1 [True]\n" and f"is not kept in {tmp_path / 'file'}" in done.stderr, done.stderr
    assert list((tmp_path / "tmp").iterdir()) == []


@pytest.mark.slow
def test_32_processes_on_an_empty_cache(tmp_path, table):
    bad, rounds = [], int(os.environ.get("MPM_ROUNDS", "20"))
    for turn in range(rounds):
        ended = [outcome(process) for process in [start(tmp_path / str(turn)) for _ in range(32)]]
        bad += [one for one in ended if one[:2] != (0, "[0. 2. 4.]\n")]
    table(f"32 processes at once on a cold cache, {rounds} times", f"{len(bad)} crashes")
    assert not bad
