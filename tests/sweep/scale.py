"""What a sweep of many small points costs besides the points.

    python tests/sweep/scale.py [POINTS [JOBS [ADDRESS]]]     points of configs/scenes/slab.yaml, conductivity x surface coefficient; row by row
    python tests/sweep/scale.py grow POINTS POINTS ...        the same scene with a runner that takes no time, at several sizes, and what a million would take

Overhead: time between the first and the last finished point, times the workers, a point, less `run_point` alone (mean over 300 of the points, afterwards).
With `local` or an address as third argument they run on Dask.
"""

import importlib
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from mpm.config import load
from mpm.sweep import api, background_collect
from mpm.sweep.cases import plan
from mpm.sweep.engine import Options
from mpm.sweep.report import Reporter
from mpm.sweep.resources import resident

ROOT = Path(__file__).parents[2]
COLLECT = """
import sys
from pathlib import Path
from mpm.sweep.api import collect_folder
assert collect_folder(Path(sys.argv[1]))[1]
print(next(row for row in Path("/proc/self/status").read_text().splitlines() if row.startswith("VmHWM")).split()[1])  # kB; ru_maxrss has the parent's too
"""
SLAB = ROOT / "configs" / "scenes" / "slab.yaml"
sys.path.insert(0, str(ROOT / "tests" / "fakes"))


class Clock(Reporter):
    """When points were finished, and the memory of this process meanwhile."""

    def __init__(self):
        self.count, self.first, self.last, self.memory = 0, 0.0, 0.0, []

    def finished(self, label, line, again):
        self.last = time.perf_counter()
        self.first = self.first or self.last
        self.count += 1
        if self.count % 100 == 1:
            self.memory.append(resident(os.getpid()))


def alone(run_point, experiments):
    """Mean seconds of a point."""
    since = time.perf_counter()
    for one in experiments:
        run_point(one)
    return (time.perf_counter() - since) / len(experiments)


def measure(points, jobs=1, address=None, runner="mpm.runner", say=lambda *_: None):
    """A sweep of so many points: what each thing took, by name."""
    side = round(points**0.5)
    experiment = load(SLAB, {"sweep.axes.beta": {"log": [0.1, 10, side]}, "sweep.axes.kappa": {"linear": [0.5, 2, points // side]}})
    found, since = {}, time.perf_counter()
    planned = plan(experiment, 10**7)
    found |= {"points": len(planned), "plan_s": time.perf_counter() - since}
    some = [case.experiment for case in planned.cases[:: max(1, points // 300)]]
    del planned
    spent, last = [], background_collect.Gather.last

    def timed(self, stop):
        began = time.perf_counter()
        written = last(self, stop)
        spent.append(time.perf_counter() - began)
        return written

    background_collect.Gather.last = timed
    out, clock = Path(tempfile.mkdtemp(prefix="scale-", dir=".")), Clock()
    try:
        result = api.execute(experiment, out, Options(jobs=jobs, scheduler=address, runner=runner), clock, 10**7)
        assert result.exit_code == 0, result
        found["peak_MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
        run_point = importlib.import_module(runner).run_point  # not before: a sweep's own process has no kernels
        run_point(some[0])
        found["alone_ms"] = 1e3 * alone(run_point, some)
        found["all_in_ms"] = 1e3 * (clock.last - clock.first) * jobs / (found["points"] - 1)
        found["overhead_ms"] = found["all_in_ms"] - found["alone_ms"]
        memory = np.array(clock.memory) / 1e6
        found |= {"memory_first_MB": memory[0], "memory_last_MB": memory[-1], "memory_most_MB": memory.max()}
        files = [path for path in out.rglob("*.nc") if path.parent.parent.name in ("points", "batches")]
        found |= {"files": len(files), "bytes_a_point": sum(path.stat().st_size for path in files) / found["points"]}
        found |= {"collect_s": spent[0], "dataset_bytes_a_point": sum(path.stat().st_size for path in out.rglob("s*/*.nc")) / found["points"]}
        found["dataset_bytes_a_point"] += (out / "sweep.nc").stat().st_size / found["points"]
        (out / "sweep.nc").unlink()
        done = subprocess.run([sys.executable, "-c", COLLECT, str(out.resolve())], cwd=ROOT, capture_output=True, text=True, check=True)
        found["collect_MB"] = int(done.stdout) / 1e3
        import xarray

        since = time.perf_counter()
        with xarray.open_dataset(out / "sweep.nc") as data:
            assert int((data.status == 0).sum()) == found["points"]
        found["open_s"] = time.perf_counter() - since
        since = time.perf_counter()
        assert api.execute(experiment, out, Options(jobs=jobs, runner=runner), None, 10**7).ran == 0
        found["again_s"] = time.perf_counter() - since
    finally:
        background_collect.Gather.last = last
        shutil.rmtree(out)
    return found


def said(found):
    """As a table."""
    return f"""{found["points"]} points, plan             {found["plan_s"]:.2f} s
a point of a worker, all in    {found["all_in_ms"]:.2f} ms; run_point alone {found["alone_ms"]:.2f} ms; overhead {found["overhead_ms"]:.2f} ms
MB of the parent               {found["memory_first_MB"]:.0f} at the first point, {found["memory_last_MB"]:.0f} at the last, most {found["memory_most_MB"]:.0f}
on disk                        {found["files"]} files, {found["bytes_a_point"]:.0f} B a point
collect, s                     {found["collect_s"]:.2f}, in a process of {found["collect_MB"]:.0f} MB at its peak
dataset                        {found["dataset_bytes_a_point"]:.0f} B a point
open sweep.nc                  {found["open_s"]:.2f} s
the same again                 {found["again_s"]:.2f} s, nothing runs
peak of the parent             {found["peak_MB"]:.0f} MB"""


def grow(sizes):
    """Each size in a process of its own, and a straight line through the two largest."""
    import json

    names = ("plan_s", "all_in_ms", "memory_last_MB", "peak_MB", "collect_MB", "files", "bytes_a_point", "collect_s", "dataset_bytes_a_point")
    names += ("open_s", "again_s")
    rows = []
    print("| points | " + " | ".join(names) + " |", flush=True)
    for size in sizes:
        done = subprocess.run([sys.executable, __file__, "null", str(size)], capture_output=True, text=True, check=True)
        rows.append(json.loads(done.stdout))
        print(f"| {rows[-1]['points']} | " + " | ".join(f"{rows[-1][name]:.4g}" for name in names) + " |", flush=True)
    (a, b), constant = rows[-2:], ("all_in_ms", "bytes_a_point", "dataset_bytes_a_point")
    line = [b[name] if name in constant else b[name] + (b[name] - a[name]) / (b["points"] - a["points"]) * (1e6 - b["points"]) for name in names]
    print("| 1000000 (line) | " + " | ".join(f"{value:.4g}" for value in line) + " |")


if __name__ == "__main__":
    if sys.argv[1:2] == ["grow"]:
        grow([int(size) for size in sys.argv[2:]] or [1000, 10_000, 100_000])
    elif sys.argv[1:2] == ["null"]:
        import json

        print(json.dumps(measure(int(sys.argv[2]), runner="null_runner")))
    else:
        print(said(measure(int((sys.argv[1:2] or [10_000])[0]), int((sys.argv[2:3] or [1])[0]), (sys.argv[3:4] or [None])[0])))
