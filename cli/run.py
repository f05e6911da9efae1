"""mpm run: one point, in this process."""

import math
from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.numbers import lines
from mpm_cli.options import Checkpoints, Config, Json, MaxRuns, Out, Quiet, Set, Smoke, Strict, Threads, again, load
from mpm_cli.progress import Single
from mpm_cli.sweep import Rerun
from mpm_cli.talk import document, leave_at_once, say


def run(
    context: typer.Context,
    config: Config,
    out: Out = None,
    set_: Set = None,
    rerun: Rerun = None,
    checkpoint: Checkpoints = None,
    smoke: Smoke = False,
    max_runs: MaxRuns = 10_000,
    threads: Threads = 1,
    strict: Strict = False,
    everything: Annotated[bool, typer.Option("--all", help="Print every number, not only those that the config asks for.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run one point to OUT/run.nc.

    If the config has a sweep, this is its first point; --set selects another. Repeat the command to continue a stopped or killed run from its checkpoint;
    it does nothing if the point is finished. A sweep into the same folder uses the point too.
    Exit codes: 0 ok; 2 usage or config; 3 warnings, with --strict; 4 the point failed; 130 Ctrl-C; 143 SIGTERM.
    """
    from mpm import compiling
    from mpm.records.checkpoint import EVERY
    from mpm.records.variables import OK, STATUS
    from mpm.sweep.alone import run_in
    from mpm.sweep.api import default_out
    from mpm.sweep.folder import signals

    experiment = load(config, set_, smoke)
    folder: Path = out or default_out(experiment)
    progress = Single(as_json, quiet)
    more = {"rerun": rerun, "every": checkpoint or EVERY, "threads": threads, "smoke": smoke, "max_runs": max_runs}
    before = compiling.seconds()
    try:
        with signals(progress.signal):
            with compiling.say(progress.compiling):
                one = run_in(experiment, folder, progress.beat, progress.note, **more)
    finally:
        progress.close()
    record = one.record
    if progress.stopped:
        leave_at_once()
    if one.ran:
        progress.finished(f"{experiment.name} {one.label}".strip(), record, compiling.seconds() - before)
    else:
        say(f"{f'{experiment.name} {one.label}'.strip()}: {record.error or 'ok'}; it was there already, and --rerun all runs it again", as_json, quiet)
    if progress.stopped:
        say(f"{'a checkpoint is kept' if one.kept else 'no checkpoint could be kept'}; to go on: {again(context)}", as_json, quiet)
    if as_json:
        named = {"status": STATUS[record.status], "warnings": record.warnings, "finals": record.finals, "facts": record.facts}
        document({"out": folder, "dataset": one.dataset, "ran": one.ran, **record.line, **named})
    else:
        for line in lines(record, experiment, everything) if record.status == OK else ():
            say(line, quiet=quiet)
        if model := record.facts.get("model"):
            dropped = "; ".join(part["dropped"] for part in model["dropped"])
            say(f"  model: {model['name']}" + (f", without {dropped}" if dropped else "; nothing can be left out"), quiet=quiet)
        if said := implicit(record.steps, record.finals):
            say(f"  {said}", quiet=quiet)
        if idle := record.facts.get("threads_idle"):
            say(f"  {idle}", quiet=quiet)
        for text in record.warnings:
            say(f"  warning: {text}", quiet=quiet)
        say(f"{one.dataset}", quiet=quiet)
    raise typer.Exit({"interrupted": 130, "terminated": 143}.get(progress.stopped, 4 if record.status != OK else 3 if strict and record.warnings else 0))


def implicit(steps: int, finals: dict) -> str:
    """How the steps of implicit mechanics went; empty where there were none, or the run was stopped."""
    if not math.isfinite(finals.get("newton_iterations", math.nan)):
        return ""
    counts = {name: int(finals[name]) for name in ("steps_rejected", "steps_failed", "newton_iterations", "newton_shifts")}
    said = "implicit mechanics: {steps} steps ({steps_rejected} more made again for their error, {steps_failed} cut), {newton_iterations} iterations, "
    deep = f", at most {1e3 * finals['wall_depth']:.2g} mm deep in a wall" if finals["wall_depth"] > 0 else ""
    return (said + "{newton_shifts} shifts").format(steps=steps, **counts) + f"; kinetic energy {finals['kinetic_over_work']:.1g} of the work done{deep}"
