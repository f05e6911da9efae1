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
    """Print what a sweep would do, without running it.

    Lists the points and which of them are finished, the physics that will be compiled, the time-step limits and which one applies, dimensionless groups,
    smaller models and what they would save, and estimates of time, memory and output. With --tol it runs coarse pilots: they measure the error of
    smaller models and choose basis, transfer, cell, particles and step (the method from the results of mpm chart, the cell from the pilots).
    """
    from mpm.sweep.plan_report import in_words, outlook

    experiment = load(config, set_, smoke)
    found = outlook(experiment, out, jobs, rerun, max_runs, tol, hear)
    words = in_words(found)
    if tol is not None:
        from mpm.study.choose import offer, settings_in_words

        found["settings"] = offer(experiment, tol, hear)
        words += "\n" + settings_in_words(found["settings"])
    document(found) if as_json else say(words)


def hear(text: str) -> None:
    """A pilot as it begins or ends: on stderr, at once."""
    warn(text)
    sys.stderr.flush()
