"""What a sweep of many small points costs besides the points: `python tests/sweep/scale.py [POINTS [JOBS [ADDRESS]]]` prints a table row by row.

The points are those of configs/scenes/slab.yaml, conductivity x surface coefficient. Overhead: time between the first and the last finished point, times
the workers, a point, less `run_point` alone (mean over 300 of the points). With `local` or an address as third argument they run on Dask.
"""

import os
import resource
import shutil
import sys
import tempfile
import time
from pathlib import Path

from mpm.config import load
from mpm.sweep import collect
from mpm.sweep.api import execute
from mpm.sweep.cases import plan
from mpm.sweep.engine import Options
from mpm.sweep.report import Reporter
from mpm.sweep.room import resident

SLAB = Path(__file__).parents[2] / "configs" / "scenes" / "slab.yaml"


class Clock(Reporter):
    """When points were finished, and the memory of this process then."""

    def __init__(self):
        self.times, self.memory = [], []

    def finished(self, label, line, again):
        self.times.append(time.perf_counter())
        if len(self.times) % 100 == 1:
            self.memory.append(resident(os.getpid()))


def say(what, value):
    print(f"{what:<52}{value}", flush=True)


def main(points, jobs, address):
    side = round(points**0.5)
    axes = {"sweep.axes.beta": {"log": [0.1, 10, side]}, "sweep.axes.kappa": {"linear": [0.5, 2, side]}}
    experiment, began = load(SLAB, axes), time.perf_counter()
    planned = plan(experiment, 10**7)
    say("plan", f"{time.perf_counter() - began:.2f} s, {len(planned)} points")
    spent, collected = [], collect.assemble

    def timed(*given):
        since = time.perf_counter()
        data = collected(*given)
        spent.append((time.perf_counter() - since, len(data)))
        return data

    collect.assemble = timed
    out, clock = Path(tempfile.mkdtemp(prefix="scale-", dir=".")), Clock()
    try:
        result = execute(experiment, out, Options(jobs=jobs, scheduler=address), clock, 10**7)
        assert result.exit_code == 0, result
        from mpm.runner import run_point

        some = [case.experiment for case in planned.cases[:: max(1, points // 300)]]
        run_point(some[0])
        since = time.perf_counter()
        for one in some:
            run_point(one)
        alone = (time.perf_counter() - since) / len(some)
        each = (clock.times[-1] - clock.times[0]) * jobs / (len(planned) - 1)
        say("a point, all in", f"{1e3 * each:.2f} ms of a worker; run_point alone {1e3 * alone:.2f} ms; overhead {1e3 * (each - alone):.2f} ms")
        growth = (clock.memory[-1] - clock.memory[0]) / len(planned)
        say("memory of the parent", f"{clock.memory[0] / 1e6:.0f} MB at the first point, {clock.memory[-1] / 1e6:.0f} MB at the last, {growth:.0f} B a point")
        files = [path for path in out.rglob("*.nc") if path.name != "sweep.nc"]
        say("on disk", f"{len(files)} files, {sum(path.stat().st_size for path in files) / len(planned):.0f} B a point")
        say("collect", f"{spent[-1][0]:.2f} s, {spent[-1][1] / len(planned):.0f} B a point; peak of the parent {peak():.0f} MB")
        import xarray

        since = time.perf_counter()
        with xarray.open_dataset(out / "sweep.nc") as found:
            assert int((found.status == 0).sum()) == len(planned)
        say("open sweep.nc", f"{time.perf_counter() - since:.2f} s")
        since = time.perf_counter()
        assert execute(experiment, out, Options(jobs=jobs), None, 10**7).ran == 0
        say("the same again", f"{time.perf_counter() - since:.2f} s, nothing runs")
    finally:
        shutil.rmtree(out)


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


if __name__ == "__main__":
    main(int((sys.argv[1:2] or [10_000])[0]), int((sys.argv[2:3] or [1])[0]), (sys.argv[3:4] or [None])[0])
