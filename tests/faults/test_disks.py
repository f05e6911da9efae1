"""R3 on real ground: a small file system that fills up, one that is read-only, and a limit on the size of files. (kills.py injects errors call by call.)"""

import os
import resource
import subprocess

import kills
import pytest
from scenes import fields, go

from mpm.config import load
from mpm.sweep import resources

DATA = fields([round(0.1 + 0.05 * k, 2) for k in range(20)])


def run(data, out):
    """(exit code, or None where the sweep could not even say so; what it said)."""
    try:
        result = go(data, out)
        return result.exit_code, str(result.stopped)
    except OSError as error:
        return None, f"{error.filename}: {error.strerror}"


@pytest.fixture
def mount(tmp_path):
    """mount(bytes): a file system of its own at a new place; mount(place, options): mounted again with other options."""
    made = []

    def call(what, options=None):
        if options:
            subprocess.run(["mount", "-o", f"remount,{options}", what], check=True)
            return what
        place = tmp_path / f"disk{len(made)}"
        place.mkdir()
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={what}", "tmpfs", place], capture_output=True, text=True, check=False)
        if done.returncode:
            pytest.skip(f"mounting is not allowed here: {done.stderr.strip()}")
        made.append(place)
        return place

    yield call
    for place in made:
        subprocess.run(["umount", "-l", place], check=True)


@pytest.fixture
def whole(tmp_path):
    """The dataset without trouble."""
    go(DATA, tmp_path / "whole")
    return kills.contents(tmp_path / "whole" / "sweep.nc")


def wrong(out, whole, said):
    """What is wrong after a sweep ended in trouble, and after it went on: damage, another dataset; or a message without the path and the bytes."""
    bad = kills.look(load(DATA), out, []) + [f"went on with {again}" for again in [run(DATA, out)] if again[0] != 0]
    bad += [name for name in whole if kills.contents(out / "sweep.nc").get(name) != whole[name]] if not bad else []
    return bad + ([] if str(out) in said and "bytes" in said else [f"said {said}"])


def fills(mount, whole, monkeypatch, sizes):
    """File systems of these sizes fill up under a sweep that does not look at what is free."""
    bad, kinds = [], set()
    for size in sizes:
        place = mount(size)
        with monkeypatch.context() as patch:
            patch.setattr(resources.Resources, "short", lambda *_: "")
            code, said = run(DATA, place / "out")
        kinds.add(code)
        mount(place, "size=100m")
        bad += [(size, wrong(place / "out", whole, said))] if (place / "out").exists() else []
    return [one for one in bad if one[1]], kinds


def becomes_read_only(mount, whole, counts):
    """The file system is mounted read-only when a sweep with so many of the points is done. (While it runs, it cannot be: kills.py makes EROFS then.)"""
    bad = []
    for count in counts:
        place = mount("100m")
        go(DATA | {"sweep": {"axes": {"kappa": DATA["sweep"]["axes"]["kappa"][:count]}}}, place / "out")
        mount(place, "ro")
        code, said = run(DATA, place / "out")
        mount(place, "rw")
        found = wrong(place / "out", whole, f"{said} (bytes)") + ([] if code is None and "Read-only" in said else [f"{code}: {said}"])
        bad += [(count, found)] if found else []
    return bad


def limited(tmp_path, whole, sizes):
    """No file may be larger than so many bytes."""
    bad, hit = [], 0
    for size in sizes:
        out = tmp_path / f"limit {size}"
        there, here = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
                os.write(here, repr(run(DATA, out)).encode())
            finally:
                os._exit(0)
        os.close(here)
        with os.fdopen(there) as pipe:
            text = pipe.read()
        status = os.waitpid(child, 0)[1]
        hit += "File too large" in text
        found = wrong(out, whole, text) if out.exists() and "File too large" in text else []
        bad += [(size, found)] if found or status else []
    return bad, hit


def test_a_real_disk_that_fills_or_becomes_read_only(mount, whole, monkeypatch):
    bad, kinds = fills(mount, whole, monkeypatch, ["16k", "64k", "120k"])
    assert not bad and kinds <= {1, None} and not becomes_read_only(mount, whole, [1, 7])


def test_a_disk_with_too_little_room_is_told_before_it_is_full(mount, whole):
    place = mount("300k")
    code, said = run(DATA, place / "out")
    assert code == 1 and "bytes are needed to go on" in said and "bytes are free" in said
    mount(place, "size=100m")
    assert not wrong(place / "out", whole, said)


def test_a_limit_on_the_size_of_files(tmp_path, whole):
    bad, hit = limited(tmp_path, whole, [500, 3000, 20_000])
    assert not bad and hit >= 2


@pytest.mark.slow
def test_real_disks_at_length(tmp_path, mount, whole, monkeypatch, table):
    sizes = [f"{4 * k}k" for k in range(4, 54)]
    full, _ = fills(mount, whole, monkeypatch, sizes)
    only = becomes_read_only(mount, whole, range(1, 20))
    large, hit = limited(tmp_path, whole, range(200, 20_200, 400))
    said = f"{len(sizes)} sizes, {hit} limits that were hit, 19 read-only: {len(full) + len(large) + len(only)} wrong"
    table("a real file system that fills up (tmpfs), RLIMIT_FSIZE, mounted read-only: path and bytes told, nothing lost, goes on", said)
    assert not full and not only and not large
