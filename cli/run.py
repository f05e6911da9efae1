"""mpm run: one point, in this process."""

from pathlib import Path

import typer
from mpm_cli.options import Checkpoints, Config, Json, MaxRuns, Out, Quiet, Set, Smoke, Strict, Threads, load
from mpm_cli.progress import Single
from mpm_cli.talk import document, leave_at_once, say


def run(
    config: Config,
    out: Out = None,
    set_: Set = None,
    checkpoint: Checkpoints = None,
    smoke: Smoke = False,
    max_runs: MaxRuns = 10_000,
    threads: Threads = 1,
    strict: Strict = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run one point to OUT/run.nc.

    Of a config with a sweep it is the first; --set chooses another. A run that was stopped or killed goes on from its checkpoint.
    Exit codes: 0 ok; 2 usage or config; 3 warnings, with --strict; 4 the point failed; 130 Ctrl-C.
    """
    from mpm.records.checkpoint import EVERY
    from mpm.records.netcdf import seal, write_whole
    from mpm.records.variables import OK, STATUS
    from mpm.sweep.api import default_out, run_one, signals

    experiment = load(config, set_, smoke)
    folder: Path = out or default_out(experiment)
    progress = Single(as_json, quiet)
    try:
        with signals(progress.signal):
            data, record, keeper = run_one(experiment, progress.beat, max_runs, folder / "run.checkpoint", checkpoint or EVERY, progress.note, threads)
    finally:
        progress.close()
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "run.nc", seal(data, record.line))
    if progress.stopped:
        leave_at_once()
    else:
        keeper.drop()
    progress.finished(experiment.name, record)
    if progress.stopped and keeper.there:
        say("the same command goes on from where it stopped", as_json, quiet)
    if as_json:
        named = {"status": STATUS[record.status], "warnings": record.warnings, "finals": record.finals, "facts": record.facts}
        document({"out": folder, "dataset": folder / "run.nc", **record.line, **named})
    else:
        for name, value in record.finals.items() if record.status == OK else ():
            say(f"  {name} = {value:.9g}", quiet=quiet)
        if model := record.facts.get("model"):
            dropped = "; ".join(one["dropped"] for one in model["dropped"])
            say(f"  model: {model['name']}" + (f", without {dropped}" if dropped else "; nothing can be left out"), quiet=quiet)
        if idle := record.facts.get("threads_idle"):
            say(f"  {idle}", quiet=quiet)
        for text in record.warnings:
            say(f"  warning: {text}", quiet=quiet)
        say(f"{folder / 'run.nc'}", quiet=quiet)
    raise typer.Exit({"interrupted": 130, "terminated": 143}.get(progress.stopped, 4 if record.status != OK else 3 if strict and record.warnings else 0))
