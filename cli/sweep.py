"""mpm sweep: every point, over processes; the same command again continues or does nothing."""

from pathlib import Path
from typing import Annotated, Any

import typer
from mpm_cli.options import Checkpoints, Config, Jobs, Json, MaxRuns, Out, Quiet, Set, Smoke, Strict, again, amount, limit, load
from mpm_cli.progress import reporter
from mpm_cli.talk import document, internal, leave_at_once, say, warn
from mpm_cli.unseen import unseen

RERUN = ("failed", "stale", "all")


def which(text: str) -> str:
    """A value of --rerun."""
    if text not in RERUN:
        raise typer.BadParameter(f"{text!r}: say failed, stale or all")
    return text


def route(text: str) -> str:
    """A value of --results."""
    if text not in ("wire", "shared"):
        raise typer.BadParameter(f"{text!r}: say wire or shared")
    return text


def address(text: str) -> str:
    """A value of --scheduler."""
    if not text.strip():
        raise typer.BadParameter("it is empty; say tcp://host:8786, or local")
    return text


MEMORY = "Memory limit per point, e.g. 4GB. A point estimated above it is not started; a running point above it is killed.  [default: free memory]"
SCHEDULER = "Run on the Dask cluster at this address, e.g. tcp://host:8786; local starts a cluster on 127.0.0.1 with JOBS workers."
RESULTS = "How a cluster returns results. wire: over the network; shared: workers write into OUT, which all of them see under one path."
AGAIN = "Rerun finished points. failed: every point that is not ok; stale: results from other source code; all: everything."
RETRIES = "Retries of a killed or timed-out point.  [default: 3 if killed, 0 if timed out]"
DRAW = "sys.modules['dask'] = None; from mpm_cli.sweep import overview; overview(*sys.argv[1:])"  # dask: see mpm_cli.unseen
Rerun = Annotated[str | None, typer.Option(metavar="failed|stale|all", parser=which, help=AGAIN, show_default=False)]


def sweep(
    context: typer.Context,
    config: Config,
    out: Out = None,
    jobs: Jobs = "auto",
    set_: Set = None,
    rerun: Rerun = None,
    timeout: Annotated[float | None, limit("Time limit per point, e.g. 90, 90s, 5min or 2h.")] = None,
    retries: Annotated[int | None, typer.Option(metavar="N", min=0, help=RETRIES, show_default=False)] = None,
    time_budget: Annotated[float | None, limit("Stop the sweep after this time; the same command continues it.")] = None,
    checkpoint: Checkpoints = None,
    fail_fast: Annotated[bool, typer.Option("--fail-fast", help="Stop at the first point that is not ok.")] = False,
    max_failures: Annotated[int | None, typer.Option(metavar="N", min=1, help="Stop after N points that are not ok.", show_default=False)] = None,
    max_runs: MaxRuns = 10_000,
    memory: Annotated[float | None, typer.Option(metavar="SIZE", parser=amount, help=MEMORY, show_default=False)] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", parser=address, help=SCHEDULER, show_default=False)] = None,
    results: Annotated[str, typer.Option(metavar="wire|shared", parser=route, help=RESULTS)] = "wire",
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Run nothing; print what would be done, as mpm plan does.")] = False,
    smoke: Smoke = False,
    strict: Strict = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run every missing point and assemble OUT/sweep.nc.

    Points run in worker processes. Repeat the command to continue a stopped sweep; it does nothing if every point is finished.
    Exit codes: 0 all ok; 2 usage or config; 3 some points failed (or have warnings, with --strict); 4 every point failed; 75 time budget reached; 130 Ctrl-C;
    143 SIGTERM; 141 all ok, but the reader of the output left.
    """
    if dry_run:
        from mpm_cli.plan import plan

        plan(config, out, jobs, set_, rerun, max_runs, smoke, as_json)
        return
    from mpm.config.units import forget
    from mpm.records.checkpoint import EVERY
    from mpm.sweep.api import default_out, execute
    from mpm.sweep.engine import Options

    with unseen("scipy"):  # pint would import it for nothing
        experiment = load(config, set_, smoke)
    forget()
    failures, every = 1 if fail_fast else max_failures, checkpoint or EVERY
    options = Options(
        jobs, timeout, retries, time_budget, failures, rerun, smoke, scheduler=scheduler, shared=results == "shared", memory=memory, checkpoint=every
    )
    result = execute(experiment, out or default_out(experiment), options, reporter(as_json, quiet), max_runs)
    if strict and result.warned and result.exit_code == 0:
        result.exit_code = 3
    if result.hurried:
        leave_at_once()
    picture = draw(result)
    if as_json:
        document(summary(result, picture))
    else:
        for line in words(result, picture, again(context)):
            say(line, quiet=quiet and result.exit_code == 0)
    raise typer.Exit(result.exit_code)


def draw(result: Any) -> Any:
    """OUT/sweep.png, where it is missing or older than the dataset."""
    picture, dataset = result.out / "sweep.png", result.out / "sweep.nc"
    if result.hurried or not dataset.exists():
        return None
    if not result.collected and picture.exists():
        return picture
    from mpm.sweep.apart import apart

    done = apart(DRAW, str(dataset), str(picture))
    if done.returncode < 0:
        warn(f"the figure was not drawn: its process ended by signal {-done.returncode}; `mpm plot {result.out} -o {picture}` tries again")
    return picture if done.returncode == 0 else None


def overview(dataset: str, picture: str) -> None:
    """Draw sweep.png in a process of its own (exit code 1 where that fails): xarray and matplotlib would double what a sweep's process takes."""
    try:
        import xarray

        from mpm.plots import overview as draw

        with xarray.open_datatree(dataset, engine="h5netcdf") as tree:  # reads what is drawn; all fields of a large sweep would take gigabytes
            draw(tree, Path(picture))
    except Exception as error:  # the results are there and sound; a figure that fails is told, and does not hide them
        internal(error, "the figure failed")
        raise SystemExit(1) from None


def summary(result: Any, picture: Any) -> dict[str, Any]:
    """The JSON document."""
    from mpm.records.variables import STATUS

    bad = (result.lines[result.lines.ids[number]] for number in result.lines.by_status(ok=False))
    failures = [{"run_id": line["run_id"], "status": STATUS[line["status"]], "error": line["error"]} for line in bad]
    return {
        "out": result.out,
        "dataset": result.out / "sweep.nc" if (result.out / "sweep.nc").exists() else None,
        "picture": picture,
        "points": sum(result.counts.values()),
        "counts": result.counts,
        "warnings": result.warned,
        "ran": result.ran,
        "failures": failures,
        "stopped": result.stopped or None,
        "seconds": result.seconds,
        "compiling_seconds": result.compiling,
        "exit_code": result.exit_code,
    }


def words(result: Any, picture: Any, command: str) -> list[str]:
    """The same for people; `command` goes on with what is left."""
    from mpm.sweep.queue import counts_in_words

    told = [f"{counts_in_words(result.counts, result.warned)}; {result.ran} run now, {result.seconds:.1f} s"]
    told += [str(path) for path in (result.out / "sweep.nc", picture) if path is not None and path.exists()]
    if result.hurried and not result.collected and result.ran:
        told.append(f"Stopped before the dataset was updated; run `mpm collect {result.out}` (the next sweep also updates it).")
    if result.counts["pending"]:
        left = f"{result.counts['pending']} point{'s are' if result.counts['pending'] > 1 else ' is'} left"
        told.append(f"{left}; to go on: {command}")
    bad = sum(result.counts[name] for name in ("failed", "timeout", "killed", "diverged"))
    if bad:
        told.append(f"{bad} point{'s are' if bad > 1 else ' is'} not ok: `mpm status {result.out}` lists the reasons; --rerun failed runs them again")
    if result.warned:
        told.append(f"warnings: `mpm status {result.out}` names a point for each kind; the variable `warnings` of the dataset gives the details")
    if result.exit_code == 1:
        warn(f"stopped: {result.stopped}")
    return told
