"""The bits of shipped scenes do not depend on what a process did before: cold, warm, in another order, in two threads, from another's cache, on Dask.

Slow: three empty caches, 60 to 90 s of processor each.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
SCENES = ("slump", "cube", "slab", "chocolate_pour")
PLAY = """
import json, sys, threading
import mpm, mpm.runner
from mpm import compiling

def series(tree):
    first = {axis: 0 for axis in tree.status.dims} if "status" in tree else {}
    data = tree["series"].to_dataset().isel(first, missing_dims="ignore")
    return {name: [value.hex() for value in data[name].values.astype(float).ravel().tolist()] for name in sorted(data.data_vars)}

def scene(name):
    whole = mpm.load(f"configs/scenes/{name}.yaml")
    return mpm.load(f"configs/scenes/{name}.yaml", smoke=True) if whole.smoke else whole

def play(name):
    return series(mpm.run(scene(name)))

def sweep(name):
    return series(mpm.sweep(scene(name), out=f"{sys.argv[2]}/{name}", jobs=2, scheduler="local"))

names, found = json.loads(sys.argv[1]), []
"""
IN_TURN = "found = [[name, play(name)] for name in names]"
IN_THREADS = """
def some(mine):
    found.extend([name, play(name)] for name in mine)
both = [threading.Thread(target=some, args=(names[k::2],)) for k in (0, 1)]
[one.start() for one in both], [one.join() for one in both]
"""
ON_DASK = "found = [[name, sweep(name)] for name in names]"
TELL = "\nprint(json.dumps({'found': found, 'compiled': compiling.seconds()}))"


def played(cache, names, way=IN_TURN, out=""):
    """([(scene, its series)], seconds of compiling) of a process of its own."""
    env = os.environ | {"MPM_CACHE_DIR": str(cache)}
    command = [sys.executable, "-c", PLAY + way + TELL, json.dumps(names), str(out)]
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    told = json.loads(done.stdout.splitlines()[-1])
    return told["found"], told["compiled"]


def test_the_same_bits_whatever_went_before(tmp_path):
    first, seconds = played(tmp_path / "a", [*SCENES, *SCENES])  # cold, and warm in the same process
    expected = dict(first[: len(SCENES)])
    assert seconds > 1.0 and all(len(values) > 3 for values in expected.values()) and dict(first[len(SCENES) :]) == expected
    again, seconds = played(tmp_path / "a", SCENES[::-1])  # from the cache of another process
    assert seconds == 0.0 and dict(again) == expected
    twice = (*SCENES, *SCENES[1:], SCENES[0])  # each in either thread
    for way, order in ((IN_TURN, SCENES[::-1]), (IN_THREADS, twice)):  # cold after other scenes; cold in two threads
        others, seconds = played(tmp_path / str(len(order)), order, way)
        assert seconds > 1.0 and len(others) == len(order)
        for name, values in others:
            assert values == expected[name], name
    dask, _ = played(tmp_path / "a", SCENES, ON_DASK, tmp_path)
    assert dict(dask) == expected
