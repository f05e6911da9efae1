"""mpm chart: speed against accuracy over methods and resolutions."""

from pathlib import Path
from typing import Annotated, Any

import typer
from mpm_cli.options import Jobs, Json, MaxRuns, Quiet, Set, again, folder, limit, load
from mpm_cli.progress import reporter
from mpm_cli.talk import document, internal, say

Configs = Annotated[list[Path], typer.Argument(metavar="CONFIG...", help="YAML files of experiments.", show_default=False)]
TO = "Folder for results.  [default: results/<config name>-chart]"
Out = Annotated[Path | None, typer.Option("-o", "--out", metavar="DIR", parser=folder, help=TO, show_default=False)]
BESIDE = "Another program to time in every round; it must print JSON lines {peer, seconds, error}."
Peer = Annotated[list[str] | None, typer.Option(metavar="NAME=COMMAND", help=BESIDE, show_default=False)]


def chart(
    context: typer.Context,
    configs: Configs,
    out: Out = None,
    jobs: Jobs = "auto",
    set_: Set = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Three resolutions a method, three rounds, compilation not timed: under two minutes once compiled.")
    ] = False,
    compiling: Annotated[bool, typer.Option(help="Also time compilation, for each kind of method in a fresh process: 10 to 25 s each.")] = True,
    peer: Peer = None,
    timeout: Annotated[float | None, limit("Time limit per setting, e.g. 90, 90s, 5min or 2h.")] = None,
    max_runs: MaxRuns = 10_000,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Measure speed against accuracy: error, time and the Pareto front over methods and resolutions.

    The methods are those of the config's `chart:` section, otherwise of its sweep's numerical axes, otherwise the usual ones for its physics. Errors are
    measured against `exact:`, otherwise against a Richardson limit. Writes OUT/chart.nc and OUT/chart.png, and prints the cheapest setting for errors of
    10 %, 1 % and 0.1 %. Repeat the command to continue.
    """
    if out is not None and len(configs) > 1:
        raise typer.BadParameter("--out holds one chart; leave it out for several configs")
    peers = dict(pair.split("=", 1) for pair in peer or [] if "=" in pair)
    if len(peers) != len(peer or []):
        raise typer.BadParameter("--peer: say NAME=COMMAND")
    codes, told = [], []
    for config in configs:
        found = one(config, out, jobs, set_, quick, compiling and not quick, peers, timeout, max_runs, as_json, quiet)
        if found["stopped"]:
            say(f"stopped ({found['stopped']}); to go on: {again(context)}", as_json, False)
        codes.append(found["exit_code"])
        told.append(found)
    if as_json:
        document(told if len(told) > 1 else told[0])
    raise typer.Exit(max(codes))


def one(config: Path, out: Any, jobs: int, set_: Any, quick: bool, cold: bool, peers: dict, timeout: Any, max_runs: int, as_json: bool, quiet: bool) -> dict:
    """The chart of one config."""
    from mpm.study.chart import chart as draw_up
    from mpm.study.chart import with_chart
    from mpm.sweep.engine import Options

    experiment = with_chart(load(config, set_), quick)
    place = out or Path("results") / f"{experiment.name}-chart{'-quick' if quick else ''}"
    result = draw_up(experiment, place, Options(jobs, timeout), lambda: reporter(as_json, quiet), peers, cold, max_runs)
    picture = draw(result) if not result.stopped else None
    for line in result.sentences:
        say(line, as_json, quiet)
    if not result.stopped:
        say(f"{result.dataset}\n{picture}", as_json, quiet)
    files = {"out": place, "dataset": result.dataset, "picture": picture}
    return {**files, "answer": result.sentences, "counts": result.counts, "stopped": result.stopped or None, "exit_code": result.exit_code}


def draw(result: Any) -> Path | None:
    """OUT/chart.png."""
    import xarray

    from mpm.plots.chart import speed_accuracy

    picture = result.out / "chart.png"
    try:
        with xarray.open_dataset(result.dataset, engine="h5netcdf") as data:
            speed_accuracy(data.load(), picture)
    except Exception as error:  # the results are there and sound; a figure that fails is told, and does not hide them
        internal(error, "the figure failed")
        return None
    return picture
