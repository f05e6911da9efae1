"""mpm plan: what a sweep would do. Runs nothing, writes nothing."""

import sys

from mpm_cli.options import Config, Jobs, Json, MaxRuns, Out, Set, Smoke, Tolerance, load
from mpm_cli.sweep import Rerun
from mpm_cli.talk import document, say, warn


def plan(
    config: Config,
    out: Out = None,
    jobs: Jobs = "auto",
    set_: Set = None,
    rerun: Rerun = None,
    max_runs: MaxRuns = 10_000,
    smoke: Smoke = False,
    as_json: Json = False,
    tol: Tolerance = None,
) -> None:
    """Say what a sweep would do.

    Points and which are there, the physics that is compiled, time-step limits and which binds, dimensionless groups, smaller models and what they would
    save, time, memory and bytes. Runs nothing, but with --tol pilots: coarse runs that measure what a smaller model would be off by, and that choose
    basis, transfer, cell, particles and step: the method from the charted fronts (mpm chart), the cell from the pilots.
    """
    from mpm.sweep.outlook import outlook, said

    experiment = load(config, set_, smoke)
    found = outlook(experiment, out, jobs, rerun, max_runs, tol, hear)
    words = said(found)
    if tol is not None:
        from mpm.study.choose import offer, told

        found["settings"] = offer(experiment, tol, hear)
        words += "\n" + told(found["settings"])
    document(found) if as_json else say(words)


def hear(text: str) -> None:
    """A pilot as it begins or ends: on stderr, at once."""
    warn(text)
    sys.stderr.flush()
