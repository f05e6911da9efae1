"""Kill -9, and make the disk fail, at every call that changes a file and at random moments; go on; compare. Prints what came of it as JSON.

    python tests/faults/kills.py kill FOLDER [RANDOM [EVERY]]      python tests/faults/kills.py disk FOLDER [POINTS]

One process imports everything once and forks a child for each sweep; in the child, calls of `os` are counted, and the n-th one kills or fails.
A kill comes before the call, after it, or in the middle of a write. RANDOM kills at random moments; of the calls, every EVERY-th.
"""

import errno
import itertools
import json
import os
import random
import shutil
import signal
import sys
import time
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "fakes")]

import h5py  # noqa: E402
from scenes import fields, many  # noqa: E402

from mpm.config import load  # noqa: E402
from mpm.sweep.api import execute  # noqa: E402
from mpm.sweep.cases import plan  # noqa: E402
from mpm.sweep.compare import NOT_RESULTS  # noqa: E402
from mpm.sweep.engine import Options  # noqa: E402
from mpm.sweep.report import Reporter  # noqa: E402
from mpm.sweep.store import Store  # noqa: E402
from mpm.sweep.verify import files, wrong  # noqa: E402

CALLS = ("open", "write", "fsync", "replace", "ftruncate", "mkdir")
SWEEPS = {"batches": load(many(24)), "own files": load(fields([2.5, 17.0, 5.0]))}  # at 17.0 the fake diverges
TROUBLE = (errno.ENOSPC, errno.EIO, errno.EROFS, errno.EDQUOT, errno.EFBIG)
real = {name: getattr(os, name) for name in CALLS}


class Told(Reporter):
    """Says each finished point into a pipe, at once."""

    def __init__(self, pipe):
        self.pipe = pipe

    def finished(self, label, line, again):
        real["write"](self.pipe, line["run_id"].encode() + b"\n")


def watch(at, act):
    """Count calls of `os`; the `at`-th is `act`ed on: act(name, arguments, do) -> what the call returns."""
    count = [0]

    def counted(name):
        def call(*arguments, **more):
            count[0] += 1
            do = lambda *a: real[name](*(a or arguments), **more)  # noqa: E731
            return act(name, arguments, do) if count[0] == at else do()

        return call

    for name in CALLS:
        setattr(os, name, counted(name))
    return count


def dies(when):
    def act(name, arguments, do):
        if name == "write" and when == "amid":
            do(arguments[0], bytes(arguments[1])[: len(arguments[1]) // 2])
        elif when != "before":
            do()
        os.kill(os.getpid(), signal.SIGKILL)

    return act


def fails(code):
    def act(name, arguments, do):
        if name == "write" and code in (errno.ENOSPC, errno.EFBIG) and len(arguments[1]) > 1:
            do(arguments[0], bytes(arguments[1])[:1])  # part of it reaches the disk, as on a disk that fills
        raise OSError(code, os.strerror(code), *(str(a) for a in arguments[:1] if isinstance(a, str | Path)))

    return act


def sweep(data, out, at=0, act=None, moment=None):
    """One sweep in a child: (how it ended, what it said, points it told finished, calls it made)."""
    there, here = os.pipe()
    child = os.fork()
    if child == 0:
        code = 90
        os.close(there)
        try:
            count = watch(at, act)
            try:
                result = execute(data, out, Options(jobs=0, runner="fake_runner"), Told(here))
                said, code = str(result.stopped), result.exit_code
            except OSError as error:
                said, code = f"{error.filename}: {error.strerror}", 80
            real["write"](here, b"=" + json.dumps([said, count[0]]).encode() + b"\n")
        finally:
            os._exit(code)
    os.close(here)
    if moment is not None:
        time.sleep(moment)
        os.kill(child, signal.SIGKILL)
    told, said, calls = [], "", 0
    with os.fdopen(there) as lines:
        for line in lines:
            if line.startswith("="):
                said, calls = json.loads(line[1:])
            elif line.endswith("\n"):
                told.append(line.strip())
    status = os.waitpid(child, 0)[1]
    return os.waitstatus_to_exitcode(status), said, told, calls


def look(data, out, told):
    """What is wrong after a sweep was cut: damaged files at final places, told points that are not there."""
    bad = [f"{path} is damaged" for kind, path in files(out) if wrong(kind, path)[1]]
    lines, damaged = Store(out).lines([case.run_id for case in plan(data).cases])
    return bad + [f"{name} is damaged" for name in damaged] + [f"{run_id} is lost" for run_id in told if run_id not in lines]


def contents(path):
    """Every array of a dataset, as type, shape and bytes; not what a clock or a retry may change. (mpm.sweep.compare says the same, ten times slower.)"""
    found = {}

    def see(name, node):
        if isinstance(node, h5py.Dataset) and name not in NOT_RESULTS:
            values = node[()]
            found[name] = (str(node.dtype), node.shape, values.tolist() if node.dtype.kind == "O" else values.tobytes())

    with h5py.File(path) as file:
        file.visititems(see)
    return found


def resume(data, out, whole):
    """Go on without trouble: what differs from the uninterrupted sweep."""
    code, said, *_ = sweep(data, out)
    left = [str(path) for path in out.rglob(".*.tmp")]
    one, two = contents(whole / "sweep.nc"), contents(out / "sweep.nc")
    different = [name for name in {**one, **two} if one.get(name) != two.get(name)]
    return ([f"exit code {code}: {said}"] if code not in (0, 3) else []) + different + left


def kill(folder, moments, every):
    """Every call of both sweeps, before, amid and after; then random moments."""
    chance, wrongs, cuts = random.Random(11), [], {"calls": 0, "moments": 0, "told": 0}
    for name, data in SWEEPS.items():
        whole = folder / f"whole {name}"
        execute(data, whole, Options(jobs=0, runner="fake_runner"))  # here, so that no child imports anything
        began = time.monotonic()
        _, _, _, calls = sweep(data, folder / "again")
        long = time.monotonic() - began
        shutil.rmtree(folder / "again")
        plans = [(at, dies(when), None) for at in range(1, calls + 1, every) for when in ("before", "amid", "after")]
        wanted, tries = moments // len(SWEEPS), 4 * moments  # some moments come after the end
        for at, act, moment in itertools.chain(plans, ((0, None, chance.uniform(0, long)) for _ in range(tries))):
            if moment is not None and wanted <= 0:
                break
            out = folder / "out"
            code, _, told, _ = sweep(data, out, at, act, moment)
            bad = look(data, out, told) if out.exists() else []
            bad += resume(data, out, whole)
            if bad:
                wrongs.append([name, at, moment, code, bad])
            cuts["calls" if moment is None else "moments"] += code == -9  # a sweep whose batches came out larger makes fewer calls
            wanted -= moment is not None and code == -9
            cuts["told"] += len(told)
            shutil.rmtree(out, ignore_errors=True)
    return {**cuts, "wrong": wrongs[:20], "wrongs": len(wrongs)}


def disk(folder, points):
    """The disk fails at `points` calls spread over both sweeps, with every error in turn."""
    wrongs, done, kinds = [], 0, {}
    for name, data in SWEEPS.items():
        whole = folder / f"whole {name}"
        execute(data, whole, Options(jobs=0, runner="fake_runner"))
        _, _, _, calls = sweep(data, folder / "again")
        shutil.rmtree(folder / "again")
        for n in range(points // len(SWEEPS)):
            at, code = 1 + n % calls, TROUBLE[(n + n // calls) % len(TROUBLE)]
            out = folder / "out"
            ended, said, told, _ = sweep(data, out, at, fails(code))
            bad = look(data, out, told) if out.exists() else []
            if ended not in (0, 1, 3, 80) or (ended in (1, 80) and (str(out) not in said or os.strerror(code) not in said)):
                bad.append(f"ended with {ended}: {said}")
            kinds[said.replace(str(out), "OUT")[-60:]] = ended
            bad += resume(data, out, whole)
            if bad:
                wrongs.append([name, at, os.strerror(code), bad])
            done += 1
            shutil.rmtree(out, ignore_errors=True)
    return {"points": done, "wrong": wrongs[:20], "wrongs": len(wrongs), "said": sorted(kinds)[:8]}


if __name__ == "__main__":
    what, folder, *numbers = sys.argv[1:]
    numbers = [int(number) for number in numbers]
    found = kill(Path(folder), *(numbers + [20, 1][len(numbers) :])) if what == "kill" else disk(Path(folder), *(numbers or [20]))
    print(json.dumps(found, indent=1))
