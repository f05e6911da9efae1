"""Sweep: from an experiment to its points, over processes, to one dataset.

cases      `plan`: axes, zips, samples and lists of points -> cases with an id that depends on their content alone
designs    Sobol, Latin hypercube, Halton and uniform samples
api        what the shell and Python share: `execute`, `run_one`, `sweep`, `run`; `alone` runs one point to a sweep's folder
engine     hands out points, hears of them, retries, keeps the clock; knows no processes and no disk; `batch_size` how many tiny ones at once
executors  where points run: the interface; `serial` in this process, `processes` by workers on this machine (`worker`), `cluster` by Dask's (`local`, `remote`)
resources  memory and disk that points may take; `queue`: which are missing, and how they are counted
store      the folder of a sweep: points by id (`summaries` of them), what it holds (`manifest`), one writer
collect    makes sweep.nc of it (`table`, `time_columns`, `time_axis`, `coordinates`; `shards` where it would be too large); `background_collect` does so
           while a sweep runs, beside it where that is much
status, compare, plan_report   what is there; same or not; what would be done (`plan_points`: what its points have in common, and where they differ)

The package itself can be called: `mpm.sweep(experiment, out=...)`, although `mpm.sweep.cases` and its siblings are modules.

Further files
    apart           a short-lived interpreter beside this one, for samples and pictures
    case_list       the points of a plan and the dimensions they stand on, as plain data
    collect_apart   the interpreter that collects a folder beside a sweep
    folder          one process in a sweep's folder: it takes the folder, reads what is there, and hears signals meanwhile
    ids             the run ids of a sweep by number and the other way, 24 bytes a point
    lock            one writer a folder, held with flock in OUT/lock
    ragged          one snapshot of particles out of the ragged rows of a dataset, as a plain table
    ranges          the values of each parameter along its dimension, from lists, even ranges and samples
    contour         where to look next for the line on which an answer crosses a level
    refine          new points where the answer bends, crosses a level, or ok meets failed
    report          what an engine tells while it works
    result          what a sweep came to
    rounds          points that are asked for a few at a time, as a fit does, each a point of an ordinary sweep in one folder
    settings        the points of a chart
    verify          every file of a folder against its checksum
    warming         small scenes whose kernels are what most configs need, for `mpm warmup` without a config
"""

import sys
import types
from typing import Any


class _Room(types.ModuleType):
    """A package that is also a function: importing any module of the package puts the package at `mpm.sweep`, over a function of that name."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """See `mpm.sweep.api.sweep`; by the front door's function of that name."""
        import mpm

        return mpm.__getattr__("sweep")(*args, **kwargs)


sys.modules[__name__].__class__ = _Room
