"""One module a kernel: what it holds, what it tells, and that Numba's own way gives the same numbers."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python as _nrt
from numba.core.runtime import rtsys

import mpm
from mpm import compiling, linking
from mpm.scene.build import build
from mpm.state import as_heated, as_moved

ROOT = Path(__file__).parent.parent
SCENE = {
    "grid": {"dimension": 1, "size": [0.12], "cell": 0.01},
    "bodies": {"block": {"shape": {"box": {"lower": [0.02], "upper": [0.1]}}, "temperature": 310.0, "material": "m"}},
    "materials": {
        "m": {
            "density": 1000.0,
            "elastic": {"hencky": {"E": 1e4, "nu": 0.3}},
            "heat": {"fourier": {"kappa": 1.0, "alpha": 1000.0}},
            "expansion": {"linear": {"coefficient": 1e-4, "reference": 300.0}},
        }
    },
    "surfaces": [{"of": "block", "convection": {"beta": 10.0, "outside": 300.0}}],
    "time": {"end": 0.05},
}
BARE = {**SCENE, "materials": {"m": {name: SCENE["materials"]["m"][name] for name in ("density", "elastic")}}, "surfaces": []}  # compiles in half the time
RUN = """
import json, sys
VERSION
import mpm.jit
from mpm import cache, compiling, fingerprint, linking
held, told = [], []
linking.listeners.append(lambda kernel, function: held.append((kernel.__module__, function.__module__ if function else "")))
import mpm
with compiling.say(lambda text, expected, took: told.append((text, took))):
    tree = mpm.run(mpm.load(json.load(sys.stdin)))
astray = sorted({pair for pair in held if pair[1].startswith("mpm.") and pair[1].split(".")[1] not in fingerprint.contained(pair[0].split(".")[1])})
series = {name: [value.hex() for value in tree["series"][name].values.astype(float).ravel().tolist()] for name in tree["series"].data_vars}
print(json.dumps({"series": series, "astray": astray, "held": len(held), "told": told, "seconds": compiling.seconds(), "said": cache.words}))
"""


def run(cache, scene, version=""):
    env = os.environ | {"MPM_CACHE_DIR": str(cache)}
    code = RUN.replace("VERSION", f"import numba; numba.__version__ = {version!r}" if version else "")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=env, input=json.dumps(scene), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def cold(tmp_path_factory):
    cache = tmp_path_factory.mktemp("cache")
    return cache, run(cache, BARE)


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    return run(tmp_path_factory.mktemp("cache"), SCENE)


@pytest.mark.wide
def test_a_kernel_holds_only_rooms_that_its_cache_is_named_after(cold):
    """Of one scene in a process of its own; tests/conftest.py asserts the same of every kernel that any test compiles."""
    assert cold[1]["held"] > 50 and cold[1]["astray"] == []


def test_what_is_compiled_is_told_and_timed(cold):
    told, seconds = cold[1]["told"], cold[1]["seconds"]
    texts = [text for text, _ in told if text]
    words = r"compiling ([\w ]+): \d+ s left, function \d+ of about \d+, kernel (\d+) of about (\d+), once on this machine"
    said = [re.fullmatch(words, text) for text in texts]
    assert all(said) and all(1 <= int(one[2]) <= int(one[3]) for one in said) and any(one[1] == "the mechanical step" for one in said)
    assert seconds > 0.5 and sum(took for _, took in told) == pytest.approx(seconds)


def test_from_the_cache_nothing_is_compiled_and_all_bits_are_the_same(cold):
    cache, first = cold
    again = run(cache, BARE)
    assert again["series"] == first["series"] and again["seconds"] == 0.0 and again["said"] == []


def test_steps_are_shared_by_bodies_that_differ_in_what_they_do_not_read():
    """By type, which is all that a kernel is compiled for: the heat step whatever moves a body, the mechanical step whatever law of heat it has."""

    def types(changes):
        (body,) = build(mpm.load(SCENE, changes)).bodies
        return numba.typeof(as_heated(body)), numba.typeof(as_moved((body,)))

    m = "materials.m."
    table = {"table": {"temperature": [300.0, 320.0], "value": [1.0, 2.0]}}
    heat, motion = types({})
    flowing = types({m + "flow": {"ellipse": {"M": 1.0, "p0": 1e3, "eta": 1e3}}, m + "expansion": None})
    conducting = types({m + "heat.fourier.kappa": table, "surfaces.0.radiation": {"emissivity": 0.9, "surroundings": 300.0}})
    assert flowing[0] == heat and flowing[1] != motion
    assert conducting[1] == motion and conducting[0] != heat


def test_what_has_to_be_compiled_is_foreseen(tmp_path, monkeypatch):
    """Heat and contacts that the config names take seconds more; none once the kernels are there, whatever its numbers."""
    monkeypatch.setattr(compiling, "kernels", lambda: tmp_path)
    bare = {"walls": {"left": "contact"}, **BARE}
    plain, touching, warm = (compiling.expected(mpm.load(data)) for data in (bare | {"walls": {"left": "slip"}}, bare, SCENE))
    assert 3.0 < plain < min(touching, warm)
    monkeypatch.setattr(compiling.spent, "remembered", False)
    compiling.remember(mpm.load(SCENE), again=False)
    assert compiling.expected(mpm.load(SCENE | {"time": {"end": 0.3}})) == 0.0 < compiling.expected(mpm.load(bare))


SHORT = """
import re, sys
import numpy as np
from mpm.integrate import sorting, state_check
from mpm.shortcuts import SHORTCUTS, stock
from mpm.state import Plane
for owner, name, new in SHORTCUTS:
    assert getattr(owner, name) is new
    if sys.argv[1] == "stock":
        setattr(owner, name, stock[f"{owner.__name__}.{name}"])
x = np.random.default_rng(0).random((40, 2))
print(state_check.span(x.ravel()), sorting.sorting(sorting.first_nodes(Plane(0.1, 20, 20), x)).tolist())
for kernel in (state_check.span, sorting.sorting, sorting.first_nodes):
    code = re.sub(r"B2B\\d+|0x[0-9a-f]+|pickle\\w+[.]\\d+", "", next(iter(kernel.overloads.values())).library.get_llvm_str())
    for block in re.sub(r'%(?!arg)["\\w.$]+', '%', code).split("\\n\\n"):
        lines = [line.partition("!")[0] for line in block.splitlines()]
        print(*sorted(line for line in lines if " phi " in line), *(line for line in lines if " phi " not in line), sep="\\n")
"""


def test_shortcuts_change_no_instruction(tmp_path):
    """Lanes, loops, roles, named tuples, what numpy makes: the code of each kernel, but for names, the order of phis, numbers, places in memory."""
    codes = []
    for way in ("short", "stock"):
        env = os.environ | {"MPM_CACHE_DIR": str(tmp_path / way), "PYTHONHASHSEED": "0"}  # names hold flags, in the order of a set
        done = subprocess.run([sys.executable, "-c", SHORT, way], cwd=ROOT, env=env, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[-2000:]
        codes.append(done.stdout)
    assert len(codes[0]) > 50_000 and codes[0] == codes[1]


class Pair(NamedTuple):
    """Two arrays."""

    x: np.ndarray
    y: np.ndarray


def part(pair, numbers, k):
    """An argument's field, a view of it, a copy by a list of places, one that is chosen in a branch, a tuple of lent ones."""
    x, copied = pair.x, pair.y[numbers]
    view = x[k:]
    both = (view, pair.y)
    chosen = pair.y
    if k > 1:
        chosen = np.ones(3)
    total = 0.0
    for i in range(len(both[0])):
        row = both[0][i:]
        total += row[0] * chosen[0] + copied[0]
    return view, both, chosen, total


def test_what_is_lent_is_neither_freed_nor_kept():
    """Users of arrays are counted right where an argument's arrays are given back, and where they are only looked at."""
    part.__module__ = "mpm.tensors"  # as a kernel of ours
    kernel = numba.njit(part)
    pair, numbers = Pair(np.arange(6.0), np.arange(6.0) + 1.0), np.array([2, 3])
    given = (pair.x, pair.y, numbers)
    before = [sys.getrefcount(one) for one in given]
    for k in (1, 2):
        for _ in range(50):
            view, both, chosen, total = kernel(pair, numbers, k)
        assert view.tolist() == both[0].tolist() == pair.x[k:].tolist() and both[1].tolist() == pair.y.tolist()
        assert chosen.tolist() == (pair.y.tolist() if k == 1 else [1.0] * 3) and total == pytest.approx(pair.x[k:].sum() + 3.0 * (6 - k))
        assert [sys.getrefcount(one) for one in given] > before
        del view, both, chosen
        assert [sys.getrefcount(one) for one in given] == before
    _nrt.memsys_enable_stats()
    allocated = rtsys.get_allocation_stats()
    for _ in range(10):
        kernel(pair, numbers, 2)
    after = rtsys.get_allocation_stats()
    assert after.alloc - allocated.alloc == after.free - allocated.free > 0


THREADS = """
import copy, json, sys, threading
import mpm
import mpm.runner, mpm.rigid, mpm.sweep.collect
scene = json.load(sys.stdin)
rigid = copy.deepcopy(scene)
del rigid["materials"]["m"]["elastic"], rigid["materials"]["m"]["expansion"]
found = {}
def go(name, config):
    tree = mpm.run(mpm.load(config))
    found[name] = {key: [value.hex() for value in tree["series"][key].values.astype(float).ravel().tolist()] for key in tree["series"].data_vars}
both = [threading.Thread(target=go, args=pair) for pair in (("moving", scene), ("rigid", rigid), ("again", scene))]
[one.start() for one in both], [one.join() for one in both]
print(json.dumps(found))
"""


@pytest.mark.slow
def test_threads_that_compile_at_once_get_the_same_bits(warm, tmp_path):
    env = os.environ | {"MPM_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", THREADS], cwd=ROOT, env=env, input=json.dumps(SCENE), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout)
    assert set(found) == {"moving", "rigid", "again"} and found["moving"] == found["again"] == warm["series"]


@pytest.mark.slow
def test_numba_of_another_version_compiles_its_own_way_says_so_and_agrees_to_round_off(warm, tmp_path):
    other = run(tmp_path, SCENE, version="9.9.9")
    assert other["held"] == 0 and len(other["said"]) == 1 and "numba 9.9.9 was not tried with mpm" in other["said"][0]
    for name, values in warm["series"].items():
        a, b = (np.array([float.fromhex(value) for value in found]) for found in (values, other["series"][name]))
        assert np.allclose(a, b, rtol=1e-9, atol=1e-12 * max(1.0, np.abs(a).max())), name


def test_the_range_of_versions():
    first, last = linking.TESTED
    assert linking.within_tested(f"{first[0]}.{first[1]}.0") and linking.within_tested(f"{last[0]}.{last[1]}.9")
    assert not linking.within_tested(f"{last[0]}.{last[1] + 1}.0") and not linking.within_tested(f"{first[0]}.{first[1] - 1}.9")
