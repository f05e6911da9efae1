"""`mpm bench --compare REV`: this checkout and another revision of it, timed in turn on one core.

Both are copied out (the revision by `git archive`), run by this Python as whole processes with one thread, pinned to the first core where the system can,
and compiled once beforehand into this user's cache. A row is a scene, the figure what the program itself measured, compiling and import apart: ns a
particle-step of a benchmark, seconds of a run. Each round gives the ratio of two neighbours in time; told are its median and its range, since the same binary
drifts by more between minutes than most changes are worth. `cold start` alone counts processor seconds of a run whose cache is empty, once.

Fails when something else computes meanwhile, or the range of the ratios is as wide as what is looked for: more rounds, an idle machine. A scene that the
revision cannot run is told as such, with what it said. Both must have done the same work: where `check` or the number of steps differs, the row says so.
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

from mpm.study.bench import BenchError

ROOT = Path(__file__).parents[2]
PARTS = (("mpm", "mpm"), ("cli", "mpm_cli"), ("configs", "configs"))
CHILD = """import os, sys
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
from mpm_cli.main import main
sys.exit(main(sys.argv[1:]))"""
ALONE = {name: "1" for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
COLD = "cold start"
ROWS = {  # what is timed: the arguments of `mpm`
    "elastic 3-D f32": "bench --n 64 --np 100000 --dtype f32",
    "elastic 3-D f64": "bench --n 64 --np 100000 --dtype f64",
    "elastic 2-D f32": "bench --dim 2 --n 256 --np 100000 --dtype f32",
    "elastic 2-D f64": "bench --dim 2 --n 256 --np 100000 --dtype f64",
    "heat, moving disc": "run configs/verification/robin_disc_particles.yaml --set grid.cell=0.0625",
    "flow, slump": "run configs/scenes/slump.yaml --smoke",
    "contact, cube": "run configs/scenes/cube.yaml --set time.end=0.1",
    "implicit, oven spring": "run configs/scenes/loaf_oven_spring.yaml",
    "rigid, loaf": "run configs/scenes/loaf.yaml",
    COLD: "run configs/scenes/slump.yaml --smoke",
}


def copied(into: Path) -> Path:
    """This checkout's sources, importable from `into`."""
    if not (ROOT / "cli").is_dir():
        raise BenchError("revisions can be compared in a checkout of mpm alone: clone it and run there")
    for name, called in PARTS:
        shutil.copytree(ROOT / name, into / called, ignore=shutil.ignore_patterns("__pycache__"))
    return into


def unpacked(revision: str, into: Path) -> Path:
    """The sources of a revision, importable from `into`."""
    if revision.startswith("-"):
        raise BenchError(f"--compare {revision}: say a commit, a tag or a branch")
    made = subprocess.run(["git", "-C", str(ROOT), "archive", revision, *(name for name, _ in PARTS)], capture_output=True, check=False)
    if made.returncode:
        raise BenchError(f"--compare {revision}: git says {made.stderr.decode(errors='replace').strip()}")
    with tarfile.open(fileobj=BytesIO(made.stdout)) as archive:
        archive.extractall(into, filter="data")
    (into / "cli").rename(into / "mpm_cli")
    return into


def timed(place: Path, row: str, cache: Path | None = None) -> dict:
    """One process: `took` in `unit`, `work` to compare; or `failed`."""
    command = ROWS[row].split()
    with tempfile.TemporaryDirectory() as out:
        if command[0] == "run":
            command += ["--json", "-o", out]
        env = os.environ | ALONE | {"PYTHONPATH": str(place)}
        if cache:
            env.pop("MPM_CACHE_DIR", None)
            env["XDG_CACHE_HOME"] = str(cache)
        with tempfile.TemporaryFile("w+") as answer, tempfile.TemporaryFile("w+") as words:
            child = subprocess.Popen([sys.executable, "-c", CHILD, *command], cwd=place, env=env, stdout=answer, stderr=words, stdin=subprocess.DEVNULL)
            _, status, used = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            answer.seek(0)
            words.seek(0)
            said, why = answer.read(), [line for line in words.read().splitlines() if line.strip()]
    if child.returncode:
        return {"failed": why[-1] if why else f"exit code {child.returncode}"}
    found = json.loads(said)
    if row == COLD:
        return {"took": used.ru_utime + used.ru_stime, "unit": "s of processor", "work": found["steps"]}
    if command[0] == "bench":
        return {"took": 1e6 * found["med_ms"] / found["N"], "unit": "ns a particle-step", "work": [float(f"{value:.4g}") for value in found["check"]]}
    return {"took": found["wall_time"], "unit": "s", "work": found["steps"]}


def compare(revision: str, rounds: int = 5, only: str = "") -> Iterator[dict]:
    """A row a scene: medians `here` and `there`, `ratio` there over here with `low` and `high`, `note`. More than 1: this checkout is faster."""
    rows = [row for row in ROWS if only in row]
    if not rows:
        raise BenchError(f"no row has {only!r} in its name; there are: {', '.join(ROWS)}")
    with tempfile.TemporaryDirectory() as folder:
        here, there = copied(Path(folder, "here")), unpacked(revision, Path(folder, "there"))
        for row in rows:
            yield cold(here, there, Path(folder)) if row == COLD else in_turn(row, here, there, rounds)


def cold(here: Path, there: Path, folder: Path) -> dict:
    """The first run on an empty cache, of both."""
    return ratio_row(COLD, [[timed(place, COLD, Path(tempfile.mkdtemp(dir=folder)))] for place in (here, there)])


def in_turn(row: str, here: Path, there: Path, rounds: int) -> dict:
    """A row here and there by turns, once before to compile."""
    first = [timed(place, row) for place in (here, there)]  # compiles
    if any("failed" in one for one in first):
        return ratio_row(row, [[one] for one in first])
    return ratio_row(row, list(zip(*([timed(place, row) for place in (here, there)] for _ in range(rounds)), strict=True)))


def ratio_row(row: str, found: list[Any]) -> dict:
    """A row of the table: medians, and the median and range of the ratio; `note` where one failed or they did other work."""
    ours, theirs = found
    for name, one in (("here", ours[0]), ("there", theirs[0])):
        if "failed" in one:
            return {"row": row, "note": f"{name}: {one['failed']}"}
    ratios = [there["took"] / here["took"] for here, there in zip(ours, theirs, strict=True)]
    middle = [statistics.median(one["took"] for one in each) for each in found]
    note = "" if ours[0]["work"] == theirs[0]["work"] else f"other work: {ours[0]['work']} here, {theirs[0]['work']} there"
    spread = {"ratio": statistics.median(ratios), "low": min(ratios), "high": max(ratios)}
    return {"row": row, "here": middle[0], "there": middle[1], "unit": ours[0]["unit"], **spread, "note": note}


HEAD = "| scene | here | there | unit | there / here | range | |\n|---|---|---|---|---|---|---|"


def line(row: dict) -> str:
    """A row of the table in Markdown."""
    if "ratio" not in row:
        return f"| {row['row']} | | | | | | {row['note']} |"
    times = " | ".join(f"{row[name]:.3g}" for name in ("here", "there"))
    return f"| {row['row']} | {times} | {row['unit']} | {row['ratio']:.3f} | {row['low']:.3f} to {row['high']:.3f} | {row['note']} |"
